//! A service with feedback on drives of a bus: enabled wherever the machine stands, without a step.

use crate::bench::{Bench, GEAR, TICK_RATE_HZ, TIMEOUT_TICKS, odrive, wrapped};
use std::f64::consts::TAU;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{Geometry, example};
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_drives::can::Odrive;
use trirrr_protocol::message::{Command, DriveFault, FaultCode, NotEnabled, Reply, State};
use trirrr_service::coefficients::FeedbackCoefficients;
use trirrr_service::features::{FeedbackParameters, On};
use trirrr_service::{Adjustable, Channels, Power, SceneParts, Service, Settings, scene};

scene! {
    /// The thesis machine, whose drives tell where they are.
    pub(crate) Measuring: Adjustable<Dynamic<f64>>, feedback = On
}

pub(crate) const HOME: [f64; 3] = [0.21, 0.22, 0.157];

pub(crate) fn angles_at([x, y, alpha]: [f64; 3]) -> Option<[f64; 3]> {
    let geometry = Geometry::<f64>::build(&example()).unwrap();
    let position = geometry.position(&Pose::from_f64(x, y, alpha)).ok()?;
    Some(geometry.motor_angles(&position))
}

/// Service of the machine, in memory that is never freed.
pub(crate) fn service(home: Pose<f64>) -> Service<'static, Measuring> {
    let parameters = FeedbackParameters {
        timeout_ticks: TIMEOUT_TICKS,
        enable_ticks: 200,
        still_rad: 2e-3,
        standing_rad: 0.02,
        moving_rad: 0.1,
        window_ticks: 5,
    };
    let geometry = Geometry::<f64>::build(&example()).unwrap();
    let coefficients = FeedbackCoefficients::build(&parameters, &example(), &geometry, home);
    let scene = SceneParts {
        feedback: Some(&*Box::leak(Box::new(coefficients.unwrap()))),
        ..Adjustable::new(example(), LimitParameters::default()).into()
    };
    let channels = Box::leak(Box::new(Channels::<Measuring, 8, 8>::new()));
    let settings = Settings::at(TICK_RATE_HZ);
    channels.service(scene, home, settings).unwrap()
}

/// Enables a machine that stands at `pose`, spoilt before by `spoil`. Returns the largest step of a command at the
/// rotor in turns, the last state, its fault, and why it was not enabled.
fn enabled(
    pose: [f64; 3],
    spoil: impl Fn(&mut Bench<Odrive, 8>, u32),
) -> (f64, State, Option<FaultCode>, Option<NotEnabled<f64>>) {
    let joints = angles_at(pose).unwrap();
    let mut service = service(Pose::from_f64(HOME[0], HOME[1], HOME[2]));
    // The rotor's turn is known: near the pose.
    let mut bench = Bench::near(Odrive, odrive, joints, joints.map(|angle| angle + 0.2));
    let mut largest: f64 = 0.0;
    let mut fault = None;
    for tick in 0..400 {
        if tick == 20 {
            assert_eq!(service.submit(&Command::Enable), Reply::Done);
        }
        spoil(&mut bench, tick);
        let readings = bench.measure();
        service.hear(readings);
        let output = *service.tick();
        if output.power == Power::On {
            for (motor, joint) in output.motors.iter().zip(joints) {
                let step = wrapped(motor.angle - joint) * GEAR / TAU;
                largest = largest.max(step.abs());
            }
        }
        if let Err(what) = bench.tick_by(&output) {
            service.raise(FaultCode::Drive(what), None, 0.0, 0.0);
        }
        while service.step() {}
        while service.outgoing().is_some() {}
        fault = service.status().fault.map(|fault| fault.code).or(fault);
    }
    let not_enabled = service.status().not_enabled;
    (largest, service.state(), fault, not_enabled)
}

/// The first command is the measured angle: within a count of an encoder of 16,384, at the rotor.
#[test]
fn a_machine_is_enabled_where_it_stands_without_a_step() {
    let mut poses = 0;
    for step in 0..60 {
        let wave = |frequency: f64| (frequency * f64::from(step) + 0.4).sin();
        let pose = [
            0.25 + 0.06 * wave(1.1),
            0.26 + 0.06 * wave(1.7),
            0.4 * wave(2.3),
        ];
        if angles_at(pose).is_none() {
            continue;
        }
        let (largest, state, fault, not_enabled) = enabled(pose, |_, _| {});
        assert_eq!(
            (state, fault, not_enabled),
            (State::Idle, None, None),
            "{pose:?}"
        );
        assert!(largest <= 1.0 / 16_384.0, "{pose:?}: {largest:e} turns");
        poses += 1;
    }
    assert!(poses >= 40, "{poses}");
}

#[test]
fn a_drive_that_fails_is_refused_or_a_fault() {
    let dead = |at: u32| {
        enabled(HOME, move |bench, tick| {
            if tick == at {
                bench.medium().drive(1).die();
            }
        })
    };
    // Before: refused with its reason. While on: a fault.
    let (_, state, _, not_enabled) = dead(0);
    assert_eq!(state, State::Disabled);
    assert!(
        matches!(not_enabled, Some(NotEnabled::Drive { motor: 1, .. })),
        "{not_enabled:?}"
    );
    let (_, state, fault, _) = dead(300);
    assert_eq!(
        (state, fault),
        (State::Fault, Some(FaultCode::Drive(DriveFault::Silent)))
    );
    let (_, state, fault, _) = enabled(HOME, |bench, tick| {
        if tick == 300 {
            bench.medium().drive(2).idle();
        }
    });
    assert_eq!(
        (state, fault),
        (State::Fault, Some(FaultCode::Drive(DriveFault::NotOn)))
    );
    let (_, state, fault, _) = enabled(HOME, |bench, tick| {
        if tick == 300 {
            bench.medium().drive(0).heat();
        }
    });
    assert_eq!(
        (state, fault),
        (State::Fault, Some(FaultCode::Drive(DriveFault::Reported)))
    );
    // An encoder that slips by a twentieth of a turn of the joint.
    let (_, state, fault, _) = enabled(HOME, |bench, tick| {
        if tick == 300 {
            bench.medium().drive(0).servo().offset += 0.05 * GEAR;
        }
    });
    assert_eq!(
        (state, fault),
        (State::Fault, Some(FaultCode::FollowingError))
    );
}
