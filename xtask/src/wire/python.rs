//! The messages of the Python client.

use super::numbers;
use super::types::{Content, Form, SchemaType, TypeKind, Types, form, kind};
use trirrr_protocol::message::{BATCH, BLOCK, LEVELS, NAME_CAPACITY, PROTOCOL, TelemetryFields};

pub(super) const MESSAGES: &str = "clients/python/trirrr/messages.py";
pub(super) const TEXTS: &str = "clients/python/trirrr/texts.py";

const HEAD: &str = r#""""The messages of docs/wire.md: fields and variants in their order. Their meanings and units stand there.

Written by ``cargo xtask wire`` from the types of crates/protocol.
"""

from .numbers import POSE, SETPOINT
from .postcard import ANGLE, BOOL, BYTE, F64, I32, N, U16, U32, U64, Bits, Enum, Optional, Sample, Struct, array
"#;

/// Constants of the messages, each with its meaning.
const CONSTANTS: [(&str, &str, u64); 5] = [
    ("PROTOCOL", "Version of the protocol.", PROTOCOL as u64),
    ("BATCH", "Most moves of a batch.", BATCH as u64),
    ("BLOCK", "Most bytes of a block of an image.", BLOCK as u64),
    ("LEVELS", "Most levels of a piece.", LEVELS as u64),
    ("NAME_CAPACITY", "Bytes of a name.", NAME_CAPACITY as u64),
];

/// Columns of a line.
const COLUMNS: usize = 120;

pub(super) fn messages(types: &Types) -> String {
    let mut text = String::from(HEAD);
    for (name, meaning, value) in CONSTANTS {
        text += &format!("\n#: {meaning}\n{name} = {value}\n");
    }
    text += "\n#: Schema keys of the messages, by the number type of the machine.\nSCHEMA = {\n";
    for (machine, _, _, key) in numbers() {
        text += &format!("    \"{machine}\": 0x{key:016X},\n");
    }
    text += "}\n";
    for named in &types.0 {
        text += "\n";
        text += &definition(named);
    }
    text
}

fn definition(named: SchemaType) -> String {
    let name = named.name;
    let assigned =
        |class: &str, arguments: Vec<String>| call(&format!("{name} = {class}"), name, &arguments);
    match form(named) {
        Form::Newtype(inner) => {
            // The one type of bits: each has a name.
            let names = TelemetryFields::NAMES.map(|(field, _)| format!("\"{field}\""));
            let bits = assigned(
                "Bits",
                vec![type_name(inner), format!("({})", names.join(", "))],
            );
            format!(
                "{bits}\n#: All of them.\nALL_FIELDS = {}\n",
                TelemetryFields::ALL.0
            )
        }
        Form::Struct(fields) => {
            let mut arguments: Vec<String> = fields
                .iter()
                .map(|(field, ty)| argument(field, ty))
                .collect();
            // The bits of a field say which of those behind it are there.
            match fields.iter().find(|(_, ty)| ty.name == "TelemetryFields") {
                Some((_, bits)) => {
                    arguments.insert(0, bits.name.into());
                    assigned("Sample", arguments)
                }
                None => assigned("Struct", arguments),
            }
        }
        Form::Enum(variants) => {
            let variant = |(variant, content): (&str, Content)| match content {
                Content::Nothing => format!("{variant}=None"),
                Content::One(inner) => format!("{variant}={}", type_name(inner)),
                Content::Fields(fields) => {
                    let each = |(field, ty): &(&str, SchemaType)| {
                        format!("\"{field}\": {}", type_name(ty))
                    };
                    format!(
                        "{variant}={{{}}}",
                        fields.iter().map(each).collect::<Vec<_>>().join(", ")
                    )
                }
            };
            assigned("Enum", variants.into_iter().map(variant).collect())
        }
    }
}

/// A call with the type's name as its first argument: on one line, or with a line for each argument.
fn call(before: &str, name: &str, arguments: &[String]) -> String {
    let line = format!("{before}(\"{name}\", {})\n", arguments.join(", "));
    match line.len() <= COLUMNS {
        true => line,
        false => format!(
            "{before}(\n    \"{name}\",\n    {},\n)\n",
            arguments.join(",\n    ")
        ),
    }
}

/// A field. A keyword of Python has an underscore behind it.
fn argument(field: &str, ty: SchemaType) -> String {
    let keyword = if field == "from" { "_" } else { "" };
    format!("{field}{keyword}={}", type_name(ty))
}

fn type_name(named: SchemaType) -> String {
    match (kind(named), named.name) {
        (TypeKind::Number, _) => "N".into(),
        (TypeKind::Angle, _) => "ANGLE".into(),
        (TypeKind::Optional(inner), _) => format!("Optional({})", type_name(inner)),
        (TypeKind::Array(inner, count), _) => format!("array({}, {count})", type_name(inner)),
        (TypeKind::Defined, name) => name.into(),
        (_, "u8") => "BYTE".into(),
        (TypeKind::Composed | TypeKind::Plain, name) => name.to_uppercase(),
    }
}
