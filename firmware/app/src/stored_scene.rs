//! Scene that has come over the line: kept in the flash, and played from the next start on in place of the image's own.

use crate::image_flash::{ImageFlash, LAYOUT};
use crate::scene::{Contact, Curves, Feedback, Homing, Model, PERIOD_S, Planner};
use crate::scene::{SCENE_OWNER, SETTINGS, Scalar, TYPES};
use crate::service::{ImageScene, Machine, PlayedScene, own_scene};
use crate::update::{NewImage, flash_refusal};
#[cfg(drive = "stepper")]
use core::cell::Cell;
#[cfg(drive = "stepper")]
use cortex_m::interrupt::{self, Mutex};
use trirrr_boot::{Slot, WholeImage, keep, kept, read, spare};
use trirrr_core::machine::Geometry;
use trirrr_core::number::WideArithmetic as _;
#[cfg(drive = "stepper")]
use trirrr_drives::stepper::StepsPerTurn;
use trirrr_protocol::message::{SceneHeader, SceneRoom, UpdateRefusal};
use trirrr_protocol::wire::of_bytes;
use trirrr_service::coefficients::SceneValues;
use trirrr_service::coefficients::{ContactCoefficients, FeedbackCoefficients, HomingCoefficients};
use trirrr_service::features::Feature;
use trirrr_service::{SceneParts, Settings};

/// Room for the values of a scene.
pub(crate) const ROOM: SceneRoom = SceneRoom {
    room: SceneValues::LONGEST as u32,
    layout: SceneValues::LAYOUT,
    types: TYPES,
};

const _: () = assert!(
    ROOM.room <= LAYOUT.scenes[0].room(),
    "a slot has room for the longest values"
);

/// Slot for values with this `header`, and its room in bytes.
pub(crate) fn room_for(header: &SceneHeader) -> Result<(Slot, u32), UpdateRefusal> {
    if let Some(need) = TYPES.lacks(&header.types).iter().next() {
        return Err(UpdateRefusal::SceneNeeds(need));
    }
    if header.layout != ROOM.layout {
        return Err(UpdateRefusal::SceneLayout);
    }
    let slot = spare(&ImageFlash::take(), &LAYOUT.scenes, SCENE_OWNER);
    Ok((slot, ROOM.room))
}

/// Checks the values in `slot`, and keeps them: the next start takes them.
pub(crate) fn keep_values(
    flash: &mut ImageFlash,
    slot: &Slot,
    content: WholeImage,
) -> Result<(), UpdateRefusal> {
    let mut room = [0; SceneValues::LONGEST];
    let bytes = read(flash, slot, content.length, &mut room);
    values(bytes.ok_or(UpdateRefusal::SceneLayout)?)?;
    keep(flash, &LAYOUT.scenes, slot, SCENE_OWNER, content).map_err(flash_refusal)
}

/// The values in `bytes`, if this image can play them.
#[inline(never)]
fn values(bytes: &[u8]) -> Result<SceneValues, UpdateRefusal> {
    let values: SceneValues = of_bytes(bytes).ok_or(UpdateRefusal::SceneLayout)?;
    let is_of_types = values.homing.is_some() == Homing::EXISTS
        && values.feedback.is_some() == Feedback::EXISTS
        && values.contact.is_some() == Contact::EXISTS
        && values.steppers.is_some() == cfg!(drive = "stepper");
    match is_of_types {
        true => values.check::<Model, Curves, Planner>(&SETTINGS)?,
        false => return Err(UpdateRefusal::SceneLayout),
    }
    Ok(values)
}

/// The newest scene in the flash that this image can play.
#[inline(never)]
fn stored() -> Option<SceneValues> {
    let flash = ImageFlash::take();
    let mut room = [0; SceneValues::LONGEST];
    kept(&flash, &LAYOUT.scenes, SCENE_OWNER)
        .find_map(|kept| values(kept.read(&flash, &mut room)?).ok())
}

/// Steps in a turn of each joint, and the motors that turn against theirs.
#[cfg(drive = "stepper")]
type Steps = ([StepsPerTurn; 3], [bool; 3]);

/// Those of the scene in the flash, once it is played.
#[cfg(drive = "stepper")]
static STEPS: Mutex<Cell<Option<Steps>>> = Mutex::new(Cell::new(None));

/// Steps of the scene that is played. `None` for those of the image.
#[cfg(drive = "stepper")]
pub(crate) fn steps() -> Option<Steps> {
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
    #[cfg(drive = "stepper")]
    {
        let steppers = values.steppers?;
        let per_turn = steppers.map(|motor| StepsPerTurn::new(motor.microsteps, motor.gear_ratio));
        let steps = (per_turn, steppers.map(|motor| motor.reversed));
        interrupt::free(|token| STEPS.borrow(token).set(Some(steps)));
    }
    parts.machine = Machine::new(parameters, values.limits());
    (parts.homing, parts.feedback, parts.contact) = (homing, feedback, contact);
    Some(settings)
}
