//! Service of a scene with a host: its construction, and the half that talks over the line.

mod background;
pub mod cause;
mod image_scene;
mod line;
mod log;
mod log_start;
#[cfg(scene_over_line)]
mod stored_scene;
#[cfg(update)]
mod update;
pub mod usb;

pub use background::Background;
pub use image_scene::Channels;
pub(crate) use image_scene::SceneForeground;
pub use line::{BAUD, IN_FLIGHT, IS_FIXED, ReceivedBytes};
pub use log::LOG_BAUD;
pub use stored_scene::played_steps;
pub use update::is_lost_expected;

use image_scene::{PlayedScene, SceneBackground};
use log_start::log_start;
use trirrr_protocol::message::{Board, Firmware};
use trirrr_service::Settings;

/// No other scene comes over the line.
#[cfg(not(scene_over_line))]
mod stored_scene {
    pub(crate) use super::image_scene::own_scene as played;
    use crate::outputs::Steps;

    /// Those of the image.
    pub fn played_steps() -> Option<Steps> {
        None
    }
}

/// No other program comes over the line.
#[cfg(not(update))]
mod update {
    use trirrr_protocol::message::Firmware;

    /// No place of another image.
    pub(crate) type NewImage = ();

    pub(crate) fn new_image(_: &'static Firmware) {}

    pub(crate) fn confirm_program() {}

    pub(crate) fn restart_if_asked() {}

    /// The program alone writes no flash.
    pub fn is_lost_expected() -> bool {
        false
    }
}

/// Builds both halves of the scene's service. The machine stands at the start of its job.
// A call: inlined, the board's crate would compile it for speed.
#[inline(never)]
pub fn build(
    channels: &'static mut Channels,
    board: Board,
    firmware: &'static Firmware,
) -> (SceneForeground, SceneBackground) {
    // Before the frame of the rest: the check of a scene in the flash takes a third of the stack.
    let played = stored_scene::played(update::new_image(firmware));
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
