//! Steppers behind the service: over holds, faults and recoveries the pulses add up to the rounded
//! angle that the service has given out.

mod common;

use common::{Pin, Scope};
use core::f64::consts::{PI, TAU};
use std::path::Path;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_drives::stepper::StepsPerTurn;
use trirrr_drives::stepper::{Axis, Line, Slots, Steppers, slots_per_tick};
use trirrr_drives::{Active, Enable};
use trirrr_protocol::message::{Command, DriveFault, FaultCode, Move, Recovery, Reply, State};
use trirrr_scene::Scene;
use trirrr_service::board::CommandOf;
use trirrr_service::paces::Ramp;
use trirrr_service::{Adjustable, Channels, Service, Settings};

type Scalar = f32;
type SceneChannels = Channels<Adjustable<Dynamic<Scalar>>, 4, 4>;

const MICROSTEPS: u32 = 3200;
const GEAR: f64 = 5.0;

/// A machine: service, drives, and what the pulses have come to.
struct Machine<'a> {
    service: Service<'a, Adjustable<Dynamic<Scalar>>>,
    steppers: Steppers<'a, Scalar>,
    slots: Slots<'a, Pin, Pin, Pin>,
    per_tick: u32,
    scope: Scope,
    forward: [bool; 3],
    pulses: [i64; 3],
    /// Angles that the service has given out, unwrapped, from the start.
    turned: [f64; 3],
    last: [f64; 3],
}

fn scene() -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/pick-stepper.toml");
    Scene::read(file).expect("a shipped scene")
}

fn pose(x: f64, y: f64, alpha: f64) -> Pose<Scalar> {
    Pose::from_f64(x, y, alpha)
}

fn start() -> Pose<Scalar> {
    pose(0.22, 0.24, 0.1)
}

impl<'a> Machine<'a> {
    fn new(channels: &'a mut SceneChannels, line: &'a Line, most: u32) -> Self {
        let scene = scene();
        let settings = Settings {
            ramp: Ramp::within(20, None),
            ..Settings::at(scene.tick_rate_hz)
        };
        let adjustable = Adjustable::new(scene.parameters, scene.limits);
        let service = channels.service(adjustable, start(), settings).unwrap();
        let angles = service.output().motors.map(|motor| motor.angle);
        let scope = Scope::default();
        let axis = |names: [&'static str; 2]| {
            let [step, direction] = names.map(|name| scope.pin(name));
            Axis::new(step, direction, false).unwrap()
        };
        let axes = [axis(["s0", "d0"]), axis(["s1", "d1"]), axis(["s2", "d2"])];
        let enable = Enable::new(scope.pin("enable"), Active::Low).unwrap();
        let per_tick = slots_per_tick(most);
        let mut machine = Self {
            service,
            steppers: Steppers::new(
                [StepsPerTurn::new(MICROSTEPS, GEAR); 3],
                [most; 3],
                angles,
                line,
            ),
            slots: Slots::new(line, axes, enable, per_tick),
            per_tick,
            scope,
            forward: [true; 3],
            pulses: [0; 3],
            turned: [0.0; 3],
            last: angles.map(f64::from),
        };
        machine.scope.take();
        machine.ask(Command::Enable);
        machine.tick();
        machine
    }

    fn acknowledge(&mut self) {
        self.ask(Command::ClearFault);
        self.ticks(2);
        self.ask(Command::Enable);
        self.ticks(2);
    }

    fn ask(&mut self, command: CommandOf<Adjustable<Dynamic<Scalar>>>) {
        let reply = self.service.submit(&command);
        assert!(!matches!(reply, Reply::Refused(_)), "{reply:?}");
        while self.service.step() {}
        while self.service.outgoing().is_some() {}
    }

    fn offer(&mut self, number: u32, to: Pose<Scalar>, ticks: u32) {
        self.ask(Command::Move(Move::rest_to_rest(
            number,
            start(),
            to,
            ticks,
        )));
        assert_eq!(self.service.status().refused, None);
    }

    /// A tick as the firmware does it, the slots up to the next, and the pulses counted.
    fn tick(&mut self) {
        let failed = self.steppers.apply(self.service.tick());
        if let Err(failure) = failed {
            let (code, drive) = (failure.code(), failure.drive);
            self.service
                .raise(code, drive, failure.value, failure.limit);
            assert!(self.service.set_position(self.steppers.angles()));
            self.steppers.apply(self.service.output()).unwrap();
        }
        let given = self
            .service
            .output()
            .motors
            .map(|motor| f64::from(motor.angle));
        for ((turned, last), now) in self.turned.iter_mut().zip(&mut self.last).zip(given) {
            let step = now - *last;
            *turned += step - TAU * (step / TAU).round();
            *last = now;
        }
        // With the one to spare.
        for _ in 0..=self.per_tick {
            self.scope.now.set(self.scope.now.get() + 1);
            self.slots.slot().unwrap();
        }
        for edge in self.scope.take() {
            let motor = edge.pin.as_bytes()[1].wrapping_sub(b'0') as usize;
            match edge.pin.as_bytes()[0] {
                b'd' => self.forward[motor] = edge.high,
                b's' if edge.high => self.pulses[motor] += if self.forward[motor] { 1 } else { -1 },
                _ => {}
            }
        }
    }

    /// The pulses are those of the angles that were given out.
    fn is_there(&self) {
        for (pulses, turned) in self.pulses.iter().zip(self.turned) {
            let exact = turned * f64::from(MICROSTEPS) * GEAR / TAU;
            // In binary32 an angle is up to 2^-22 rad off, 6e-4 of a microstep, at either end. The position follows the
            // angle within a sixteenth.
            assert!(
                (*pulses as f64 - exact).abs() <= 0.5625 + 2e-3,
                "{pulses} {exact}"
            );
        }
    }

    fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            self.tick();
            self.is_there();
            self.ask(Command::Status);
        }
    }

    fn state(&self) -> State {
        self.service.state()
    }

    /// From wherever it stands to the start.
    fn recover(&mut self, ticks: u32) {
        self.ask(Command::Recover(Recovery { to: start(), ticks }));
        self.ticks(ticks + 5);
        assert_eq!(self.state(), State::Idle);
    }
}

#[test]
fn over_holds_faults_and_recoveries_no_step_is_lost() {
    let mut channels = Box::new(SceneChannels::new());
    let line = Line::new();
    let mut machine = Machine::new(&mut channels, &line, 80);
    machine.offer(0, pose(0.29, 0.26, 0.2), 200);
    machine.ask(Command::Start);
    machine.ticks(40);
    machine.ask(Command::Hold);
    machine.ticks(40);
    assert_eq!(machine.state(), State::Holding);
    machine.ask(Command::Resume);
    machine.ticks(60);
    assert_eq!(machine.state(), State::Running);
    let halfway = machine.pulses;
    assert!(
        halfway.iter().any(|pulses| pulses.abs() > 100),
        "{halfway:?}"
    );
    // A fault from elsewhere, in the middle of the way.
    let code = FaultCode::Drive(DriveFault::Reported);
    machine.service.raise(code, Some(1), 1.0, 0.0);
    machine.ticks(10);
    assert_eq!(machine.state(), State::Fault);
    machine.acknowledge();
    machine.ticks(10);
    machine.recover(300);
    // Where it began, to the step, as the angles are.
    assert_eq!(machine.pulses, [0; 3]);
    assert!(machine.turned.iter().all(|turned| turned.abs() < PI / 1e5));
}

#[test]
fn a_motor_that_is_too_slow_is_where_it_was_when_the_fault_is_cleared() {
    let mut channels = Box::new(SceneChannels::new());
    let line = Line::new();
    // At most two microsteps in a tick, 0.4 rad/s.
    let mut machine = Machine::new(&mut channels, &line, 2);
    machine.offer(0, pose(0.29, 0.26, 0.2), 150);
    machine.ask(Command::Start);
    for _ in 0..200 {
        machine.tick();
        machine.is_there();
        if machine.state() == State::Fault {
            break;
        }
        machine.ask(Command::Status);
    }
    // The next tick reports it.
    machine.ticks(1);
    let fault = machine.service.status().fault.expect("too fast");
    assert_eq!(fault.code, FaultCode::Drive(DriveFault::StepRate));
    assert!(fault.value > 1.0 && fault.limit == 1.0, "{fault:?}");
    let stands = machine.pulses;
    machine.ticks(5);
    machine.acknowledge();
    machine.ticks(5);
    // It holds, and does not fail again.
    assert_eq!((machine.state(), machine.pulses), (State::Cleared, stands));
    machine.recover(2000);
    assert_eq!(machine.pulses, [0; 3]);
}
