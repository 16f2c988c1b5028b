//! A part of the scene on the line of a machine that only passes it on: an image whose scene cannot
//! be changed holds no code to read or to write a [`Section`], nor room for one. The layout is the
//! same.

use super::scene::Section;
use core::fmt;
use postcard_schema::Schema;
use postcard_schema::schema::NamedType;
use serde::de::{DeserializeOwned, Deserializer, SeqAccess, Visitor};
use serde::ser::{SerializeTuple, Serializer};
use serde::{Deserialize, Serialize};

/// Type as which a part of the scene in a request is read.
pub trait Replacement: DeserializeOwned + Schema {
    /// The part; none where it was not read.
    fn section(&self) -> Option<&Section>;
}

impl Replacement for Section {
    fn section(&self) -> Option<&Section> {
        Some(self)
    }
}

/// A [`Section`] in a request to a machine that takes none: its bytes, which end the message, are left
/// out whatever they say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unread;

impl Replacement for Unread {
    #[inline(always)]
    fn section(&self) -> Option<&Section> {
        None
    }
}

impl Schema for Unread {
    const SCHEMA: &'static NamedType = Section::SCHEMA;
}

impl<'de> Deserialize<'de> for Unread {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Rest;

        impl<'de> Visitor<'de> for Rest {
            type Value = Unread;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a part of a scene")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut bytes: A) -> Result<Unread, A::Error> {
                // Up to the end of the message, which is an error of no concern.
                while let Ok(Some(_)) = bytes.next_element::<u8>() {}
                Ok(Unread)
            }
        }

        deserializer.deserialize_tuple(usize::MAX, Rest)
    }
}

/// A [`Section`] in a reply, as the bytes that it is sent as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written<'a>(pub &'a [u8]);

impl Schema for Written<'_> {
    const SCHEMA: &'static NamedType = Section::SCHEMA;
}

impl Serialize for Written<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // A tuple has no length in front.
        let mut bytes = serializer.serialize_tuple(self.0.len())?;
        for byte in self.0 {
            bytes.serialize_element(byte)?;
        }
        bytes.end()
    }
}
