//! From questions to drives that are on, and back.

use crate::bench::{
    Bench, DAMIAO, Ended, MOTEUS, ROBSTRIDE, START, T_MOTOR, actuator, moteus, odrive, wrapped,
};
use trirrr_drives::can::{Odrive, Protocol};
use trirrr_protocol::message::{DriveReading, DriveState};
use trirrr_service::Power;

/// Whatever the drives have counted from: they go on where they are, without a torque, and off again.
fn goes_on_where_it_stands<P: Protocol, const LONGEST: usize>(mut bench: Bench<P, LONGEST>) {
    // Off, and with questions alone: no drive has a torque, whatever the board asks.
    for power in [Power::Off, Power::Check, Power::Clear, Power::Check] {
        bench.power = power;
        for _ in 0..20 {
            bench.tick().unwrap();
            assert_eq!(bench.torques(), [0.0; 3]);
        }
    }
    let known = bench.readings;
    for (reading, start) in known.iter().zip(START) {
        assert_eq!((reading.state, reading.error), (DriveState::Off, 0));
        // A unit of the MIT mode is 400 rad / 65535 at the rotor.
        assert!(wrapped(reading.angle - start).abs() < 8e-4, "{reading:?}");
    }
    let most = |bench: &Bench<P, LONGEST>| {
        bench
            .torques()
            .map(f64::abs)
            .into_iter()
            .fold(0.0, f64::max)
    };
    bench.power = Power::Check;
    bench.stand();
    bench.power = Power::On;
    let mut ticks = 0;
    while !bench
        .readings
        .iter()
        .all(|reading| reading.state == DriveState::On)
    {
        bench.tick().unwrap();
        // One unit of position and one of torque: no step.
        assert!(most(&bench) < 0.25, "{:?}", bench.torques());
        ticks += 1;
        assert!(ticks < 60);
    }
    bench.watch(200).unwrap();
    assert!(most(&bench) < 0.25);
    // Off within the tick that says so: the frames, and a sample.
    bench.power = Power::Off;
    bench.tick().unwrap();
    bench.tick().unwrap();
    assert_eq!(bench.torques(), [0.0; 3]);
    bench.off(60);
    assert!(
        bench
            .readings
            .iter()
            .all(|reading| reading.state == DriveState::Off)
    );
    bench.enable(200).unwrap();
}

#[test]
fn every_kind_of_drive_goes_on_where_it_stands() {
    goes_on_where_it_stands(Bench::new(Odrive, odrive));
    goes_on_where_it_stands(Bench::new(MOTEUS, moteus));
    for mit in [DAMIAO, T_MOTOR, ROBSTRIDE] {
        goes_on_where_it_stands(Bench::new(mit, actuator(mit)));
    }
}

/// A drive that is absent, or not calibrated, or in error keeps the others off.
fn refused<P: Protocol, const LONGEST: usize>(
    bench: &mut Bench<P, LONGEST>,
) -> (usize, DriveReading<f64>) {
    match bench.enable(200) {
        Err(Ended::Drive(leg, reading)) => {
            bench.off(60);
            assert_eq!(bench.torques(), [0.0; 3]);
            (leg, reading)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_drive_that_cannot_go_on_says_why() {
    let mut bench = Bench::new(Odrive, odrive);
    bench.medium().drive(1).die();
    let (leg, reading) = refused(&mut bench);
    assert_eq!(
        (leg, reading.state, reading.age),
        (1, DriveState::Silent, u16::MAX)
    );

    let mut bench = Bench::new(Odrive, odrive);
    bench.medium().drive(2).lose_calibration();
    let (leg, reading) = refused(&mut bench);
    assert_eq!((leg, reading.state), (2, DriveState::Uncalibrated));

    let mut bench = Bench::new(MOTEUS, moteus);
    bench.medium().drive(0).lose_calibration();
    let (leg, reading) = refused(&mut bench);
    assert_eq!(
        (leg, reading.state, reading.error),
        (0, DriveState::Uncalibrated, 36)
    );

    for (mit, error) in [(DAMIAO, 0xC), (T_MOTOR, 1)] {
        let mut bench = Bench::new(mit, actuator(mit));
        bench.medium().drive(1).heat();
        let (leg, reading) = refused(&mut bench);
        assert_eq!(
            (leg, reading.state, reading.error),
            (1, DriveState::Fault, error)
        );
        assert_eq!(reading.temperature_c, 120);
    }
}

/// An encoder that slips shows in the reading: the angle is off by as much.
#[test]
fn a_slip_of_the_encoder_shows_in_the_reading() {
    let mut bench = Bench::new(Odrive, odrive);
    bench.enable(200).unwrap();
    bench.watch(20).unwrap();
    bench.medium().drive(0).servo().offset += 0.4;
    bench.watch(60).unwrap();
    let slip = std::f64::consts::TAU * 0.4 / crate::bench::GEAR;
    let [first, second, _] = bench.readings;
    assert!(
        (wrapped(first.angle - START[0]) - slip).abs() < 1e-3,
        "{first:?}"
    );
    assert!(wrapped(second.angle - START[1]).abs() < 1e-4);
    // The drive pulls the other way, as its own loop is off by the same angle, and tells the torque.
    assert!(
        first.torque < -10.0 && (first.torque - bench.torques()[0]).abs() < 1e-3,
        "{first:?}"
    );
}
