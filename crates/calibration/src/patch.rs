//! Changes of values in the text of a scene: everything else stays as it is, comments included.

use toml_edit::{Array, DocumentMut, Formatted, Item, Value};
use trirrr_scene::read::in_other_unit;

/// Text of a scene, or of the file of a machine, whose values are changed.
#[derive(Clone, Debug)]
pub struct ScenePatch {
    document: DocumentMut,
    changes: usize,
}

/// One step of a path such as `machine.leg[1].base_m`.
enum PatchStep<'a> {
    Key(&'a str),
    /// Element of a list, from 0.
    Element(usize),
}

fn steps(path: &str) -> Vec<PatchStep<'_>> {
    let parts = path.split('.').flat_map(|part| match part.split_once('[') {
        None => vec![PatchStep::Key(part)],
        Some((key, rest)) => {
            let number = rest.trim_end_matches(']').parse::<usize>();
            vec![
                PatchStep::Key(key),
                PatchStep::Element(number.unwrap_or(1).max(1) - 1),
            ]
        }
    });
    parts.collect()
}

impl ScenePatch {
    /// Takes the text of a scene.
    ///
    /// # Errors
    /// It is no TOML, in words.
    pub fn of(text: &str) -> Result<Self, String> {
        let document = text.parse::<DocumentMut>();
        Ok(Self {
            document: document.map_err(|error| error.to_string())?,
            changes: 0,
        })
    }

    /// Returns true if the text has the key at `path`; elements of lists are counted from 1.
    pub fn has(&self, path: &str) -> bool {
        self.item(path).is_some()
    }

    fn item(&self, path: &str) -> Option<&Item> {
        let mut item = self.document.as_item();
        for step in steps(path) {
            item = match step {
                PatchStep::Key(key) => item.get(key)?,
                PatchStep::Element(index) => item.get(index)?,
            };
        }
        (!item.is_none()).then_some(item)
    }

    /// Puts a number at `path`, rounded to 12 digits. Returns false where there is no table for the key.
    pub fn put_number(&mut self, path: &str, value: f64) -> bool {
        self.put(path, number(value))
    }

    /// Puts a list of numbers, as [`put_number`](Self::put_number).
    pub fn put_numbers(&mut self, path: &str, values: &[f64]) -> bool {
        let list: Array = values.iter().map(|value| number(*value)).collect();
        self.put(path, Value::Array(list))
    }

    /// Puts a text.
    pub fn put_text(&mut self, path: &str, text: &str) -> bool {
        self.put(path, Value::from(text))
    }

    /// Puts a table on one line.
    pub fn put_table(&mut self, path: &str, values: &[(&str, f64)]) -> bool {
        let table = values.iter().map(|(key, value)| (*key, number(*value)));
        self.put(path, Value::InlineTable(table.collect()))
    }

    /// Adds the tables and keys of `path` that are missing, but no elements of lists, and puts the table of `values` there.
    pub fn add_table(&mut self, path: &str, values: &[(&str, f64)]) -> bool {
        if let Some((parent, _)) = path.rsplit_once('.')
            && !self.has(parent)
        {
            let empty = Value::InlineTable(toml_edit::InlineTable::new());
            if !self.put(parent, empty) {
                return false;
            }
        }
        self.put_table(path, values)
    }

    fn put(&mut self, path: &str, mut value: Value) -> bool {
        let (parent, key) = path.rsplit_once('.').unwrap_or(("", path));
        let mut item = self.document.as_item_mut();
        for step in steps(parent) {
            let next = match step {
                PatchStep::Key("") => continue,
                // A key that is missing would be added.
                PatchStep::Key(key) if item.get(key).is_none() => return false,
                PatchStep::Key(key) => item.get_mut(key),
                PatchStep::Element(index) => item.get_mut(index),
            };
            let Some(next) = next else {
                return false;
            };
            item = next;
        }
        // Values of a table on one line have no line of their own.
        let is_inline = item.is_inline_table();
        let Some(table) = item.as_table_like_mut() else {
            return false;
        };
        if let Some(old) = table.get(key).and_then(Item::as_value) {
            let decor = old.decor();
            let text = |raw: Option<&toml_edit::RawString>| {
                raw.and_then(|raw| raw.as_str())
                    .unwrap_or_default()
                    .to_owned()
            };
            let [before, after] = [text(decor.prefix()), text(decor.suffix())];
            // The old value stays readable, unless it stands inside of a line.
            let mut bare = old.clone();
            bare.decor_mut().clear();
            let was = bare.to_string();
            let after = match is_inline || was.contains(['#', '\n']) {
                true => after,
                false => format!(" # was {was}{after}"),
            };
            *value.decor_mut() = toml_edit::Decor::new(before, after);
        }
        // The same in another unit would be given, too.
        if let Some((other, _)) = in_other_unit(key)
            && let Some(old) = table.remove(&other)
            && !is_inline
            && let Some(old) = old.as_value()
        {
            let mut bare = old.clone();
            bare.decor_mut().clear();
            *value.decor_mut() = toml_edit::Decor::new(" ", format!(" # was {other} = {bare}"));
        }
        table.insert(key, Item::Value(value));
        self.changes += 1;
        true
    }

    /// Values that have been changed.
    pub fn changes(&self) -> usize {
        self.changes
    }

    /// The text, below lines of comment.
    pub fn text(&self, head: &[String]) -> String {
        let head: String = head.iter().map(|line| format!("# {line}\n")).collect();
        format!("{head}{}", self.document)
    }
}

/// Number in at most 12 digits.
fn number(value: f64) -> Value {
    let rounded = format!("{value:.11e}").parse().unwrap_or(value);
    Value::Float(Formatted::new(rounded))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# a machine\nname = \"a\" # its name\n\n[[machine.leg]]\nbase_m = [0.0, 0.433]\nproximal_m = 0.2 # steel\n\n[[machine.leg]]\nproximal_m = 0.3\n\n[homing]\nto = \"switches\"\nangle_rad = 0.5\n\n[links]\nproximal = { mass_kg = 0.1 }\n";

    #[test]
    fn values_change_and_comments_stay() {
        let mut patch = ScenePatch::of(TEXT).expect("TOML");
        assert!(patch.put_number("machine.leg[1].proximal_m", 0.2003));
        assert!(patch.put_numbers("machine.leg[1].base_m", &[1.0, 2.5]));
        assert!(patch.put_numbers("homing.angle_rad", &[0.1, 0.2, 0.3]));
        assert!(patch.put_number("machine.leg[2].distal_m", 1.0 / 3.0));
        assert!(patch.add_table("machine.leg[2].links.distal", &[("mass_kg", 0.25)]));
        assert!(patch.put_number("links.proximal.mass_kg", 0.125));
        assert!(!patch.put_number("machine.leg[3].proximal_m", 0.2));
        assert!(!patch.put_number("drive[1].zero_rad", 0.2));
        assert!(patch.has("homing.angle_rad") && !patch.has("drive"));
        let text = patch.text(&["calibrated".into()]);
        let wanted = "# calibrated\n# a machine\nname = \"a\" # its name\n\n[[machine.leg]]\nbase_m = [1.0, 2.5] # was [0.0, 0.433]\nproximal_m = 0.2003 # was 0.2 # steel\n\n[[machine.leg]]\nproximal_m = 0.3\ndistal_m = 0.333333333333\nlinks = { distal = { mass_kg = 0.25 } }\n\n[homing]\nto = \"switches\"\nangle_rad = [0.1, 0.2, 0.3] # was 0.5\n\n[links]\nproximal = { mass_kg = 0.125 }\n";
        assert_eq!(text, wanted);
        assert!(ScenePatch::of("a = = 1").is_err());
    }

    #[test]
    fn a_value_takes_the_place_of_the_same_in_another_unit() {
        let mut patch = ScenePatch::of("[[machine.leg]]\nproximal_mm = 200\nbase_mm = [0, 433]\n")
            .expect("TOML");
        assert!(patch.put_number("machine.leg[1].proximal_m", 0.2003));
        assert!(patch.put_numbers("machine.leg[1].base_m", &[0.0, 0.4331]));
        let wanted = "[[machine.leg]]\nproximal_m = 0.2003 # was proximal_mm = 200\nbase_m = [0.0, 0.4331] # was base_mm = [0, 433]\n";
        assert_eq!(patch.text(&[]), wanted);
    }
}
