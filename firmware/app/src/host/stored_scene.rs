//! Scene that has come over the line: played from the next start on in place of the image's own.

use super::image_scene::{ImageScene, PlayedScene, own_scene};
use super::update::{ImageFlash, LAYOUT, NewImage, values};
use crate::outputs::Steps;
use crate::scene::{self, Contact, Feedback, Homing, PERIOD_S, SCENE_OWNER, SETTINGS, Scalar};
use core::cell::Cell;
use cortex_m::interrupt::{self, Mutex};
use trirrr_boot::kept;
use trirrr_core::machine::Geometry;
use trirrr_core::number::WideArithmetic as _;
use trirrr_drives::stepper::StepsPerTurn;
use trirrr_service::coefficients::SceneValues;
use trirrr_service::coefficients::{ContactCoefficients, FeedbackCoefficients, HomingCoefficients};
use trirrr_service::features::Feature;
use trirrr_service::{SceneParts, Settings};

/// The newest scene in the flash that this image can play.
#[inline(never)]
fn stored() -> Option<SceneValues> {
    let flash = ImageFlash::take();
    let mut room = [0; SceneValues::LONGEST];
    kept(&flash, &LAYOUT.scenes, SCENE_OWNER)
        .find_map(|kept| values(kept.read(&flash, &mut room)?).ok())
}

/// Steps of the scene in the flash, once it is played.
static STEPS: Mutex<Cell<Option<Steps>>> = Mutex::new(Cell::new(None));

/// Steps of the scene that is played. `None` for those of the image, and without steppers.
pub fn played_steps() -> Option<Steps> {
    interrupt::free(|token| STEPS.borrow(token).get())
}

/// The scene in the flash, or the image's own. To be called once.
#[inline(never)]
pub(crate) fn played(update: NewImage) -> PlayedScene {
    let (mut parts, start, settings) = own_scene(update);
    let Some(values) = stored() else {
        return (parts, start, settings);
    };
    defmt::info!("scene from the flash, key {=u32:#x}", values.key);
    match build(&values, &mut parts) {
        Some(settings) => (parts, values.start(), settings),
        None => (parts, start, settings),
    }
}

/// Builds what the image has as constants in the place of its own. `None` where that was done before, or a coefficient cannot be
/// built, which is refused with the values.
#[inline(never)]
fn build(
    values: &SceneValues,
    parts: &mut SceneParts<'static, ImageScene>,
) -> Option<Settings<Scalar>> {
    let settings = values.settings(&SETTINGS);
    let parameters = values.parameters();
    let (mut homing, mut feedback, mut contact) = (None, None, None);
    if Homing::EXISTS {
        let period = Scalar::factor_to_f64(settings.period);
        let built = HomingCoefficients::build(&values.homing?, period);
        homing = Some(&*cortex_m::singleton!(: HomingCoefficients<Scalar> = built)?);
    }
    if Feedback::EXISTS {
        let geometry = Geometry::build(&parameters).ok()?;
        let start = values.start();
        let built = FeedbackCoefficients::build(&values.feedback?, &parameters, &geometry, start)?;
        feedback = Some(&*cortex_m::singleton!(: FeedbackCoefficients<Scalar> = built)?);
    }
    if Contact::EXISTS {
        let built = ContactCoefficients::build(&values.contact?, PERIOD_S)?;
        contact = Some(&*cortex_m::singleton!(: ContactCoefficients<Scalar> = built)?);
    }
    if scene::HAS_STEPPERS {
        let steppers = values.steppers?;
        let per_turn = steppers.map(|motor| StepsPerTurn::new(motor.microsteps, motor.gear_ratio));
        let steps = (per_turn, steppers.map(|motor| motor.reversed));
        interrupt::free(|token| STEPS.borrow(token).set(Some(steps)));
    }
    parts.machine = scene::Machine::new(parameters, values.limits());
    (parts.homing, parts.feedback, parts.contact) = (homing, feedback, contact);
    Some(settings)
}
