//! Run time of one tick on this machine.

use crate::error::ReportError;
use std::hint::black_box;
use std::time::{Duration, Instant};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_scene::Scene;
use trirrr_scene::pipeline;

/// Samples, of which the fastest counts: other load on the machine disturbs it least.
const SAMPLES: usize = 20;
/// Least duration of a sample.
const SAMPLE: Duration = Duration::from_millis(10);

/// Nanoseconds per tick over the job of `scene`, in the fastest sample.
pub(crate) fn nanoseconds<N: Number>(scene: &Scene) -> Result<f64, ReportError> {
    let pipeline::Job {
        machine, player, ..
    } = pipeline::scene::<N>(scene)
        .map_err(|error| ReportError::Refused(format!("scene {}: {error}", scene.name)))?;
    let setpoints: Vec<Setpoint<N>> = player.setpoints().collect();
    let mut fastest = f64::INFINITY;
    for _ in 0..SAMPLES {
        let (start, mut jobs) = (Instant::now(), 0u32);
        while start.elapsed() < SAMPLE {
            for setpoint in &setpoints {
                let _ = black_box(machine.motors(black_box(setpoint)));
            }
            jobs += 1;
        }
        let ticks = f64::from(jobs) * setpoints.len() as f64;
        fastest = fastest.min(start.elapsed().as_secs_f64() * 1e9 / ticks);
    }
    Ok(fastest)
}
