//! Torque, rate and power of each motor over a move, and the force on its bearing: the figures that a
//! motor, a gear and a bearing are chosen by.
//!
//! Run with `cargo run -p trirrr-core --example size_motor`.

use std::error::Error;
use trirrr_core::machine::{LinkParameters, example};
use trirrr_core::model::Dynamic;
use trirrr_core::reaction::Reactions;
use trirrr_core::setpoint::{Pose, RestToRest};
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{Horizontal, Massive};
use trirrr_core::torque::payload::Centred;

/// The machine lies flat and its links have mass.
type Machine = Dynamic<f64, Centred<f64>, Massive<f64, Horizontal>>;

/// Instants of the move at which the figures are taken.
const SAMPLES: u32 = 1000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut parameters = example();
    for leg in &mut parameters.legs {
        // Rods of 0.2 m and 0.05 kg, about their centre of mass.
        let rod = LinkParameters {
            mass_kg: 0.05,
            com_m: 0.1,
            inertia_kgm2: 0.05 * 0.2 * 0.2 / 12.0,
        };
        (leg.proximal, leg.distal) = (rod, rod);
    }
    let tick: Tick<Machine> = Tick::build(&parameters)?;
    let reactions = Reactions::build(&parameters);
    let from = Pose::from_f64(0.21, 0.22, 9f64.to_radians());
    let to = Pose::from_f64(0.28, 0.28, 12f64.to_radians());

    for duration_s in [1.0, 0.5, 0.25] {
        let path = RestToRest::new(from, to, SAMPLES, duration_s / f64::from(SAMPLES));
        let [mut torque, mut square, mut rate, mut power, mut force] = [[0.0_f64; 3]; 5];
        for k in 0..=SAMPLES {
            let motion = tick.evaluate(&path.at(k))?;
            let (powers, joints) = (motion.powers()?, reactions.forces(&motion)?);
            for (i, motor) in motion.motors.iter().enumerate() {
                torque[i] = torque[i].max(motor.torque.abs());
                square[i] += motor.torque * motor.torque / f64::from(SAMPLES + 1);
                rate[i] = rate[i].max(motor.rate.abs());
                power[i] = power[i].max(powers[i].abs());
                force[i] = force[i].max(joints[i].base.x.hypot(joints[i].base.y));
            }
        }
        println!("the move in {duration_s} s");
        println!("motor  peak N m   rms N m    rad/s      W          bearing N");
        for i in 0..3 {
            let rms = square[i].sqrt();
            println!(
                "{}      {:<9.5}  {rms:<9.5}  {:<9.4}  {:<9.5}  {:.4}",
                i + 1,
                torque[i],
                rate[i],
                power[i],
                force[i],
            );
        }
    }
    Ok(())
}
