//! The repository's Rust files, and which of them are tests.

use crate::repository::{root, text};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use syn::{Attribute, Item, Meta};

/// One file of product code.
pub(super) struct Source {
    /// From the repository's root.
    pub(super) path: PathBuf,
    pub(super) text: String,
    /// Parsed, without items that are compiled for tests only.
    pub(super) syntax: syn::File,
}

/// All files of product code.
pub(super) struct Sources {
    pub(super) product: Vec<Source>,
}

impl Sources {
    /// Reads every Rust file that git tracks and drops the tests.
    ///
    /// A test is a file below a directory `tests` or `benches`, a file `tests.rs`, and a file that
    /// its parent includes under `#[cfg(test)]`.
    pub(super) fn read() -> Result<Self> {
        let mut product = Vec::new();
        let mut tests = BTreeSet::new();
        for path in tracked("*.rs")? {
            if is_test(&path) {
                continue;
            }
            let text = fs::read_to_string(root().join(&path))
                .with_context(|| path.display().to_string())?;
            let mut syntax = syn::parse_file(&text).with_context(|| path.display().to_string())?;
            for name in drop_tests(&mut syntax.items) {
                let directory = directory_of_modules(&path);
                tests.insert(directory.join(&name).with_extension("rs"));
                tests.insert(directory.join(&name));
            }
            product.push(Source { path, text, syntax });
        }
        product.retain(|source| !source.path.ancestors().any(|above| tests.contains(above)));
        ensure!(!product.is_empty(), "git tracks no Rust file here");
        Ok(Self { product })
    }
}

/// Files of a `pattern` that git tracks and that stand in the work tree.
pub(super) fn tracked(pattern: &str) -> Result<Vec<PathBuf>> {
    let mut git = Command::new("git");
    let text = text(git.current_dir(root()).args(["ls-files", pattern]))?;
    let present = text.lines().filter(|line| root().join(line).is_file());
    Ok(present.map(PathBuf::from).collect())
}

fn is_test(path: &Path) -> bool {
    let in_directory = path.iter().any(|part| part == "tests" || part == "benches");
    in_directory || path.file_name().is_some_and(|name| name == "tests.rs")
}

/// The directory in which `path` has the files of its modules.
fn directory_of_modules(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default();
    if ["mod", "lib", "main"].iter().any(|name| stem == *name) {
        path.parent().unwrap_or(Path::new("")).to_owned()
    } else {
        path.with_extension("")
    }
}

/// Removes items under `#[cfg(test)]`, at every depth of modules. Returns the names of modules among
/// them that are files of their own.
fn drop_tests(items: &mut Vec<Item>) -> Vec<String> {
    let mut files = Vec::new();
    items.retain(|item| {
        let test = attributes(item).iter().any(is_for_tests);
        if let (true, Item::Mod(module)) = (test, item)
            && module.content.is_none()
        {
            files.push(module.ident.to_string());
        }
        !test
    });
    for item in items {
        if let Item::Mod(module) = item
            && let Some((_, inner)) = &mut module.content
        {
            // Inline modules hold no test files here.
            drop_tests(inner);
        }
    }
    files
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn is_for_tests(attribute: &Attribute) -> bool {
    match &attribute.meta {
        Meta::List(list) if list.path.is_ident("cfg") => {
            let condition = list.tokens.to_string();
            condition == "test" || condition.starts_with("all (test")
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_for_tests_are_dropped_and_their_files_named() {
        let text = "#[cfg(test)] mod far; mod near { #[cfg(test)] fn a() {} fn b() {} } #[cfg(not(test))] fn c() {}";
        let mut file = syn::parse_file(text).expect("Rust");
        assert_eq!(drop_tests(&mut file.items), ["far"]);
        assert_eq!(file.items.len(), 2);
        let Item::Mod(near) = &file.items[0] else {
            panic!("the module `near` stays");
        };
        assert_eq!(near.content.as_ref().expect("inline").1.len(), 1);
    }

    #[test]
    fn a_file_s_modules_lie_beside_it_or_below_its_name() {
        for (file, directory) in [("a/lib.rs", "a"), ("a/mod.rs", "a"), ("a/b.rs", "a/b")] {
            assert_eq!(directory_of_modules(Path::new(file)), Path::new(directory));
        }
    }

    #[test]
    fn tests_are_known_by_where_they_lie() {
        for (path, test) in [
            ("tests/bench/src/lib.rs", true),
            ("core/src/fixed/tests.rs", true),
            ("core/examples/tick.rs", false),
            ("core/src/lib.rs", false),
        ] {
            assert_eq!(is_test(Path::new(path)), test, "{path}");
        }
    }
}
