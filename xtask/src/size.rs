//! `cargo xtask size`: flash and RAM, of the tick alone on every target and of the firmware, for the RP2040 too.
//!
//! The tick alone (image `core`) is its code and constants in flash and, in RAM, its coefficients,
//! one setpoint and one outcome. That image does not link if a panic is left in the tick. The symbols
//! of the firmware are looked through for what its scene has no use for, and its code for how deep the
//! stack gets and whether an interrupt may panic.

use crate::boards::{FIRMWARE_MEMORY, FIRMWARE_TARGET, RP2040_TARGET};
use crate::budget::{BudgetRow, Options};
use crate::callgraph;
use crate::cores::CORES;
use crate::elf::{Footprint, check_boot, footprint};
use crate::image::{Image, scalars};
use crate::parallel;
use crate::repository::SceneFile;
use crate::rp2040;
use crate::symbols;
use crate::table::table;
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
    flash: u64,
    /// Without the stack.
    ram: u64,
    /// Most that the stack takes; of the firmware alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stack: Option<u64>,
}

impl SizeRow {
    /// Returns true if the row is that of this image.
    pub(crate) fn is(&self, image: &str, scene: &str, scalar: &str, target: &str) -> bool {
        (self.image.as_str(), self.scene.as_str()) == (image, scene)
            && (self.scalar.as_str(), self.target.as_str()) == (scalar, target)
    }

    pub(crate) fn flash(&self) -> u64 {
        self.flash
    }

    pub(crate) fn ram(&self) -> u64 {
        self.ram
    }

    pub(crate) fn stack(&self) -> Option<u64> {
        self.stack
    }
}

impl BudgetRow for SizeRow {
    fn key(&self) -> String {
        format!(
            "{} {} {} {}",
            self.image, self.target, self.scalar, self.scene
        )
    }

    fn figures(&self) -> Vec<(&'static str, f64)> {
        let stack = self.stack.map(|stack| ("stack", stack as f64));
        [("flash", self.flash as f64), ("ram", self.ram as f64)]
            .into_iter()
            .chain(stack)
            .collect()
    }
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let mut scenes = Vec::new();
    for file in options.scenes()? {
        // A scene that is refused is better refused here than from within a build script.
        let scene = Scene::read(&file.path)?;
        scenes.push((file, scene));
    }
    // The code of one image is walked through while the next ones are built.
    let rows = parallel::map(parallel::workers(), &scenes, |(file, scene)| {
        measure(file, scene)
    })?;
    let rows: Vec<SizeRow> = rows.into_iter().flatten().collect();
    options.print(&rows, text)?;
    hold_order(&rows)?;
    hold_ceilings(&rows)?;
    options.settle("size", rows, true)
}

fn measure(scene: &SceneFile, read: &Scene) -> Result<Vec<SizeRow>> {
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
    for scalar in scalars(read) {
        let targets: Vec<_> = CORES.iter().map(|core| core.target).collect();
        let image = Image {
            package: "trirrr-insns",
            binary: "bare",
            scene,
            scalar,
            target: FIRMWARE_TARGET,
        };
        for (target, built) in targets.iter().zip(image.build_for(&targets)?) {
            rows.push(row("core", scalar, target, footprint(&built)?));
        }
    }
    let firmware = Image::firmware(scene, of_scene(read.number));
    let file = firmware.build()?;
    check_boot(&file, FIRMWARE_MEMORY)?;
    symbols::check(&file, read)?;
    symbols::check_arithmetic(&file, true)?;
    let stack = callgraph::check(&file)?;
    let measured = footprint(&file)?;
    rows.push(SizeRow {
        stack: Some(stack.most.into()),
        ..row("firmware", firmware.scalar, FIRMWARE_TARGET, measured)
    });
    if rp2040::is_for(scene) {
        let (measured, stack) = rp2040::measure(scene)?;
        rows.push(SizeRow {
            stack: Some(stack.into()),
            ..row("firmware", firmware.scalar, RP2040_TARGET, measured)
        });
    }
    Ok(rows)
}

fn text(rows: &[SizeRow]) -> String {
    let cells = rows.iter().map(|row| {
        vec![
            row.image.clone(),
            row.scene.clone(),
            row.scalar.clone(),
            row.target.clone(),
            row.flash.to_string(),
            row.ram.to_string(),
            row.stack.map_or(String::new(), |stack| stack.to_string()),
        ]
    });
    let headings = [
        "image", "scene", "scalar", "target", "flash", "ram", "stack",
    ];
    table(&headings, &cells.collect::<Vec<_>>())
}

/// Upper limits of figures: image, target, scene, figure, bytes.
const CEILINGS: [(&str, &str, &str, &str, u64); 3] = [
    (
        "core",
        "thumbv6m-none-eabi",
        "pick-stepper",
        "flash",
        8 * 1024,
    ),
    ("firmware", FIRMWARE_TARGET, "thesis", "flash", 40 * 1024),
    ("firmware", FIRMWARE_TARGET, "thesis", "ram", 8 * 1024),
];

fn hold_ceilings(rows: &[SizeRow]) -> Result<()> {
    for (image, target, scene, figure, ceiling) in CEILINGS {
        let of = |row: &&SizeRow| row.image == image && row.target == target && row.scene == scene;
        for row in rows.iter().filter(of) {
            let mut figures = row.figures().into_iter();
            let (_, bytes) = figures
                .find(|(name, _)| *name == figure)
                .with_context(|| format!("{}: no {figure}", row.key()))?;
            ensure!(
                bytes <= ceiling as f64,
                "{}: {bytes} bytes of {figure}, the ceiling is {ceiling}",
                row.key()
            );
        }
    }
    Ok(())
}

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
        assert!(hold_ceilings(&[row("pick-stepper", 8192, 0)]).is_ok());
        let error = hold_ceilings(&[row("pick-stepper", 8193, 0)]).expect_err("above it");
        assert_eq!(
            error.to_string(),
            "core thumbv6m-none-eabi f32 pick-stepper: 8193 bytes of flash, the ceiling is 8192"
        );
        assert!(hold_ceilings(&[row("thesis", 8193, 8193)]).is_ok());
        assert!(hold_ceilings(&[firmware("thesis", 0, 8192, 0)]).is_ok());
        assert!(hold_ceilings(&[firmware("vertical", 0, 8193, 0)]).is_ok());
        let error = hold_ceilings(&[firmware("thesis", 0, 8193, 0)]).expect_err("above it");
        assert!(error.to_string().contains("8193 bytes of ram"), "{error}");
    }

    #[test]
    fn every_ceiling_is_of_something_that_is_measured() {
        for (image, target, scene, figure, _) in CEILINGS {
            let found = crate::repository::scenes_named(&[scene.to_owned()]);
            assert_eq!(found.expect("a shipped scene").len(), 1);
            let is_core = CORES.iter().any(|core| core.target == target);
            assert!(is_core && image == "core" || (image, target) == ("firmware", FIRMWARE_TARGET));
            let figures = firmware(scene, 1, 1, 1).figures();
            assert!(figures.iter().any(|(name, _)| *name == figure));
        }
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
