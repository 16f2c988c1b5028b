//! Service of the scene: its types, its memory, its construction.

use crate::inputs::{Angle, Closed};
use crate::log_start::log_start;
use crate::scene::{self, Curves, LEVELS, Model, Planner, Scalar};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{self, Board, FaultCode, Firmware};
use trirrr_service::board::PartOf;
use trirrr_service::features::Feature;
use trirrr_service::{SceneParts, Settings};

#[cfg(contact_refused)]
compile_error!(
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

/// Machine with its limits: a client may change them, or the coefficients are in the image.
#[cfg(not(adjustable))]
pub(crate) type Machine = trirrr_service::board::Compiled<'static, Model, Curves, Planner>;
#[cfg(adjustable)]
pub(crate) type Machine = trirrr_service::Adjustable<Model, Curves, Planner>;

/// Place of another image, where the program may be replaced over the line.
#[cfg(not(update))]
pub(crate) type Update = ();
#[cfg(update)]
pub(crate) type Update = crate::update::NewImage;

trirrr_service::scene! {
    /// Scene of this image.
    pub ImageScene: Machine,
    batches = scene::Batches,
    update = Update,
    levels = scene::Levels,
    homing = scene::Homing,
    feedback = scene::Feedback,
    contact = scene::Contact,
    retreat = scene::Retreat,
    interlocks = scene::Interlocks,
    probe = scene::Probe,
    digital = scene::Digital
}

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

/// Plays a tick: for speed, in the board's crate.
#[inline(always)]
pub(crate) fn tick(foreground: &mut SceneForeground, closed: Closed) {
    foreground.tick_with(closed);
}

/// Latches a fault from outside, as all that follows in the board's crate.
#[inline(always)]
pub(crate) fn raise(
    foreground: &mut SceneForeground,
    code: FaultCode,
    index: Option<u8>,
    [value, limit]: [Scalar; 2],
) {
    foreground.raise(code, index, value, limit);
}

/// Takes angles that drives have counted.
#[inline(always)]
pub(crate) fn set_position(foreground: &mut SceneForeground, angles: [Angle; 3]) {
    foreground.set_position(angles);
}

/// Reports the latency of a tick. Returns true if it was in time.
#[inline(always)]
pub(crate) fn report_timing(foreground: &mut SceneForeground, duration: u32, period: u32) -> bool {
    foreground.report_timing(duration, period)
}

/// Values of the scene that is played: parts, start, and settings.
pub(crate) type PlayedScene = (
    SceneParts<'static, ImageScene>,
    Pose<Scalar>,
    Settings<Scalar>,
);

/// The image's own scene.
pub(crate) fn own_scene(update: Update) -> PlayedScene {
    #[cfg(not(adjustable))]
    let machine = Machine {
        coefficients: &scene::COEFFICIENTS,
        parts: scene::PARTS,
        types: core::marker::PhantomData,
    };
    #[cfg(adjustable)]
    let machine = Machine::new(scene::PARAMETERS, scene::LIMITS);
    (scene::parts(machine, update), scene::START, scene::SETTINGS)
}

/// Builds both halves of the scene's service. The machine stands at the start of its job.
// A call: inlined, the board's crate would compile it for speed.
#[inline(never)]
pub fn build(
    channels: &'static mut Channels,
    board: Board,
    firmware: &'static Firmware,
) -> (SceneForeground, SceneBackground) {
    #[cfg(update)]
    let update = crate::update::NewImage::new(firmware);
    #[cfg(not(update))]
    let update = ();
    // Before the frame of the rest: the check of a scene in the flash takes a third of the stack.
    #[cfg(scene_over_line)]
    let played = crate::stored_scene::played(update);
    #[cfg(not(scene_over_line))]
    let played = own_scene(update);
    build_scene(channels, board, firmware, played)
}

#[cfg_attr(scene_over_line, inline(never))]
fn build_scene(
    channels: &'static mut Channels,
    board: Board,
    firmware: &'static Firmware,
    (parts, start, own): PlayedScene,
) -> (SceneForeground, SceneBackground) {
    log_start(&board);
    // The reader of the scene refuses a start out of reach. The error is not formatted: that would bring
    // floats as text into the image.
    let settings = Settings {
        board,
        firmware,
        ..own
    };
    let Ok(halves) = channels.split(parts, start, settings) else {
        panic!("the start is out of reach");
    };
    halves
}
