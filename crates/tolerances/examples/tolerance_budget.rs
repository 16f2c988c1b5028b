//! Greatest error at the tool of a scene's job, and the parameters that it comes from.
//!
//! `cargo run -p trirrr-tolerances --example tolerance_budget -- scenes/plotter.toml`

use std::error::Error;
use trirrr_scene::Scene;
use trirrr_tolerances::{ToleranceAnalysis, WorstCase};

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1);
    let scene = Scene::read(file.unwrap_or_else(|| "scenes/plotter.toml".into()))?;
    let analysis = ToleranceAnalysis::new(&scene)?;
    let mut worst = WorstCase::default();
    for span in analysis.spans() {
        worst.note(&span, &scene.limits, scene.torque);
    }
    if let Some(span) = worst.not_bounded {
        println!("not bounded from t = {} s on", span.start_s);
    }
    let Some((span, tool)) = worst.distance else {
        return Ok(());
    };
    println!(
        "at most {:.1} um off, from t = {} s to {} s",
        1e6 * tool.distance_m(),
        span.start_s,
        span.end_s
    );
    for share in analysis.budget(&tool) {
        println!(
            "{:>8.1} um by {} +- {} {}",
            1e6 * share.along_m,
            share.parameter,
            share.half_width,
            share.parameter.unit()
        );
    }
    Ok(())
}
