//! `cargo xtask size`: flash and RAM, of the tick alone on every target and of the firmware.
//!
//! The tick alone (image `core`) is its code and constants in flash and, in RAM, its coefficients,
//! one setpoint and one outcome. That image does not link if a panic is left in the tick. The symbols
//! of the firmware are looked through for what its scene has no use for.

use crate::budget::{Measured, Options};
use crate::cores::CORES;
use crate::elf::{Footprint, Memory, check_boot, footprint};
use crate::image::{Image, scalars};
use crate::repository::SceneFile;
use crate::symbols;
use crate::table::table;
use anyhow::{Result, bail, ensure};
use serde::{Deserialize, Serialize};
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;

/// The target of the firmware.
pub(crate) const FIRMWARE_TARGET: &str = "thumbv7em-none-eabihf";

/// The STM32F405, as in the `memory.x` of the root.
pub(crate) const FIRMWARE_MEMORY: Memory = Memory {
    vectors: 0x0800_0000,
    flash: (0x0800_0000, 1024 * 1024),
    ram: (0x2000_0000, 128 * 1024),
};

/// One image's footprint, bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// `core` or `firmware`.
    image: String,
    scene: String,
    scalar: String,
    target: String,
    flash: u64,
    ram: u64,
}

impl Row {
    /// Whether it is that of this image.
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
}

impl Measured for Row {
    fn key(&self) -> String {
        format!(
            "{} {} {} {}",
            self.image, self.target, self.scalar, self.scene
        )
    }

    fn figures(&self) -> Vec<(&'static str, f64)> {
        vec![("flash", self.flash as f64), ("ram", self.ram as f64)]
    }
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let mut rows = Vec::new();
    for scene in &options.scenes()? {
        // A scene that is refused is better refused here than from within a build script.
        rows.extend(measure(scene, &Scene::read(&scene.path)?)?);
    }
    options.print(&rows, text)?;
    hold_order(&rows)?;
    hold_ceilings(&rows)?;
    options.settle("size", rows, true)
}

fn measure(scene: &SceneFile, read: &Scene) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    let mut add = |image: &str, scalar: &str, target: &str, Footprint { flash, ram }| {
        rows.push(Row {
            image: image.into(),
            scene: scene.name.clone(),
            scalar: scalar.into(),
            target: target.into(),
            flash,
            ram,
        });
    };
    for scalar in scalars(read) {
        for core in CORES {
            let image = Image {
                package: "trirrr-insns",
                binary: "bare",
                scene,
                scalar,
                target: core.target,
            };
            add("core", scalar, core.target, footprint(&image.build()?)?);
        }
    }
    let firmware = Image::firmware(scene, of_scene(read.number));
    let file = firmware.build()?;
    check_boot(&file, FIRMWARE_MEMORY)?;
    symbols::check(&file, read)?;
    add(
        "firmware",
        firmware.scalar,
        FIRMWARE_TARGET,
        footprint(&file)?,
    );
    Ok(rows)
}

fn text(rows: &[Row]) -> String {
    let cells = rows.iter().map(|row| {
        vec![
            row.image.clone(),
            row.scene.clone(),
            row.scalar.clone(),
            row.target.clone(),
            row.flash.to_string(),
            row.ram.to_string(),
        ]
    });
    let headings = ["image", "scene", "scalar", "target", "flash", "ram"];
    table(&headings, &cells.collect::<Vec<_>>())
}

/// Most flash of the tick alone: image, target, scene, bytes.
const CEILINGS: &[(&str, &str, &str, u64)] =
    &[("core", "thumbv6m-none-eabi", "pick-stepper", 8 * 1024)];

fn hold_ceilings(rows: &[Row]) -> Result<()> {
    for (image, target, scene, ceiling) in CEILINGS {
        let mut of = rows
            .iter()
            .filter(|row| row.image == *image && row.target == *target && row.scene == *scene);
        if let Some(row) = of.find(|row| row.flash > *ceiling) {
            bail!(
                "{}: {} bytes of flash, the ceiling is {ceiling}",
                row.key(),
                row.flash
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
fn hold_order(rows: &[Row]) -> Result<()> {
    for massless in rows.iter().filter(|row| row.scene == WITHOUT_LINKS) {
        let same = |row: &&Row| {
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

    fn row(scene: &str, flash: u64, ram: u64) -> Row {
        Row {
            image: "core".into(),
            scene: scene.into(),
            scalar: "f32".into(),
            target: "thumbv6m-none-eabi".into(),
            flash,
            ram,
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
    fn the_tick_without_torques_has_a_ceiling() {
        assert!(hold_ceilings(&[row("pick-stepper", 8192, 0)]).is_ok());
        let error = hold_ceilings(&[row("pick-stepper", 8193, 0)]).expect_err("above it");
        assert!(error.to_string().contains("the ceiling is 8192"), "{error}");
        assert!(hold_ceilings(&[row("thesis", 8193, 0)]).is_ok());
    }

    #[test]
    fn json_is_an_array_of_flat_objects_with_the_contract_s_keys() {
        let json = serde_json::to_value([row("thesis", 1, 2)]).expect("plain data");
        let object = json[0].as_object().expect("an object");
        for key in ["scene", "scalar", "target", "flash", "ram"] {
            assert!(object.contains_key(key), "{key}");
        }
        assert!(
            object
                .values()
                .all(|value| !value.is_object() && !value.is_array())
        );
    }
}
