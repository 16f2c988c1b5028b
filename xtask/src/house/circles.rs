//! Circles of files: each names something of the next, and the last something of the first.

use super::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::UseTree;
use syn::visit::{self, Visit};

/// Path of a file's module in its crate, or of anything as it is written.
type Names = Vec<String>;

/// Most files that pass a name on.
const PASSES: u8 = 8;

/// Paths that a file names.
#[derive(Default)]
struct Paths {
    imported: Vec<Names>,
    in_code: Vec<Names>,
}

/// Circles of three files and more, each within a crate. A file and those below it are no circle: a parent lists its children.
pub(super) fn find(sources: &[Source]) -> Vec<String> {
    let mut crates: BTreeMap<PathBuf, BTreeMap<Names, Paths>> = BTreeMap::new();
    for source in sources {
        if let Some((root, name)) = module(&source.path) {
            let files = crates.entry(root).or_default();
            let paths = files.entry(name).or_default();
            paths.visit_file(&source.syntax);
        }
    }
    let mut found = Vec::new();
    for (root, files) in &crates {
        for circle in circles(files) {
            let names: Names = circle.iter().map(|name| name.join("::")).collect();
            found.push(format!("{}: {}", root.display(), names.join(" ")));
        }
    }
    found
}

/// Directory of the crate's sources, and the module of the file; `None` outside of a `src`.
fn module(file: &Path) -> Option<(PathBuf, Names)> {
    let root = file.ancestors().find(|above| above.ends_with("src"))?;
    let inside = file.strip_prefix(root).ok()?.with_extension("");
    let parts = inside.iter().map(|part| part.display().to_string());
    let is_own = |part: &String| !["lib", "main", "mod"].contains(&part.as_str());
    Some((root.to_owned(), parts.filter(is_own).collect()))
}

impl Paths {
    fn import(&mut self, tree: &UseTree, before: &[String]) {
        let below = |name: &syn::Ident| [before, &[name.to_string()]].concat();
        match tree {
            UseTree::Path(path) => self.import(&path.tree, &below(&path.ident)),
            UseTree::Group(group) => group
                .items
                .iter()
                .for_each(|item| self.import(item, before)),
            UseTree::Name(name) if name.ident != "self" => self.imported.push(below(&name.ident)),
            UseTree::Rename(name) => self.imported.push(below(&name.ident)),
            UseTree::Name(_) | UseTree::Glob(_) => self.imported.push(before.to_vec()),
        }
    }
}

impl<'ast> Visit<'ast> for Paths {
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.import(&item.tree, &[]);
    }

    /// A module within a file names things from another place than the file.
    fn visit_item_mod(&mut self, _: &'ast syn::ItemMod) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names = path.segments.iter().map(|one| one.ident.to_string());
        self.in_code.push(names.collect());
        visit::visit_path(self, path);
    }
}

/// The file in which the thing is defined that the file `from` calls `path`; `None` where it is in another crate.
fn definition(
    files: &BTreeMap<Names, Paths>,
    from: &[String],
    path: &[String],
    depth: u8,
) -> Option<Names> {
    let above = path.iter().take_while(|name| *name == "super").count();
    let (mut at, rest) = match path.first()?.as_str() {
        "crate" => (Names::new(), &path[1..]),
        "self" => (from.to_vec(), &path[1..]),
        "super" => (
            from[..from.len().checked_sub(above)?].to_vec(),
            &path[above..],
        ),
        _ if files.contains_key(&[from, &path[..1]].concat()) => (from.to_vec(), path),
        _ => return None,
    };
    for (index, name) in rest.iter().enumerate() {
        let below = [&at[..], &rest[index..=index]].concat();
        if files.contains_key(&below) {
            at = below;
            continue;
        }
        let imported = files.get(&at).map_or(&[][..], |paths| &paths.imported);
        let passed_on = imported
            .iter()
            .find(|path| path.last() == Some(name) && *path != rest);
        let defined = passed_on.and_then(|path| {
            definition(
                files,
                &at,
                &[path, &rest[index + 1..]].concat(),
                depth.checked_sub(1)?,
            )
        });
        return Some(defined.unwrap_or(at));
    }
    Some(at)
}

fn circles(files: &BTreeMap<Names, Paths>) -> BTreeSet<Vec<&Names>> {
    let mut uses: BTreeMap<&Names, BTreeSet<&Names>> = BTreeMap::new();
    for (name, paths) in files {
        let named = paths.imported.iter().chain(&paths.in_code);
        let named = named.filter_map(|path| definition(files, name, path, PASSES));
        let named = named.filter_map(|file| files.get_key_value(&file));
        let named = named.map(|(file, _)| file);
        let others = named.filter(|file| !file.starts_with(name) && !name.starts_with(file));
        uses.insert(name, others.collect());
    }
    let reached: BTreeMap<&Names, _> = files
        .keys()
        .map(|name| (name, reached(&uses, name)))
        .collect();
    let circle = |name: &Names| {
        let others = reached[name].iter().copied();
        others
            .filter(|other| reached[other].contains(name))
            .collect()
    };
    let all = files.keys().map(circle);
    all.filter(|circle: &Vec<_>| circle.len() >= 3).collect()
}

/// Files that lead on from `from`, over others.
fn reached<'a>(
    uses: &BTreeMap<&'a Names, BTreeSet<&'a Names>>,
    from: &'a Names,
) -> BTreeSet<&'a Names> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(next) = open.pop() {
        open.extend(uses[next].iter().filter(|file| found.insert(**file)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_is_found_through_what_a_parent_passes_on() {
        let files = [
            ("a/src/lib.rs", "mod b; mod c; mod d; pub use b::B;"),
            ("a/src/b.rs", "use crate::c::C; pub struct B;"),
            ("a/src/c/mod.rs", "mod e; pub use e::C; fn c() { e::e() }"),
            ("a/src/c/e.rs", "pub struct C(super::super::d::D);"),
            (
                "a/src/d.rs",
                "mod inside { use super::D; } pub struct D(crate::B);",
            ),
        ];
        let sources = files.map(|(path, text)| Source {
            path: path.into(),
            text: text.into(),
            syntax: syn::parse_file(text).expect("Rust"),
        });
        assert_eq!(find(&sources), ["a/src: b c::e d"]);
        assert!(find(&sources[..4]).is_empty());
    }
}
