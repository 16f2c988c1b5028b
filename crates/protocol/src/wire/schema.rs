//! A message type's shape as a value: its key and its greatest length.
//!
//! Both follow from the type itself through [`Schema`], so that none can fall behind a
//! message that is changed.

use postcard_schema::key::Key;
use postcard_schema::schema::{DataModelType, DataModelVariant, NamedType, NamedValue};

pub use postcard_schema::Schema;

/// Key of what a device and a client say to each other: FNV-1a over the names, types and order of
/// all fields and variants in `Request` and `Response`. Two programs with the same key read each
/// other's messages; one whose messages were changed has another key. The names of the types
/// themselves do not count.
pub const fn key<Request: Schema, Response: Schema>() -> u64 {
    // The tuple ties both together in their order.
    u64::from_le_bytes(Key::for_path::<(Request, Response)>("trirrr").to_bytes())
}

/// Most bytes that a message of type `T` takes, checksum and COBS not included.
///
/// # Panics
/// If `T` has no bound: it holds a string, a sequence or a map. Meant for constants, where that is
/// an error of compilation.
pub const fn longest<T: Schema>() -> usize {
    longest_type(T::SCHEMA)
}

const fn longest_type(named: &NamedType) -> usize {
    match named.ty {
        DataModelType::Bool | DataModelType::I8 | DataModelType::U8 => 1,
        // A varint carries 7 bits in a byte.
        DataModelType::I16 | DataModelType::U16 => 3,
        DataModelType::I32 | DataModelType::U32 => 5,
        DataModelType::I64 | DataModelType::U64 => 10,
        DataModelType::I128 | DataModelType::U128 => 19,
        DataModelType::F32 => 4,
        DataModelType::F64 => 8,
        // A length and up to four bytes of UTF-8.
        DataModelType::Char => 5,
        DataModelType::Option(inner) => 1 + longest_type(inner),
        DataModelType::Unit | DataModelType::UnitStruct => 0,
        DataModelType::NewtypeStruct(inner) => longest_type(inner),
        DataModelType::Tuple(parts) | DataModelType::TupleStruct(parts) => longest_parts(parts),
        DataModelType::Struct(fields) => longest_fields(fields),
        DataModelType::Enum(variants) => {
            let mut longest = 0;
            let mut index = 0;
            while index < variants.len() {
                let length = varint_length(index)
                    + match variants[index].ty {
                        DataModelVariant::UnitVariant => 0,
                        DataModelVariant::NewtypeVariant(inner) => longest_type(inner),
                        DataModelVariant::TupleVariant(parts) => longest_parts(parts),
                        DataModelVariant::StructVariant(fields) => longest_fields(fields),
                    };
                if length > longest {
                    longest = length;
                }
                index += 1;
            }
            longest
        }
        _ => panic!("a message of unbounded length"),
    }
}

const fn longest_parts(parts: &[&NamedType]) -> usize {
    let mut sum = 0;
    let mut index = 0;
    while index < parts.len() {
        sum += longest_type(parts[index]);
        index += 1;
    }
    sum
}

const fn longest_fields(fields: &[&NamedValue]) -> usize {
    let mut sum = 0;
    let mut index = 0;
    while index < fields.len() {
        sum += longest_type(fields[index].ty);
        index += 1;
    }
    sum
}

const fn varint_length(mut value: usize) -> usize {
    let mut length = 1;
    while value >= 0x80 {
        value >>= 7;
        length += 1;
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::{decoded_length, encode, frame_length};
    use serde::Serialize;

    #[test]
    fn a_varint_has_seven_bits_a_byte() {
        let lengths = [0, 0x7F, 0x80, 0x3FFF, 0x4000].map(varint_length);
        assert_eq!(lengths, [1, 1, 2, 2, 3]);
    }

    #[derive(Schema, Serialize)]
    struct Plain {
        a: u32,
        b: [f32; 3],
    }

    #[derive(Schema, Serialize)]
    struct Renamed {
        a: u32,
        c: [f32; 3],
    }

    #[derive(Schema, Serialize)]
    struct Swapped {
        b: [f32; 3],
        a: u32,
    }

    #[derive(Schema, Serialize)]
    struct Wider {
        a: u32,
        b: [f64; 3],
    }

    #[derive(Schema, Serialize)]
    struct Alike {
        a: u32,
        b: [f32; 3],
    }

    /// The one without a value is not the longest, wherever it stands.
    #[derive(Schema, Serialize)]
    #[expect(dead_code, reason = "shapes without a value of theirs")]
    enum Outcome<N> {
        Ok(N),
        None,
    }

    #[derive(Schema, Serialize)]
    #[expect(dead_code, reason = "shapes without a value of theirs")]
    enum Choice<N> {
        One(N),
        Both { x: Option<N>, y: i64 },
    }

    #[test]
    fn whatever_changes_in_a_message_changes_the_key() {
        let keys = [
            key::<Plain, ()>(),
            key::<Renamed, ()>(),
            key::<Swapped, ()>(),
            key::<Wider, ()>(),
            key::<(), Plain>(),
            key::<Plain, Plain>(),
            key::<Choice<f32>, Plain>(),
            key::<Choice<f64>, Plain>(),
            key::<Outcome<f64>, Plain>(),
        ];
        for (index, one) in keys.iter().enumerate() {
            assert!(!keys[..index].contains(one), "{index}");
        }
        assert_eq!(key::<Plain, ()>(), key::<Alike, ()>());
    }

    /// The values with the longest encodings, and what the bound says.
    #[test]
    fn the_longest_message_is_as_long_as_the_bound() {
        fn longest_is<T: Schema + Serialize>(message: &T) {
            let bytes = longest::<T>();
            let mut room = [0; 128];
            let plain = postcard::to_slice(message, &mut room).unwrap();
            assert_eq!(plain.len(), bytes);
            let room = &mut [0; 128][..frame_length(bytes)];
            let frame = encode(message, room).unwrap();
            // COBS adds one byte up to 254, the frame its zero.
            assert_eq!(frame.len(), decoded_length(bytes) + 2);
        }
        longest_is(&Plain {
            a: u32::MAX,
            b: [1.0; 3],
        });
        longest_is(&Choice::Both {
            x: Some(1.0f64),
            y: i64::MIN,
        });
        longest_is(&[Outcome::Ok(i128::MIN), Outcome::Ok(i128::MAX)]);
        longest_is(&(u16::MAX, i16::MIN, true, u8::MAX, '\u{10FFFF}', u128::MAX));
        longest_is(&[i32::MIN; 5]);
        longest_is(&Outcome::Ok([i128::MIN; 2]));
    }
}
