//! Every pose in which the machine can be assembled for given motor angles, and the one that the
//! platform reaches when the motors turn.
//!
//! Run with `cargo run -p trirrr-core --example forward_kinematics`.

use std::error::Error;
use trirrr_core::forward::{Forward, Tracker};
use trirrr_core::machine::{Geometry, example};
use trirrr_core::setpoint::Pose;

fn main() -> Result<(), Box<dyn Error>> {
    let parameters = example();
    let geometry = Geometry::<f64>::build(&parameters)?;
    let forward = Forward::build(&parameters, &geometry);

    // Inverse kinematics: the motor angles of a pose.
    let start = Pose::from_f64(0.21, 0.22, 9f64.to_radians());
    let angles = geometry.motor_angles(&geometry.position(&start)?);
    println!("motor angles {angles:.6?} rad");

    // Forward kinematics: up to six assembly modes have these motor angles.
    let found = forward.assemblies(&angles)?;
    for (number, mode) in found.modes().iter().enumerate() {
        let (at, angle) = (mode.pose.position, mode.pose.angle);
        println!(
            "assembly mode {}: x {:.6} m, y {:.6} m, alpha {:.6} rad, det A {:+.3e} m^4",
            number + 1,
            at.x,
            at.y,
            angle,
            mode.det_a,
        );
    }

    // A moving platform stays in its mode. The tracker follows it and refuses to come nearer than
    // 0.01 to the parallel singularity, where two modes meet; it uses up to 16 parts of the way.
    let here = forward.nearest(&found, &start).ok_or("no assembly mode")?;
    let tracker = Tracker::new(forward, 0.01, 16);
    let track = tracker.start(&angles, here.pose)?;
    let turned = [angles[0] + 0.05, angles[1], angles[2] - 0.05];
    let track = tracker.follow(&track, &turned)?;
    let (at, angle) = (track.pose.position, track.pose.angle);
    println!(
        "after the turn: x {:.6} m, y {:.6} m, alpha {angle:.6} rad",
        at.x, at.y
    );
    Ok(())
}
