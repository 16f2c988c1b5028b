//! Types of the messages, as the compiler has them.

use postcard_schema::Schema;
use postcard_schema::schema::{DataModelType, DataModelVariant, NamedType};
use trirrr_core::number::Fixed;
use trirrr_protocol::message::{Message, Request};

pub(super) type SchemaType = &'static NamedType;

/// Part of a message on the line. Machines in fixed point have a type of their own for numbers and for angles: both are told apart.
pub(super) enum TypeKind {
    /// `N`, the machine's number.
    Number,
    /// The machine's angle.
    Angle,
    /// Pose or setpoint, which have a table by hand.
    Composed,
    /// A type with a table of its own.
    Defined,
    Optional(SchemaType),
    Array(SchemaType, usize),
    /// A type of postcard, by its name.
    Plain,
}

pub(super) fn kind(named: SchemaType) -> TypeKind {
    match (named.name, named.ty) {
        ("Fixed", _) => TypeKind::Number,
        ("Turns", _) => TypeKind::Angle,
        ("Pose" | "Setpoint", _) => TypeKind::Composed,
        (
            _,
            DataModelType::Struct(_) | DataModelType::Enum(_) | DataModelType::NewtypeStruct(_),
        ) => TypeKind::Defined,
        (_, DataModelType::Option(inner)) => TypeKind::Optional(inner),
        (_, DataModelType::Tuple(parts)) => TypeKind::Array(parts[0], parts.len()),
        _ => TypeKind::Plain,
    }
}

/// Content of a variant.
pub(super) enum Content {
    Nothing,
    One(SchemaType),
    Fields(Vec<(&'static str, SchemaType)>),
}

/// Form of a defined type.
pub(super) enum Form {
    Struct(Vec<(&'static str, SchemaType)>),
    Enum(Vec<(&'static str, Content)>),
    Newtype(SchemaType),
}

pub(super) fn form(named: SchemaType) -> Form {
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
fn parts(named: SchemaType) -> Vec<SchemaType> {
    let types = |fields: Vec<(&str, SchemaType)>| fields.into_iter().map(|(_, ty)| ty).collect();
    match kind(named) {
        TypeKind::Optional(inner) | TypeKind::Array(inner, _) => vec![inner],
        TypeKind::Defined => match form(named) {
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
pub(super) struct Types(pub(super) Vec<SchemaType>);

impl Types {
    pub(super) fn read() -> Self {
        fn collect(named: SchemaType, found: &mut Vec<SchemaType>) {
            if found.iter().any(|each| each.name == named.name) {
                return;
            }
            for part in parts(named) {
                collect(part, found);
            }
            if matches!(kind(named), TypeKind::Defined) {
                found.push(named);
            }
        }
        let mut found = Vec::new();
        collect(Request::<Fixed>::SCHEMA, &mut found);
        collect(Message::<Fixed>::SCHEMA, &mut found);
        Self(found)
    }

    pub(super) fn named(&self, name: &str) -> Option<SchemaType> {
        self.0.iter().copied().find(|each| each.name == name)
    }

    /// `root` and the defined types in it, in the order in which a reader meets them, without those that `stop` at another place.
    pub(super) fn from(
        &self,
        root: SchemaType,
        stop: &dyn Fn(&str) -> bool,
        found: &mut Vec<SchemaType>,
    ) {
        if matches!(kind(root), TypeKind::Defined) {
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
