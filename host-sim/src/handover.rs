//! Hands a command over to `trirrr-full`, with the same arguments.
//!
//! `trirrr-full` lies beside this program. In a checkout it is built once, and again when this program is newer.

use crate::failure::CliError;
use crate::terminal::say;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Name of the program, without the ending of an executable file.
const FULL: &str = "trirrr-full";

/// Manifest of the package that this program was built from.
const MANIFEST: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");

/// Runs `trirrr-full` for `what`, which this program is built without, and returns its exit code.
///
/// # Errors
/// Failed: `trirrr-full` is not there, or cannot be built or run.
pub(crate) fn hand_over(what: &str) -> Result<ExitCode, CliError> {
    let failed = |reason: String| CliError::Failed(format!("{what}: {reason}"));
    let own = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let full = own.with_file_name(format!("{FULL}{}", std::env::consts::EXE_SUFFIX));
    match Checkout::of(&own) {
        Some(checkout) if !is_newer(&full, &own) => checkout.build(what, &full).map_err(failed)?,
        None if !full.exists() => {
            return Err(CliError::Failed(format!(
                "{what} is part of {FULL}, which is not beside {}; install it: cargo install --path host-sim --features full",
                own.display()
            )));
        }
        _ => {}
    }
    let mut command = Command::new(&full);
    command.args(std::env::args_os().skip(1));
    run(command).map_err(|error| failed(format!("{} cannot be run: {error}", full.display())))
}

/// Replaces this program, so that signals reach the other.
#[cfg(unix)]
fn run(mut command: Command) -> std::io::Result<ExitCode> {
    use std::os::unix::process::CommandExt;
    Err(command.exec())
}

/// Runs the other program to its end. Ctrl-C reaches both: this one has to outlive it.
#[cfg(not(unix))]
fn run(mut command: Command) -> std::io::Result<ExitCode> {
    // A handler that is there already, of a command that began, keeps this program alive, too.
    let _ = ctrlc::set_handler(|| {});
    let code = command
        .status()?
        .code()
        .and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Returns true if the file `full` was written after the file `own`.
fn is_newer(full: &Path, own: &Path) -> bool {
    let written = |file: &Path| file.metadata().and_then(|data| data.modified());
    match (written(full), written(own)) {
        (Ok(full), Ok(own)) => full >= own,
        _ => false,
    }
}

/// Target directory of a checkout, and the profile, that this program was built in.
struct Checkout {
    target: PathBuf,
    profile: String,
}

impl Checkout {
    /// None: the program `own` was installed, or its sources are gone.
    fn of(own: &Path) -> Option<Self> {
        let folder = own.parent()?;
        let target = folder.parent()?;
        let is_target = target.join("CACHEDIR.TAG").exists() && Path::new(MANIFEST).exists();
        let profile = match folder.file_name()?.to_str()? {
            "debug" => "dev",
            name => name,
        };
        is_target.then(|| Self {
            target: target.into(),
            profile: profile.into(),
        })
    }

    /// Builds `full`.
    fn build(&self, what: &str, full: &Path) -> Result<(), String> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        command
            .args(["build", "--profile", &self.profile, "--bin", FULL])
            .args([
                "--features",
                "full",
                "--manifest-path",
                MANIFEST,
                "--target-dir",
            ])
            .arg(&self.target);
        if !full.exists() {
            say(&format!(
                "{what} is part of {FULL}, which is built now, once: that takes minutes"
            ));
        } else {
            command.arg("--quiet");
        }
        let is_built = command
            .status()
            .map_err(|error| format!("cargo cannot be run to build {FULL}: {error}"))?
            .success();
        if !is_built {
            return Err(format!("{FULL} cannot be built: cargo says why above"));
        }
        Ok(())
    }
}
