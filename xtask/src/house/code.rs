//! Types by name and parameters, and lines of code.

use super::source::Source;
use anyhow::{Result, ensure};
use proc_macro2::{Delimiter, Span, TokenStream, TokenTree};
use quote::ToTokens;
use std::collections::{BTreeMap, BTreeSet};
use syn::visit::{self, Visit};
use syn::{GenericParam, Generics, Ident, Visibility};

/// Figures of all sources.
#[derive(Default)]
pub(super) struct Code {
    /// Places of each type's definitions, by name.
    names: BTreeMap<String, Vec<String>>,
    /// Type parameters of each public type, with its place.
    parameters: Vec<(usize, String)>,
    pub(super) most_parameters: usize,
    /// Lines with code on them, by room.
    rooms: BTreeMap<String, usize>,
    pub(super) lines: usize,
}

impl Code {
    /// Public types with more than `allowed` type parameters.
    pub(super) fn above(&self, allowed: usize) -> Vec<String> {
        let above = self.parameters.iter().filter(|(count, _)| *count > allowed);
        above
            .map(|(count, place)| format!("{count}: {place}"))
            .collect()
    }

    /// Names that are defined `times` times or more, each with its places.
    pub(super) fn repeated(&self, times: usize) -> Vec<String> {
        let often = self
            .names
            .iter()
            .filter(|(_, places)| places.len() >= times);
        let named = |(name, places): (&String, &Vec<String>)| {
            format!("{name} x{}: {}", places.len(), places.join(", "))
        };
        often.map(named).collect()
    }

    pub(super) fn lines_by_room(&self) -> Vec<String> {
        let rooms = self.rooms.iter();
        rooms
            .map(|(room, lines)| format!("{room}: {lines}"))
            .collect()
    }
}

pub(super) fn measure(sources: &[Source]) -> Result<Code> {
    let mut code = Code::default();
    for source in sources {
        let mut types = Types {
            place: source.path.display().to_string(),
            code: &mut code,
        };
        types.visit_file(&source.syntax);
        let mut lines = BTreeSet::new();
        collect_lines(source.syntax.to_token_stream(), &mut lines);
        let room: Vec<_> = source
            .path
            .iter()
            .take_while(|part| *part != "src")
            .collect();
        let room = room.join("/".as_ref()).display().to_string();
        *code.rooms.entry(room).or_default() += lines.len();
        code.lines += lines.len();
    }
    code.most_parameters = code
        .parameters
        .iter()
        .map(|(count, _)| *count)
        .max()
        .unwrap_or(0);
    ensure!(!code.names.is_empty(), "no type was found");
    Ok(code)
}

struct Types<'a> {
    place: String,
    code: &'a mut Code,
}

impl Types<'_> {
    fn define(&mut self, name: &Ident) {
        let places = self.code.names.entry(name.to_string()).or_default();
        places.push(self.place.clone());
    }

    fn define_with(&mut self, name: &Ident, visibility: &Visibility, generics: &Generics) {
        self.define(name);
        // `pub(crate)` and narrower is no interface that a user reads.
        if matches!(visibility, Visibility::Public(_)) {
            let count = type_parameters(generics);
            let place = format!("{name} in {}", self.place);
            self.code.parameters.push((count, place));
        }
    }
}

impl<'ast> Visit<'ast> for Types<'_> {
    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        self.define_with(&item.ident, &item.vis, &item.generics);
        visit::visit_item_struct(self, item);
    }

    fn visit_item_enum(&mut self, item: &'ast syn::ItemEnum) {
        self.define_with(&item.ident, &item.vis, &item.generics);
        visit::visit_item_enum(self, item);
    }

    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        self.define(&item.ident);
        visit::visit_item_trait(self, item);
    }

    fn visit_item_type(&mut self, item: &'ast syn::ItemType) {
        self.define(&item.ident);
        visit::visit_item_type(self, item);
    }
}

fn type_parameters(generics: &Generics) -> usize {
    let types = generics.params.iter();
    types
        .filter(|one| matches!(one, GenericParam::Type(_)))
        .count()
}

/// Lines on which a token stands that is no documentation.
fn collect_lines(tokens: TokenStream, lines: &mut BTreeSet<usize>) {
    let tokens = tokens.into_iter();
    // A `#`, perhaps with `!`, is held back until the group behind it is known to be no documentation.
    let mut held: Vec<Span> = Vec::new();
    for token in tokens {
        match token {
            TokenTree::Punct(punct)
                if punct.as_char() == '#' || (punct.as_char() == '!' && !held.is_empty()) =>
            {
                held.push(punct.span());
            }
            TokenTree::Group(group) => {
                let docs = !held.is_empty()
                    && group.delimiter() == Delimiter::Bracket
                    && matches!(group.stream().into_iter().next(), Some(TokenTree::Ident(name)) if name == "doc");
                if docs {
                    held.clear();
                    continue;
                }
                insert(lines, held.drain(..));
                insert(lines, [group.span_open(), group.span_close()]);
                collect_lines(group.stream(), lines);
            }
            other => {
                insert(lines, held.drain(..));
                insert(lines, [other.span()]);
            }
        }
    }
}

fn insert(lines: &mut BTreeSet<usize>, spans: impl IntoIterator<Item = Span>) {
    for span in spans {
        lines.extend(span.start().line..=span.end().line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn measured(text: &str) -> Code {
        let source = Source {
            path: PathBuf::from("core/src/a.rs"),
            text: text.into(),
            syntax: syn::parse_file(text).expect("Rust"),
        };
        measure(&[source]).expect("types")
    }

    #[test]
    fn lifetimes_and_constants_are_no_type_parameters() {
        let code = measured(
            "pub struct A<'a, N, P: Fn(N), const L: usize>(&'a N, P);\n\
             struct Hidden<A, B, C, D>(A, B, C, D);",
        );
        assert_eq!(code.most_parameters, 2);
        assert_eq!(code.above(1), ["2: A in core/src/a.rs"]);
    }

    #[test]
    fn a_name_is_counted_in_every_module() {
        let code = measured("mod a { enum X {} } mod b { struct X; } trait X {} struct Y;");
        let place = "core/src/a.rs";
        assert_eq!(
            code.repeated(3),
            [format!("X x3: {place}, {place}, {place}")]
        );
    }

    #[test]
    fn comments_docs_and_empty_lines_are_no_code() {
        let text = "//! Room.\n\n/// Docs.\n#[derive(Clone)]\nstruct A; // why\n\n// reason\nfn f() {\n    /* two\n    lines */\n    g(\"one\n    two\");\n}\n";
        let code = measured(text);
        assert_eq!(code.lines, 6);
        assert_eq!(code.lines_by_room(), ["core: 6"]);
    }
}
