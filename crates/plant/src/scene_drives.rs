//! The drives that a scene names.

use crate::bus_drives;
use crate::drives::SimulatedDrives;
use crate::joint_control::JointDrives;
use crate::loop_drives::SimulatedLoops;
use crate::refusal::Refusal;
use crate::steppers::{self, SimulatedSteppers};
use trirrr_core::units::Units;
use trirrr_drives::count::Countable;
use trirrr_drives::stepper::Line;
use trirrr_scene::{NumberType, Scene, Timing};

/// Samples in each tick.
///
/// # Errors
/// [`Refusal::Scene`]: the scene does not say how often its steppers may step.
pub(crate) fn samples_per_tick(scene: &Scene) -> Result<u32, Refusal> {
    let sampled = match scene.controller.map(|controller| controller.timing) {
        Some(Timing::Sampled { per_tick }) => per_tick,
        _ => 1,
    };
    // A stepper drive has slots without a controller, too.
    match steppers::of_scene(scene) {
        Some(motors) if sampled == 1 => steppers::slots_per_tick(scene, &motors),
        _ => Ok(sampled),
    }
}

/// Builds the drives of `scene` for ticks in `units`. The machine stands with its joints at
/// `start`; `line` joins the two halves of stepper drives.
///
/// # Errors
/// [`Refusal::Scene`]: the plant has no model of these drives. [`Refusal::Drive`]: a drive on a bus does not go on.
pub(crate) fn build<'l, N: Countable>(
    scene: &Scene,
    units: Units,
    start: [f64; 3],
    line: &'l Line,
) -> Result<Box<dyn SimulatedDrives<N> + 'l>, Refusal> {
    let per_tick = samples_per_tick(scene)?;
    if let Some(motors) = steppers::of_scene(scene) {
        let drives = SimulatedSteppers::build(scene, &motors, per_tick, units, start, line)?;
        return Ok(Box::new(drives));
    }
    if let Some(drives) = bus_drives::build(scene, per_tick, units, start)? {
        return Ok(drives);
    }
    if let Some(mut drives) = SimulatedLoops::build::<N>(scene, per_tick, units, start) {
        drives.enable::<N>();
        return Ok(Box::new(drives));
    }
    Ok(match scene.number {
        NumberType::F64 => Box::new(JointDrives::<f64>::build(scene, per_tick, units)?),
        // A drive computes in SI units, which fixed point has no room for.
        NumberType::F32 | NumberType::Fixed | NumberType::Micromath => {
            Box::new(JointDrives::<f32>::build(scene, per_tick, units)?)
        }
    })
}
