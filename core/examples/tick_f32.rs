//! A tick in `f32`, as a microcontroller with an FPU runs it: pose, velocity and acceleration in, angle,
//! rate, acceleration and torque of each motor out.
//!
//! Run with `cargo run -p trirrr-core --example tick_f32`.

use std::error::Error;
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::{Pose, RestToRest};
use trirrr_core::tick::Tick;

/// Tick rate, Hz.
const RATE_HZ: f32 = 100.0;

/// Duration of the move, ticks.
const TICKS: u32 = 100;

fn main() -> Result<(), Box<dyn Error>> {
    // The parameters of your machine go here: six lengths, three base joints, platform, loads, SI units.
    let parameters = example();

    // The model names number type, payload and links. `Dynamic<f32>` has a platform whose centre of
    // mass is its reference point, and links without mass. Everything is checked here, nothing in
    // the tick.
    let tick: Tick<Dynamic<f32>> = Tick::build(&parameters)?;

    let from = Pose::from_f64(0.21, 0.22, 9f64.to_radians());
    let to = Pose::from_f64(0.28, 0.28, 12f64.to_radians());
    let path = RestToRest::new(from, to, TICKS, 1.0 / RATE_HZ);

    println!("   t, s   motor  angle, rad  rate, rad/s  torque, N m");
    for k in (0..=TICKS).step_by(20) {
        // A setpoint without a motion ends in a status: unreachable, singular, out of range.
        let motion = tick.evaluate(&path.at(k))?;
        for (index, motor) in motion.motors.iter().enumerate() {
            println!(
                "{:7.3}   {}      {:10.6}  {:11.6}  {:11.6}",
                k as f32 / RATE_HZ,
                index + 1,
                motor.angle,
                motor.rate,
                motor.torque,
            );
        }
    }
    Ok(())
}
