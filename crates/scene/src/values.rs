//! Values of a scene that go to a board over its line.

use crate::drive::DriveKind;
use crate::scene::Scene;
use crate::settings::settings;
use trirrr_core::status::Status;
use trirrr_core::units::Units;
use trirrr_protocol::message::Transmit;
use trirrr_service::Settings;
use trirrr_service::coefficients::{SceneValues, StepperValues};

/// Values of `scene` for an image in the number type `N`, in `units`: those that its own image would have as constants.
///
/// # Errors
/// Homing of a machine that cannot stand at its start.
pub fn values<N: Transmit>(scene: &Scene, units: &Units) -> Result<SceneValues, Status> {
    let Settings {
        ramp,
        host_timeout_ticks,
        telemetry_every,
        power,
        reactions,
        planning,
        scene: identity,
        ..
    } = settings::<N>(scene, units);
    let homing = scene.homing.map(|homing| homing.parameters(scene, units));
    let start = scene.job.start;
    Ok(SceneValues {
        key: identity.key,
        name: identity.name,
        // Within 8 bits: a machine of 2^127 m has no scene.
        units: [units.length, units.time, units.mass].map(|exponent| exponent as i8),
        start: [start.position.x, start.position.y, start.angle],
        legs: scene.parameters.legs.each_ref().map(Into::into),
        platform: (&scene.parameters).into(),
        limits: (&scene.limits).into(),
        ramp,
        host_timeout_ticks,
        telemetry_every,
        power,
        reactions,
        planning: planning.map(|planning| planning.convert(N::to_f64)),
        homing: homing.transpose()?,
        feedback: scene
            .feedback
            .map(|feedback| feedback.parameters(scene.tick_rate_hz)),
        contact: scene
            .contact
            .map(|contact| contact.parameters(scene.tick_rate_hz)),
        steppers: steppers(scene),
    })
}

/// Steps of the scene's steppers; none with other drives.
fn steppers(scene: &Scene) -> Option<[StepperValues; 3]> {
    let [a, b, c] = scene.drives?.map(|drive| match drive.kind {
        DriveKind::Stepper(stepper) => Some(StepperValues {
            microsteps: stepper.steps_per_rev * stepper.microsteps,
            gear_ratio: drive.gear_ratio,
            reversed: drive.reversed,
        }),
        DriveKind::Bldc(_) | DriveKind::Can(_) => None,
    });
    Some([a?, b?, c?])
}
