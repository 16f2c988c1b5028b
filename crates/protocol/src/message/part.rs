//! Contents of a request on the line of a machine that takes none such: an image whose scene cannot be changed
//! holds no code to read or to write a [`Section`], nor room for one, and one that plays no quintics, or takes no batches of moves, none for those.
//! The layout is the same.

use super::scene::Section;
use core::fmt;
use core::marker::PhantomData;
use postcard_schema::Schema;
use postcard_schema::schema::NamedType;
use serde::de::{DeserializeOwned, Deserializer, SeqAccess, Visitor};
use serde::ser::{SerializeTuple, Serializer};
use serde::{Deserialize, Serialize};

/// Type as which a `T` in a request is read.
pub trait Content<T>: Copy + fmt::Debug + PartialEq + DeserializeOwned + Schema {
    /// True where the content is read.
    const IS_READ: bool;

    /// The content; none where it was not read.
    fn content(&self) -> Option<&T>;
}

impl<T: Copy + fmt::Debug + PartialEq + DeserializeOwned + Schema> Content<T> for T {
    const IS_READ: bool = true;

    fn content(&self) -> Option<&T> {
        Some(self)
    }
}

/// A `T` in a request to a machine that takes none: its bytes, which end the message, are left
/// out whatever they say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unread<T = Section>(PhantomData<T>);

impl<T> Unread<T> {
    /// The content that was left out.
    pub const CONTENT: Self = Self(PhantomData);
}

impl<T: Copy + fmt::Debug + PartialEq + Schema> Content<T> for Unread<T> {
    const IS_READ: bool = false;

    #[inline(always)]
    fn content(&self) -> Option<&T> {
        None
    }
}

impl<T: Schema> Schema for Unread<T> {
    const SCHEMA: &'static NamedType = T::SCHEMA;
}

impl<'de, T> Deserialize<'de> for Unread<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(usize::MAX, Rest)?;
        Ok(Self::CONTENT)
    }
}

/// The bytes up to the end of the message.
struct Rest;

impl<'de> Visitor<'de> for Rest {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("bytes")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut bytes: A) -> Result<(), A::Error> {
        // The end of the message is an error of no concern.
        while let Ok(Some(_)) = bytes.next_element::<u8>() {}
        Ok(())
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
