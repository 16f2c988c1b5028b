//! Runs with a probe.

use super::interlocks::{Guarded, touching};
use super::*;
use trirrr_protocol::message::{
    Acting, DriveReading, DriveState, FaultCode, ProbeContact, ProbeRun,
};

const THERE: [f64; 3] = [0.28, 0.28, 0.2];

fn probing() -> Guarded {
    Guarded {
        bench: Bench::set(touching(), home(), settings()),
        readings: InterlockReadings::default(),
    }
}

/// A move on its way by this command, with its tool on.
fn under_way(command: Command<f64>, ticks: u16) -> Guarded {
    let mut machine = probing();
    offer(&mut machine.bench);
    machine.bench.done(command);
    machine.ticks(ticks);
    machine
}

fn offer<S: Scene<N = f64> + 'static>(bench: &mut Bench<S>) {
    let [x, y, alpha] = THERE;
    // One that was measured stands nowhere exactly.
    let from = bench.status().end.map_or(home(), |end| end.pose);
    bench.offer(Move {
        tool_power: 0.5,
        ..rest(0, from, pose(x, y, alpha), 100)
    });
}

const PROBE: Command<f64> = Command::Probe { away: false };

fn contact<S: Scene<N = f64> + 'static>(bench: &mut Bench<S>) -> ProbeContact<f64> {
    match bench.status().probe {
        Some(ProbeRun::Touched(contact)) => contact,
        other => panic!("{other:?}"),
    }
}

/// The first reading counts, bounces and all; from there on the path is that of a stop.
#[test]
fn a_run_ends_in_the_tick_of_the_contact_and_keeps_the_pose_of_its_reading() {
    let mut machine = under_way(PROBE, 40);
    assert!(machine.bench.service.output().tool > 0.0);
    assert_eq!(machine.bench.status().probe, Some(ProbeRun::Armed));
    let mut plain = under_way(Command::Start, 40);
    plain.bench.done(Command::Stop);
    // The reading of the tick belongs to the sample before.
    let sample = *machine.bench.telemetry.last().expect("a sample");
    machine.readings.probe = true;
    let output = machine.tick();
    assert_eq!(output.tool, 0.0);
    assert_eq!(output.motors, plain.tick().motors);
    assert_eq!(machine.bench.service.state(), State::Stopping);
    assert_eq!(machine.bench.status().acting, Acting::Probe);
    let felt = contact(&mut machine.bench);
    assert_eq!((felt.tick, felt.pose), (sample.tick, sample.setpoint.pose));
    assert_eq!(felt.measured, None);
    // It bounces and lets go: that changes nothing.
    machine.readings.probe = false;
    while machine.bench.service.state() != State::Idle {
        assert_eq!(machine.tick().motors, plain.tick().motors);
    }
    assert_eq!(contact(&mut machine.bench), felt);
    let status = machine.bench.status();
    assert_eq!((status.next, status.done), (1, 1));
    let told: Vec<_> = machine
        .bench
        .events
        .iter()
        .filter(|event| matches!(event, Event::Probe(_)))
        .collect();
    let touched = Event::Probe(ProbeRun::Touched(felt));
    assert_eq!(told.last(), Some(&&touched));
}

#[test]
fn a_run_without_a_contact_ends_with_the_job_and_says_so() {
    let mut machine = under_way(PROBE, 1);
    machine.until(State::Idle);
    assert_eq!(machine.bench.status().probe, Some(ProbeRun::NotTouched));
    assert_eq!(machine.bench.status().done, 1);
    // A contact that comes later is none of the run.
    machine.readings.probe = true;
    machine.ticks(20);
    assert_eq!(machine.bench.status().probe, Some(ProbeRun::NotTouched));
    assert_eq!(
        machine.bench.status().inputs.probe,
        trirrr_protocol::message::InputState::Active
    );
}

/// The last reading of a job belongs to its end.
#[test]
fn a_contact_at_the_very_end_of_the_path_counts() {
    let mut machine = under_way(PROBE, 0);
    let [x, y, alpha] = THERE;
    while machine.bench.service.foreground.pose != pose(x, y, alpha) {
        machine.tick();
    }
    machine.readings.probe = true;
    machine.tick();
    assert_eq!(contact(&mut machine.bench).pose, pose(x, y, alpha));
    machine.until(State::Idle);
}

#[test]
fn a_run_is_refused_where_its_contact_is_there_or_cannot_come() {
    let mut machine = probing();
    assert_eq!(machine.bench.refused(PROBE), Refusal::NothingQueued);
    let away = Command::Probe { away: true };
    assert_eq!(machine.bench.refused(away), Refusal::ProbeOpen);
    machine.readings.probe = true;
    machine.ticks(5);
    assert_eq!(machine.bench.refused(PROBE), Refusal::ProbeTouches);
    let mut plain = Bench::<Thesis<f64>>::new();
    assert_eq!(plain.refused(PROBE), Refusal::NoProbe);
    let guarded = super::interlocks::scene(crate::settings::StopCategory::Off);
    let mut guarded = Bench::set(guarded, home(), settings());
    assert_eq!(guarded.refused(PROBE), Refusal::NoProbe);
    assert_eq!(guarded.status().probe, None);
}

#[test]
fn a_run_away_ends_where_the_probe_lets_go() {
    let mut machine = probing();
    machine.readings.probe = true;
    machine.ticks(5);
    offer(&mut machine.bench);
    machine.bench.done(Command::Probe { away: true });
    machine.ticks(40);
    assert_eq!(machine.bench.service.state(), State::Running);
    machine.readings.probe = false;
    machine.tick();
    assert_eq!(machine.bench.service.state(), State::Stopping);
    contact(&mut machine.bench);
}

/// An order that meets a contact, free of bounces, changes nothing; a job without a probe does not mind one.
#[test]
fn only_a_run_minds_the_probe() {
    let mut machine = under_way(Command::Start, 40);
    machine.readings.probe = true;
    machine.ticks(5);
    assert_eq!(machine.bench.service.state(), State::Running);
    machine.until(State::Idle);
    machine.readings.probe = false;
    machine.ticks(5);
    let end = machine.bench.status().end.expect("it stands").pose;
    machine.bench.offer(rest(1, end, home(), 100));
    machine.readings.probe = true;
    machine.tick();
    machine.bench.done(PROBE);
    machine.ticks(5);
    assert_eq!(machine.bench.state(), State::Idle);
    assert_eq!(machine.bench.status().probe, None);
}

#[test]
fn a_run_that_is_stopped_or_fails_was_without_a_contact() {
    for fails in [false, true] {
        let mut machine = under_way(PROBE, 40);
        match fails {
            true => machine
                .bench
                .service
                .raise(FaultCode::Overrun, None, 1.5, 1.0),
            false => machine.bench.done(Command::Stop),
        }
        machine.tick();
        machine.readings.probe = true;
        machine.ticks(40);
        assert_eq!(machine.bench.status().probe, Some(ProbeRun::NotTouched));
    }
    // A hold leaves the run as it is: the contact ends it.
    let mut machine = under_way(PROBE, 40);
    machine.bench.done(Command::Hold);
    machine.until(State::Holding);
    assert_eq!(machine.bench.status().probe, Some(ProbeRun::Armed));
    machine.bench.done(Command::Resume);
    machine.until(State::Running);
    machine.readings.probe = true;
    machine.until(State::Idle);
    contact(&mut machine.bench);
}

/// Drives that lag behind their commands by 1 mrad: the measured pose is where the platform truly was.
#[test]
fn drives_that_tell_where_they_are_give_the_measured_pose() {
    let feedback = super::feedback::coefficients();
    let scene = SceneParts {
        feedback: Some(feedback),
        ..touching()
    };
    let mut bench = Bench::off(scene, home(), settings());
    let mut readings = InterlockReadings::default();
    let mut tick = |bench: &mut Bench<_>, lag: f64, touches: bool| {
        let service: &mut Service<'_, _> = &mut bench.service;
        let output = *service.output();
        let state = match output.is_on() {
            true => DriveState::On,
            false => DriveState::Off,
        };
        service.hear(output.motors.map(|motor| DriveReading {
            state,
            age: 0,
            state_age: 0,
            ..DriveReading::unheard(motor.angle - lag)
        }));
        readings.probe = touches;
        service.sense(readings);
        bench.tick();
        bench.judge();
        output.motors.map(|motor| motor.angle - lag)
    };
    bench.done(Command::Enable);
    for _ in 0..10 {
        tick(&mut bench, 0.0, false);
    }
    assert_eq!(bench.state(), State::Idle, "{:?}", bench.status());
    offer(&mut bench);
    bench.done(PROBE);
    for _ in 0..40 {
        tick(&mut bench, 1e-3, false);
    }
    let told = tick(&mut bench, 1e-3, true);
    let felt = contact(&mut bench);
    let measured = felt.measured.expect("a pose");
    let angles =
        super::feedback::angles_at([measured.position.x, measured.position.y, measured.angle]);
    for (angle, told) in angles.expect("in reach").iter().zip(told) {
        assert!((angle - told).abs() < 1e-9, "{angle} {told}");
    }
    assert!((measured.position.x - felt.pose.position.x).abs() > 1e-5);
}
