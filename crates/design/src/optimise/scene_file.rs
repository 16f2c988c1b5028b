//! Files of a scene with other values in them: comments and order stay.

use std::path::Path;
use toml_edit::{DocumentMut, Item, Table, Value};
use trirrr_scene::read::{KeyStep, ListElement, Setting, in_other_unit, machine_path, on_disk};

/// Key of the machine's file in a scene.
const MACHINE: &str = "machine";

/// Scene with other values: its own text, and that of its machine where it has a file of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct EditedScene {
    /// Text of the scene.
    pub scene: String,
    /// Text of the machine's file, which the scene names as it was asked to.
    pub machine: Option<String>,
}

fn document(text: &str, file: &str) -> Result<DocumentMut, String> {
    text.parse()
        .map_err(|error: toml_edit::TomlError| format!("{file}: {}", error.message()))
}

/// Text of the file that the scene in `file` names as its machine, if it does.
fn machine_text(scene: &DocumentMut, file: &str) -> Result<Option<(String, String)>, String> {
    let Some(name) = scene.get(MACHINE).and_then(Item::as_str) else {
        return Ok(None);
    };
    let path = machine_path(Path::new(file), name);
    let text = on_disk(&path)?;
    Ok(Some((path.display().to_string(), text)))
}

/// Writes `settings` into the scene in `text`, in their order. A value of a machine in a file of its own goes into the text of that file;
/// the scene names it `machine_name`.
///
/// # Errors
/// The file and the reason, if a text is no TOML or a path leads nowhere.
pub fn with_values(
    text: &str,
    file: &str,
    settings: &[Setting],
    machine_name: &str,
) -> Result<EditedScene, String> {
    let mut scene = document(text, file)?;
    let mut machine = match machine_text(&scene, file)? {
        Some((path, text)) => Some(document(&text, &path)?),
        None => None,
    };
    for setting in settings {
        let value: Value = setting
            .value()
            .parse()
            .map_err(|error: toml_edit::TomlError| {
                format!("{}: {}", setting.key(), error.message())
            })?;
        let first = setting.steps().first().map(|step| step.key.as_str());
        // As the reader: a table of the scene goes before that of the machine's file.
        let is_of_machine =
            first.is_some_and(|first| first == MACHINE || !scene.contains_key(first));
        let root = match &mut machine {
            Some(machine) if is_of_machine => machine,
            _ => &mut scene,
        };
        put(setting.steps(), root.as_item_mut(), &value)
            .map_err(|reason| format!("{}: {reason}", setting.key()))?;
    }
    if machine.is_some() {
        scene[MACHINE] = toml_edit::value(machine_name);
    }
    Ok(EditedScene {
        scene: scene.to_string(),
        machine: machine.map(|machine| machine.to_string()),
    })
}

/// Number under the key of `setting` in the scene in `text` or in the file of its machine; of several elements, the first.
///
/// # Errors
/// The file and the reason, if a text is no TOML.
pub fn own_value(text: &str, file: &str, setting: &Setting) -> Result<Option<f64>, String> {
    let mut scene = document(text, file)?;
    if let Some(value) = number(setting.steps(), scene.as_item_mut()) {
        return Ok(Some(value));
    }
    let Some((path, text)) = machine_text(&scene, file)? else {
        return Ok(None);
    };
    let mut machine = document(&text, &path)?;
    Ok(number(setting.steps(), machine.as_item_mut()))
}

fn number(steps: &[KeyStep], item: &mut Item) -> Option<f64> {
    let Some((step, rest)) = steps.split_first() else {
        return item
            .as_float()
            .or(item.as_integer().map(|whole| whole as f64));
    };
    let table = item.as_table_like_mut()?;
    if let ([], None, false) = (rest, step.element, table.contains_key(&step.key))
        && let Some((other, to_own)) = in_other_unit(&step.key)
    {
        return number(rest, table.get_mut(&other)?).map(to_own);
    }
    let next = table.get_mut(&step.key)?;
    let index = match step.element {
        None => return number(rest, next),
        Some(ListElement::One(number)) => number - 1,
        Some(ListElement::Each) => 0,
    };
    match next {
        Item::ArrayOfTables(tables) => {
            let table = tables.get_mut(index)?;
            let mut item = Item::Table(table.clone());
            number(rest, &mut item)
        }
        Item::Value(Value::Array(array)) => {
            let mut item = Item::Value(array.get(index)?.clone());
            number(rest, &mut item)
        }
        _ => None,
    }
}

/// Puts `value` where `steps` lead from `item`.
fn put(steps: &[KeyStep], item: &mut Item, value: &Value) -> Result<(), String> {
    let Some((step, rest)) = steps.split_first() else {
        // White space and a comment behind the old value stay.
        let mut value = value.clone();
        if let Some(old) = item.as_value() {
            *value.decor_mut() = old.decor().clone();
        }
        *item = Item::Value(value);
        return Ok(());
    };
    let key = &step.key;
    let table = item
        .as_table_like_mut()
        .ok_or_else(|| format!("there is no table of `{key}`"))?;
    let Some(element) = step.element else {
        // The value takes the place of the same in another unit.
        if let ([], Some((other, _))) = (rest, in_other_unit(key)) {
            table.remove(&other);
        }
        let next = table.entry(key).or_insert_with(|| match rest {
            [] => Item::None,
            _ => Item::Table(Table::new()),
        });
        return put(rest, next, value);
    };
    let list = table
        .get_mut(key)
        .ok_or_else(|| format!("there is no list `{key}`"))?;
    let is_meant = |index: usize| match element {
        ListElement::Each => true,
        ListElement::One(number) => number == index + 1,
    };
    let mut found = false;
    match list {
        Item::ArrayOfTables(tables) => {
            for (index, table) in tables.iter_mut().enumerate() {
                if is_meant(index) {
                    found = true;
                    let mut item = Item::Table(std::mem::take(table));
                    let done = put(rest, &mut item, value);
                    if let Item::Table(changed) = item {
                        *table = changed;
                    }
                    done?;
                }
            }
        }
        Item::Value(Value::Array(array)) => {
            for (index, old) in array.iter_mut().enumerate() {
                if is_meant(index) {
                    found = true;
                    let mut item = Item::Value(old.clone());
                    put(rest, &mut item, value)?;
                    if let Item::Value(changed) = item {
                        *old = changed;
                    }
                }
            }
        }
        _ => return Err(format!("`{key}` is no list")),
    }
    match found {
        true => Ok(()),
        false => Err(format!("the list `{key}` has no such element")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# A machine.\nname = \"a\"\n\n[[leg]]\nbase_m = [0.0, 0.7] # left\nl = 0.3 # short\n\n[[leg]]\nbase_m = [0.8, 0.7]\nl = 0.3\n\n[platform]\nmass_kg = 1 # heavy\nlinks = { a = { m = 2.0 } }\n";

    fn set(settings: &[&str]) -> Result<String, String> {
        let settings: Vec<Setting> = settings.iter().map(|each| each.parse().unwrap()).collect();
        with_values(TEXT, "a.toml", &settings, "m.toml").map(|edited| edited.scene)
    }

    #[test]
    fn values_change_and_all_else_stays() {
        let text = set(&[
            "leg[*].l=0.25",
            "leg[2].base_m[1]=0.9",
            "platform.mass_kg=1.5",
            "platform.links.a.m=3.0",
            "limits.torque_nm=4.0",
        ])
        .unwrap();
        let expected = TEXT
            .replace("l = 0.3", "l = 0.25")
            .replace("[0.8, 0.7]", "[0.9, 0.7]")
            .replace("mass_kg = 1 ", "mass_kg = 1.5 ")
            .replace("m = 2.0", "m = 3.0");
        assert_eq!(text, expected + "\n[limits]\ntorque_nm = 4.0\n");
        for (wrong, part) in [
            ("leg[3].l=1", "no such element"),
            ("name[1]=1", "no list"),
            ("name.x=1", "no table"),
            ("legs[1].l=1", "no list"),
        ] {
            assert!(set(&[wrong]).unwrap_err().contains(part), "{wrong}");
        }
    }

    #[test]
    fn own_values_are_read_where_they_stand() {
        for (key, value) in [
            ("leg[*].l", Some(0.3)),
            ("leg[2].base_m[1]", Some(0.8)),
            ("platform.mass_kg", Some(1.0)),
            ("platform.links.a.m", Some(2.0)),
            ("platform.none", None),
            ("name", None),
        ] {
            let setting: Setting = format!("{key}=0").parse().unwrap();
            assert_eq!(own_value(TEXT, "a.toml", &setting), Ok(value), "{key}");
        }
    }
}
