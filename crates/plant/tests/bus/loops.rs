//! A service on amplifiers and encoders, with the loops of a board: enabled wherever the machine stands, and safe when a part
//! of it fails.

use crate::bench::wrapped;
use crate::faults::Random;
use crate::service::{HOME, angles_at};
use std::f64::consts::TAU;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{Geometry, example};
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;
use trirrr_plant::loop_drives::SimulatedLoops;
use trirrr_protocol::message::{Command, DriveFault, FaultCode, NotEnabled, Reply, State};
use trirrr_scene::Scene;
use trirrr_service::coefficients::{FeedbackCoefficients, HomingCoefficients};
use trirrr_service::features::{
    Contact, FeedbackParameters, HomingMotor, HomingParameters, HomingTimes, NoImage, On,
};
use trirrr_service::{Adjustable, Channels, SceneParts, Settings, scene};

scene! {
    /// The thesis machine with homing and feedback.
    Measuring: Adjustable<Dynamic<f64>>, batches = On, update = NoImage, homing = On, feedback = On
}

const TICK_RATE_HZ: f64 = 500.0;
const PER_TICK: u32 = 10;
const COUNTS_PER_TURN: f64 = 4096.0 * 10.0;
const WINDOW_TICKS: u16 = 5;
/// Inertia of a joint, kg m^2, friction, N m s/rad, and the load on it, N m.
const INERTIA: f64 = 0.02;
const VISCOUS: f64 = 0.02;
const LOAD: f64 = 0.3;

/// Watch over the loops.
const WATCH: FeedbackParameters = FeedbackParameters {
    timeout_ticks: 20,
    enable_ticks: 200,
    still_rad: 2e-3,
    standing_rad: 0.01,
    moving_rad: 0.1,
    window_ticks: WINDOW_TICKS,
};

/// The machine of the example on amplifiers with encoders.
fn scene() -> Scene {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenes/plant-thesis.toml"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let edits = [
        ("tick_rate_hz = 100", "tick_rate_hz = 500"),
        ("rate_hz = 10000", "rate_hz = 5000"),
        (
            "encoder_counts_per_rev = 16384",
            "encoder_counts_per_rev = 4096",
        ),
        ("kp_nm_rad = 2000.0", "kp_nm_rad = 500.0"),
    ];
    let text = edits.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    Scene::parse(&text, "loops.toml").unwrap()
}

/// Fault of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// The amplifier fails, and tells.
    Failed,
    /// It gives no current, and does not tell.
    Dead,
    /// The encoder does not count any more.
    Stuck,
    /// It has lost counts.
    Slipped(i32),
}

/// End of a run.
struct Ended {
    /// Largest difference between a command while enabling and where the joints stood, rad.
    step: f64,
    state: State,
    fault: Option<(FaultCode, u32)>,
    not_enabled: Option<NotEnabled<f64>>,
    /// Largest torque of an amplifier while the state said that they are off.
    off_torque: f64,
    /// Largest way of a joint from where it stood, rad.
    farthest: f64,
}

/// Enables a machine at `pose` in tick 20, and spoils motor `leg` by `part` in tick `at`.
fn play(pose: [f64; 3], at: u32, leg: usize, part: Option<Part>, ticks: u32) -> Ended {
    let stood = angles_at(pose).unwrap();
    let home = Pose::from_f64(HOME[0], HOME[1], HOME[2]);
    let geometry = Geometry::<f64>::build(&example()).unwrap();
    let coefficients = FeedbackCoefficients::build(&WATCH, &example(), &geometry, home).unwrap();
    let measuring = SceneParts {
        feedback: Some(&coefficients),
        ..Adjustable::new(example(), LimitParameters::default()).into()
    };
    let mut channels = Box::new(Channels::<Measuring, 8, 8>::new());
    let mut service = channels
        .service(measuring, home, Settings::at(TICK_RATE_HZ))
        .unwrap();
    let mut loops = SimulatedLoops::build::<f64>(&scene(), PER_TICK, Units::SI, stood).unwrap();
    let (mut joints, mut rates) = (stood, [0.0; 3]);
    let mut ended = Ended {
        step: 0.0,
        state: State::Disabled,
        fault: None,
        not_enabled: None,
        off_torque: 0.0,
        farthest: 0.0,
    };
    let period = 1.0 / (TICK_RATE_HZ * f64::from(PER_TICK));
    for tick in 0..ticks {
        if tick == 20 {
            assert_eq!(service.submit(&Command::Enable), Reply::Done);
        }
        if let Some(part) = part.filter(|_| tick == at) {
            let faults = &mut loops.faults[leg];
            match part {
                Part::Failed => faults.failed = true,
                Part::Dead => faults.dead = true,
                Part::Stuck => faults.stuck = true,
                Part::Slipped(counts) => faults.slipped = counts,
            }
        }
        let readings = loops.measure();
        service.hear(readings);
        let output = *service.tick();
        if output.is_on() && ended.fault.is_none() && part.is_none() {
            for (motor, joint) in output.motors.iter().zip(stood) {
                ended.step = ended.step.max(wrapped(motor.angle - joint).abs());
            }
        }
        loops.apply(&output);
        for _ in 0..PER_TICK {
            let torques = loops.step(joints);
            for i in 0..3 {
                // A brake holds what is off; a load pulls at what is not.
                if !output.is_on() {
                    rates[i] = 0.0;
                    ended.off_torque = ended.off_torque.max(torques[i].abs());
                    continue;
                }
                let load = LOAD - VISCOUS * rates[i];
                rates[i] += (torques[i] + load) / INERTIA * period;
                joints[i] += rates[i] * period;
                ended.farthest = ended.farthest.max((joints[i] - stood[i]).abs());
            }
        }
        while service.step() {}
        while service.outgoing().is_some() {}
        if let Some(fault) = service.status().fault
            && ended.fault.is_none()
        {
            ended.fault = Some((fault.code, tick));
        }
    }
    ended.not_enabled = service.status().not_enabled;
    ended.state = service.state();
    ended
}

/// Anywhere in the workspace whose angles the encoders know: the first command is where the joints are.
#[test]
fn a_machine_is_enabled_where_it_stands_within_a_count() {
    for pose in [HOME, [0.25, 0.26, 0.3], [0.27, 0.2, -0.2]] {
        let ended = play(pose, 0, 0, None, 300);
        assert_eq!((ended.state, ended.fault.is_none()), (State::Idle, true));
        assert!(
            ended.step <= TAU / COUNTS_PER_TURN,
            "{pose:?}: {:e}",
            ended.step
        );
        assert_eq!(ended.off_torque, 0.0);
        // 0.3 N m over 500 N m/rad.
        assert!(ended.farthest < 3e-3, "{}", ended.farthest);
    }
}

#[test]
fn an_amplifier_that_has_failed_is_not_enabled() {
    let ended = play(HOME, 5, 1, Some(Part::Failed), 300);
    assert_eq!(ended.state, State::Disabled);
    assert!(
        matches!(
            ended.not_enabled,
            Some(NotEnabled::Drive {
                motor: 1,
                error: 1,
                ..
            })
        ),
        "{:?}",
        ended.not_enabled
    );
    assert_eq!(ended.off_torque, 0.0);
}

/// A part that fails at any time while the machine stands under load: the right fault, in its time, with the amplifiers off.
#[test]
fn parts_that_fail_are_faults() {
    let mut random = Random(5);
    for case in 0..60 {
        let (at, leg) = (60 + random.below(60), random.below(3) as usize);
        let part = match random.below(4) {
            0 => Part::Failed,
            1 => Part::Dead,
            2 => Part::Stuck,
            // More than 0.01 rad, which the loop sees as an error and turns away.
            _ => Part::Slipped([-1, 1][case % 2] * (200 + random.below(2000) as i32)),
        };
        let ended = play(HOME, at, leg, Some(part), 320);
        let context = format!("{part:?} of {leg} in tick {at}: {:?}", ended.fault);
        let (code, tick) = match ended.fault {
            Some(fault) => fault,
            // A loop that stands still finds no error with an encoder that stands still, either.
            None if part == Part::Stuck => continue,
            None => panic!("{context}"),
        };
        assert_eq!(ended.state, State::Fault, "{context}");
        match part {
            Part::Failed => {
                assert_eq!(code, FaultCode::Drive(DriveFault::Reported), "{context}");
                assert!(tick - at <= 2, "{context}");
            }
            _ => {
                assert_eq!(code, FaultCode::FollowingError, "{context}");
                // 0.3 N m turn 0.02 kg m^2 by 0.01 rad within 37 ms.
                assert!(tick - at <= 20 + u32::from(WINDOW_TICKS), "{context}");
            }
        }
        assert_eq!(ended.off_torque, 0.0, "{context}");
    }
}

/// Stiffness and damping of a hard stop, N m/rad and N m s/rad, and the torque that tells it, N m.
const STOP: [f64; 2] = [2e4, 5.0];
const STALL_TORQUE: f64 = 1.0;

/// Homes a machine whose joints stand `offset` from where they are counted from, against hard stops that the loops feel. Returns
/// how far what the loops tell is from the joints then, and the largest torque on a stop.
fn home(offset: [f64; 3]) -> ([f64; 3], f64) {
    let counted = angles_at(HOME).unwrap();
    let pose = Pose::from_f64(HOME[0], HOME[1], HOME[2]);
    let positive = [true, false, true];
    let sign = positive.map(|positive| if positive { 1.0 } else { -1.0 });
    let period = 1.0 / TICK_RATE_HZ;
    let motors = [0, 1, 2].map(|i| HomingMotor {
        angle_rad: wrapped(counted[i] + 0.4 * sign[i]),
        positive: positive[i],
        search_rate_rad_s: 0.5,
        latch_rate_rad_s: 0.05,
        acceleration_rad_s2: 5.0,
        back_off_rad: 0.1,
        travel_max_rad: 1.0,
        stall_torque_nm: STALL_TORQUE,
        stage: 0,
    });
    let debounce_ticks = 3;
    let settings = Settings::at(TICK_RATE_HZ);
    let homing = HomingParameters {
        contact: Contact::Torque,
        motors,
        debounce_ticks,
        stall_is_fault: false,
        start: HOME,
        times: HomingTimes::new(
            Contact::Torque,
            &motors,
            debounce_ticks,
            counted,
            period,
            settings.ramp.ticks,
        ),
    };
    let geometry = Geometry::<f64>::build(&example()).unwrap();
    let feedback = FeedbackCoefficients::build(&WATCH, &example(), &geometry, pose).unwrap();
    let homing = HomingCoefficients::build(&homing, period);
    let scene = SceneParts {
        homing: Some(&homing),
        feedback: Some(&feedback),
        ..Adjustable::new(example(), LimitParameters::default()).into()
    };
    let mut channels = Box::new(Channels::<Measuring, 8, 8>::new());
    let mut service = channels.service(scene, pose, settings).unwrap();
    let mut loops = SimulatedLoops::build::<f64>(&self::scene(), PER_TICK, Units::SI, counted);
    let loops = loops.as_mut().unwrap();
    let mut joints = [0, 1, 2].map(|i| counted[i] + offset[i]);
    let (mut rates, mut pressed) = ([0.0_f64; 3], 0.0_f64);
    let step = period / f64::from(PER_TICK);
    for tick in 0..20_000 {
        match (tick, service.state()) {
            (5, _) => assert_eq!(service.submit(&Command::Enable), Reply::Done),
            (_, State::Unhomed) => assert_eq!(service.submit(&Command::Home), Reply::Done),
            (_, State::Idle) => break,
            (_, State::Fault) => panic!("{:?}", service.status().fault),
            _ => {}
        }
        if tick % 100 == 0 {
            service.submit(&Command::Status);
        }
        while service.step() {}
        while service.outgoing().is_some() {}
        service.hear(loops.measure());
        let output = *service.tick();
        if let Some(by) = service.shift() {
            loops.shift::<f64>(by);
        }
        loops.apply(&output);
        for _ in 0..PER_TICK {
            // The encoders count from where the joints were.
            let torques = loops.step([0, 1, 2].map(|i| joints[i] - offset[i]));
            for i in 0..3 {
                if !output.is_on() {
                    continue;
                }
                let into = sign[i] * wrapped(joints[i] - motors[i].angle_rad);
                let push = match into > 0.0 {
                    true => (STOP[0] * into + STOP[1] * sign[i] * rates[i]).max(0.0),
                    false => 0.0,
                };
                pressed = pressed.max(push);
                let torque = torques[i] - sign[i] * push + LOAD - VISCOUS * rates[i];
                rates[i] += step * torque / INERTIA;
                joints[i] += step * rates[i];
            }
        }
    }
    assert_eq!(service.state(), State::Idle, "not homed");
    let readings = loops.measure::<f64>();
    let off = [0, 1, 2].map(|i| wrapped(readings[i].angle - joints[i]));
    (off, pressed)
}

/// Amplifiers and encoders find hard stops by the torque of their loops, from wherever the joints stand: to two counts.
#[test]
fn loops_are_homed_to_hard_stops_by_their_torque() {
    let mut random = Random(11);
    let count = TAU / COUNTS_PER_TURN;
    for _ in 0..12 {
        let offset = [0, 1, 2].map(|_| (f64::from(random.below(5000)) - 2500.0) * 1e-4);
        let (off, pressed) = home(offset);
        for each in off {
            assert!(each.abs() <= 2.0 * count, "{offset:?}: {off:?}");
        }
        // The joint's impact at the rate of the search, and what the loops press with: their torque rises by 500 N m/rad times
        // 0.5 rad/s in the ticks that confirm it.
        let impact = 0.5 * (STOP[0] * INERTIA).sqrt();
        let most = impact + STALL_TORQUE + LOAD + 500.0 * 0.5 * 5.0 / TICK_RATE_HZ;
        assert!(pressed > STALL_TORQUE && pressed < most, "{pressed} N m");
    }
}
