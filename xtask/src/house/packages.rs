//! Packages of the workspace: their examples, and the direction of their dependencies.

use crate::packages::Package;
use crate::repository::root;
use anyhow::{Context, Result};
use std::path::Path;

/// Rooms from the ground up. A package depends on its own floor and those below.
const FLOORS: [&[&str]; 4] = [
    &["core"],
    &["crates"],
    &["clients", "host-sim", "firmware", "lab", "web"],
    &["tests", "xtask"],
];

/// Figures of the packages.
pub(super) struct Packages {
    pub(super) count: usize,
    /// Dependencies between packages of the workspace, those of tests left out.
    pub(super) dependencies: usize,
    /// `PACKAGE: EXAMPLE` of each program.
    pub(super) examples: Vec<String>,
    /// `PACKAGE -> PACKAGE` of each dependency on a floor above.
    pub(super) upward: Vec<String>,
}

pub(super) fn measure() -> Result<Packages> {
    count(root(), &Package::all()?)
}

fn count(root: &Path, packages: &[Package]) -> Result<Packages> {
    let mut found = Packages {
        count: packages.len(),
        dependencies: 0,
        examples: Vec::new(),
        upward: Vec::new(),
    };
    for package in packages {
        let examples = package.examples();
        let named = examples.map(|example| format!("{}: {example}", package.name));
        found.examples.extend(named);
        let own = floor(root, Path::new(&package.manifest_path))?;
        // Tests and examples may use rooms above: no user of the package compiles them.
        let dependencies = package.dependencies.iter();
        for dependency in dependencies.filter(|one| one.kind.as_deref() != Some("dev")) {
            let Some(path) = &dependency.path else {
                continue;
            };
            found.dependencies += 1;
            if floor(root, Path::new(path))? > own {
                let arrow = format!("{} -> {}", package.name, dependency.name);
                found.upward.push(arrow);
            }
        }
    }
    Ok(found)
}

/// The floor of the package at `path`.
fn floor(root: &Path, path: &Path) -> Result<usize> {
    let inside = path.strip_prefix(root).ok();
    let room = inside.and_then(|inside| inside.iter().next()?.to_str());
    room.and_then(|room| FLOORS.iter().position(|rooms| rooms.contains(&room)))
        .with_context(|| format!("{}: no room of the workspace", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dependency_upwards_is_found_and_a_test_s_is_not() {
        let text = r#"[
            { "name": "low", "manifest_path": "/w/core/Cargo.toml", "targets": [
                { "name": "tick", "kind": ["example"] }, { "name": "low", "kind": ["lib"] } ],
              "dependencies": [
                { "name": "high", "path": "/w/crates/high", "kind": null },
                { "name": "high", "path": "/w/crates/high", "kind": "dev" },
                { "name": "serde", "path": null, "kind": null } ] },
            { "name": "high", "manifest_path": "/w/crates/high/Cargo.toml", "targets": [],
              "dependencies": [ { "name": "low", "path": "/w/core", "kind": null } ] } ]"#;
        let packages: Vec<Package> = serde_json::from_str(text).expect("as cargo writes it");
        let found = count(Path::new("/w"), &packages).expect("rooms");
        assert_eq!(found.upward, ["low -> high"]);
        assert_eq!(found.examples, ["low: tick"]);
        assert_eq!((found.count, found.dependencies), (2, 2));
    }

    #[test]
    fn a_package_outside_the_rooms_is_an_error() {
        assert!(floor(Path::new("/w"), Path::new("/w/cellar/Cargo.toml")).is_err());
    }
}
