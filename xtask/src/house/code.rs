//! Types by name and parameters, and lines of code.

use super::source::Source;
use std::collections::BTreeMap;
use syn::visit::{self, Visit};
use syn::{Generics, Ident, Visibility};

/// Names of the types of a file; of public ones with their type parameters, lifetimes and constants apart.
struct Types(Vec<(String, usize)>);

impl Types {
    fn of(source: &Source) -> Vec<(String, usize)> {
        let mut types = Self(Vec::new());
        types.visit_file(&source.syntax);
        types.0
    }

    fn define(&mut self, name: &Ident, visibility: &Visibility, generics: &Generics) {
        // `pub(crate)` and narrower is no interface that a user reads.
        let parameters = match visibility {
            Visibility::Public(_) => generics.type_params().count(),
            _ => 0,
        };
        self.0.push((name.to_string(), parameters));
    }
}

impl<'ast> Visit<'ast> for Types {
    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        self.define(&item.ident, &item.vis, &item.generics);
        visit::visit_item_struct(self, item);
    }

    fn visit_item_enum(&mut self, item: &'ast syn::ItemEnum) {
        self.define(&item.ident, &item.vis, &item.generics);
        visit::visit_item_enum(self, item);
    }

    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        self.0.push((item.ident.to_string(), 0));
        visit::visit_item_trait(self, item);
    }

    fn visit_item_type(&mut self, item: &'ast syn::ItemType) {
        self.0.push((item.ident.to_string(), 0));
        visit::visit_item_type(self, item);
    }
}

/// Public types with more than `allowed` type parameters.
pub(super) fn wide(sources: &[Source], allowed: usize) -> Vec<String> {
    let mut found = Vec::new();
    for source in sources {
        let wide = Types::of(source)
            .into_iter()
            .filter(|(_, count)| *count > allowed);
        let place = |(name, count)| format!("{count}: {name} in {}", source.path.display());
        found.extend(wide.map(place));
    }
    found
}

/// Names of types that are defined `times` times or more, each with its places.
pub(super) fn repeated(sources: &[Source], times: usize) -> Vec<String> {
    let mut names: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for source in sources {
        for (name, _) in Types::of(source) {
            let places = names.entry(name).or_default();
            places.push(source.path.display().to_string());
        }
    }
    names.retain(|_, places| places.len() >= times);
    let names = names.iter();
    names
        .map(|(name, places)| format!("{name} x{}: {}", places.len(), places.join(", ")))
        .collect()
}

/// Lines of code of each room: those that are neither empty nor comments, before the tests of a file.
pub(super) fn lines_by_room(sources: &[Source]) -> BTreeMap<String, usize> {
    let mut rooms = BTreeMap::new();
    for Source { path, text, .. } in sources {
        let product = text.split("\n#[cfg(test)]\nmod tests {").next();
        let lines = product.unwrap_or_default().lines().map(str::trim);
        let code = lines.filter(|line| !line.is_empty() && !line.starts_with("//"));
        let path = path.display().to_string();
        let room = path.split("/src/").next().unwrap_or_default();
        *rooms.entry(room.to_owned()).or_default() += code.count();
    }
    rooms
}

/// Lines of a room that choose by `cfg`, `cfg_attr` or `cfg!`, each with its place.
pub(super) fn conditions(sources: &[Source], room: &str) -> Vec<String> {
    let mut found = Vec::new();
    for Source { path, text, .. } in sources.iter().filter(|it| it.path.starts_with(room)) {
        for (index, line) in text.lines().enumerate() {
            let chooses = ["cfg(", "cfg_attr(", "cfg!("].iter();
            if chooses.into_iter().any(|word| line.contains(word)) {
                found.push(format!("{}:{}: {}", path.display(), index + 1, line.trim()));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> [Source; 1] {
        [Source {
            path: "core/src/a.rs".into(),
            text: text.into(),
            syntax: syn::parse_file(text).expect("Rust"),
        }]
    }

    #[test]
    fn lifetimes_and_constants_are_no_type_parameters() {
        let sources = source(
            "pub struct A<'a, N, P: Fn(N), const L: usize>(&'a N, P);\n\
             struct Hidden<A, B, C, D>(A, B, C, D);",
        );
        assert_eq!(wide(&sources, 1), ["2: A in core/src/a.rs"]);
        assert!(wide(&sources, 2).is_empty());
    }

    #[test]
    fn every_form_of_a_cfg_is_found_in_its_room_alone() {
        let sources = source(
            "#[cfg(a)]\nmod b;\n#[cfg_attr(a, inline)]\nfn c() { cfg!(a); }\n/// cfgs\nmod d;\n",
        );
        assert_eq!(conditions(&sources, "core").len(), 3);
        assert!(conditions(&sources, "firmware/app").is_empty());
    }

    #[test]
    fn a_name_is_counted_in_every_module() {
        let sources = source("mod a { enum X {} } mod b { struct X; } trait X {} struct Y;");
        let place = "core/src/a.rs";
        let found = [format!("X x3: {place}, {place}, {place}")];
        assert_eq!(repeated(&sources, 3), found);
    }

    #[test]
    fn comments_docs_empty_lines_and_tests_are_no_code() {
        let text = "//! Room.\n\n/// Docs.\n#[derive(Clone)]\nstruct A; // why\n\n// reason\n#[cfg(test)]\nmod tests {}\n";
        assert_eq!(lines_by_room(&source(text))["core"], 2);
    }
}
