//! `cargo xtask footprints`: the table of scenes against flash, RAM, stack and instructions per tick in
//! `docs/footprints.md`, from the figures that are checked in.

use crate::boards::FIRMWARE_TARGET;
use crate::budget::{BudgetRow, checked_in};
use crate::insns;
use crate::repository::{root, scenes_named};
use crate::size;
use anyhow::{Context, Result};
use std::fs;
use std::path::PathBuf;
use trirrr_image::generate::{kind, of_scene};
use trirrr_scene::Scene;

#[derive(clap::Args)]
pub(crate) struct FootprintsArgs {
    /// Write the table into docs/footprints.md
    #[arg(long)]
    bless: bool,
}

const BEGIN: &str = "<!-- cargo xtask footprints -->\n";
const END: &str = "<!-- end -->\n";

fn file() -> PathBuf {
    root().join("docs/footprints.md")
}

pub(crate) fn run(arguments: &FootprintsArgs) -> Result<()> {
    let table = table()?;
    print!("{table}");
    if arguments.bless {
        let text = fs::read_to_string(file())?;
        let (before, after) = around(&text).context("docs/footprints.md has no place for it")?;
        fs::write(file(), format!("{before}{BEGIN}{table}{END}{after}"))?;
    }
    Ok(())
}

/// Returns the text before the table and behind it; none if a mark of the table is missing.
fn around(text: &str) -> Option<(&str, &str)> {
    let (before, rest) = text.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    Some((before, after))
}

fn table() -> Result<String> {
    let sizes: Vec<size::SizeRow> = checked_in("size")?;
    let counts: Vec<insns::InsnsRow> = checked_in("insns")?;
    let mut table = String::from(
        "| scene | number | torques | drives | image: flash | RAM | stack | tick alone on m4f: flash | \
         on m0: flash | instructions per tick on m4f | on m0 |\n\
         |---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for scene_file in scenes_named(&[])? {
        let scene = Scene::read(&scene_file.path)?;
        let (name, scalar) = (scene_file.name.as_str(), of_scene(scene.number));
        let size = |image: &str, target: &str| {
            let key = format!("{image} {target} {scalar} {name}");
            find(&sizes, key)
        };
        let count = |core: &str| find(&counts, format!("{core} {scalar} {name}"));
        let image = size("firmware", FIRMWARE_TARGET)?;
        let cells = [
            name.to_owned(),
            scalar.to_owned(),
            if scene.torque { "yes" } else { "no" }.to_owned(),
            kind(&scene).to_owned(),
            image.flash.to_string(),
            image.ram.to_string(),
            image.stack.context("no stack is checked in")?.to_string(),
            size("core", "thumbv7em-none-eabihf")?.flash.to_string(),
            size("core", "thumbv6m-none-eabi")?.flash.to_string(),
            count("m4f")?.max.to_string(),
            count("m0")?.max.to_string(),
        ];
        table += &format!("| {} |\n", cells.join(" | "));
    }
    Ok(table)
}

/// The row of `key`.
fn find<Row: BudgetRow>(rows: &[Row], key: String) -> Result<&Row> {
    let row = rows.iter().find(|row| row.key() == key);
    row.with_context(|| format!("{key}: not checked in"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_has_the_figures_that_are_checked_in() {
        let text = fs::read_to_string(file()).expect("the document");
        let (before, after) = around(&text).expect("a place for the table");
        let now = table().expect("all figures");
        assert_eq!(
            text,
            format!("{before}{BEGIN}{now}{END}{after}"),
            "cargo xtask footprints --bless"
        );
    }
}
