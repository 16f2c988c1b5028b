//! Linkage files: the shipped mechanisms, refusals, ends of motion, and files with random edits.

mod arm;
mod docs;
mod ends;
mod mutation;
mod refusals;
mod shipped;
mod slots;
mod structures;
mod study;
mod tetrad;

use std::path::{Path, PathBuf};
use trirrr_linkage::assur::{Linkage, PointRef};

/// The folder of the shipped files.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../linkages")
}

fn shipped_text(name: &str) -> String {
    let file = folder().join(name).with_extension("toml");
    std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

fn shipped(name: &str) -> Linkage {
    parse(&shipped_text(name))
}

fn parse(text: &str) -> Linkage {
    Linkage::parse(text, "a.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// The link of a name.
fn link(linkage: &Linkage, name: &str) -> usize {
    let found = linkage.links.iter().position(|link| link.name == name);
    found.unwrap_or_else(|| panic!("no link {name}"))
}

/// The joint of a name.
fn joint(linkage: &Linkage, name: &str) -> usize {
    let found = linkage.joints.iter().position(|joint| joint.name == name);
    found.unwrap_or_else(|| panic!("no joint {name}"))
}

/// A point of a link by their names.
fn point(linkage: &Linkage, of: &str, name: &str) -> PointRef {
    let link = link(linkage, of);
    let points = &linkage.links[link].points;
    let point = points.iter().position(|(point, _)| point == name);
    PointRef {
        link,
        point: point.unwrap_or_else(|| panic!("no point {name}")),
    }
}

/// A table `[[joint]]` of a pin through the points `at`.
fn pin(name: &str, at: [&str; 2]) -> String {
    format!("[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nat = {at:?}\n")
}

/// A table `[[joint]]` of a `slider` on a `guide`, with `more` keys.
fn slide(name: &str, guide: &str, slider: &str, more: &str) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\nkind = \"prismatic\"\nguide = \"{guide}\"\n\
         slider = \"{slider}\"\n{more}"
    )
}
