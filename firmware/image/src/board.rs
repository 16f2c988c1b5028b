//! Pins of a board as data: a TOML file with chip, crystal, and pins by function.
//!
//! The build script of a chip's package calls [`build_script`]. The file is checked against the chip, and against what the
//! scene needs; the package includes `OUT_DIR/board.rs`, which has the pins as types.

mod chip;
mod clock;
mod commit;
mod file;
mod needs;
mod role;
mod source;
mod table;

pub use chip::{Chip, Family};
pub use file::{BoardFile, WiredPin};
pub use needs::Needs;
pub use role::Role;
pub use table::table;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};
use trirrr_scene::read::text_of;
use trirrr_scene::{BOARDS, is_board_file, visible};

/// Folder of the shipped board files, in the root of the repository.
const FILES: &str = "firmware/boards/files";

/// Variable of the environment that names the board.
const VARIABLE: &str = "BOARD";

/// Variable of the environment that puts USB in the place of the line's port.
const LINE: &str = "LINE";

/// Writes `OUT_DIR/board.rs` for the firmware of the family `name`, with the pins and the build that the identity tells, and tells Cargo about the file and the variables that this depends on. With a line over USB `cfg(usb)` is set.
///
/// `BOARD` names the board: a shipped file, or a path relative to `root`. Without it the `board` of the scene counts, and without
/// that the default of the package.
///
/// # Errors
/// A board that is not there, or is refused: with file, line, key and reason.
pub fn build_script(name: &str, root: &Path) -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-env-changed={VARIABLE}");
    let family = Family::of(name)
        .ok_or_else(|| format!("{name}: no chip of a board file is of this family"))?;
    let handed_on = |name: &str| env::var(format!("DEP_TRIRRR_APP_{}", name.to_uppercase())).ok();
    let mut needs = Needs::read(handed_on)?;
    println!("cargo:rerun-if-env-changed={LINE}");
    needs.usb_line = asks_for_usb(env::var(LINE).ok().as_deref())?;
    if needs.usb_line && needs.autonomous {
        return Err(format!(
            "{}: autonomous = true in [service]: the board has no line, so leave {LINE}=usb out",
            visible(&needs.scene)
        )
        .into());
    }
    let variable = env::var(VARIABLE).ok().filter(|name| !name.is_empty());
    let file = chosen(variable.as_deref(), &needs, family, root)?;
    println!("cargo:rerun-if-changed={}", file.display());
    let name = file.strip_prefix(root).unwrap_or(&file);
    let board = BoardFile::parse(
        &text_of(&file)?,
        &name.display().to_string(),
        Some((family, &needs)),
    )?;
    let out = env::var_os("OUT_DIR").ok_or("OUT_DIR is not set: not a build script")?;
    println!("cargo:rustc-check-cfg=cfg(usb)");
    if board.has_usb_line() && !needs.autonomous {
        println!("cargo:rustc-cfg=usb");
    }
    let text = source::source(&board, &needs) + &firmware(&file, &board, root);
    fs::write(PathBuf::from(out).join("board.rs"), text)?;
    Ok(())
}

/// Returns true if the variable `LINE` asks for a line over USB.
fn asks_for_usb(line: Option<&str>) -> Result<bool, String> {
    match line {
        None | Some("") => Ok(false),
        Some("usb") => Ok(true),
        Some(other) => Err(format!(
            "{LINE}={}: must be usb; without it the port of the board file counts",
            visible(other)
        )),
    }
}

/// Build of the image as source: version of the package, commit, and the board of `file`.
fn firmware(file: &Path, board: &BoardFile, root: &Path) -> String {
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    let (label, firmware) = (
        "trirrr_app::ImageLabel",
        "trirrr_protocol::message::Firmware",
    );
    format!(
        "const BUILD: {firmware} = {firmware}::new(env!(\"CARGO_PKG_VERSION\"), {:?}, {name:?}, {:?});\n\
         #[cfg(not(update))]\n\
         pub(crate) const FIRMWARE: &{firmware} = &BUILD;\n\
         #[cfg(update)]\n\
         static LABEL: {label} = {label}::new(BUILD);\n\
         #[cfg(update)]\n\
         pub(crate) const FIRMWARE: &{firmware} = &LABEL.firmware;\n",
        commit::commit(root),
        board.chip.name,
    )
}

/// The file of the board that `variable`, the scene or the family names.
fn chosen(
    variable: Option<&str>,
    needs: &Needs,
    family: Family,
    root: &Path,
) -> Result<PathBuf, String> {
    let (by, name) = match (variable, needs.board.as_deref()) {
        (Some(name), _) => (format!("{VARIABLE}={name}"), name),
        (None, Some(name)) => (format!("{}: board = \"{name}\"", needs.scene), name),
        (None, None) => (String::new(), family.default_board()),
    };
    let file = match is_board_file(name) {
        true => root.join(name),
        false => root.join(FILES).join(name).with_extension("toml"),
    };
    if file.is_file() {
        return Ok(file);
    }
    let shipped = BOARDS.join(", ");
    Err(format!(
        "{}: no such board: {} is no file; shipped boards are {shipped}, and a path ends in .toml",
        visible(&by),
        visible(
            &file
                .strip_prefix(root)
                .unwrap_or(&file)
                .display()
                .to_string()
        ),
    ))
}

/// Text of a shipped board file.
#[cfg(test)]
fn shipped(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let file = root.join(FILES).join(name).with_extension("toml");
    fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

#[cfg(test)]
mod tests;
