//! The values of a section: numbers, vectors, strings, choices.

use super::in_other_unit;
use super::section::{MeasuredValue, expected_but_found};
use super::suggest::{did_you_mean, unit_of};
use super::{Bound, Place, Section};
use crate::words::short;
use std::borrow::Cow;
use toml::de::DeValue;

/// Longest name, in characters.
const LONGEST_NAME: usize = 64;

impl<'d> Section<'d, '_> {
    /// A number that must be there.
    pub fn number(&self, key: &'d str, bound: Bound) -> Option<f64> {
        self.demand(key, &bound.number_in(key))?;
        self.optional_number(key, bound)
    }

    /// A number that may be left out.
    pub fn number_or(&self, key: &'d str, bound: Bound, default: f64) -> Option<f64> {
        match self.has(key) {
            true => self.optional_number(key, bound),
            false => Some(default),
        }
    }

    /// A number that may be left out: `None` if it is, and if it is refused.
    pub fn optional_number(&self, key: &'d str, bound: Bound) -> Option<f64> {
        let measured = self.measured(key)?;
        let value = measured.value.get_ref();
        self.check_number(&self.place_of(key), key, &measured, value, bound)
    }

    /// A whole number that must be there.
    pub fn integer(&self, key: &'d str, low: u32, high: u32) -> Option<u32> {
        let bound = Bound::Whole(low, high);
        self.demand(key, &bound.number_in(key))?;
        self.optional_number(key, bound).map(|value| value as u32)
    }

    /// A whole number, or `word` for none, that must be there.
    pub fn count_or(&self, key: &'d str, low: u32, high: u32, word: &str) -> Option<Option<u32>> {
        let Some(value) = self.value(key).filter(|value| value.get_ref().is_str()) else {
            return self.integer(key, low, high).map(Some);
        };
        let is_word = value.get_ref().as_str() == Some(word);
        if !is_word {
            let number = Bound::Whole(low, high).number_in(key);
            self.refuse(key, format!("must be {number}, or \"{word}\""));
        }
        is_word.then_some(None)
    }

    /// A sign, 1 or -1, that must be there.
    pub fn sign(&self, key: &'d str) -> Option<f64> {
        self.demand(key, &Bound::Sign.number_in(key))?;
        self.optional_number(key, Bound::Sign)
    }

    /// `[x, y]`: `default` where it is left out, an error if there is none.
    pub fn vector(&self, key: &'d str, default: Option<[f64; 2]>) -> Option<[f64; 2]> {
        if default.is_some() && !self.has(key) {
            return default;
        }
        let expected = format!("[x, y], {} each", Bound::Finite.number_in(key));
        self.demand(key, &expected)?;
        self.array(key, Bound::Finite, &expected)
    }

    /// Array of `COUNT` numbers that must be there.
    pub fn numbers<const COUNT: usize>(&self, key: &'d str, bound: Bound) -> Option<[f64; COUNT]> {
        let expected = format!("{COUNT} numbers");
        self.demand(key, &expected)?;
        self.array(key, bound, &expected)
    }

    /// One number that holds for all three, or an array of three; `None` if left out or refused.
    pub fn number_or_three(&self, key: &'d str, bound: Bound) -> Option<[f64; 3]> {
        self.number_or_each(key, bound, 3)?.try_into().ok()
    }

    /// One number that holds for all `count`, or an array of as many; `None` if left out or refused.
    pub fn number_or_each(&self, key: &'d str, bound: Bound, count: usize) -> Option<Vec<f64>> {
        let value = self.value(key)?;
        match value.get_ref() {
            DeValue::Array(_) => {
                let of_them = match count {
                    3 => "three".into(),
                    count => count.to_string(),
                };
                let expected = format!("{}, or {of_them} of them", bound.number_in(key));
                let mut numbers = vec![0.0; count];
                self.fill(key, bound, &expected, &mut numbers)?;
                Some(numbers)
            }
            _ => self
                .optional_number(key, bound)
                .map(|number| vec![number; count]),
        }
    }

    /// `COUNT` vectors `[[x, y], ...]` that must be there.
    pub fn vectors<const COUNT: usize>(&self, key: &'d str) -> Option<[[f64; 2]; COUNT]> {
        let number = Bound::Finite.number_in(key);
        let expected = format!("{COUNT} vectors [[x, y], ...], {number} each");
        self.demand(key, &expected)?;
        let measured = self.measured(key)?;
        let rows = measured.value.get_ref().as_array();
        let numbers = rows.filter(|rows| rows.len() == COUNT).and_then(|rows| {
            let mut vectors = [[0.0; 2]; COUNT];
            for (vector, row) in vectors.iter_mut().zip(rows.iter()) {
                let row = row.get_ref().as_array().filter(|row| row.len() == 2)?;
                for (number, item) in vector.iter_mut().zip(row.iter()) {
                    let given = as_f64(item.get_ref()).filter(|number| number.is_finite())?;
                    *number = measured.to_own.map_or(given, |to_own| to_own(given));
                }
            }
            Some(vectors)
        });
        if numbers.is_none() {
            self.refuse(key, format!("expected {expected}"));
        }
        numbers
    }

    fn array<const LEN: usize>(
        &self,
        key: &'d str,
        bound: Bound,
        expected: &str,
    ) -> Option<[f64; LEN]> {
        let mut numbers = [0.0; LEN];
        self.fill(key, bound, expected, &mut numbers)?;
        Some(numbers)
    }

    /// Reads an array of as many numbers as there is room for.
    fn fill(&self, key: &'d str, bound: Bound, expected: &str, numbers: &mut [f64]) -> Option<()> {
        let measured = self.measured(key)?;
        let value = measured.value.get_ref();
        let Some(array) = value.as_array() else {
            self.refuse(key, expected_but_found(expected, value));
            return None;
        };
        if array.len() != numbers.len() {
            self.refuse(
                key,
                format!("expected {expected}, found {} values", array.len()),
            );
            return None;
        }
        let mut good = true;
        for (i, (number, item)) in numbers.iter_mut().zip(array.iter()).enumerate() {
            let place = Place {
                line: self.document.line(item.span().start),
                column: self.document.column(item.span().start),
                key: format!("{}[{}]", self.child(measured.name), i + 1),
                value: Some(self.document.quote(item.span())),
            };
            match self.check_number(&place, key, &measured, item.get_ref(), bound) {
                Some(checked) => *number = checked,
                None => good = false,
            }
        }
        good.then_some(())
    }

    fn check_number(
        &self,
        place: &Place,
        key: &'d str,
        measured: &MeasuredValue,
        value: &DeValue,
        bound: Bound,
    ) -> Option<f64> {
        let Some(given) = as_f64(value) else {
            let expected = expected_but_found(&bound.number_in(measured.name), value);
            self.document.refuse(place, expected);
            return None;
        };
        let number = measured.to_own.map_or(given, |to_own| to_own(given));
        if let Some(objection) = bound.objection(number) {
            let unit = unit_of(key).unwrap_or_default();
            let mut reason = match unit {
                "" => objection,
                unit => format!("{objection} ({unit})"),
            };
            if measured.to_own.is_some() && number.is_finite() {
                reason += &format!("; it is {} {unit}", short(number));
            } else if let (Bound::TwoTurns, Some((other, _))) = (bound, in_other_unit(key)) {
                reason += &format!("; in degrees it is `{other}`");
            }
            self.document.refuse(place, reason);
            return None;
        }
        Some(number)
    }

    /// `true` or `false`, which must be there.
    pub fn boolean(&self, key: &'d str) -> Option<bool> {
        self.demand(key, "true or false")?;
        let value = self.value(key)?;
        let boolean = value.get_ref().as_bool();
        if boolean.is_none() {
            self.refuse(key, expected_but_found("true or false", value.get_ref()));
        }
        boolean
    }

    /// A string that may be left out.
    pub fn optional_text(&self, key: &'d str) -> Option<Cow<'d, str>> {
        let value = self.value(key)?;
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.refuse(key, expected_but_found("a string", value.get_ref()));
        }
        text.map(Cow::Borrowed)
    }

    /// A string that must be there.
    pub fn text(&self, key: &'d str) -> Option<Cow<'d, str>> {
        self.demand(key, "a string")?;
        self.optional_text(key)
    }

    /// A name that must be there and can be that of a folder.
    pub fn folder_name(&self, key: &'d str) -> Option<String> {
        let name = self.text(key)?;
        let good = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if !(1..=LONGEST_NAME).contains(&name.chars().count()) || !name.chars().all(good) {
            let reason = format!(
                "must be 1 to {LONGEST_NAME} letters, digits, `-` or `_`, for it names a folder"
            );
            self.refuse(key, reason);
            return None;
        }
        Some(name.into_owned())
    }

    /// An array of strings, each with its place; `None` if it is something else.
    pub fn texts(&self, key: &'d str) -> Option<Vec<(Place, &'d str)>> {
        let expected = "an array of strings";
        self.demand(key, expected)?;
        let value = self.value(key)?;
        let Some(array) = value.get_ref().as_array() else {
            self.refuse(key, expected_but_found(expected, value.get_ref()));
            return None;
        };
        let texts = array.iter().enumerate().map(|(i, item)| {
            let place = Place {
                line: self.document.line(item.span().start),
                column: self.document.column(item.span().start),
                key: format!("{}[{}]", self.child(key), i + 1),
                value: Some(self.document.quote(item.span())),
            };
            let text = item.get_ref().as_str();
            if text.is_none() {
                let reason = expected_but_found("a string", item.get_ref());
                self.document.refuse(&place, reason);
            }
            text.map(|text| (place, text))
        });
        // All are looked at before the first refusal counts.
        texts.collect::<Vec<_>>().into_iter().collect()
    }

    /// One of `choices`, which must be there.
    pub fn choice<T: Copy>(&self, key: &'d str, choices: &[(&str, T)]) -> Option<T> {
        let names: Vec<String> = choices
            .iter()
            .map(|(name, _)| format!("\"{name}\""))
            .collect();
        let names = names.join(", ");
        self.demand(key, &format!("one of {names}"))?;
        let text = self.text(key)?;
        let found = choices.iter().find(|(name, _)| *name == text);
        if found.is_none() {
            let known: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
            let meant = did_you_mean(&text, &known);
            self.refuse(key, format!("must be one of {names}{meant}"));
        }
        found.map(|(_, choice)| *choice)
    }
}

/// A float or an integer as the nearest binary64 number.
fn as_f64(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix())
            .ok()
            .map(|integer| integer as f64),
        _ => None,
    }
}
