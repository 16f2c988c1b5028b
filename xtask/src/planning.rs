//! `cargo xtask planning`: what it costs a board to plan a path, from QEMU.

use crate::admission::{CORE, SCALAR};
use crate::budget::Options;
use crate::image::Image;
use crate::{cores, qemu};
use anyhow::{Context, Result, ensure};

/// Counts a plan of 100 cells along the way of the job's first move, under the limits of each scene.
pub(crate) fn run(options: &Options) -> Result<()> {
    let core = cores::named(CORE).context("a core of the table")?;
    println!(
        "{:12} {:>10} {:>10} {:>10} {:>10} {:>10}",
        "scene", "cells", "longest", "backward", "forward", "all"
    );
    for file in options.scenes()? {
        let image = Image::insns("plan", &file, SCALAR, core.target);
        let built = image.build_as("", |_| {})?;
        let printed = qemu::run(core, &built)?;
        ensure!(
            printed.trim_end().ends_with("100 of 100"),
            "{}: not every cell passes: {printed}",
            file.name
        );
        let counts = |stage: &str| -> Vec<f64> {
            let count = |line: &str| -> Option<f64> {
                let count: f64 = line.strip_prefix(stage)?.trim().parse().ok()?;
                Some((count / core.units_per_instruction).round())
            };
            printed.lines().filter_map(count).collect()
        };
        let [cells, backward, forward] = ["cell ", "backward ", "forward "].map(counts);
        let sum = |of: &[f64]| of.iter().sum::<f64>();
        let all = sum(&cells) + sum(&backward) + sum(&forward);
        println!(
            "{:12} {:>10} {:>10} {:>10} {:>10} {:>10}",
            file.name,
            sum(&cells),
            cells.iter().copied().fold(0.0, f64::max),
            sum(&backward),
            sum(&forward),
            all
        );
    }
    Ok(())
}
