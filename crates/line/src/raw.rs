//! Messages that are passed on and not read.

use crate::Frames;
use crate::frames::MESSAGE_BYTES;
use serde::de::{Deserialize, DeserializeOwned, Deserializer, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeTuple, Serializer};
use std::fmt;

/// Bytes of a message of either side, in any number type. Its frame is that of the message itself: whoever passes messages on
/// checks frames, and needs no number type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawMessage(Vec<u8>);

impl RawMessage {
    /// Returns the bytes; at least one.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// Returns the bytes of `message`. `None` where it is longer than any message.
    pub fn of<T: Serialize>(message: &T) -> Option<Self> {
        converted(message)
    }

    /// Reads the message as a `T`. `None` where it is none.
    pub fn read<T: DeserializeOwned>(&self) -> Option<T> {
        converted(self)
    }
}

/// Reads `message` as another type that has the same bytes, over the frame that both have.
fn converted<T: Serialize, U: DeserializeOwned>(message: &T) -> Option<U> {
    let mut frame = Vec::new();
    Frames::append(message, &mut frame);
    let mut found = None;
    Frames::default().receive(&frame, |message| found = Some(message));
    found
}

impl Serialize for RawMessage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

impl<'de> Deserialize<'de> for RawMessage {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(MESSAGE_BYTES, Bytes)
    }
}

/// Takes all bytes that there are.
struct Bytes;

impl<'de> Visitor<'de> for Bytes {
    type Value = RawMessage;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the bytes of a message")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut bytes: A) -> Result<RawMessage, A::Error> {
        let mut all = Vec::new();
        // The end of the message is the error that ends it.
        while let Ok(Some(byte)) = bytes.next_element() {
            all.push(byte);
        }
        Ok(RawMessage(all))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_protocol::message::{Command, Message, Reply, Request};

    #[test]
    fn a_message_that_is_passed_on_keeps_its_bytes() {
        let request = Request::<f32> {
            sequence: 300,
            command: Command::telemetry(10),
        };
        let mut frame = Vec::new();
        Frames::append(&request, &mut frame);
        let mut raw: Vec<RawMessage> = Vec::new();
        Frames::default().receive(&frame, |message| raw.push(message));
        assert_eq!(raw.len(), 1);
        assert_eq!(raw[0].bytes(), [0xac, 0x02, 11, 10, 127]);
        assert_eq!(raw[0].read::<Request<f32>>(), Some(request));
        assert_eq!(raw[0].read::<Message<f32>>(), None);
        let mut again = Vec::new();
        Frames::append(&raw[0], &mut again);
        assert_eq!(again, frame);
    }

    #[test]
    fn the_longest_message_fits_and_a_damaged_one_is_none() {
        let message = Message::<f64>::Reply {
            sequence: u32::MAX,
            reply: Reply::Done,
        };
        for length in [1, MESSAGE_BYTES] {
            let raw = RawMessage(vec![7; length]);
            assert_eq!(raw.read::<RawMessage>(), Some(raw.clone()), "{length}");
            assert_eq!(raw.read::<Message<f64>>(), None);
        }
        let mut frame = Vec::new();
        Frames::append(&message, &mut frame);
        frame[2] ^= 0x10;
        let mut frames = Frames::default();
        frames.receive(&frame, |raw: RawMessage| panic!("{raw:?}"));
        assert_eq!(frames.counters().errors(), 1);
    }
}
