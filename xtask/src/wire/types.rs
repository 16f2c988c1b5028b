//! Types of the messages, as the compiler has them.

use postcard_schema::Schema;
use postcard_schema::schema::{DataModelType, DataModelVariant, NamedType};
use trirrr_core::number::Fixed;
use trirrr_protocol::message::{Message, Request};

pub(super) type Named = &'static NamedType;

/// Part of a message on the line. Machines in fixed point have a type of their own for numbers and for angles: both are told apart.
pub(super) enum Kind {
    /// `N`, the machine's number.
    Number,
    /// The machine's angle.
    Angle,
    /// Pose or setpoint, which have a table by hand.
    Composed,
    /// A type with a table of its own.
    Defined,
    Optional(Named),
    Array(Named, usize),
    /// A type of postcard, by its name.
    Plain,
}

pub(super) fn kind(named: Named) -> Kind {
    match (named.name, named.ty) {
        ("Fixed", _) => Kind::Number,
        ("Turns", _) => Kind::Angle,
        ("Pose" | "Setpoint", _) => Kind::Composed,
        (
            _,
            DataModelType::Struct(_) | DataModelType::Enum(_) | DataModelType::NewtypeStruct(_),
        ) => Kind::Defined,
        (_, DataModelType::Option(inner)) => Kind::Optional(inner),
        (_, DataModelType::Tuple(parts)) => Kind::Array(parts[0], parts.len()),
        _ => Kind::Plain,
    }
}

/// Content of a variant.
pub(super) enum Content {
    Nothing,
    One(Named),
    Fields(Vec<(&'static str, Named)>),
}

/// Form of a defined type.
pub(super) enum Form {
    Struct(Vec<(&'static str, Named)>),
    Enum(Vec<(&'static str, Content)>),
    Newtype(Named),
}

pub(super) fn form(named: Named) -> Form {
    let fields = |fields: &[&'static postcard_schema::schema::NamedValue]| {
        fields.iter().map(|field| (field.name, field.ty)).collect()
    };
    match named.ty {
        DataModelType::Struct(inner) => Form::Struct(fields(inner)),
        DataModelType::NewtypeStruct(inner) => Form::Newtype(inner),
        DataModelType::Enum(variants) => {
            let content = |ty: &'static DataModelVariant| match ty {
                DataModelVariant::UnitVariant => Content::Nothing,
                DataModelVariant::NewtypeVariant(inner) => Content::One(inner),
                DataModelVariant::StructVariant(inner) => Content::Fields(fields(inner)),
                DataModelVariant::TupleVariant(_) => {
                    panic!("{}: the reference has no word for a tuple", named.name)
                }
            };
            Form::Enum(
                variants
                    .iter()
                    .map(|variant| (variant.name, content(variant.ty)))
                    .collect(),
            )
        }
        _ => panic!("{} is not a type of its own", named.name),
    }
}

/// Types that a type consists of.
fn parts(named: Named) -> Vec<Named> {
    let types = |fields: Vec<(&str, Named)>| fields.into_iter().map(|(_, ty)| ty).collect();
    match kind(named) {
        Kind::Optional(inner) | Kind::Array(inner, _) => vec![inner],
        Kind::Defined => match form(named) {
            Form::Struct(fields) => types(fields),
            Form::Newtype(inner) => vec![inner],
            Form::Enum(variants) => {
                let of = |(_, content)| match content {
                    Content::Nothing => Vec::new(),
                    Content::One(inner) => vec![inner],
                    Content::Fields(fields) => types(fields),
                };
                variants.into_iter().flat_map(of).collect()
            }
        },
        _ => Vec::new(),
    }
}

/// Defined types of all messages, each behind those that it consists of.
pub(super) struct Types(pub(super) Vec<Named>);

impl Types {
    pub(super) fn read() -> Self {
        fn collect(named: Named, found: &mut Vec<Named>) {
            if found.iter().any(|each| each.name == named.name) {
                return;
            }
            for part in parts(named) {
                collect(part, found);
            }
            if matches!(kind(named), Kind::Defined) {
                found.push(named);
            }
        }
        let mut found = Vec::new();
        collect(Request::<Fixed>::SCHEMA, &mut found);
        collect(Message::<Fixed>::SCHEMA, &mut found);
        Self(found)
    }

    pub(super) fn named(&self, name: &str) -> Option<Named> {
        self.0.iter().copied().find(|each| each.name == name)
    }

    /// `root` and the defined types in it, in the order in which a reader meets them, without those that `stop` at another place.
    pub(super) fn from(&self, root: Named, stop: &dyn Fn(&str) -> bool, found: &mut Vec<Named>) {
        if matches!(kind(root), Kind::Defined) {
            if found.iter().any(|each| each.name == root.name) {
                return;
            }
            found.push(root);
        }
        for part in parts(root) {
            if !stop(part.name) {
                self.from(part, stop, found);
            }
        }
    }
}
