//! Slot of the values of a scene that come over the line.

use super::image_flash::{ImageFlash, LAYOUT, flash_refusal, refusal};
use crate::scene::{Contact, Curves, Feedback, HAS_STEPPERS, Homing, Model, Planner};
use crate::scene::{SCENE_OWNER, SETTINGS, TYPES};
use trirrr_boot::{Receiver, Slot, WholeImage, keep, read, spare};
use trirrr_protocol::message::{SceneHeader, SceneRoom, UpdateRefusal};
use trirrr_protocol::wire::of_bytes;
use trirrr_service::coefficients::SceneValues;
use trirrr_service::features::Feature;

/// Room for the values of a scene.
const ROOM: SceneRoom = SceneRoom {
    room: SceneValues::LONGEST as u32,
    layout: SceneValues::LAYOUT,
    types: TYPES,
};

const _: () = assert!(
    ROOM.room <= LAYOUT.scenes[0].room(),
    "a slot has room for the longest values"
);

/// Slot of the values that come, if such come.
#[derive(Debug)]
pub(super) struct SceneSlot(Option<Slot>);

impl SceneSlot {
    /// No values come.
    pub(super) const NONE: Self = Self(None);

    /// Room for values.
    pub(super) const ROOM: Option<SceneRoom> = Some(ROOM);

    /// Slot of the values that come.
    pub(super) fn slot(&self) -> Option<Slot> {
        self.0
    }

    /// Begins with values that have this `header`.
    pub(super) fn begin(
        &mut self,
        header: &SceneHeader,
        receiver: &mut Receiver,
    ) -> Result<(), UpdateRefusal> {
        if let Some(need) = TYPES.lacks(&header.types).iter().next() {
            return Err(UpdateRefusal::SceneNeeds(need));
        }
        if header.layout != ROOM.layout {
            return Err(UpdateRefusal::SceneLayout);
        }
        let slot = spare(&ImageFlash::take(), &LAYOUT.scenes, SCENE_OWNER);
        let values = WholeImage {
            length: header.length,
            checksum: header.checksum,
        };
        let begun = receiver.begin(ROOM.room, values);
        begun.map_err(|error| refusal(error, ROOM.room))?;
        self.0 = Some(slot);
        Ok(())
    }

    /// Checks the values, and keeps them: the next start takes them. Returns `false` where none came.
    pub(super) fn finish(
        &mut self,
        flash: &mut ImageFlash,
        receiver: &mut Receiver,
    ) -> Result<bool, UpdateRefusal> {
        let Some(slot) = &self.0 else {
            return Ok(false);
        };
        let values = receiver.whole();
        let values = values.map_err(|error| refusal(error, slot.room()))?;
        keep_values(flash, slot, values)?;
        self.0 = None;
        Ok(true)
    }
}

fn keep_values(
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
pub(crate) fn values(bytes: &[u8]) -> Result<SceneValues, UpdateRefusal> {
    let values: SceneValues = of_bytes(bytes).ok_or(UpdateRefusal::SceneLayout)?;
    let is_of_types = values.homing.is_some() == Homing::EXISTS
        && values.feedback.is_some() == Feedback::EXISTS
        && values.contact.is_some() == Contact::EXISTS
        && values.steppers.is_some() == HAS_STEPPERS;
    match is_of_types {
        true => values.check::<Model, Curves, Planner>(&SETTINGS)?,
        false => return Err(UpdateRefusal::SceneLayout),
    }
    Ok(values)
}
