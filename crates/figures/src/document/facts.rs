//! Values of one thing: pairs of a section, or a row of a table.

use super::Reader;
use super::quantity::{parts_of, quantities, unit_of};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};
use std::borrow::Cow;

/// One value.
#[derive(Clone, Debug)]
pub(super) struct Fact {
    /// Key in JSON; empty: text alone. Dots lead into objects.
    key: Cow<'static, str>,
    pub(super) label: Cow<'static, str>,
    pub(super) reader: Reader,
    value: Value,
    /// Unit of a value whose key names none.
    unit: Option<&'static str>,
    /// Decimals in a table.
    pub(super) decimals: Option<usize>,
    /// Lines in place of the words for the value.
    given: Option<Vec<String>>,
    /// First number of an object, which stands for it in a table.
    first: Option<f64>,
}

impl Fact {
    fn unit(&self) -> Option<&'static str> {
        self.unit.or(unit_of(&self.key))
    }

    /// Lines of text; none: there is nothing to show.
    pub(super) fn lines(&self) -> Vec<String> {
        let words = || Vec::from_iter(words(&self.value, self.unit()));
        self.given.clone().unwrap_or_else(words)
    }

    /// Number of a column of numbers, and its unit.
    pub(super) fn number(&self) -> Option<(f64, &'static str)> {
        let own = self.value.as_f64().filter(|_| self.given.is_none());
        Some((own.or(self.first)?, self.unit().unwrap_or_default()))
    }
}

/// Words for a value; `None`: there is nothing.
fn words(value: &Value, unit: Option<&'static str>) -> Option<String> {
    let text = match value {
        Value::Null => String::new(),
        Value::Bool(value) => if *value { "yes" } else { "no" }.into(),
        Value::Number(value) => quantities(&[value.as_f64()?], unit),
        Value::String(text) => text.clone(),
        Value::Array(values) => {
            let numbers: Option<Vec<f64>> = values.iter().map(Value::as_f64).collect();
            let all = || {
                values
                    .iter()
                    .filter_map(|each| words(each, unit))
                    .collect::<Vec<_>>()
            };
            numbers.map_or_else(|| all().join(", "), |numbers| quantities(&numbers, unit))
        }
        Value::Object(map) => {
            let each = |(key, value): (&String, &Value)| {
                let (name, own) = parts_of(key);
                Some(format!(
                    "{} {}",
                    name.replace('_', " "),
                    words(value, own.or(unit))?
                ))
            };
            map.iter().filter_map(each).collect::<Vec<_>>().join(", ")
        }
    };
    (!text.is_empty()).then_some(text)
}

/// Key or label.
pub trait Name: Into<Cow<'static, str>> {}

impl<T: Into<Cow<'static, str>>> Name for T {}

/// Lines of text; an empty one is none.
pub trait TextLines {
    /// Returns the lines.
    fn lines(self) -> Vec<String>;
}

impl TextLines for Vec<String> {
    fn lines(self) -> Vec<String> {
        self
    }
}

impl TextLines for Option<String> {
    fn lines(self) -> Vec<String> {
        Vec::from_iter(self)
    }
}

impl TextLines for String {
    fn lines(self) -> Vec<String> {
        vec![self]
    }
}

impl TextLines for &str {
    fn lines(self) -> Vec<String> {
        vec![self.into()]
    }
}

/// Values in order.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    pub(super) all: Vec<Fact>,
    pub(super) is_marked: bool,
}

impl Facts {
    /// Begins without a value.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a value, shown in the unit of its key. Null is not shown.
    #[must_use]
    pub fn pair(mut self, key: impl Name, label: impl Name, value: impl Serialize) -> Self {
        self.all.push(Fact {
            key: key.into(),
            label: label.into(),
            reader: Reader::Terminal,
            // Null for a value without JSON, as a path that is no text.
            value: serde_json::to_value(value).unwrap_or_default(),
            unit: None,
            decimals: None,
            given: None,
            first: None,
        });
        self
    }

    /// Changes the last value.
    fn last(mut self, change: impl FnOnce(&mut Fact)) -> Self {
        if let Some(fact) = self.all.last_mut() {
            change(fact);
        }
        self
    }

    /// Adds a value for programs.
    #[must_use]
    pub fn data(self, key: impl Name, value: impl Serialize) -> Self {
        let with = self.pair(key, "", value);
        with.last(|fact| fact.reader = Reader::Program)
    }

    /// Shows the last value by these words.
    #[must_use]
    pub fn words(self, words: impl TextLines) -> Self {
        let mut lines = words.lines();
        lines.retain(|line| !line.is_empty());
        self.last(|fact| fact.given = Some(lines))
    }

    /// Adds lines of words that follow from other values.
    #[must_use]
    pub fn text(self, label: impl Name, words: impl TextLines) -> Self {
        self.pair("", label, ()).words(words)
    }

    /// Adds an array for programs.
    #[must_use]
    pub fn rows(self, key: impl Name, rows: impl IntoIterator<Item = Self>) -> Self {
        self.data(key, Vec::from_iter(rows))
    }

    /// Adds a value that follows from others, in `unit`; JSON has the others.
    #[must_use]
    pub fn derived(self, label: impl Name, unit: &'static str, value: impl Serialize) -> Self {
        self.pair("", label, value).in_unit(unit)
    }

    /// Adds an object, shown in one line; null is not shown. In a table its first number stands for it.
    #[must_use]
    pub fn group(self, key: impl Name, label: impl Name, facts: impl Into<Option<Facts>>) -> Self {
        let key = key.into();
        let facts = facts.into();
        let unit = unit_of(&key);
        let line = facts.as_ref().map(|facts| facts.line_in(unit));
        let first = facts
            .as_ref()
            .and_then(|facts| facts.all.first()?.value.as_f64());
        let with = self.pair(key, label, facts).words(line);
        with.last(|fact| fact.first = first)
    }

    /// Shows the last value in `unit`.
    #[must_use]
    pub fn in_unit(self, unit: &'static str) -> Self {
        self.last(|fact| fact.unit = Some(unit))
    }

    /// Shows the last value with so many decimals of its unit, in a table.
    #[must_use]
    pub fn decimals(self, decimals: usize) -> Self {
        self.last(|fact| fact.decimals = Some(decimals))
    }

    /// Leaves the last value to readers of the page.
    #[must_use]
    pub fn page_only(self) -> Self {
        self.last(|fact| fact.reader = Reader::Page)
    }

    /// Leaves all values to readers of the page.
    #[must_use]
    pub fn page_row(mut self) -> Self {
        let all = self.all.iter_mut();
        all.for_each(|fact| fact.reader = fact.reader.min(Reader::Page));
        self
    }

    /// Adds other values.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        self.all.extend(other.all);
        self
    }

    /// Marks the row: `*` in text, a colour on the page.
    #[must_use]
    pub fn marked(mut self, is_marked: bool) -> Self {
        self.is_marked = is_marked;
        self
    }

    /// Values that `reader` sees.
    pub(super) fn shown(&self, reader: Reader) -> impl Iterator<Item = &Fact> {
        self.all.iter().filter(move |fact| fact.reader >= reader)
    }

    /// The values in one line.
    pub fn line(&self) -> String {
        self.line_in(None)
    }

    /// The values in one line; those without a unit are in `unit`.
    pub fn line_in(&self, unit: Option<&'static str>) -> String {
        let mut text = String::new();
        for fact in self.shown(Reader::Terminal) {
            let own = || words(&fact.value, fact.unit().or(unit)).unwrap_or_default();
            let words = fact
                .given
                .as_ref()
                .map_or_else(own, |lines| lines.join(" "));
            if words.is_empty() {
                continue;
            }
            // A time or a place belongs to the value before it.
            text += match matches!(&*fact.label, "at" | "at t =") {
                _ if text.is_empty() => "",
                true => " ",
                false => ", ",
            };
            text += &fact.label;
            text += if fact.label.is_empty() { "" } else { " " };
            text += &words;
        }
        text
    }

    pub(super) fn json_into(&self, map: &mut Map<String, Value>) {
        for fact in self.all.iter().filter(|fact| !fact.key.is_empty()) {
            insert(map, &fact.key, fact.value.clone());
        }
    }
}

impl Serialize for Facts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = Map::new();
        self.json_into(&mut map);
        map.serialize(serializer)
    }
}

/// Inserts at a key with dots between the steps. Later values of one object join it.
pub(super) fn insert(map: &mut Map<String, Value>, key: &str, value: Value) {
    let (first, value) = match key.split_once('.') {
        Some((first, rest)) => {
            let mut inner = Map::new();
            insert(&mut inner, rest, value);
            (first, inner.into())
        }
        None => (key, value),
    };
    merge(map.entry(first).or_insert(Value::Null), value);
}

fn merge(place: &mut Value, value: Value) {
    match (place, value) {
        (Value::Object(own), Value::Object(more)) => {
            for (key, value) in more {
                merge(own.entry(key).or_insert(Value::Null), value);
            }
        }
        (place, value) => *place = value,
    }
}

/// Rows as CSV, with the keys of the first as the head. Null is empty, `true` is 1; numbers have the fewest digits that read back.
pub fn csv(rows: &[Facts]) -> String {
    let quoted = |text: &str| match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    };
    let cell = |fact: &Fact| match &fact.value {
        Value::Null => String::new(),
        Value::Bool(value) => u8::from(*value).to_string(),
        Value::Number(value) if value.is_f64() => {
            format!("{:?}", value.as_f64().unwrap_or(f64::NAN))
        }
        Value::String(text) => quoted(text),
        other => quoted(&other.to_string()),
    };
    let line = |row: &Facts, cell: &dyn Fn(&Fact) -> String| {
        let keyed = row.all.iter().filter(|fact| !fact.key.is_empty());
        keyed.map(cell).collect::<Vec<_>>().join(",") + "\n"
    };
    let head = rows.first().map(|row| line(row, &|fact| quoted(&fact.key)));
    let head = head.unwrap_or_default();
    rows.iter().fold(head, |text, row| text + &line(row, &cell))
}
