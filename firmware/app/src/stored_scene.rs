//! Scene that has come over the line: kept in the flash, and played from the next start on in place of the image's own.

use crate::image_flash::{ImageFlash, LAYOUT};
#[cfg(feedback)]
use crate::scene::FEEDBACK;
#[cfg(homing)]
use crate::scene::HOMING;
#[cfg(contact)]
use crate::scene::{CONTACT, PERIOD_S};
use crate::scene::{Curves, Model, Planner, SCENE_OWNER, SETTINGS, START, Scalar, TYPES};
use crate::scene::{LIMITS, PARAMETERS};
use crate::update::flash_refusal;
#[cfg(drive = "stepper")]
use core::cell::Cell;
#[cfg(drive = "stepper")]
use cortex_m::interrupt::{self, Mutex};
use trirrr_boot::{Slot, WholeImage, keep, kept, read, spare};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::Parameters;
#[cfg(homing)]
use trirrr_core::number::WideArithmetic as _;
use trirrr_core::setpoint::Pose;
#[cfg(drive = "stepper")]
use trirrr_drives::stepper::StepsPerTurn;
use trirrr_protocol::message::{SceneHeader, SceneRoom, UpdateRefusal};
use trirrr_protocol::wire::of_bytes;
#[cfg(contact)]
use trirrr_service::ContactCoefficients;
#[cfg(feedback)]
use trirrr_service::FeedbackCoefficients;
#[cfg(homing)]
use trirrr_service::HomingCoefficients;
use trirrr_service::{SceneValues, Settings};

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
    let is_of_types = values.homing.is_some() == cfg!(homing)
        && values.feedback.is_some() == cfg!(feedback)
        && values.contact.is_some() == cfg!(contact)
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

/// Scene that is played.
pub(crate) struct PlayedScene {
    pub(crate) parameters: Parameters,
    pub(crate) limits: LimitParameters,
    pub(crate) start: Pose<Scalar>,
    pub(crate) settings: Settings<Scalar>,
    #[cfg(homing)]
    pub(crate) homing: &'static HomingCoefficients<Scalar>,
    #[cfg(feedback)]
    pub(crate) feedback: &'static FeedbackCoefficients<Scalar>,
    #[cfg(contact)]
    pub(crate) contact: &'static ContactCoefficients<Scalar>,
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

/// The image's own scene.
const OWN: PlayedScene = PlayedScene {
    parameters: PARAMETERS,
    limits: LIMITS,
    start: START,
    settings: SETTINGS,
    #[cfg(homing)]
    homing: &HOMING,
    #[cfg(feedback)]
    feedback: &FEEDBACK,
    #[cfg(contact)]
    contact: &CONTACT,
};

/// The scene in the flash, or the image's own. To be called once.
#[inline(never)]
pub(crate) fn played() -> PlayedScene {
    let Some(values) = stored() else {
        return OWN;
    };
    defmt::info!("scene from the flash, key {=u32:#x}", values.key);
    build(&values).unwrap_or(OWN)
}

/// Builds what the image has as constants. `None` where that was done before, or a coefficient cannot be built, which is refused with the
/// values.
#[inline(never)]
fn build(values: &SceneValues) -> Option<PlayedScene> {
    let settings = values.settings(&SETTINGS);
    let (parameters, start) = (values.parameters(), values.start());
    #[cfg(homing)]
    let homing = {
        let period = Scalar::factor_to_f64(settings.period);
        let built = HomingCoefficients::build(&values.homing?, period);
        cortex_m::singleton!(: HomingCoefficients<Scalar> = built)?
    };
    #[cfg(feedback)]
    let feedback = {
        let geometry = trirrr_core::machine::Geometry::build(&parameters).ok()?;
        let built = FeedbackCoefficients::build(&values.feedback?, &parameters, &geometry, start)?;
        cortex_m::singleton!(: FeedbackCoefficients<Scalar> = built)?
    };
    #[cfg(contact)]
    let contact = {
        let built = ContactCoefficients::build(&values.contact?, PERIOD_S)?;
        cortex_m::singleton!(: ContactCoefficients<Scalar> = built)?
    };
    #[cfg(drive = "stepper")]
    {
        let steppers = values.steppers?;
        let per_turn = steppers.map(|motor| StepsPerTurn::new(motor.microsteps, motor.gear_ratio));
        let steps = (per_turn, steppers.map(|motor| motor.reversed));
        interrupt::free(|token| STEPS.borrow(token).set(Some(steps)));
    }
    Some(PlayedScene {
        parameters,
        limits: values.limits(),
        start,
        settings,
        #[cfg(homing)]
        homing,
        #[cfg(feedback)]
        feedback,
        #[cfg(contact)]
        contact,
    })
}
