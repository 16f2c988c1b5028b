//! Packages of the workspace: the direction of their dependencies.

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

/// `PACKAGE -> PACKAGE` of each dependency on a floor above, those of tests left out.
pub(super) fn upward() -> Result<Vec<String>> {
    upward_of(root(), &Package::all()?)
}

fn upward_of(root: &Path, packages: &[Package]) -> Result<Vec<String>> {
    let mut upward = Vec::new();
    for package in packages {
        let own = floor(root, Path::new(&package.manifest_path))?;
        // Tests and examples may use rooms above: no user of the package compiles them.
        let dependencies = package.dependencies.iter();
        for dependency in dependencies.filter(|one| one.kind.as_deref() != Some("dev")) {
            if let Some(path) = &dependency.path
                && floor(root, Path::new(path))? > own
            {
                upward.push(format!("{} -> {}", package.name, dependency.name));
            }
        }
    }
    Ok(upward)
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
            { "name": "low", "manifest_path": "/w/core/Cargo.toml", "targets": [], "dependencies": [
                { "name": "high", "path": "/w/crates/high", "kind": null },
                { "name": "high", "path": "/w/crates/high", "kind": "dev" },
                { "name": "serde", "path": null, "kind": null } ] },
            { "name": "high", "manifest_path": "/w/crates/high/Cargo.toml", "targets": [],
              "dependencies": [ { "name": "low", "path": "/w/core", "kind": null } ] } ]"#;
        let packages: Vec<Package> = serde_json::from_str(text).expect("as cargo writes it");
        let upward = upward_of(Path::new("/w"), &packages).expect("rooms");
        assert_eq!(upward, ["low -> high"]);
    }

    #[test]
    fn a_package_outside_the_rooms_is_an_error() {
        assert!(floor(Path::new("/w"), Path::new("/w/cellar/Cargo.toml")).is_err());
    }
}
