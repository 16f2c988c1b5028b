//! The decoder: any bytes on the line, and any payload in a frame whose checksum is right.

use crate::device::{MessageDecoder, RequestDecoder};
use core::fmt::Debug;
use serde::de::DeserializeOwned;
use serde::ser::SerializeTuple;
use serde::{Serialize, Serializer};
use trirrr_protocol::message::{Message, Request};
use trirrr_protocol::wire::{Decoder, FrameError, encode};

/// Longest frame that this target makes.
const ROOM: usize = 8192;

/// A payload as it is: bytes without a length in front.
struct Payload<'a>(&'a [u8]);

impl Serialize for Payload<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

/// Both directions of the line, in f32 and f64.
pub fn decoder(data: &[u8]) {
    line::<Request<f64>, _>(data, RequestDecoder::new());
    line::<Message<f64>, _>(data, MessageDecoder::new());
    line::<Request<f32>, _>(data, RequestDecoder::new());
    line::<Message<f32>, _>(data, MessageDecoder::new());
    framed::<Request<f64>, _>(data, RequestDecoder::new());
    framed::<Message<f64>, _>(data, MessageDecoder::new());
    framed::<Request<f32>, _>(data, RequestDecoder::new());
    framed::<Message<f32>, _>(data, MessageDecoder::new());
}

/// `data` is what is on the line: every zero ends a frame, and each is a message or has its error.
fn line<T, const N: usize>(data: &[u8], mut decoder: Decoder<N>)
where
    T: Serialize + DeserializeOwned + Debug,
{
    let (mut ends, mut messages) = (0, 0);
    for byte in data {
        let heard = decoder.feed::<T>(*byte);
        assert_eq!(heard.is_some(), *byte == 0);
        ends += u32::from(*byte == 0);
        if let Some(Ok(message)) = heard {
            messages += 1;
            comes_back(&message);
        }
    }
    let counters = decoder.counters();
    assert_eq!(counters.messages, messages);
    assert_eq!(counters.messages + counters.errors(), ends);
}

/// `data` is what is in a frame: only what it says can be wrong with it.
fn framed<T, const N: usize>(data: &[u8], mut decoder: Decoder<N>)
where
    T: Serialize + DeserializeOwned + Debug,
{
    let mut room = [0; ROOM];
    let Ok(mut frame) = encode(&Payload(data), &mut room) else {
        return;
    };
    match decoder.take::<T>(&mut frame) {
        Some(Ok(message)) => comes_back(&message),
        Some(Err(FrameError::Message | FrameError::Trailing)) => {}
        Some(Err(FrameError::TooLong)) => assert!(data.len() + 4 > N),
        Some(Err(FrameError::Truncated)) => assert!(data.is_empty()),
        other => panic!("a whole frame: {other:?}"),
    }
    assert!(frame.is_empty());
}

/// What was heard can be said, and is heard the same.
fn comes_back<T>(message: &T)
where
    T: Serialize + DeserializeOwned + Debug,
{
    let (mut room, mut again) = ([0; ROOM], [0; ROOM]);
    let frame = encode(message, &mut room).expect("it was in a frame");
    let back: T = Decoder::<ROOM>::new()
        .take(&mut &*frame)
        .expect("the frame is whole")
        .expect("it is a message");
    // In bytes: what is not a number is not equal to itself.
    assert_eq!(
        encode(&back, &mut again).expect("it is as long"),
        frame,
        "{message:?}"
    );
}
