//! Number type of a board: that of the scene, or the one that the board names.

use crate::failure::CliError;
use crate::terminal::say;
use trirrr_client::describe;
use trirrr_core::number::Number;
use trirrr_core::units::Units;
use trirrr_protocol::message::{Refusal, Transmit};
use trirrr_scene::{NumberType, Scene};

/// Does `work` with a board in the number type that the user has `given`, or else in that of the `scene`. A board that computes in another one
/// says so before anything is asked of it: the work is done in that one then, unless the user has given his.
///
/// # Errors
/// Those of `work`.
pub(crate) fn in_boards_numbers<T>(
    given: Option<NumberType>,
    scene: NumberType,
    mut work: impl FnMut(NumberType) -> Result<T, CliError>,
) -> Result<T, CliError> {
    match work(given.unwrap_or(scene)) {
        Err(CliError::OtherNumbers { board, .. }) if given.is_none() => {
            say(&format!(
                "the board computes in {board}, the scene in {scene}: going on in {board}, as by --scalar {board}"
            ));
            work(board)
        }
        done => done,
    }
}

/// Units of the machine of `scene` in a number type.
///
/// # Errors
/// Refused: a job or a machine that the number type cannot hold.
pub(crate) fn units<N: Number>(scene: &Scene) -> Result<Units, CliError> {
    trirrr_scene::units::<N>(scene)
        .map_err(|why| CliError::Refused(format!("scene {}: {why}", scene.name)))
}

/// Returns the failure of a command that a board has refused for this reason, which is `text` in words.
pub(crate) fn refused<N: Transmit>(refusal: &Refusal<N>, text: String) -> CliError {
    let board = match refusal {
        Refusal::Schema { expected } => describe::board::number_type(*expected),
        _ => None,
    };
    match (board, refusal) {
        (Some(board), _) => CliError::OtherNumbers { board, text },
        // What the user has given is good: the machine is in no state for it.
        (
            None,
            Refusal::DoorOpen | Refusal::LimitSwitch { .. } | Refusal::State(_) | Refusal::Busy,
        ) => CliError::Failed(text),
        (None, _) => CliError::Refused(text),
    }
}
