//! Drives between the service and the plant: outputs of ticks in, commands of motors out.

use crate::bus_drives;
use crate::control::{Commands, Measured};
use crate::joint_control::JointDrives;
use crate::loop_drives::SimulatedLoops;
use crate::refusal::Refusal;
use crate::steppers::{self, SimulatedSteppers};
use trirrr_core::number::Number;
use trirrr_core::tick::Motor;
use trirrr_core::units::Units;
use trirrr_drives::count::Countable;
use trirrr_drives::joint::Reference;
use trirrr_drives::stepper::Line;
use trirrr_protocol::message::DriveReading;
use trirrr_scene::{NumberType, Scene, Timing};
use trirrr_service::Output;

/// The three drives of a machine whose ticks are in the number type `N`.
pub(crate) trait SimulatedDrives<N: Number>: Send {
    /// Returns what the drives tell at the begin of a tick, for a service that watches them; none of drives that tell
    /// nothing. Drives that nobody watches are judged here, in the [tick](Self::tick).
    fn measure(&mut self) -> Option<[DriveReading<N>; 3]> {
        None
    }

    /// Takes the output of a tick.
    ///
    /// # Errors
    /// [`Refusal::Drive`]: a drive cannot do what the tick commands.
    fn tick(&mut self, output: &Output<N>) -> Result<(), Refusal>;

    /// Takes sample `slot` of the tick, counted from 0, and returns what the motors are told until
    /// the next sample.
    fn sample(&mut self, slot: u32, measured: &[Measured; 3]) -> Commands;
}

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

/// Reference of one motor in SI units and the number type `D` of a drive, from a tick in `units`.
pub(crate) fn reference<N: Number, D: Number>(motor: &Motor<N>, units: &Units) -> Reference<D> {
    Reference {
        angle: D::angle_from_f64(N::angle_to_f64(motor.angle)),
        rate: D::from_f64(motor.rate.to_f64() * units.rate_rad_s()),
        acceleration: D::from_f64(motor.acceleration.to_f64() * units.acceleration_rad_s2()),
        torque: D::from_f64(motor.torque.to_f64() * units.torque_nm()),
    }
}
