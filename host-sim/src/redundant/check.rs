//! `trirrr check` for a redundant machine.

use super::document::checked;
use super::read;
use crate::check::CheckArgs;
use crate::failure::CliError;
use crate::terminal::show;

/// Checks the scene, and prints what it asks for.
///
/// # Errors
/// Refused: everything that is found wrong, each with its line; a figure, which draws a path.
pub fn check(args: &CheckArgs) -> Result<(), CliError> {
    if args.figure.is_some() {
        return Err(CliError::Refused(format!(
            "{}: --figure draws a path, and the job of a redundant machine has moves; `trirrr run --fast` draws them",
            args.scene.display()
        )));
    }
    let scene = read(&args.scene, &args.job)?;
    show(&checked(&scene), args.json)
}
