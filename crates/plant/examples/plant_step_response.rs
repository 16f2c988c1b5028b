//! Step response of the machine's plant: each joint is told to be 0.01 rad further at once.
//!
//! `cargo run -p trirrr-plant --example plant_step_response -- scenes/plant-thesis.toml`

use std::error::Error;
use std::sync::atomic::AtomicBool;
use trirrr_drives::stepper::Line;
use trirrr_plant::table::Row;
use trirrr_plant::{PlantRun, job};
use trirrr_scene::Scene;

const STEP_RAD: f64 = 0.01;
/// A joint has settled once it stays this near, as a share of the step.
const BAND: f64 = 0.02;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1);
    let file = file.unwrap_or_else(|| "scenes/plant-thesis.toml".into());
    let scene = Scene::read(&file)?;

    // The machine stands at the start of its job, then every tick asks for the same step.
    let mut output = job::outputs(&scene)?[0];
    let start = output.motors.map(|motor| motor.angle);
    for motor in &mut output.motors {
        motor.angle += STEP_RAD;
        (motor.rate, motor.acceleration) = (0.0, 0.0);
    }

    let line = Line::new();
    let mut run = PlantRun::<f64>::build(&scene, &line)?;
    let mut rows = Vec::new();
    let mut sink = |row: &Row| rows.push((row.t, row.angles));
    for _ in 0..=scene.ticks() + 1 {
        run.tick(&output, &mut sink);
    }
    let outcome = run.finish(&AtomicBool::new(false), &mut sink);
    println!(
        "{}: {:?} after {} s",
        scene.name, outcome.end, outcome.simulated_s
    );

    for (joint, start) in start.iter().enumerate() {
        let response = |angles: &[f64; 3]| (angles[joint] - start) / STEP_RAD;
        let peak = rows
            .iter()
            .map(|(_, angles)| response(angles))
            .fold(0.0, f64::max);
        let outside = |angles: &[f64; 3]| (response(angles) - 1.0).abs() > BAND;
        let settled = rows.iter().rfind(|(_, angles)| outside(angles));
        println!(
            "joint {}: overshoot {:.1} %, within {} % of the step after {:.4} s",
            joint + 1,
            100.0 * (peak - 1.0).max(0.0),
            100.0 * BAND,
            settled.map_or(0.0, |(t, _)| *t),
        );
    }
    Ok(())
}
