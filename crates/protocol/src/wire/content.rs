//! Values as bytes, without a frame.

use super::BufferTooSmall;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Writes `value` to the start of `buffer` as a message has it, and returns the bytes.
///
/// # Errors
/// [`BufferTooSmall`].
pub fn to_bytes<'b, T: Serialize>(
    value: &T,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], BufferTooSmall> {
    let bytes = buffer.len();
    match postcard::to_slice(value, buffer) {
        Ok(written) => Ok(written),
        Err(_) => Err(BufferTooSmall { bytes }),
    }
}

/// Reads a value of all `bytes`. `None` if they are none, or more.
pub fn of_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let (value, rest) = postcard::take_from_bytes(bytes).ok()?;
    rest.is_empty().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_comes_back_of_its_own_bytes_alone() {
        let value = (7u32, [1.5f64, -0.0], Some(300u16));
        let mut room = [0; 32];
        let bytes = to_bytes(&value, &mut room).expect("room").to_vec();
        assert_eq!(of_bytes(&bytes), Some(value));
        let longer = [&bytes[..], &[0]].concat();
        assert_eq!(of_bytes::<(u32, [f64; 2], Option<u16>)>(&longer), None);
        let shorter = &bytes[..bytes.len() - 1];
        assert_eq!(of_bytes::<(u32, [f64; 2], Option<u16>)>(shorter), None);
        let error = to_bytes(&value, &mut room[..4]);
        assert_eq!(error, Err(BufferTooSmall { bytes: 4 }));
    }
}
