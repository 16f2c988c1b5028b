//! The reference in `docs/wire.md`: tables between marks, which name the types that a chapter begins at.

use super::docs::Docs;
use super::numbers;
use super::types::{Content, Form, SchemaType, TypeKind, Types, form, kind};
use anyhow::{Context, Result, bail, ensure};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt::Write;
use trirrr_protocol::message::{BATCH, BLOCK, FULL_LEVEL, LEVEL_PARTS, LEVELS, PROTOCOL};

const BEGIN: &str = "<!-- cargo xtask wire: ";
const MARK_END: &str = " -->";
const END: &str = "<!-- end -->";

/// Mark of the table of number types.
const KEYS: &str = "keys";

/// Columns of a line of text.
const COLUMNS: usize = 120;

/// Constants that doc comments link to, which the reference gives as numbers.
const CONSTANTS: [(&str, u64); 6] = [
    ("BATCH", BATCH as u64),
    ("BLOCK", BLOCK as u64),
    ("FULL_LEVEL", FULL_LEVEL as u64),
    ("LEVELS", LEVELS as u64),
    ("LEVEL_PARTS", LEVEL_PARTS as u64),
    ("PROTOCOL", PROTOCOL as u64),
];

/// Terms that the reference explains elsewhere.
const TERMS: [(&str, &str); 7] = [
    ("a scene that comes over the line", "#scene-over-the-line"),
    ("an update of the program", "#update"),
    ("board file", "board.md#board-files"),
    ("each conversation", "#the-conversation"),
    ("power lists", "#power-lists"),
    ("the frames", "#frames"),
    ("types and values", "board.md#types-and-values"),
];

/// The document `old` with what the types say now between its marks.
pub(super) fn written(old: &str, types: &Types, docs: &Docs) -> Result<String> {
    let roots: Vec<&str> = old.split(BEGIN).skip(1).flat_map(mark_words).collect();
    let mut writer = Writer {
        types,
        docs,
        terms: RefCell::default(),
        described: BTreeSet::new(),
    };
    let mut text = String::new();
    let mut rest = old;
    while let Some((before, behind)) = rest.split_once(BEGIN) {
        let (mark, behind) = behind.split_once(MARK_END).context(MARK_END)?;
        let (_, behind) = behind.split_once(END).context(END)?;
        let content = match mark {
            KEYS => keys(),
            mark => writer.chapter(mark, &roots)?,
        };
        write!(text, "{before}{BEGIN}{mark}{MARK_END}\n{content}{END}")?;
        rest = behind;
    }
    text += rest;
    writer.require_all(&text)?;
    Ok(text)
}

/// Words of the mark that `text` begins in.
fn mark_words(text: &str) -> impl Iterator<Item = &str> {
    let mark = text.split_once(MARK_END).map_or("", |(mark, _)| mark);
    mark.split(' ')
}

fn keys() -> String {
    let mut table = String::from("| machine | N | Angle | schema key |\n|---|---|---|---|\n");
    for (machine, number, angle, key) in numbers() {
        table += &format!("| {machine} | {number} | {angle} | 0x{key:016X} |\n");
    }
    table
}

/// A type in the document.
fn type_name(named: SchemaType) -> String {
    match kind(named) {
        TypeKind::Number => "N".into(),
        TypeKind::Angle => "Angle".into(),
        TypeKind::Optional(inner) => format!("{}?", type_name(inner)),
        TypeKind::Array(inner, count) => format!("[{}; {count}]", type_name(inner)),
        TypeKind::Defined => link(named.name, named.name),
        TypeKind::Composed | TypeKind::Plain => named.name.into(),
    }
}

fn link(text: &str, heading: &str) -> String {
    format!("[{text}](#{})", heading.to_lowercase())
}

struct Writer<'a> {
    types: &'a Types,
    docs: &'a Docs,
    /// Terms that were found in a doc comment.
    terms: RefCell<BTreeSet<&'static str>>,
    /// Types that have a section.
    described: BTreeSet<&'static str>,
}

impl Writer<'_> {
    /// Sections of the types in those that `mark` names, up to the `roots` of other chapters.
    fn chapter(&mut self, mark: &str, roots: &[&str]) -> Result<String> {
        let mut found = Vec::new();
        for root in mark.split(' ') {
            let named = self.types.named(root);
            let named = named.with_context(|| format!("{root} is in no message"))?;
            self.types
                .from(named, &|name| roots.contains(&name), &mut found);
        }
        // A type that two chapters need stands in the first.
        found.retain(|named| self.described.insert(named.name));
        Ok(found.into_iter().map(|named| self.section(named)).collect())
    }

    /// Fails where `text` has no section of a type, or a rule by hand misses one.
    fn require_all(&self, text: &str) -> Result<()> {
        let types = || self.types.0.iter();
        let missing = types().find(|named| !self.described.contains(named.name));
        if let Some(named) = missing {
            bail!("docs/wire.md describes no {}", named.name);
        }
        let wrappers = text.lines().find(|line| line.contains("| 9D, "));
        for named in types().filter(|named| matches!(form(named), Form::Newtype(_))) {
            let is_fed = wrappers.is_some_and(|line| line.contains(named.name));
            ensure!(
                is_fed,
                "docs/wire.md: the schema key feeds 9D for {}, too",
                named.name
            );
        }
        for (term, _) in TERMS {
            let is_used = self.terms.borrow().contains(term);
            ensure!(is_used, "no doc comment has the words {term:?}");
        }
        Ok(())
    }

    /// The heading of a type, its meaning, and its table.
    fn section(&self, named: SchemaType) -> String {
        let name = named.name;
        let mut text = format!("\n### {name}\n\n");
        for paragraph in self.docs.of(name).split("\n\n") {
            text += &wrapped(&self.prose(paragraph));
            text += "\n";
        }
        match form(named) {
            Form::Newtype(inner) => text += &format!("On the line it is a {}.\n", type_name(inner)),
            Form::Struct(fields) => {
                text += "| field | type | |\n|---|---|---|\n";
                for (field, ty) in fields {
                    let meaning = self.meaning(&format!("{name}.{field}"));
                    text += &format!("| `{field}` | {} | {meaning} |\n", type_name(ty));
                }
            }
            Form::Enum(variants) => {
                text += "| | variant | content | |\n|---|---|---|---|\n";
                for (number, (variant, content)) in variants.into_iter().enumerate() {
                    let path = format!("{name}.{variant}");
                    let mut meaning = vec![self.meaning(&path)];
                    let content = match content {
                        Content::Nothing => String::new(),
                        Content::One(inner) => type_name(inner),
                        Content::Fields(fields) => {
                            let each = |(field, ty): &(&str, SchemaType)| {
                                format!("`{field}`: {}", type_name(ty))
                            };
                            for (field, _) in &fields {
                                let of_field = self.meaning(&format!("{path}.{field}"));
                                meaning.push(format!("`{field}`: {}", uncapitalised(&of_field)));
                            }
                            fields.iter().map(each).collect::<Vec<_>>().join(", ")
                        }
                    };
                    text += &format!(
                        "| {number} | `{variant}` | {content} | {} |\n",
                        meaning.join(" ")
                    );
                }
            }
        }
        // Cells without content.
        text.replace("|  |", "| |").replace("|  |", "| |")
    }

    fn meaning(&self, path: &str) -> String {
        self.prose(self.docs.of(path))
    }

    /// A paragraph of a doc comment on one line, with the links of the document.
    fn prose(&self, doc: &str) -> String {
        let doc = doc.replace('\n', " ");
        let mut text = String::new();
        let mut rest = doc.as_str();
        while let Some((before, behind)) = rest.split_once('[') {
            text += before;
            let Some((shown, behind)) = behind.split_once(']') else {
                text += "[";
                rest = behind;
                continue;
            };
            let target = behind
                .strip_prefix('(')
                .and_then(|target| target.split_once(')'));
            let is_code = shown.starts_with('`');
            rest = match target {
                Some((_, after)) => after,
                None => behind,
            };
            match target {
                Some((target, _)) => text += &self.linked(shown, target),
                None if is_code => text += &self.linked(shown, shown.trim_matches('`')),
                None => text += &format!("[{shown}]"),
            }
        }
        text += rest;
        for (term, place) in TERMS {
            if text.contains(term) {
                self.terms.borrow_mut().insert(term);
                text = text.replacen(term, &format!("[{term}]({place})"), 1);
            }
        }
        text
    }

    /// A link of the documentation: to a heading of the document, or its text alone.
    fn linked(&self, shown: &str, target: &str) -> String {
        let last = target.rsplit("::").next().unwrap_or(target);
        if let Some((_, value)) = CONSTANTS.iter().find(|(name, _)| *name == last) {
            return value.to_string();
        }
        match self.types.named(last) {
            Some(named) => link(shown.trim_matches('`'), named.name),
            None => shown.replace("::", "."),
        }
    }
}

/// `text` as it goes on behind a colon.
fn uncapitalised(text: &str) -> String {
    let mut letters = text.chars();
    match (letters.next(), letters.next()) {
        (Some(first), Some(second)) if second.is_lowercase() || (first, second) == ('A', ' ') => {
            format!("{}{}", first.to_lowercase(), &text[first.len_utf8()..])
        }
        _ => text.into(),
    }
}

/// `text` in lines of no more than [`COLUMNS`], with a newline behind each.
fn wrapped(text: &str) -> String {
    let (mut lines, mut length) = (String::new(), 0);
    for word in text.split(' ') {
        if length > 0 && length + 1 + word.len() > COLUMNS {
            lines += "\n";
            length = 0;
        }
        if length > 0 {
            lines += " ";
            length += 1;
        }
        lines += word;
        length += word.len();
    }
    lines + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_the_documentation_lead_to_headings_of_the_document() {
        let (types, docs) = (Types::read(), Docs::read().expect("the sources"));
        let writer = Writer {
            types: &types,
            docs: &docs,
            terms: RefCell::default(),
            described: BTreeSet::new(),
        };
        for (doc, text) in [
            (
                "[N; 3] of a\n[`Move`](super::Move), in (-pi, pi].",
                "[N; 3] of a [Move](#move), in (-pi, pi].",
            ),
            (
                "the [state](super::Status) of [`Goal`]",
                "the [state](#status) of [Goal](#goal)",
            ),
            (
                "[`Enable`](super::Command::Enable), [`Status::end`]",
                "`Enable`, `Status.end`",
            ),
            ("1 to [`BLOCK`]", "1 to 128"),
            ("a [distance](trirrr_core::singularity)", "a distance"),
            ("CRC-32 of the frames", "CRC-32 of [the frames](#frames)"),
        ] {
            assert_eq!(writer.prose(doc), text);
        }
    }

    #[test]
    fn a_meaning_goes_on_behind_the_name_of_its_field() {
        for (text, rest) in [
            ("The next.", "the next."),
            ("A leg.", "a leg."),
            ("D goes on.", "D goes on."),
            ("ASCII.", "ASCII."),
            ("`true`: on.", "`true`: on."),
            ("", ""),
        ] {
            assert_eq!(uncapitalised(text), rest);
        }
    }

    #[test]
    fn a_type_that_no_chapter_names_is_an_error() {
        let (types, docs) = (Types::read(), Docs::read().expect("the sources"));
        let one = "<!-- cargo xtask wire: Request -->\n<!-- end -->\n";
        let error = written(one, &types, &docs).expect_err("it has no Message");
        assert!(error.to_string().contains("describes no"), "{error}");
        let unknown = written(
            "<!-- cargo xtask wire: Reqest -->\n<!-- end -->",
            &types,
            &docs,
        );
        assert!(unknown.is_err_and(|error| error.to_string().contains("Reqest is in no message")));
    }
}
