//! `cargo xtask size`: flash and RAM, of the tick alone on every target and of the firmware.
//!
//! The tick alone (image `core`) is its code and constants in flash and, in RAM, its coefficients,
//! one setpoint and one outcome. That image does not link if a panic is left in the tick.

use crate::budget::{Measured, Options};
use crate::cores::CORES;
use crate::elf::{Footprint, Memory, check_boot, footprint};
use crate::image::Image;
use crate::repository::SceneFile;
use crate::table::table;
use anyhow::{Result, ensure};
use serde::{Deserialize, Serialize};
use trirrr_image::generate::SCALARS;
use trirrr_scene::Scene;

/// The target of the firmware.
pub(crate) const FIRMWARE_TARGET: &str = "thumbv7em-none-eabihf";

/// The STM32F405, as in `memory.x`.
pub(crate) const FIRMWARE_MEMORY: Memory = Memory {
    flash: (0x0800_0000, 1024 * 1024),
    ram: (0x2000_0000, 128 * 1024),
};

/// One image's footprint, bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Row {
    /// `core` or `firmware`.
    image: String,
    scene: String,
    scalar: String,
    target: String,
    flash: u64,
    ram: u64,
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
        Scene::read(&scene.path)?;
        rows.extend(measure(scene)?);
    }
    options.print(&rows, text)?;
    hold_order(&rows)?;
    options.settle("size", rows, true)
}

fn measure(scene: &SceneFile) -> Result<Vec<Row>> {
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
    for (scalar, _) in SCALARS {
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
        let firmware = Image {
            package: "trirrr-firmware",
            binary: "trirrr-firmware",
            scene,
            scalar,
            target: FIRMWARE_TARGET,
        };
        let file = firmware.build()?;
        check_boot(&file, FIRMWARE_MEMORY)?;
        add("firmware", scalar, FIRMWARE_TARGET, footprint(&file)?);
    }
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
