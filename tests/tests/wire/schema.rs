//! The tables of the messages, and the schema keys.

use super::document;
use postcard_schema::Schema;
use postcard_schema::schema::{DataModelType, DataModelVariant, NamedType, NamedValue};
use std::collections::BTreeMap;
use trirrr_core::number::{Coarse, Fixed};
use trirrr_protocol::message::{Message, PROTOCOL, Request, Transmit};
use trirrr_protocol::wire::schema::key;

/// Types whose parts are given in a table of their own, with the numbers.
const COMPOSED: [&str; 2] = ["Pose", "Setpoint"];

type Types = BTreeMap<&'static str, &'static DataModelType>;

/// A type as the document writes it. `N` and `Angle` are f32 here.
fn name(named: &'static NamedType) -> String {
    match named.ty {
        DataModelType::Tuple(parts) if !COMPOSED.contains(&named.name) => {
            format!("[{}; {}]", name(parts[0]), parts.len())
        }
        DataModelType::Option(inner) => format!("{}?", name(inner)),
        _ => named.name.into(),
    }
}

/// Collects every struct and enum in `named`.
fn collect(named: &'static NamedType, types: &mut Types) {
    let fields = |fields: &[&'static NamedValue], types: &mut Types| {
        for field in fields {
            collect(field.ty, types);
        }
    };
    match named.ty {
        DataModelType::Struct(inner) => {
            types.insert(named.name, named.ty);
            fields(inner, types);
        }
        DataModelType::Enum(variants) => {
            types.insert(named.name, named.ty);
            for variant in *variants {
                match variant.ty {
                    DataModelVariant::UnitVariant => {}
                    DataModelVariant::NewtypeVariant(inner) => collect(inner, types),
                    DataModelVariant::StructVariant(inner) => fields(inner, types),
                    DataModelVariant::TupleVariant(_) => {
                        panic!("{}: the document has no word for it", named.name)
                    }
                }
            }
        }
        DataModelType::NewtypeStruct(_) => _ = types.insert(named.name, named.ty),
        DataModelType::Option(inner) => collect(inner, types),
        DataModelType::Tuple(parts) => parts.iter().for_each(|part| collect(part, types)),
        _ => {}
    }
}

/// The rows of the table of a type, without what they mean.
fn rows(ty: &'static DataModelType) -> Vec<Vec<String>> {
    match ty {
        DataModelType::Struct(fields) => fields
            .iter()
            .map(|field| vec![field.name.into(), name(field.ty)])
            .collect(),
        DataModelType::Enum(variants) => variants
            .iter()
            .enumerate()
            .map(|(number, variant)| {
                let content = match variant.ty {
                    DataModelVariant::NewtypeVariant(inner) => name(inner),
                    DataModelVariant::StructVariant(fields) => {
                        let field =
                            |field: &&NamedValue| format!("{}: {}", field.name, name(field.ty));
                        fields.iter().map(field).collect::<Vec<_>>().join(", ")
                    }
                    _ => String::new(),
                };
                vec![number.to_string(), variant.name.into(), content]
            })
            .collect(),
        _ => Vec::new(),
    }
}

#[test]
fn the_tables_are_those_of_the_types() {
    let mut types = Types::new();
    collect(Request::<f32>::SCHEMA, &mut types);
    collect(Message::<f32>::SCHEMA, &mut types);
    assert!(types.len() > 20, "{types:?}");
    let text = document::text();
    for (type_name, ty) in types {
        let expected = rows(ty);
        if expected.is_empty() {
            continue;
        }
        let columns = expected[0].len();
        let mut found = document::table(&text, type_name);
        for row in &mut found {
            assert!(
                row.len() == columns + 1,
                "{type_name}: {row:?} has not {columns} columns and a meaning"
            );
            row.truncate(columns);
            // The number types of the machine that the types are taken of.
            let types = row.last_mut().expect("there are columns");
            *types = types
                .split_inclusive(|letter: char| !letter.is_alphanumeric())
                .map(
                    |word| match word.trim_end_matches(|c: char| !c.is_alphanumeric()) {
                        "N" | "Angle" => word.replace("Angle", "f32").replace('N', "f32"),
                        _ => word.into(),
                    },
                )
                .collect();
        }
        assert_eq!(found, expected, "docs/wire.md, {type_name}");
    }
}

/// A struct of one unnamed part feeds a byte of its own: a client that does not know which types these are computes other
/// keys.
#[test]
fn the_schema_key_names_the_types_that_wrap_a_number() {
    let mut types = Types::new();
    collect(Request::<f32>::SCHEMA, &mut types);
    collect(Message::<f32>::SCHEMA, &mut types);
    let text = document::text();
    let row = text.lines().find(|line| line.contains("| 9D, "));
    let row = row.expect("the row of the byte 9D");
    let wraps = types
        .iter()
        .filter(|(_, ty)| matches!(ty, DataModelType::NewtypeStruct(_)));
    let names: Vec<_> = wraps.map(|(name, _)| *name).collect();
    assert!(!names.is_empty());
    for name in names {
        assert!(row.contains(name), "{row} does not name {name}");
    }
}

#[test]
fn the_version_is_that_of_the_protocol() {
    let text = document::text();
    let words = "Version of this protocol: ";
    let versions: Vec<&str> = text.split(words).skip(1).collect();
    assert_eq!(versions.len(), 2, "of the hello and of its answer");
    for version in versions {
        assert!(
            version.starts_with(&format!("{PROTOCOL}.")),
            "{words}{version:.4}"
        );
    }
}

#[test]
fn the_keys_are_those_of_the_types() {
    let row = |machine: &str, number: &str, angle: &str, key: u64| {
        format!("| {machine} | {number} | {angle} | 0x{key:016X} |\n")
    };
    fn of<N: Transmit>() -> u64 {
        key::<Request<N>, Message<N>>()
    }
    let expected = [
        row("f64", "f64", "f64, rad", of::<f64>()),
        row("f32", "f32", "f32, rad", of::<f32>()),
        row("micromath", "f32", "f32, rad", of::<Coarse>()),
        row(
            "fixed",
            "i32, in 2^-29",
            "i64, in 2^-32 of a turn",
            of::<Fixed>(),
        ),
    ];
    let head = "| machine | N | Angle | schema key |\n|---|---|---|---|\n";
    document::compare(head, "\nThe key is", &expected.concat());
}
