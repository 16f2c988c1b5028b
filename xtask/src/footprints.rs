//! `cargo xtask footprints`: the table of scenes against flash, RAM, stack and instructions per tick in
//! `docs/footprints.md`, and those of `docs/cycles.md`, from the figures that are checked in.

use crate::boards::FIRMWARE_TARGET;
use crate::budget::{BudgetRow, checked_in};
use crate::cycles::document;
use crate::insns;
use crate::repository::{root, scenes_named};
use crate::size;
use anyhow::{Context, Result};
use std::fs;
use trirrr_image::generate::{kind, of_scene};
use trirrr_scene::Scene;

#[derive(clap::Args)]
pub(crate) struct FootprintsArgs {
    /// Write the tables into docs/footprints.md and docs/cycles.md
    #[arg(long)]
    bless: bool,
}

/// A table in a document, between marks.
struct Place {
    file: &'static str,
    begin: &'static str,
    table: fn() -> Result<String>,
}

const PLACES: [Place; 4] = [
    Place {
        file: "docs/footprints.md",
        begin: "<!-- cargo xtask footprints -->\n",
        table,
    },
    Place {
        file: "docs/cycles.md",
        begin: "<!-- cargo xtask footprints: cycles of the tick -->\n",
        table: document::ticks,
    },
    Place {
        file: "docs/cycles.md",
        begin: "<!-- cargo xtask footprints: cycles of the service -->\n",
        table: document::service,
    },
    Place {
        file: "docs/cycles.md",
        begin: "<!-- cargo xtask footprints: cycles by class -->\n",
        table: document::classes,
    },
];

const END: &str = "<!-- end -->\n";

pub(crate) fn run(arguments: &FootprintsArgs) -> Result<()> {
    for place in PLACES {
        let table = (place.table)()?;
        println!("{table}");
        if arguments.bless {
            let file = root().join(place.file);
            let text = fs::read_to_string(&file)?;
            fs::write(file, place.with(&text, &table)?)?;
        }
    }
    Ok(())
}

impl Place {
    /// `text` with `table` between the marks.
    fn with(&self, text: &str, table: &str) -> Result<String> {
        let Self { file, begin, .. } = self;
        let parts = text.split_once(begin);
        let parts = parts.and_then(|(before, rest)| Some((before, rest.split_once(END)?.1)));
        let (before, after) = parts.with_context(|| format!("{file} has no place for it"))?;
        Ok(format!("{before}{begin}{table}{END}{after}"))
    }
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
    fn the_documents_have_the_figures_that_are_checked_in() {
        for place in PLACES {
            let text = fs::read_to_string(root().join(place.file)).expect("the document");
            let now = (place.table)().expect("all figures");
            let expected = place.with(&text, &now).expect("a place for the table");
            assert_eq!(text, expected, "cargo xtask footprints --bless");
        }
    }
}
