//! Packages of the workspace by where they are built, and which of them are published.

use crate::boards::{FIRMWARE_MEMORY, FIRMWARE_TARGET, G474_MEMORY, RP2040_MEMORY, RP2040_TARGET};
use crate::elf::Memory;
use crate::repository::{cargo, text};
use anyhow::Result;
use serde::Deserialize;
use std::process::Command;

/// Package for a microcontroller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DevicePackage {
    pub(crate) name: &'static str,
    /// Feature that names the chip, of a package for several.
    pub(crate) chip: Option<&'static str>,
    /// Rust target.
    pub(crate) target: &'static str,
}

impl DevicePackage {
    pub(crate) const fn of(name: &'static str, target: &'static str) -> Self {
        let chip = None;
        Self { name, chip, target }
    }

    const fn stm32(chip: &'static str) -> Self {
        Self {
            name: "trirrr-stm32",
            chip: Some(chip),
            target: FIRMWARE_TARGET,
        }
    }

    /// Name for messages.
    pub(crate) fn title(&self) -> String {
        match self.chip {
            Some(chip) => format!("{} for {chip}", self.name),
            None => self.name.to_owned(),
        }
    }

    /// Adds to `cargo` the choice of the package for its chip and target.
    pub(crate) fn choose(&self, cargo: &mut Command) {
        cargo.args(["-p", self.name, "--target", self.target]);
        cargo.args(self.features());
    }

    /// Cargo's arguments that name the chip.
    pub(crate) fn features(&self) -> impl Iterator<Item = &'static str> {
        self.chip.into_iter().flat_map(|chip| ["--features", chip])
    }

    /// Memory of the board.
    pub(crate) fn memory(&self) -> Memory {
        match *self {
            RP2040 => RP2040_MEMORY,
            STM32G474 => G474_MEMORY,
            _ => FIRMWARE_MEMORY,
        }
    }
}

/// Firmware of the boards.
pub(crate) const STM32F405: DevicePackage = DevicePackage::stm32("stm32f405");
pub(crate) const STM32G474: DevicePackage = DevicePackage::stm32("stm32g474");
pub(crate) const RP2040: DevicePackage = DevicePackage::of("trirrr-rp2040", RP2040_TARGET);

/// The packages that are built for microcontrollers only; a host has nothing to check in them.
pub(crate) const DEVICE_PACKAGES: [DevicePackage; 6] = [
    DevicePackage::of("trirrr-app", FIRMWARE_TARGET),
    DevicePackage::of("trirrr-boards", FIRMWARE_TARGET),
    STM32F405,
    STM32G474,
    RP2040,
    DevicePackage::of("trirrr-insns", FIRMWARE_TARGET),
];

/// Packages whose dependencies take long to compile: `cargo xtask nightly` checks them.
pub(crate) const NIGHTLY_PACKAGES: [&str; 5] = [
    "trirrr-foxglove",
    "trirrr-images",
    "trirrr-oracle",
    "trirrr-tick-time",
    "trirrr-web-bindgen",
];

/// Libraries that are built without `std`.
pub(crate) const BARE_PACKAGES: [&str; 4] = [
    "trirrr-core",
    "trirrr-protocol",
    "trirrr-service",
    "trirrr-drives",
];

/// Adds to `cargo` the choice of every package that is for a host. All at once, so that their common
/// dependencies are compiled once: packages that are chosen one by one ask for different features of them. With all commands, which the
/// tests ask for: else programs and docs would have all libraries compiled again.
pub(crate) fn choose_host(cargo: &mut Command) {
    cargo.args(["--workspace", "--features", "full"]);
    let device = DEVICE_PACKAGES.map(|package| package.name);
    for package in device.iter().chain(&NIGHTLY_PACKAGES) {
        cargo.args(["--exclude", package]);
    }
}

/// A package of the workspace, as `cargo metadata` describes it.
#[derive(Debug, Deserialize)]
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) manifest_path: String,
    pub(crate) dependencies: Vec<Dependency>,
    pub(crate) targets: Vec<Target>,
    /// Registries that it may go to; none where it is internal, any where nothing is said.
    publish: Option<Vec<String>>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Dependency {
    pub(crate) name: String,
    /// The directory of a package of the workspace.
    pub(crate) path: Option<String>,
    /// None of a usual dependency, else `dev` or `build`.
    pub(crate) kind: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Target {
    pub(crate) name: String,
    pub(crate) kind: Vec<String>,
}

impl Package {
    /// The packages of the workspace.
    pub(crate) fn all() -> Result<Vec<Self>> {
        #[derive(Deserialize)]
        struct Metadata {
            packages: Vec<Package>,
        }
        let metadata = ["metadata", "--no-deps", "--format-version", "1"];
        let metadata: Metadata = serde_json::from_str(&text(cargo().args(metadata))?)?;
        Ok(metadata.packages)
    }

    /// Tells a package that others can depend on from an internal one.
    pub(crate) fn is_published(&self) -> bool {
        self.publish.as_ref().is_none_or(|to| !to.is_empty())
    }

    /// Names of its example programs.
    pub(crate) fn examples(&self) -> impl Iterator<Item = &str> {
        let is_example = |target: &&Target| target.kind.iter().any(|kind| kind == "example");
        let examples = self.targets.iter().filter(is_example);
        examples.map(|target| target.name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_package_is_one_of_the_workspace() {
        let packages = Package::all().expect("cargo metadata");
        let device = DEVICE_PACKAGES.map(|package| package.name);
        let named = device.iter().chain(&NIGHTLY_PACKAGES);
        for name in named.chain(&BARE_PACKAGES) {
            assert!(packages.iter().any(|one| one.name == *name), "{name}");
        }
    }

    /// It builds the chores with the features of the tests, and of no other packages.
    #[test]
    fn ci_leaves_out_the_same_packages() {
        let script = include_str!("../../.ci/run").split_whitespace();
        let words: Vec<&str> = script.collect();
        let named = words.windows(2).filter(|pair| pair[0] == "--exclude");
        let mut named: Vec<&str> = named.map(|pair| pair[1]).collect();
        let device = DEVICE_PACKAGES.iter().map(|package| package.name);
        let mut left_out: Vec<&str> = device.chain(NIGHTLY_PACKAGES).collect();
        named.sort_unstable();
        left_out.sort_unstable();
        // The firmware of the STM32s is there for each chip.
        left_out.dedup();
        assert_eq!(named, left_out);
    }

    #[test]
    fn libraries_are_published_and_chores_are_not() {
        let packages = Package::all().expect("cargo metadata");
        let published = |name| {
            let found = packages.iter().find(|one| one.name == name);
            found.expect("a package").is_published()
        };
        assert!(published("trirrr-core") && published("trirrr-service"));
        assert!(!published("xtask") && !published("trirrr-tests"));
    }
}
