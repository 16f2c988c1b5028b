//! Tables of `docs/cycles.md`, from the figures that are checked in.

use super::CyclesRow;
use super::boards::{BOARDS, MEMORIES, Memory};
use crate::budget::{BudgetRow, checked_in};
use anyhow::{Context, Result};

/// The board that the firmware is for, and its number type.
const BOARD: &str = "m4f f32";

/// Ticks per second that admission has to leave time for.
const TICK_RATE_HZ: f64 = 1000.0;

struct Rows(Vec<CyclesRow>);

impl Rows {
    fn read() -> Result<Self> {
        checked_in("cycles").map(Self)
    }

    /// The row of `key` and a memory, if there is one.
    fn find(&self, key: &str, memory: Memory) -> Option<&CyclesRow> {
        let key = format!("{key} {}", memory.name());
        self.0.iter().find(|row| row.key() == key)
    }

    /// Scenes that are modelled, by name.
    fn scenes(&self) -> Vec<&str> {
        let mut scenes: Vec<&str> = self.0.iter().map(|row| row.scene.as_str()).collect();
        scenes.sort_unstable();
        scenes.dedup();
        scenes
    }

    /// Scalars of a scene, in the order of the tables.
    fn scalars(&self, scene: &str) -> Vec<&'static str> {
        let is_there = |scalar: &&str| {
            let is_one =
                |row: &CyclesRow| row.scene == scene && row.scalar == *scalar && row.what == "tick";
            self.0.iter().any(is_one)
        };
        let scalars = trirrr_image::generate::SCALARS
            .iter()
            .map(|(name, _)| *name);
        scalars.filter(is_there).collect()
    }
}

fn line(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

fn header(cells: &[&str], names: usize) -> String {
    let rules = (0..cells.len()).map(|nth| if nth < names { "---" } else { "---:" });
    format!(
        "| {} |\n| {} |\n",
        cells.join(" | "),
        rules.collect::<Vec<_>>().join(" | ")
    )
}

/// Setpoint and tick on every board.
pub(crate) fn ticks() -> Result<String> {
    let rows = Rows::read()?;
    let headings = [
        "scene",
        "number",
        "board",
        "instructions",
        "RAM",
        "setpoint of it",
        "flash",
        "flash, cold",
        "\u{b5}s in flash",
    ];
    let mut table = header(&headings, 3);
    for scene in rows.scenes() {
        for scalar in rows.scalars(scene) {
            for board in &BOARDS {
                let key = format!("{} {scalar} {scene} tick", board.core);
                let of =
                    MEMORIES.map(|memory| rows.find(&key, memory).with_context(|| key.clone()));
                let [ram, flash, cold] = of;
                let (ram, flash, cold) = (ram?, flash?, cold?);
                table += &line(&[
                    scene.into(),
                    scalar.into(),
                    format!("{}, {:.0} MHz", board.name, board.mhz),
                    format!("{:.0}", ram.instructions),
                    format!("{:.0}", ram.mean),
                    format!("{:.0}", ram.setpoint_mean.context("a setpoint")?),
                    format!("{:.0}", flash.mean),
                    format!("{:.0}", cold.mean),
                    format!("{:.2}", flash.us_mean),
                ]);
            }
        }
    }
    Ok(table)
}

/// The service and the admission on the board that the firmware is for.
pub(crate) fn service() -> Result<String> {
    let rows = Rows::read()?;
    let headings = [
        "scene",
        "number",
        "service: RAM",
        "flash",
        "flash, cold",
        "longest, flash",
        "\u{b5}s",
        "slice: flash",
        "move: flash",
        "\u{b5}s",
        "moves per second",
    ];
    let mut table = header(&headings, 2);
    for scene in rows.scenes() {
        let admitted = |what| {
            let key = format!("{BOARD} {scene} {what}");
            rows.find(&key, Memory::Flash).context(key)
        };
        let (slice, whole) = (admitted("slice")?, admitted("admission")?);
        let service = |scalar| {
            let key = format!("m4f {scalar} {scene} service");
            let [ram, flash, cold] = MEMORIES.map(|memory| rows.find(&key, memory));
            Some((scalar, ram?, flash?, cold?))
        };
        // That of a scene in fixed point is modelled where it homes.
        let Some((scalar, ram, flash, cold)) = rows.scalars(scene).into_iter().find_map(service)
        else {
            continue;
        };
        let left = 1e6 * flash.mhz - TICK_RATE_HZ * flash.mean;
        table += &line(&[
            scene.into(),
            scalar.into(),
            format!("{:.0}", ram.mean),
            format!("{:.0}", flash.mean),
            format!("{:.0}", cold.mean),
            format!("{:.0}", flash.max),
            format!("{:.2}", flash.us_mean),
            format!("{:.0}", slice.mean),
            format!("{:.0}", whole.mean),
            format!("{:.0}", whole.us_mean),
            format!("{:.0}", left / whole.mean),
        ]);
    }
    Ok(table)
}

/// Classes of cycles on the board that the firmware is for.
pub(crate) fn classes() -> Result<String> {
    let rows = Rows::read()?;
    let headings = [
        "scene", "part", "all", "float", "divide", "multiply", "integer", "load", "store",
        "multiple", "branch", "stall",
    ];
    let mut table = header(&headings, 2);
    for scene in ["thesis", "thesis-links", "vertical"] {
        for what in ["tick", "service", "slice"] {
            let key = format!("{BOARD} {scene} {what}");
            let row = rows.find(&key, Memory::Ram).context(key)?;
            let cycles = [row.mean].into_iter().chain(row.classes());
            let cells = [scene.to_owned(), what.to_owned()].into_iter();
            let cells = cells.chain(cycles.map(|cycles| format!("{cycles:.0}")));
            table += &line(&cells.collect::<Vec<_>>());
        }
    }
    Ok(table)
}
