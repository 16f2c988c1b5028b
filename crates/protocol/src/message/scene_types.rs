//! Types of a scene, as an image has them: what a scene that comes over the line may need.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::to_source;

/// Parts of a scene for which an image has types or constants, with a [key](SceneTypes::keys) each.
pub const SCENE_KEYS: usize = 10;

/// Part that an image may lack for a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, Schema)]
pub enum SceneNeed {
    /// Torques, which `torque = false` leaves out.
    Torques,
    /// A centre of mass of the platform off the reference point.
    PayloadOffset,
    /// Inertia of rotors.
    Rotors,
    /// Masses of links.
    LinkMasses,
    /// Gravity in the plane, with masses of links.
    Gravity,
    /// Quintic moves.
    Quintics,
    /// A limit of jerk.
    Jerk,
    /// A planner of paths.
    Paths,
    /// Batches of moves.
    Batches,
    /// Room for power lists, as many levels.
    PowerLists,
    /// Another number type.
    Number,
    /// Another tick rate.
    TickRate,
    /// Another kind of drives, or other constants of theirs.
    Drives,
    /// Another brake.
    Brake,
    /// Another output to the tool.
    ToolOutput,
    /// Other inputs, or spare inputs and outputs.
    Inputs,
    /// Another lamp.
    Lamp,
    /// Homing.
    Homing,
    /// Feedback of the drives.
    Feedback,
    /// Detection of contacts.
    Contact,
}

impl SceneNeed {
    /// All of them, in the order of their bits: first the parts that an image has or lacks, then the levels, then the keys.
    pub const ALL: [Self; 20] = [
        Self::Torques,
        Self::PayloadOffset,
        Self::Rotors,
        Self::LinkMasses,
        Self::Gravity,
        Self::Quintics,
        Self::Jerk,
        Self::Paths,
        Self::Batches,
        Self::PowerLists,
        Self::Number,
        Self::TickRate,
        Self::Drives,
        Self::Brake,
        Self::ToolOutput,
        Self::Inputs,
        Self::Lamp,
        Self::Homing,
        Self::Feedback,
        Self::Contact,
    ];
}

/// Set of needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneNeeds(u32);

impl SceneNeeds {
    /// Adds a need.
    pub fn insert(&mut self, need: SceneNeed) {
        self.0 |= 1 << need as u32;
    }

    /// The needs in their order.
    pub fn iter(self) -> impl Iterator<Item = SceneNeed> {
        let all = SceneNeed::ALL.into_iter();
        all.filter(move |need| self.0 >> *need as u32 & 1 == 1)
    }
}

/// Types and constants of an image, or those that a scene needs: see types and values. Values of a scene are not among
/// them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SceneTypes {
    /// Parts that are there: bit n for variant n of [`SceneNeed`], 0 to 8.
    pub room: u16,
    /// Levels of the tool's power for which there is room.
    pub levels: u16,
    /// A key each of what has to be the same, of the variants 10 to 19 of [`SceneNeed`].
    pub keys: [u32; SCENE_KEYS],
}

to_source!(pub [] SceneTypes [] in trirrr_protocol::message { room, levels, keys });

impl SceneTypes {
    /// Types with these `parts`, of [`SceneNeed::Torques`] to [`SceneNeed::Batches`].
    pub fn with_room(parts: &[SceneNeed], levels: u16, keys: [u32; SCENE_KEYS]) -> Self {
        let bits = parts.iter().map(|part| 1u32 << *part as u32);
        Self {
            // Those of the room are the lowest.
            room: bits.fold(0, |room, bit| room | bit) as u16,
            levels,
            keys,
        }
    }

    /// Returns what an image of these types lacks for a scene that needs those of `scene`.
    pub fn lacks(&self, scene: &Self) -> SceneNeeds {
        let mut lacks = SceneNeeds(u32::from(scene.room & !self.room));
        if scene.levels > self.levels {
            lacks.insert(SceneNeed::PowerLists);
        }
        let keys = self.keys.iter().zip(&scene.keys);
        let from = SceneNeed::ALL.into_iter().skip(SceneNeed::Number as usize);
        for (need, (own, asked)) in from.zip(keys) {
            if own != asked {
                lacks.insert(need);
            }
        }
        lacks
    }
}

/// Description of the values of a scene that come over the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SceneHeader {
    /// Bytes.
    pub length: u32,
    /// CRC-32 of the bytes, that of the frames.
    pub checksum: u32,
    /// Key of the layout of the values.
    pub layout: u64,
    /// Types that the scene needs.
    pub types: SceneTypes,
}

/// Room of an image for values of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SceneRoom {
    /// Most bytes.
    pub room: u32,
    /// Key of the layout of the values.
    pub layout: u64,
    /// Types of the image.
    pub types: SceneTypes,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needs_are_numbered_as_they_are_listed() {
        for (index, need) in SceneNeed::ALL.into_iter().enumerate() {
            assert_eq!(need as usize, index);
        }
        let keys = SceneNeed::Contact as usize - SceneNeed::Number as usize + 1;
        assert_eq!(keys, SCENE_KEYS);
    }

    #[test]
    fn an_image_takes_less_than_it_has_and_the_same_wiring() {
        use SceneNeed::*;
        let keys = [1; SCENE_KEYS];
        let image = SceneTypes::with_room(&[Torques, Rotors, Batches], 1024, keys);
        let lean = SceneTypes::with_room(&[Torques], 0, keys);
        assert_eq!(image.lacks(&lean), SceneNeeds::default());
        assert_eq!(image.lacks(&image), SceneNeeds::default());
        let mut other = SceneTypes::with_room(&[Torques, Gravity, Paths], 2048, keys);
        other.keys[0] = 2;
        other.keys[SCENE_KEYS - 1] = 2;
        let lacks: std::vec::Vec<SceneNeed> = image.lacks(&other).iter().collect();
        assert_eq!(lacks, [Gravity, Paths, PowerLists, Number, Contact]);
    }
}
