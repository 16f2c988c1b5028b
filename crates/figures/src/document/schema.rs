//! JSON Schema of the objects of documents, from examples of them. The ends of keys tell units.

use super::quantity::unit_of;
use serde_json::{Map, Value, json};

/// Address of the dialect.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Schema that `examples` keep, of the object that is called `title`.
pub fn of(title: &str, examples: &[Value]) -> Value {
    let mut schema = kind(None, &examples.iter().collect::<Vec<_>>());
    if let Value::Object(schema) = &mut schema {
        schema.insert("$schema".into(), DIALECT.into());
        schema.insert("title".into(), title.into());
    }
    schema
}

fn name(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(number) if number.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    }
}

/// Schema of the values at one place. `unit` is that of the numbers there.
fn kind(unit: Option<&str>, values: &[&Value]) -> Value {
    let mut names: Vec<&str> = values.iter().map(|value| name(value)).collect();
    names.sort_unstable();
    names.dedup();
    if names.contains(&"number") {
        names.retain(|name| *name != "integer");
    }
    let mut schema = Map::new();
    let objects: Vec<&Map<String, Value>> = values
        .iter()
        .filter_map(|value| value.as_object())
        .collect();
    let items: Vec<&Value> = values
        .iter()
        .filter_map(|value| value.as_array())
        .flatten()
        .collect();
    if !objects.is_empty() {
        let keys = objects.iter().flat_map(|object| object.keys());
        let property = |key: &String| {
            let found: Vec<&Value> = objects
                .iter()
                .filter_map(|object| object.get(key))
                .collect();
            (key.clone(), kind(unit_of(key).or(unit), &found))
        };
        schema.insert(
            "properties".into(),
            keys.clone().map(property).collect::<Map<_, _>>().into(),
        );
        let mut always: Vec<&String> = keys
            .filter(|key| objects.iter().all(|object| object.contains_key(*key)))
            .collect();
        always.sort_unstable();
        always.dedup();
        schema.insert(
            "required".into(),
            always.into_iter().map(String::as_str).collect(),
        );
        schema.insert("additionalProperties".into(), false.into());
    }
    if !items.is_empty() {
        schema.insert("items".into(), kind(unit, &items));
    }
    if let Some(unit) = unit.filter(|_| names.contains(&"number")) {
        schema.insert("x-unit".into(), unit.into());
    }
    // Without an example of another kind, null alone tells nothing of the value.
    match names.as_slice() {
        [one] => schema.insert("type".into(), json!(one)),
        names => schema.insert("type".into(), json!(names)),
    };
    schema.into()
}
