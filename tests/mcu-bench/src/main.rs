//! Executes the flashed image of the STM32F405 with a model of the registers that it uses, and checks its pins.
//!
//! `cargo xtask bench` builds the images and calls this program; `docs/bench.md` says what is checked and how exact it is.

mod bus;
mod cases;
mod chip;
mod cpu;
mod host;
mod rotors;
mod time;
mod trace;
mod usb;
mod wiring;

use anyhow::{Context, Result, ensure};
use cases::{CASES, Case, Row, Subject};
use chip::Kind;
use clap::Parser;
use std::path::PathBuf;
use std::time::Instant;
use trirrr_scene::Scene;

#[derive(Parser)]
#[command(name = "trirrr-mcu-bench")]
struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// Image of the scene, as it is flashed
    image: PathBuf,
    /// Image of the scene that panics in its 50th tick
    #[arg(long)]
    panicking: Option<PathBuf>,
    /// Chip that the image is for
    #[arg(long, value_enum, default_value = "stm32f405")]
    chip: Kind,
    /// The line of the images is USB
    #[arg(long)]
    usb: bool,
    /// Boot loader, of an image that is replaced over the line
    #[arg(long, requires = "other")]
    boot: Option<PathBuf>,
    /// Image of another scene that takes its place
    #[arg(long, requires = "boot")]
    other: Option<PathBuf>,
    /// Case to run; all without
    #[arg(long)]
    case: Vec<String>,
    /// File for the edges of the job, as Value Change Dump
    #[arg(long)]
    vcd: Option<PathBuf>,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let known: Vec<&str> = CASES.iter().map(|case| case.name).collect();
    for case in &arguments.case {
        ensure!(
            known.contains(&case.as_str()),
            "{case}: no case of the bench; there are {}",
            known.join(", ")
        );
    }
    let subject = Subject {
        scene: Scene::read(&arguments.scene)?,
        kind: arguments.chip,
        has_usb: arguments.usb,
        image: arguments.image,
        panicking: arguments.panicking,
        update: arguments
            .boot
            .zip(arguments.other)
            .map(<[PathBuf; 2]>::from),
        dump: arguments.vcd,
    };
    let start = Instant::now();
    let mut rows = Vec::new();
    for Case { name, needs, run } in CASES {
        let chosen = arguments.case.iter().any(|chosen| chosen == name);
        let possible = subject.has(needs);
        ensure!(
            possible || !chosen,
            "case {name}: it looks at {needs:?}, which {} does not have",
            arguments.scene.display()
        );
        if chosen || arguments.case.is_empty() && possible {
            rows.extend(run(&subject).with_context(|| format!("case {name}"))?);
        }
    }
    print(&rows);
    let broken = rows.iter().filter(|row| !row.holds).count();
    println!(
        "{}: {} figures, {broken} out of bounds, {:.1} s",
        subject.scene.name,
        rows.len(),
        start.elapsed().as_secs_f64()
    );
    ensure!(broken == 0, "{broken} figures are out of their bounds");
    Ok(())
}

fn print(rows: &[Row]) {
    let headings = ["case", "figure", "measured", "bound", ""].map(str::to_owned);
    let cells = rows.iter().map(|row| {
        let verdict = if row.holds { "" } else { "FAILS" };
        [
            row.case.to_owned(),
            row.subject.clone(),
            row.measured.clone(),
            row.bound.clone(),
            verdict.to_owned(),
        ]
    });
    let lines: Vec<[String; 5]> = std::iter::once(headings).chain(cells).collect();
    let width = |column: usize| {
        lines
            .iter()
            .map(|line| line[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..5).map(width).collect();
    for line in &lines {
        let cells = line.iter().zip(&widths);
        let cells: Vec<String> = cells
            .map(|(cell, width)| format!("{cell:width$}"))
            .collect();
        println!("| {} |", cells.join(" | ").trim_end());
    }
}
