//! `cargo xtask admission`: what it costs a board to judge a move, from QEMU.
//!
//! It is counted as it is compiled in the firmware, for size.

use crate::budget::{BudgetRow, Options};
use crate::cores::Core;
use crate::image::Image;
use crate::repository::SceneFile;
use crate::{parallel, qemu};
use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use trirrr_scene::Scene;

/// The core that admission is counted on, and the number type.
pub(crate) const CORE: &str = "m4f";
pub(crate) const SCALAR: &str = "f32";

/// The image's own code as that of the firmware's background.
const FOR_SIZE: &str = r#"profile.device.package.trirrr-insns.opt-level="z""#;

/// Figures of one scene's moves, in instructions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct AdmissionRow {
    core: String,
    scalar: String,
    scene: String,
    /// `own`: the scene's own; `all`: whatever it leaves out limited, too.
    limits: String,
    moves: usize,
    refused: usize,
    /// Of one admission.
    min: f64,
    mean: f64,
    max: f64,
    /// Of the longest slice of work.
    slice_max: f64,
    /// Intervals that a move was divided into.
    intervals_mean: f64,
    intervals_max: u32,
}

impl BudgetRow for AdmissionRow {
    const KEY: &str = "core scalar scene limits";
    const FIGURES: &str = "mean max slice_max";
    const COLUMNS: &str = "core scalar scene limits moves refused min mean max slice_max \
                           intervals_mean intervals_max";
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let mut cores = options.cores()?;
    cores.retain(|core| core.name == CORE);
    let core = cores
        .first()
        .with_context(|| format!("admission is measured on {CORE} alone"))?;
    let scenes = options.scenes()?;
    let rows = parallel::map(parallel::workers(), &scenes, |file| measure(file, core))?;
    let rows: Vec<AdmissionRow> = rows.into_iter().flatten().collect();
    options.print(&rows)?;
    options.settle("admission", rows)
}

/// Builds the image: as in the firmware, whose background is compiled for size (`[profile.device]`).
pub(crate) fn image(file: &SceneFile, core: &Core) -> Result<PathBuf> {
    let image = Image::insns("admit", file, SCALAR, core.target);
    image.build_as("", |cargo| {
        cargo.args(["--config", FOR_SIZE]);
    })
}

fn measure(file: &SceneFile, core: &Core) -> Result<[AdmissionRow; 2]> {
    let built = image(file, core)?;
    let printed = qemu::run(core, &built)?;
    let moves = parse(&printed, core.units_per_instruction).with_context(|| file.name.clone())?;
    let count = Scene::read(&file.path)?.job.moves.len();
    ensure!(
        moves.len() == 2 * count,
        "{}: {} moves were judged, the job has {count}, twice",
        file.name,
        moves.len()
    );
    let row = |limits: &str, moves: &[Judged]| {
        let mean = |of: fn(&Judged) -> f64| {
            let sum: f64 = moves.iter().map(of).sum();
            (sum / moves.len() as f64 * 10.0).round() / 10.0
        };
        let most = |of: fn(&Judged) -> f64| moves.iter().map(of).fold(0.0, f64::max);
        AdmissionRow {
            core: core.name.into(),
            scalar: SCALAR.into(),
            scene: file.name.clone(),
            limits: limits.into(),
            moves: moves.len(),
            refused: moves.iter().filter(|one| !one.admitted).count(),
            min: moves.iter().map(|one| one.total).fold(f64::MAX, f64::min),
            mean: mean(|one| one.total),
            max: most(|one| one.total),
            slice_max: most(|one| one.longest),
            intervals_mean: mean(|one| f64::from(one.intervals)),
            intervals_max: moves.iter().map(|one| one.intervals).max().unwrap_or(0),
        }
    };
    let (own, all) = moves.split_at(count);
    Ok([row("own", own), row("all", all)])
}

/// The judgement of one move, in instructions.
#[derive(Debug, PartialEq)]
pub(crate) struct Judged {
    pub(crate) intervals: u32,
    pub(crate) total: f64,
    longest: f64,
    admitted: bool,
}

/// Reads `move INTERVALS TOTAL LONGEST VERDICT`, counts being in units of which an instruction takes
/// `units`.
pub(crate) fn parse(printed: &str, units: f64) -> Result<Vec<Judged>> {
    let line = |line: &str| -> Result<Judged> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [
            "move",
            intervals,
            total,
            longest,
            verdict @ ("admitted" | "refused"),
        ] = words[..]
        else {
            anyhow::bail!("the image says: {line}");
        };
        let count = |word: &str| -> Result<f64> {
            let count: f64 = word.parse()?;
            Ok((count / units).round())
        };
        Ok(Judged {
            intervals: intervals.parse()?,
            total: count(total)?,
            longest: count(longest)?,
            admitted: verdict == "admitted",
        })
    };
    printed.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_become_instructions() {
        let printed = "move 16 6400 640 admitted\nmove 20 12800 1280 refused\n";
        let moves = parse(printed, 6.4).expect("good lines");
        assert_eq!(moves.len(), 2);
        assert_eq!((moves[0].total, moves[0].longest), (1000.0, 100.0));
        assert!(moves[0].admitted && !moves[1].admitted);
        let error = parse("panicked at somewhere", 6.4).expect_err("no line of ours");
        assert_eq!(error.to_string(), "the image says: panicked at somewhere");
    }
}
