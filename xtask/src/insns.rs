//! `cargo xtask insns`: instructions per tick, from QEMU.
//!
//! Every core runs every tick of the scene's job and has to give the bits that the host gives;
//! a count of wrong results would be worth nothing.

pub(crate) mod counts;
mod service;

use crate::budget::{BudgetRow, Ceiling, Options, hold_ceilings};
use crate::cores::Core;
use crate::image::Image;
use crate::repository::SceneFile;
use crate::{parallel, qemu, reference};
use anyhow::{Context, Result, ensure};
use counts::Counts;
use serde::{Deserialize, Serialize};
use std::path::Path;
use trirrr_scene::Scene;

/// Ceilings that no change may exceed, instructions. What runs on a board has its ceilings in cycles (`cycles.rs`).
const CEILINGS: [Ceiling; 1] = [Ceiling::new("m4f f32 *", "dyad_max", 60.0)];

/// Core on which the service is counted.
const SERVICE_CORE: &str = "m4f";
const SERVICE_SCALAR: &str = "f32";

/// Figures of one core, number type and scene, in instructions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct InsnsRow {
    core: String,
    scalar: String,
    scene: String,
    /// The tick proper: one setpoint to twelve results.
    min: f64,
    mean: f64,
    pub(crate) max: f64,
    /// The setpoint itself, from the move.
    setpoint_min: f64,
    setpoint_mean: f64,
    setpoint_max: f64,
    /// Position of one RRR dyad as two vectors, without angles: the longest.
    dyad_max: f64,
    /// The tick of the service with a sample in each, where there is a service: while it plays the job,
    #[serde(skip_serializing_if = "Option::is_none")]
    service_mean: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    service_max: Option<f64>,
    /// with holds and resumes all along the job, the longest,
    #[serde(skip_serializing_if = "Option::is_none")]
    service_held_max: Option<f64>,
    /// and while it homes the machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    service_homing_max: Option<f64>,
    /// Checksum of all results, the same on the host.
    bits: String,
}

impl BudgetRow for InsnsRow {
    const KEY: &str = "core scalar scene";
    const FIGURES: &str = "mean max setpoint_mean setpoint_max dyad_max service_mean service_max \
                           service_held_max service_homing_max";
    const COLUMNS: &str = "core scalar scene min mean max setpoint_min setpoint_mean setpoint_max \
                           dyad_max service_mean service_max service_held_max service_homing_max \
                           bits";
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let rows = measure(options, &options.cores()?)?;
    options.print(&rows)?;
    hold_ceilings(&rows, &CEILINGS)?;
    options.settle("insns", rows)
}

/// Every scene in its number types on `cores`. Emulators run while the next images are built.
fn measure(options: &Options, cores: &[&'static Core]) -> Result<Vec<InsnsRow>> {
    let scenes = options.scenes()?;
    let mut jobs = Vec::new();
    for file in &scenes {
        let scene = Scene::read(&file.path)?;
        for scalar in options.scalars(&scene) {
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
    let image = Image::insns(
        "count",
        file,
        scalar,
        cores.first().context("a core to count on")?.target,
    );
    let built = image.build_for(&targets)?;
    let rows = cores.iter().zip(built);
    rows.map(|(core, built)| measure_one(file, scene, scalar, core, expected, &built))
        .collect()
}

/// Returns true if the service is counted. Homing is, in the scene's own number type, whichever that is.
pub(crate) fn has_service(core: &Core, scene: &Scene, scalar: &str) -> bool {
    core.name == SERVICE_CORE && (scalar == SERVICE_SCALAR || scene.homing.is_some())
}

fn measure_one(
    file: &SceneFile,
    scene: &Scene,
    scalar: &'static str,
    core: &Core,
    expected: u64,
    image: &Path,
) -> Result<InsnsRow> {
    let key = format!("{} {scalar} {}", core.name, file.name);
    let printed = qemu::run(core, image)?;
    let counts = Counts::parse(&printed, core.units_per_instruction, &["tick"], 3)
        .with_context(|| key.clone())?;
    let (counted, ticks) = (counts.column("tick", 0).len(), scene.ticks() as usize + 1);
    ensure!(
        counted == ticks,
        "{key}: {counted} ticks were counted, the job has {ticks}"
    );
    ensure!(
        counts.bits == expected,
        "{key}: the results differ from the host's (checksum {:016x}, on the host {expected:016x})",
        counts.bits
    );
    let service = match has_service(core, scene, scalar) {
        true => Some(service::measure(file, scalar, core, expected)?),
        false => None,
    };
    let tick = counts.spread("tick", 0)?;
    let setpoint = counts.spread("tick", 1)?;
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
        dyad_max: counts.spread("tick", 2)?.max,
        service_mean: service.as_ref().map(|service| service.mean),
        service_max: service.as_ref().map(|service| service.max),
        service_held_max: service.as_ref().map(|service| service.held_max),
        service_homing_max: service.and_then(|service| service.homing_max),
        bits: format!("{:016x}", counts.bits),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cores::CORES;

    #[test]
    fn every_ceiling_is_of_something_that_is_measured() {
        crate::budget::expect_measured::<InsnsRow>("insns", &CEILINGS);
    }

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
    fn the_ceiling_itself_is_allowed() {
        let with = |dyad_max| InsnsRow {
            dyad_max,
            ..row(500.0)
        };
        assert!(hold_ceilings(&[with(60.0)], &CEILINGS).is_ok());
        let error = hold_ceilings(&[with(61.0)], &CEILINGS).expect_err("above the ceiling");
        assert_eq!(
            error.to_string(),
            "m4f f32 thesis: dyad_max is 61, the ceiling is 60"
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
