//! Values that an argument sets in a scene.

use super::in_other_unit;
use std::fmt;
use std::str::FromStr;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// One value that goes before that of the file: `limits.rate_rad_s=3`, `machine.leg[1].elbow=-1`.
///
/// Tables and keys of the path that the scene lacks are added; elements of lists are counted from 1, and must be there. `[*]` is each
/// element of a list: `machine.leg[*].distal_m=0.25`. The value is as in TOML; a text of letters, digits, `-` and `_` needs no quotation marks.
///
/// ```
/// use trirrr_scene::read::Setting;
///
/// assert!("platform.mass_kg=0.8".parse::<Setting>().is_ok());
/// assert!("platform.mass_kg".parse::<Setting>().is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    steps: Vec<KeyStep>,
    /// Path of the key, as it was given.
    pub(super) key: String,
    /// The value in TOML.
    pub(super) value: String,
}

/// Key of a table, and the element of a list under it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyStep {
    /// Key of the table.
    pub key: String,
    /// Element of the list under the key; none: the value itself.
    pub element: Option<ListElement>,
}

/// Element of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListElement {
    /// Number of one, from 1.
    One(usize),
    /// Each of them.
    Each,
}

/// Reason for which a text is no [`Setting`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingError {
    /// There is no `=`.
    #[error("expected KEY=VALUE, such as limits.rate_rad_s=3")]
    NoValue,
    /// The path of the key is none.
    #[error(
        "the key is a path of names, such as machine.leg[1].elbow; lists are counted from 1, and [*] is each element"
    )]
    Key,
    /// The value is none of TOML, or several.
    #[error("the value is one of TOML on one line: a number, true, false, a text, [1.0, 2.0]")]
    Value,
}

impl FromStr for Setting {
    type Err = SettingError;

    fn from_str(text: &str) -> Result<Self, SettingError> {
        let (key, value) = text.split_once('=').ok_or(SettingError::NoValue)?;
        let (key, value) = (key.trim(), value.trim());
        let steps: Option<Vec<KeyStep>> = key.split('.').map(KeyStep::of).collect();
        let steps = steps.ok_or(SettingError::Key)?;
        if value.contains(['\n', '\r']) {
            return Err(SettingError::Value);
        }
        let value = match is_name(value) && !matches!(value, "true" | "false" | "inf" | "nan") {
            true if value.parse::<f64>().is_err() => format!("\"{value}\""),
            _ => value.to_owned(),
        };
        let good = DeTable::parse(&format!("v = {value}")).is_ok_and(|it| it.get_ref().len() == 1);
        let key = key.to_owned();
        let setting = Self { steps, key, value };
        good.then_some(setting).ok_or(SettingError::Value)
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.key, self.value)
    }
}

fn is_name(text: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    !text.is_empty() && text.chars().all(letter)
}

impl KeyStep {
    fn of(text: &str) -> Option<Self> {
        let (key, element) = match text.split_once('[') {
            None => (text, None),
            Some((key, rest)) => {
                let element = match rest.strip_suffix(']')? {
                    "*" => ListElement::Each,
                    number => ListElement::One(number.parse().ok().filter(|it| *it > 0)?),
                };
                (key, Some(element))
            }
        };
        let key = key.to_owned();
        is_name(&key).then_some(Self { key, element })
    }
}

impl Setting {
    /// Steps of the path to the value.
    pub fn steps(&self) -> &[KeyStep] {
        &self.steps
    }

    /// Path of the key, as it was given.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// The value in TOML.
    pub fn value(&self) -> &str {
        &self.value
    }

    /// Puts `value` into `root`.
    ///
    /// # Errors
    /// The reason, if the path leads nowhere.
    pub(super) fn put<'t>(
        &self,
        root: &mut DeTable<'t>,
        value: Spanned<DeValue<'t>>,
    ) -> Result<(), String> {
        put_at(&self.steps, root, &value)
    }
}

fn put_at<'t>(
    steps: &[KeyStep],
    table: &mut DeTable<'t>,
    value: &Spanned<DeValue<'t>>,
) -> Result<(), String> {
    let (step, rest) = steps.split_first().ok_or("there is no key")?;
    // The value takes the place of the same in another unit.
    if let ([], None, Some((other, _))) = (rest, step.element, in_other_unit(&step.key)) {
        table.remove(other.as_str());
    }
    for place in step.places(table, value.span())? {
        match (rest, place.get_mut()) {
            ([], _) => *place = value.clone(),
            (_, DeValue::Table(table)) => put_at(rest, table, value)?,
            _ => return Err(format!("`{}` is no table", step.key)),
        }
    }
    Ok(())
}

impl KeyStep {
    /// The values under the step; an empty table where there was none.
    fn places<'a, 't>(
        &self,
        table: &'a mut DeTable<'t>,
        span: std::ops::Range<usize>,
    ) -> Result<&'a mut [Spanned<DeValue<'t>>], String> {
        let key = Spanned::new(span.clone(), self.key.clone().into());
        let Some(element) = self.element else {
            let empty = || Spanned::new(span, DeValue::Table(DeTable::new()));
            return Ok(std::slice::from_mut(table.entry(key).or_insert_with(empty)));
        };
        let Some(list) = table.get_mut(self.key.as_str()) else {
            return Err(format!("there is no list `{}`", self.key));
        };
        let DeValue::Array(list) = list.get_mut() else {
            return Err(format!("`{}` is no list", self.key));
        };
        let (key, count) = (&self.key, list.len());
        match element {
            ListElement::Each if count == 0 => Err(format!("the list `{key}` is empty")),
            ListElement::Each => Ok(&mut **list),
            ListElement::One(number) => list
                .get_mut(number - 1..number)
                .ok_or_else(|| format!("the list `{key}` has {count} elements")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_is_a_path_and_a_value_of_toml() {
        let text = |text: &str| text.parse::<Setting>().map(|it| it.to_string());
        assert_eq!(text("a.b[2].c = 1e-3"), Ok("a.b[2].c = 1e-3".into()));
        assert_eq!(text("number=fixed"), Ok("number = \"fixed\"".into()));
        assert_eq!(text("a=-3"), Ok("a = -3".into()));
        assert_eq!(text("a=true"), Ok("a = true".into()));
        assert_eq!(text("a=[0.0, -9.81]"), Ok("a = [0.0, -9.81]".into()));
        assert_eq!(text("a"), Err(SettingError::NoValue));
        assert_eq!(text("a[*].b=1"), Ok("a[*].b = 1".into()));
        for key in ["", "a..b", "a[0]", "a[**]", "a[x]", "a[1", "a b", "a[1]]"] {
            assert_eq!(text(&format!("{key}=1")), Err(SettingError::Key), "{key}");
        }
        for value in ["", "[1", "1\nb = 2", "1 2", "\"x", "a b"] {
            assert_eq!(
                text(&format!("a={value}")),
                Err(SettingError::Value),
                "{value}"
            );
        }
    }
}
