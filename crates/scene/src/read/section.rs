//! A table of a scene, read key by key.

use super::suggest::suggest;
use super::{Conversion, Document, Place};
use std::cell::{Cell, RefCell};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table and the path to it. Whatever is asked of it and is not right becomes a [`Problem`] of
/// the document, and the answer is `None`. Keys that were never asked for are reported as unknown
/// when the section is dropped.
///
/// [`Problem`]: crate::Problem
pub struct Section<'d, 't> {
    pub(super) document: &'d Document<'t>,
    table: &'d DeTable<'t>,
    path: String,
    /// Line and column of its begin.
    begin: [usize; 2],
    asked: RefCell<Vec<&'d str>>,
    lenient: Cell<bool>,
}

impl<'d, 't> Section<'d, 't> {
    /// The whole file.
    pub(crate) fn root(document: &'d Document<'t>, table: &'d DeTable<'t>) -> Self {
        Self::new(document, table, String::new(), [1; 2])
    }

    fn new(
        document: &'d Document<'t>,
        table: &'d DeTable<'t>,
        path: String,
        begin: [usize; 2],
    ) -> Self {
        Self {
            document,
            table,
            path,
            begin,
            asked: RefCell::default(),
            lenient: Cell::new(false),
        }
    }

    /// The place of the section itself.
    pub fn place(&self) -> Place {
        Place {
            line: self.begin[0],
            column: self.begin[1],
            key: self.path.clone(),
            value: None,
        }
    }

    /// The place of a key: where its value is, or where it is missing. A value in [another unit](super::in_other_unit) has the name of
    /// that.
    pub fn place_of(&self, key: &str) -> Place {
        let other = match self.table.contains_key(key) {
            true => None,
            false => super::in_other_unit(key).map(|(name, _)| name),
        };
        let other = other.filter(|name| self.table.contains_key(name.as_str()));
        let key = other.as_deref().unwrap_or(key);
        let ([line, column], value) = match self.table.get(key) {
            Some(value) => (
                self.document.position(value.span().start),
                Some(self.document.quote(value.span())),
            ),
            None => (self.begin, None),
        };
        Place {
            line,
            column,
            key: self.child(key),
            value,
        }
    }

    /// Adds a problem at `key`.
    pub fn refuse(&self, key: &str, reason: impl Into<String>) {
        self.document.refuse(&self.place_of(key), reason);
    }

    /// Adds a problem at a place within the section.
    pub fn refuse_at(&self, place: &Place, reason: impl Into<String>) {
        self.document.refuse(place, reason);
    }

    /// Refuses an array of tables as a whole; its text is too long to quote.
    pub fn refuse_list(&self, key: &str, reason: impl Into<String>) {
        let place = self.place_of(key);
        self.document.refuse(
            &Place {
                value: None,
                ..place
            },
            reason,
        );
    }

    /// Accepts whatever keys are left: what they mean depends on one that was refused.
    pub fn ignore_rest(&self) {
        self.lenient.set(true);
    }

    /// Returns `true` if `key` is there.
    pub fn has(&self, key: &'d str) -> bool {
        self.value(key).is_some()
    }

    /// A table that must be there.
    pub fn section(&self, key: &'d str) -> Option<Section<'d, 't>> {
        self.demand(key, "a table")?;
        self.optional_section(key)
    }

    /// A table that may be left out.
    pub fn optional_section(&self, key: &'d str) -> Option<Section<'d, 't>> {
        let value = self.value(key)?;
        let begin = self.document.position(value.span().start);
        match value.get_ref() {
            DeValue::Table(table) => {
                Some(Section::new(self.document, table, self.child(key), begin))
            }
            other => {
                self.refuse(key, expected_but_found("a table", other));
                None
            }
        }
    }

    /// An array of tables, empty where it is left out; `None` if it is something else.
    pub fn sections(&self, key: &'d str) -> Option<Vec<Section<'d, 't>>> {
        let Some(value) = self.value(key) else {
            return Some(Vec::new());
        };
        let path = self.child(key);
        let expected = format!("tables, each under its own [[{path}]]");
        let Some(array) = value.get_ref().as_array() else {
            self.refuse(key, expected_but_found(&expected, value.get_ref()));
            return None;
        };
        let mut sections = Vec::with_capacity(array.len());
        for (i, item) in array.iter().enumerate() {
            let begin = self.document.position(item.span().start);
            let path = format!("{path}[{}]", i + 1);
            match item.get_ref() {
                DeValue::Table(table) => {
                    sections.push(Section::new(self.document, table, path, begin));
                }
                other => {
                    let place = Place {
                        line: begin[0],
                        column: begin[1],
                        key: path,
                        value: Some(self.document.quote(item.span())),
                    };
                    let reason = expected_but_found("a table", other);
                    self.document.refuse(&place, reason);
                }
            }
        }
        (sections.len() == array.len()).then_some(sections)
    }

    /// The keys of the section, in the order of the file, where they are names of its own.
    pub fn names(&self) -> Vec<&'d str> {
        let mut keys: Vec<_> = self.table.iter().map(|(key, _)| key).collect();
        keys.sort_by_key(|key| key.span().start);
        keys.into_iter().map(|key| key.get_ref().as_ref()).collect()
    }

    pub(super) fn value(&self, key: &'d str) -> Option<&'d Spanned<DeValue<'t>>> {
        self.measured(key).map(|measured| measured.value)
    }

    /// The value of `key`, under its own name or that in another unit. Both are refused.
    pub(super) fn measured(&self, key: &'d str) -> Option<MeasuredValue<'d, 't>> {
        self.ask(key);
        let own = self.table.get(key);
        let other = super::in_other_unit(key).and_then(|(name, to_own)| {
            let (name, value) = self.table.get_key_value(name.as_str())?;
            let name: &'d str = name.get_ref();
            Some((name, value, to_own))
        });
        let Some((name, value, to_own)) = other else {
            return own.map(|value| MeasuredValue {
                name: key,
                value,
                to_own: None,
            });
        };
        if self.ask(name) && own.is_some() {
            self.refuse(
                name,
                format!("`{key}` is given, too; leave out one of both"),
            );
        }
        Some(MeasuredValue {
            name,
            value,
            to_own: Some(to_own),
        })
    }

    /// Notes that `key` is known. Returns true at the first time.
    fn ask(&self, key: &'d str) -> bool {
        let is_new = !self.asked.borrow().contains(&key);
        if is_new {
            self.asked.borrow_mut().push(key);
        }
        is_new
    }

    /// Refuses if the key is missing.
    pub(super) fn demand(&self, key: &'d str, expected: &str) -> Option<()> {
        let there = self.has(key);
        if !there {
            self.refuse(key, format!("missing, expected {expected}"));
        }
        there.then_some(())
    }

    pub(super) fn child(&self, key: &str) -> String {
        match self.path.as_str() {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        }
    }
}

/// Value of a key, maybe in another unit.
pub(super) struct MeasuredValue<'d, 't> {
    /// Name of the key in the file.
    pub(super) name: &'d str,
    pub(super) value: &'d Spanned<DeValue<'t>>,
    /// Conversion to the unit of the key that was asked for; none of a value in this unit.
    pub(super) to_own: Option<Conversion>,
}

impl Drop for Section<'_, '_> {
    fn drop(&mut self) {
        if self.lenient.get() || std::thread::panicking() {
            return;
        }
        let asked = self.asked.borrow();
        for (key, value) in self.table {
            let name: &str = key.get_ref();
            if asked.contains(&name) || self.document.counts_on() {
                continue;
            }
            let place = Place {
                line: self.document.line(key.span().start),
                column: self.document.column(key.span().start),
                key: self.child(name),
                value: Some(self.document.quote(value.span())),
            };
            let hint = match suggest(name, &asked) {
                _ if self.document.top_keys.contains(&name) => {
                    "it belongs at the top of the file, before the first table".into()
                }
                Some(meant) => format!("did you mean `{meant}`?"),
                None if asked.is_empty() => "none is expected here".into(),
                None => format!("keys here are {}", asked.join(", ")),
            };
            self.document.refuse(&place, format!("unknown key; {hint}"));
        }
    }
}

/// The reason where a value has the wrong type.
pub(super) fn expected_but_found(expected: &str, found: &DeValue) -> String {
    let found = match found {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "a boolean",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    };
    format!("expected {expected}, found {found}")
}
