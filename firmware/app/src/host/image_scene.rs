//! Types of the scene's service, its memory, and its values.

use super::update::NewImage;
use crate::scene::{self, LEVELS, Scalar};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message;
use trirrr_service::board::PartOf;
use trirrr_service::features::Feature;
use trirrr_service::{SceneParts, Settings};

const _: () = assert!(
    scene::CAN_FEEL,
    "[contact] needs a number type with a floating point: build the image with TRIRRR_SCALAR=f32, or leave [contact] out"
);

/// Places for moves; one stays empty. At one tick a move, and 1 kHz, the machine has a quarter of a second to live on; power
/// lists take the room of some. The RAM of an RP2040 holds the program, too: with moves of 4 ms, the shortest of a plan, the
/// machine has half a second to live on.
const MOVES: usize = match (cfg!(small), scene::Levels::EXISTS) {
    (true, _) => 129,
    (false, true) => 225,
    (false, false) => 257,
};

/// Places for telemetry samples; one stays empty. The background sends while the tick adds.
const SAMPLES: usize = 8;

/// Scene of this image.
pub(crate) type ImageScene = scene::ImageScene<NewImage>;

/// A part of the scene in a reply.
type ScenePart = PartOf<ImageScene>;

/// Memory between both halves.
pub type Channels = trirrr_service::Channels<ImageScene, MOVES, SAMPLES, LEVELS>;

/// Half that ticks.
pub(crate) type SceneForeground = trirrr_service::board::Foreground<'static, ImageScene>;

/// Half that talks.
pub(crate) type SceneBackground = trirrr_service::board::Background<'static, ImageScene>;

/// Message to the host.
pub(crate) type Message = message::Message<Scalar, ScenePart>;

/// Message to the host, its parts borrowed.
pub(crate) type MessageRef<'m> = message::MessageRef<'m, Scalar, ScenePart>;

/// Request of the host.
pub(crate) type Request = trirrr_service::board::RequestOf<ImageScene>;

/// Values of the scene that is played: parts, start, and settings.
pub(crate) type PlayedScene = (
    SceneParts<'static, ImageScene>,
    Pose<Scalar>,
    Settings<Scalar>,
);

/// The image's own scene.
pub(crate) fn own_scene(update: NewImage) -> PlayedScene {
    let parts = scene::parts(scene::machine(), update);
    (parts, scene::START, scene::SETTINGS)
}
