//! `cargo xtask insns`: instructions per tick, from QEMU.
//!
//! Every core runs every tick of the scene's job and has to give the bits that the host gives;
//! a count of wrong results would be worth nothing.

mod counts;
mod service;

use crate::budget::{BudgetRow, Options};
use crate::cores::{self, CORES, Core};
use crate::image::{Image, scalars};
use crate::repository::SceneFile;
use crate::table::table;
use crate::{parallel, qemu, reference};
use anyhow::{Context, Result, bail, ensure};
use counts::{Spread, parse};
use serde::{Deserialize, Serialize};
use std::path::Path;
use trirrr_scene::Scene;

/// The longest position of a dyad, f32 on m4f, in any scene.
const DYAD_CEILING: f64 = 60.0;

/// Ceilings that no change may exceed: core, number type, scene, instructions of the longest tick.
const CEILINGS: &[(&str, &str, &str, f64)] = &[
    ("m4f", "f32", "thesis", 600.0),
    ("m4f", "f32", "thesis-links", 750.0),
    ("m3", "fixed", "thesis", 1800.0),
    ("m0", "fixed", "thesis", 10_000.0),
];

/// Core on which the service is counted.
const SERVICE_CORE: &str = "m4f";
const SERVICE_SCALAR: &str = "f32";

#[derive(clap::Args)]
pub(crate) struct InsnsArgs {
    #[command(flatten)]
    options: Options,
    /// m4f, m3, m0 or rv32imc; repeat for more; without it, all of them
    #[arg(long)]
    core: Vec<String>,
}

/// Figures of one core, number type and scene, in instructions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct InsnsRow {
    core: String,
    scalar: String,
    scene: String,
    /// The tick proper: one setpoint to twelve results.
    min: f64,
    mean: f64,
    max: f64,
    /// The setpoint itself, from the move.
    setpoint_min: f64,
    setpoint_mean: f64,
    setpoint_max: f64,
    /// Position of one RRR dyad as two vectors, without angles: the longest.
    dyad_max: f64,
    /// The tick of the whole service while it plays the job; on m4f only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    service_mean: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    service_max: Option<f64>,
    /// Its longest tick with holds and resumes all along the job.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    service_held_max: Option<f64>,
    /// Its longest tick while it homes the machine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    service_homing_max: Option<f64>,
    /// Checksum of all results, the same on the host.
    bits: String,
}

impl InsnsRow {
    /// Returns true if the row is that of this core, scene and number type.
    pub(crate) fn is(&self, core: &str, scene: &str, scalar: &str) -> bool {
        (
            self.core.as_str(),
            self.scene.as_str(),
            self.scalar.as_str(),
        ) == (core, scene, scalar)
    }

    /// Instructions of the longest tick.
    pub(crate) fn longest(&self) -> f64 {
        self.max
    }
}

impl BudgetRow for InsnsRow {
    fn key(&self) -> String {
        format!("{} {} {}", self.core, self.scalar, self.scene)
    }

    fn figures(&self) -> Vec<(&'static str, f64)> {
        let mut figures = vec![
            ("mean", self.mean),
            ("max", self.max),
            ("setpoint_mean", self.setpoint_mean),
            ("setpoint_max", self.setpoint_max),
            ("dyad_max", self.dyad_max),
        ];
        let service = [
            ("service_mean", self.service_mean),
            ("service_max", self.service_max),
            ("service_held_max", self.service_held_max),
            ("service_homing_max", self.service_homing_max),
        ];
        figures.extend(
            service
                .into_iter()
                .filter_map(|(name, figure)| Some((name, figure?))),
        );
        figures
    }
}

pub(crate) fn run(arguments: &InsnsArgs) -> Result<()> {
    let options = &arguments.options;
    let rows = measure(&options.scenes()?, &cores_named(&arguments.core)?)?;
    options.print(&rows, text)?;
    hold_ceilings(&rows)?;
    options.settle("insns", rows, arguments.core.is_empty())
}

fn cores_named(names: &[String]) -> Result<Vec<&'static Core>> {
    if names.is_empty() {
        return Ok(CORES.iter().collect());
    }
    let known = || {
        CORES
            .iter()
            .map(|core| core.name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    names
        .iter()
        .map(|name| {
            cores::named(name).with_context(|| format!("{name}: no such core ({})", known()))
        })
        .collect()
}

/// Every scene in its number types on `cores`. Emulators run while the next images are built.
fn measure(scenes: &[SceneFile], cores: &[&'static Core]) -> Result<Vec<InsnsRow>> {
    let mut jobs = Vec::new();
    for file in scenes {
        let scene = Scene::read(&file.path)?;
        for scalar in scalars(&scene) {
            jobs.push((file, scene.clone(), scalar));
        }
    }
    let rows = parallel::map(parallel::workers(), &jobs, |(file, scene, scalar)| {
        measure_on(cores, file, scene, scalar)
    })?;
    Ok(rows.into_iter().flatten().collect())
}

fn measure_on(
    cores: &[&'static Core],
    file: &SceneFile,
    scene: &Scene,
    scalar: &'static str,
) -> Result<Vec<InsnsRow>> {
    let expected = reference::checksum(scene, scalar)?;
    let targets: Vec<_> = cores.iter().map(|core| core.target).collect();
    let image = Image {
        package: "trirrr-insns",
        binary: "count",
        scene: file,
        scalar,
        target: cores.first().context("a core to count on")?.target,
    };
    let built = image.build_for(&targets)?;
    let rows = cores.iter().zip(built);
    rows.map(|(core, built)| measure_one(file, scene, scalar, core, expected, &built))
        .collect()
}

fn measure_one(
    file: &SceneFile,
    scene: &Scene,
    scalar: &'static str,
    core: &Core,
    expected: u64,
    image: &Path,
) -> Result<InsnsRow> {
    let printed = qemu::run(core, image)?;
    let counts = parse(&printed, core.units_per_instruction)
        .with_context(|| format!("{} {scalar} {}", core.name, file.name))?;
    ensure!(
        counts.ticks.len() == scene.ticks() as usize + 1,
        "{} {scalar} {}: {} ticks were counted, the job has {}",
        core.name,
        file.name,
        counts.ticks.len(),
        scene.ticks() as usize + 1
    );
    ensure!(
        counts.bits == expected,
        "{} {scalar} {}: the results differ from the host's (checksum {:016x}, on the host {expected:016x})",
        core.name,
        file.name,
        counts.bits
    );
    // Homing is counted in the scene's own number type, whichever that is.
    let counted = scalar == SERVICE_SCALAR || scene.homing.is_some();
    let service = if core.name == SERVICE_CORE && counted {
        Some(service::measure(file, scalar, core, expected)?)
    } else {
        None
    };
    let tick = Spread::of(&counts.ticks)?;
    let setpoint = Spread::of(&counts.setpoints)?;
    Ok(InsnsRow {
        core: core.name.into(),
        scalar: scalar.into(),
        scene: file.name.clone(),
        min: tick.min,
        mean: tick.mean,
        max: tick.max,
        setpoint_min: setpoint.min,
        setpoint_mean: setpoint.mean,
        setpoint_max: setpoint.max,
        dyad_max: Spread::of(&counts.dyads)?.max,
        service_mean: service.as_ref().map(|service| service.job.mean),
        service_max: service.as_ref().map(|service| service.job.max),
        service_held_max: service.as_ref().map(|service| service.held.max),
        service_homing_max: service
            .and_then(|service| service.homing)
            .map(|homing| homing.max),
        bits: format!("{:016x}", counts.bits),
    })
}

fn text(rows: &[InsnsRow]) -> String {
    let cells = rows.iter().map(|row| {
        let mut cells = vec![row.core.clone(), row.scalar.clone(), row.scene.clone()];
        let figures = [row.min, row.mean, row.max];
        let setpoint = [row.setpoint_min, row.setpoint_mean, row.setpoint_max];
        let dyad = [row.dyad_max];
        cells.extend(
            figures
                .iter()
                .chain(&setpoint)
                .chain(&dyad)
                .map(|figure| format!("{figure}")),
        );
        let service = [
            row.service_mean,
            row.service_max,
            row.service_held_max,
            row.service_homing_max,
        ];
        cells.extend(
            service
                .iter()
                .map(|figure| figure.map_or("-".into(), |figure| format!("{figure}"))),
        );
        cells.push(row.bits.clone());
        cells
    });
    let headings = [
        "core",
        "scalar",
        "scene",
        "min",
        "mean",
        "max",
        "setpoint min",
        "mean",
        "max",
        "dyad max",
        "service mean",
        "max",
        "held max",
        "homing max",
        "bits",
    ];
    table(&headings, &cells.collect::<Vec<_>>())
}

fn hold_ceilings(rows: &[InsnsRow]) -> Result<()> {
    for (core, scalar, scene, ceiling) in CEILINGS {
        let mut of = rows
            .iter()
            .filter(|row| row.core == *core && row.scalar == *scalar && row.scene == *scene);
        if let Some(row) = of.find(|row| row.max > *ceiling) {
            bail!(
                "{}: {} instructions, the ceiling is {ceiling}",
                row.key(),
                row.max
            );
        }
    }
    let mut on_m4f = rows
        .iter()
        .filter(|row| row.core == "m4f" && row.scalar == "f32");
    if let Some(row) = on_m4f.find(|row| row.dyad_max > DYAD_CEILING) {
        bail!(
            "{}: {} instructions for a dyad, the ceiling is {DYAD_CEILING}",
            row.key(),
            row.dyad_max
        );
    }
    let of_service = |row: &&InsnsRow| {
        let longest = [
            row.service_max,
            row.service_held_max,
            row.service_homing_max,
        ];
        row.scalar == SERVICE_SCALAR
            && longest
                .into_iter()
                .flatten()
                .any(|longest| longest > service::CEILING)
    };
    if let Some(row) = rows.iter().find(of_service) {
        bail!(
            "{}: {:?} instructions for a tick of the service, with holds {:?}, in homing {:?}; the \
             ceiling is {}",
            row.key(),
            row.service_max,
            row.service_held_max,
            row.service_homing_max,
            service::CEILING
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(max: f64) -> InsnsRow {
        InsnsRow {
            core: "m4f".into(),
            scalar: "f32".into(),
            scene: "thesis".into(),
            min: 400.0,
            mean: 450.0,
            max,
            setpoint_min: 40.0,
            setpoint_mean: 41.5,
            setpoint_max: 43.0,
            dyad_max: 50.0,
            service_mean: None,
            service_max: None,
            service_held_max: None,
            service_homing_max: None,
            bits: "00000000000000ff".into(),
        }
    }

    #[test]
    fn no_tick_of_the_service_in_f32_may_exceed_its_ceiling() {
        for (in_homing, allowed) in [(service::CEILING, true), (service::CEILING + 1.0, false)] {
            let homed = InsnsRow {
                service_homing_max: Some(in_homing),
                ..row(500.0)
            };
            assert_eq!(hold_ceilings(std::slice::from_ref(&homed)).is_ok(), allowed);
            let fixed = InsnsRow {
                scalar: "fixed".into(),
                ..homed
            };
            assert!(hold_ceilings(&[fixed]).is_ok());
        }
    }

    #[test]
    fn the_ceiling_itself_is_allowed() {
        assert!(hold_ceilings(&[row(600.0)]).is_ok());
        let error = hold_ceilings(&[row(601.0)]).expect_err("above the ceiling");
        assert_eq!(
            error.to_string(),
            "m4f f32 thesis: 601 instructions, the ceiling is 600"
        );
    }

    /// Checks that the file has the figures of every core and number type. The report would leave
    /// out an uncounted one without a word.
    #[test]
    fn both_thesis_scenes_are_checked_in_for_every_core_and_number_type() {
        let rows: Vec<InsnsRow> = crate::budget::checked_in("insns").expect("the file of figures");
        for scene in ["thesis", "thesis-links"] {
            for core in CORES {
                for (scalar, _) in trirrr_image::generate::SCALARS {
                    let key = format!("{} {scalar} {scene}", core.name);
                    assert!(rows.iter().any(|row| row.key() == key), "{key}");
                }
            }
        }
    }

    #[test]
    fn an_unknown_core_is_refused_with_the_known_ones() {
        let error = cores_named(&["m7".into()]).expect_err("not emulated here");
        assert_eq!(error.to_string(), "m7: no such core (m4f, m3, m0, rv32imc)");
    }

    #[test]
    fn json_is_an_array_of_flat_objects_with_the_contract_s_keys() {
        let json = serde_json::to_value([row(500.0)]).expect("plain data");
        let object = json[0].as_object().expect("an object");
        for key in ["core", "scalar", "scene", "min", "mean", "max"] {
            assert!(object.contains_key(key), "{key}");
        }
        assert!(
            object
                .values()
                .all(|value| !value.is_object() && !value.is_array())
        );
    }
}
