//! `trirrr install`: brings the values of a scene to a board over its line.

use crate::arguments::SetArgs;
use crate::failure::CliError;
use crate::stream::{PortArgs, conversation, patience};
use crate::terminal::print;
use crate::update::{PATIENCE, Words, bring};
use clap::Args;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use trirrr_client::{SceneImage, UpdateClient, describe};
use trirrr_image::generate::BoardScene;
use trirrr_protocol::message::Identity;
use trirrr_scene::visible;

/// `trirrr install`.
///
/// Brings a scene to a board whose image takes scenes over its line: machine, limits, start and settings, without a new image. The board checks
/// it, keeps it in its flash, and plays it from its restart on.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The image is built from a scene with `scene_over_line = true` in [service], and has to have the types that the scene needs: number, tick rate, drives, \
tool, inputs. What it lacks is named. The drives have to be off. Whatever is lost on the way, the board keeps its scene of before or has the new \
one, whole. See docs/board.md, Scene over the line.")]
pub struct InstallArgs {
    /// The scene, a TOML file
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// Values in place of the scene's.
    #[command(flatten)]
    pub set: SetArgs,
    /// The line to the board.
    #[command(flatten)]
    pub line: PortArgs,
}

/// Brings the scene.
///
/// # Errors
/// Refused: the scene, or the board that has answered. Failed: the port, or a scene that the board does not take.
pub fn command(args: &InstallArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let scene = args.set.scene_to_move(&args.scene)?;
    let refused = |why: String| CliError::Refused(format!("{}: {why}", args.scene.display()));
    let for_board = BoardScene::of(&scene).map_err(|error| refused(error.to_string()))?;
    let image = SceneImage::new(for_board.types, &for_board.values);
    print(&format!(
        "scene       {}, key {:#010x}, {} bytes\n",
        visible(&scene.name),
        scene.key,
        image.header().length
    ))?;
    let client = UpdateClient::of_scene(image, patience(PATIENCE), conversation());
    let words = Words {
        waiting: "the board starts with it",
        ended: "the board keeps its scene, or has this one whole: a hello tells",
    };
    let check = |identity: &Identity| {
        let board = describe::board::name(&identity.firmware.board);
        match names_another(scene.board.as_deref(), &board) {
            Some(named) => Err(refused(format!(
                "board = \"{}\", and the board is {}: its pins are others; change `board` in the scene if its wiring is the same",
                visible(named),
                visible(&board)
            ))),
            None => Ok(()),
        }
    };
    bring(client, &args.line, &words, &check, stop)
}

/// Board that a scene names, if it is another than `board`. The path of a file says nothing of the name in the image.
fn names_another<'s>(named: Option<&'s str>, board: &str) -> Option<&'s str> {
    named.filter(|named| !named.ends_with(".toml") && *named != board)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_for_another_board_is_told_from_one_for_any() {
        assert_eq!(names_another(None, "feather-f405"), None);
        assert_eq!(names_another(Some("feather-f405"), "feather-f405"), None);
        assert_eq!(names_another(Some("mine.toml"), "feather-f405"), None);
        assert_eq!(names_another(Some("pico"), "feather-f405"), Some("pico"));
    }
}
