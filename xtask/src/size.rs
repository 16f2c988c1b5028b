//! `cargo xtask size`: flash and RAM, of the tick alone on every target and of the firmware, for the RP2040 too.
//!
//! The tick alone (image `core`) is its code and constants in flash and, in RAM, its coefficients,
//! one setpoint and one outcome. That image does not link if a panic is left in the tick. The symbols
//! of the firmware are looked through for what its scene has no use for, and its code for how deep the
//! stack gets and whether an interrupt may panic.

use crate::boards::{AUTONOMOUS, FIRMWARE_TARGET, RP2040_SCENE};
use crate::budget::{BudgetRow, Ceiling, Options, hold_ceilings};
use crate::callgraph;
use crate::elf::{Footprint, check_boot, footprint, with_elf};
use crate::image::Image;
use crate::parallel;
use crate::repository::{SceneFile, scenes_named};
use crate::symbols;
use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;

/// One image's footprint, bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SizeRow {
    /// `core` or `firmware`.
    image: String,
    scene: String,
    scalar: String,
    target: String,
    pub(crate) flash: u64,
    /// Without the stack.
    pub(crate) ram: u64,
    /// Most that the stack takes; of the firmware alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) stack: Option<u64>,
}

impl BudgetRow for SizeRow {
    const KEY: &str = "image target scalar scene";
    const FIGURES: &str = "flash ram stack";
    const COLUMNS: &str = "image scene scalar target flash ram stack";
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let mut scenes = Vec::new();
    let mut files = options.scenes()?;
    if options.names_none() {
        files.extend(scenes_named(&AUTONOMOUS.map(String::from))?);
    }
    for file in files {
        // A scene that is refused is better refused here than from within a build script.
        let scene = Scene::read(&file.path)?;
        scenes.push((file, scene));
    }
    let cores = options.cores()?;
    let targets: Vec<_> = cores.iter().map(|core| core.target).collect();
    // The code of one image is walked through while the next ones are built.
    let rows = parallel::map(parallel::workers(), &scenes, |(file, scene)| {
        measure(&targets, file, scene, &options.scalars(scene))
    })?;
    let rows: Vec<SizeRow> = rows.into_iter().flatten().collect();
    options.print(&rows)?;
    hold_order(&rows)?;
    hold_ceilings(&rows, &CEILINGS)?;
    options.settle("size", rows)
}

fn measure(
    targets: &[&'static str],
    scene: &SceneFile,
    read: &Scene,
    scalars: &[&'static str],
) -> Result<Vec<SizeRow>> {
    let mut rows = Vec::new();
    let row = |image: &str, scalar: &str, target: &str, Footprint { flash, ram }| SizeRow {
        image: image.into(),
        scene: scene.name.clone(),
        scalar: scalar.into(),
        target: target.into(),
        flash,
        ram,
        stack: None,
    };
    // Without a host the tick is that of the same machine with one.
    let ticks = match read.service.autonomous {
        Some(_) => &[],
        None => scalars,
    };
    for &scalar in ticks {
        let image = Image::insns("bare", scene, scalar, FIRMWARE_TARGET);
        for (target, built) in targets.iter().zip(image.build_for(targets)?) {
            rows.push(row(
                "core",
                scalar,
                target,
                with_elf(&built, |elf| Ok(footprint(elf)))?,
            ));
        }
    }
    let own = of_scene(read.number);
    let mut boards = match read.service.autonomous {
        // What has no host is small: in the number type of the core.
        Some(_) => vec![Image::firmware(scene, "f32")],
        None => vec![Image::firmware(scene, own)],
    };
    let is_small = read.service.autonomous.is_some() && own == "fixed";
    if scene.path.ends_with(RP2040_SCENE) || is_small {
        boards.push(Image::rp2040(scene, own));
    }
    for image in boards {
        let (measured, stack) = measure_firmware(&image, read)?;
        rows.push(SizeRow {
            stack: Some(stack.into()),
            ..row("firmware", image.scalar, image.target, measured)
        });
    }
    Ok(rows)
}

/// Builds and checks a board's image: its footprint, and the most that its stack takes.
pub(crate) fn measure_firmware(image: &Image, scene: &Scene) -> Result<(Footprint, u32)> {
    let has_fpu = image.target == FIRMWARE_TARGET;
    with_elf(&image.build()?, |elf| {
        check_boot(elf, image.memory()).context("it cannot boot")?;
        symbols::check(elf, scene, has_fpu)?;
        Ok((footprint(elf), callgraph::check_elf(elf)?.most))
    })
}

/// Upper limits, bytes.
const CEILINGS: [Ceiling; 6] = [
    Ceiling::new("core thumbv6m-none-eabi * pick-stepper", "flash", 8192.0),
    // Of it, 5 KiB are the admission that is 29 times as fast: two ways to compute an operation, values in registers.
    // Another 3 KiB are the tick's, for speed, and 4.5 KiB rates of each part of a move, for holds without a reserve. The
    // states in which drives go on and off, and come to rest after a fault, take 2.7 KiB; several requests in flight, and the
    // account of what a job met, 1.9 KiB. Limits of the motors, fields of a sample and the name of a job take 1.5 KiB.
    // Answers about updates, scenes over the line and spare outputs take 0.6 KiB, the watchdog's measure of the ticks and the
    // place where a job's tool went off 0.2 KiB, a status that is true while orders are on their way 0.1 KiB.
    Ceiling::new("firmware thumbv7em-none-eabihf * thesis", "flash", 65_344.0),
    // Of it, 53 KiB are for the 256 moves that wait.
    Ceiling::new("firmware thumbv7em-none-eabihf * thesis", "ram", 67_584.0),
    // Without a host: the tick, its states, and one job.
    Ceiling::new(
        "firmware thumbv7em-none-eabihf f32 thesis-alone",
        "flash",
        12_000.0,
    ),
    Ceiling::new(
        "firmware thumbv7em-none-eabihf f32 thesis-alone",
        "ram",
        800.0,
    ),
    // With steppers, homing, gripper, emergency stop and lamp.
    Ceiling::new(
        "firmware thumbv7em-none-eabihf f32 pick-alone",
        "flash",
        22_000.0,
    ),
];

/// The thesis machine and the same with link masses: what pays for links, and what must not.
const WITHOUT_LINKS: &str = "thesis";
const WITH_LINKS: &str = "thesis-links";

/// A scene pays only for what it uses: without link masses an image is smaller in both memories
/// than with them.
fn hold_order(rows: &[SizeRow]) -> Result<()> {
    for massless in rows.iter().filter(|row| row.scene == WITHOUT_LINKS) {
        let same = |row: &&SizeRow| {
            row.scene == WITH_LINKS
                && (&row.image, &row.scalar, &row.target)
                    == (&massless.image, &massless.scalar, &massless.target)
        };
        let Some(massive) = rows.iter().find(same) else {
            continue;
        };
        ensure!(
            massless.flash < massive.flash && massless.ram < massive.ram,
            "{}: {} flash, {} RAM, with links {} and {}: link code or data is in an image that \
             does not use it",
            massless.key(),
            massless.flash,
            massless.ram,
            massive.flash,
            massive.ram
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ceiling_is_of_something_that_is_measured() {
        crate::budget::expect_measured::<SizeRow>("size", &CEILINGS);
    }

    fn row(scene: &str, flash: u64, ram: u64) -> SizeRow {
        SizeRow {
            image: "core".into(),
            scene: scene.into(),
            scalar: "f32".into(),
            target: "thumbv6m-none-eabi".into(),
            flash,
            ram,
            stack: None,
        }
    }

    fn firmware(scene: &str, flash: u64, ram: u64, stack: u64) -> SizeRow {
        SizeRow {
            image: "firmware".into(),
            target: FIRMWARE_TARGET.into(),
            stack: Some(stack),
            ..row(scene, flash, ram)
        }
    }

    #[test]
    fn a_massless_image_must_be_smaller_in_both_memories() {
        let links = row(WITH_LINKS, 2000, 400);
        assert!(hold_order(&[row(WITHOUT_LINKS, 1500, 300), links.clone()]).is_ok());
        assert!(hold_order(&[row(WITHOUT_LINKS, 2000, 300), links.clone()]).is_err());
        assert!(hold_order(&[row(WITHOUT_LINKS, 1500, 400), links]).is_err());
    }

    #[test]
    fn no_figure_is_above_its_ceiling() {
        let hold = |row| hold_ceilings(&[row], &CEILINGS);
        assert!(hold(row("pick-stepper", 8192, 0)).is_ok());
        let error = hold(row("pick-stepper", 8193, 0)).expect_err("above it");
        assert_eq!(
            error.to_string(),
            "core thumbv6m-none-eabi f32 pick-stepper: flash is 8193, the ceiling is 8192"
        );
        assert!(hold(row("thesis", 8193, 8193)).is_ok());
        assert!(hold(firmware("thesis", 0, 67_584, 0)).is_ok());
        assert!(hold(firmware("vertical", 0, 67_585, 0)).is_ok());
        let error = hold(firmware("thesis", 0, 67_585, 0)).expect_err("above it");
        assert!(error.to_string().contains("ram is 67585"), "{error}");
    }

    #[test]
    fn json_is_an_array_of_flat_objects_with_the_contract_s_keys() {
        let rows = [firmware("thesis", 1, 2, 3), row("thesis", 1, 2)];
        let json = serde_json::to_value(rows).expect("plain data");
        let object = json[0].as_object().expect("an object");
        assert!(json[1].get("stack").is_none());
        for key in ["scene", "scalar", "target", "flash", "ram", "stack"] {
            assert!(object.contains_key(key), "{key}");
        }
        assert!(
            object
                .values()
                .all(|value| !value.is_object() && !value.is_array())
        );
    }
}
