//! Text for the user. Names, descriptions, paths and errors come from files, boards and lines: none of them commands the terminal.

use crate::failure::CliError;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, Write};
use trirrr_figures::document::Document;
use trirrr_scene::visible_lines;

/// Returns a message as standard error shows it: with the name of the program, and [visible](visible_lines).
pub(crate) fn message(text: &str) -> String {
    format!("trirrr: {}", visible_lines(text))
}

/// Says `text` on standard error. Who does not listen stops nothing.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{}", message(text));
}

/// Bar of `length` steps on standard error, as `template` lays it out. Nothing is seen of it where that is no terminal.
pub(crate) fn bar(length: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Prints the lines of `text` on standard output.
///
/// # Errors
/// Failed: standard output cannot be written.
pub(crate) fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    let text = visible_lines(text);
    printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Prints a result: as text, or as one object.
///
/// # Errors
/// Failed: standard output cannot be written.
pub(crate) fn show(document: &Document, as_json: bool) -> Result<(), CliError> {
    match as_json {
        true => print(&format!("{}\n", document.json())),
        false => print(&document.text()),
    }
}

/// Prints a line of a log. A standard output that is closed stops nobody.
pub(crate) fn print_line(text: &str) {
    let _ = print(&format!("{text}\n"));
}

/// Judges a write to standard output. Who closes it early does not want what is printed; any other error counts.
///
/// # Errors
/// Failed: standard output cannot be written.
pub(crate) fn printed(result: io::Result<()>) -> Result<(), CliError> {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::Failed(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}
