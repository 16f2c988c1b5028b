//! Frames there and back, and every way in which a line spoils them.

use super::*;
use proptest::prelude::*;
use std::vec::Vec;

/// A message with room for zeros, long runs without one, and values that do not fit.
type Message = (u32, Vec<u8>, Option<f32>);

const LONGEST: usize = 700;
const DECODED: usize = decoded_length(LONGEST);

fn frame(message: &Message) -> Vec<u8> {
    let mut buffer = [0; frame_length(LONGEST)];
    encode(message, &mut buffer).unwrap().to_vec()
}

/// Everything that the decoder says to `bytes`.
fn hear(decoder: &mut Decoder<DECODED>, mut bytes: &[u8]) -> Vec<Result<Message, FrameError>> {
    let mut heard = Vec::new();
    while let Some(frame) = decoder.take(&mut bytes) {
        heard.push(frame);
    }
    assert!(bytes.is_empty());
    heard
}

/// A frame around `bytes`, with the checksum that belongs to them: made by hand.
fn framed(bytes: &[u8]) -> Vec<u8> {
    let mut checked = bytes.to_vec();
    checked.extend(CRC.checksum(bytes).to_le_bytes());
    stuffed(&checked)
}

fn stuffed(bytes: &[u8]) -> Vec<u8> {
    let mut out = std::vec![0; cobs::max_encoding_length(bytes.len())];
    let length = cobs::encode(bytes, &mut out);
    out.truncate(length);
    out.push(0);
    out
}

fn messages() -> impl Strategy<Value = Message> {
    let bytes = prop_oneof![
        proptest::collection::vec(any::<u8>(), 0..600),
        proptest::collection::vec(1..=255u8, 240..270),
        proptest::collection::vec(Just(0u8), 0..600),
    ];
    (any::<u32>(), bytes, proptest::option::of(-1f32..1.0))
}

#[test]
fn the_checksum_is_the_one_of_the_catalogue() {
    assert_eq!(CRC.checksum(b"123456789"), 0xCBF4_3926);
    assert_eq!(checksum_of_bytes(b"123456789"), 0xCBF4_3926);
}

proptest! {
    #[test]
    fn a_message_comes_back(message in messages(), pieces in 1..40usize) {
        let frame = frame(&message);
        prop_assert_eq!(frame.iter().filter(|byte| **byte == 0).count(), 1);
        prop_assert_eq!(frame.last(), Some(&0));
        let mut decoder = Decoder::new();
        let mut heard = Vec::new();
        for piece in frame.chunks(pieces) {
            heard.extend(hear(&mut decoder, piece));
        }
        prop_assert_eq!(Some(decoder.checksum()), checksum(&message));
        prop_assert_eq!(heard, [Ok(message)]);
        prop_assert_eq!(decoder.counters().messages, 1);
        prop_assert_eq!(decoder.counters().errors(), 0);
    }

    /// Any burst up to 32 bits is found by a CRC-32; behind COBS a changed byte may move a block's
    /// end as well, which the frame's length or its checksum shows.
    #[test]
    fn a_changed_byte_is_never_accepted(message in messages(), at in any::<prop::sample::Index>(), flip in 1..=255u8) {
        let mut frame = frame(&message);
        let at = at.index(frame.len());
        frame[at] ^= flip;
        frame.push(0);
        let heard = hear(&mut Decoder::new(), &frame);
        prop_assert!(heard.iter().all(|each| each.is_err()), "{heard:?}");
    }

    #[test]
    fn a_frame_cut_short_is_refused(message in messages(), at in any::<prop::sample::Index>()) {
        let mut frame = frame(&message);
        // Without its last byte before the zero at least.
        frame.truncate(at.index(frame.len() - 1));
        frame.push(0);
        let heard = hear(&mut Decoder::new(), &frame);
        prop_assert_eq!(heard.len(), 1);
        prop_assert!(heard[0].is_err());
    }

    /// Whatever was on the line, the frame behind the next zero is heard.
    #[test]
    fn the_next_zero_makes_it_listen_again(
        noise in proptest::collection::vec(any::<u8>(), 0..2000),
        message in messages(),
    ) {
        let mut decoder = Decoder::new();
        let before = hear(&mut decoder, &noise).len();
        let mut line = std::vec![0];
        line.extend(frame(&message));
        let heard = hear(&mut decoder, &line);
        prop_assert_eq!(heard.last(), Some(&Ok(message)));
        let counters = decoder.counters();
        prop_assert_eq!(
            counters.messages as usize + counters.errors() as usize,
            before + heard.len()
        );
    }
}

#[test]
fn every_damage_has_its_name() {
    let message: Message = (5, std::vec![1, 0, 2], Some(0.5));
    let bytes = plain(&message);
    let wrong_checksum = {
        let mut checked = bytes.clone();
        checked.extend((CRC.checksum(&bytes) ^ 1).to_le_bytes());
        stuffed(&checked)
    };
    let unknown_option = {
        let mut bytes = bytes.clone();
        let at = bytes.len() - 5;
        bytes[at] = 2;
        framed(&bytes)
    };
    let mut trailing = bytes.clone();
    trailing.push(7);
    // 0xFF announces 254 bytes.
    for (line, expected) in [
        (std::vec![0], FrameError::Empty),
        (framed(&[3; DECODED + 1]), FrameError::TooLong),
        (stuffed(&[1, 2, 3]), FrameError::Truncated),
        (framed(&[]), FrameError::Truncated),
        (std::vec![0xFF, 1, 2, 0], FrameError::Stuffing),
        (std::vec![9, 0], FrameError::Stuffing),
        (wrong_checksum, FrameError::Checksum),
        (unknown_option, FrameError::Message),
        (framed(&bytes[..bytes.len() - 1]), FrameError::Message),
        // A varint of more than 32 bits.
        (framed(&[0xFF; 12]), FrameError::Message),
        (framed(&trailing), FrameError::Trailing),
    ] {
        let mut decoder = Decoder::new();
        assert_eq!(hear(&mut decoder, &line), [Err(expected)]);
        assert_eq!(decoder.counters().of(expected), 1);
        assert_eq!(decoder.counters().errors(), 1);
        assert_eq!(hear(&mut decoder, &frame(&message)), [Ok(message.clone())]);
    }
}

#[test]
fn the_longest_message_fits_and_one_byte_more_does_not() {
    const N: usize = decoded_length(9);
    let mut buffer = [0; frame_length(10)];
    let mut decoder = Decoder::<N>::new();
    let mut line = encode(&[7u8; 9], &mut buffer).unwrap();
    assert_eq!(decoder.take(&mut line), Some(Ok([7u8; 9])));
    let mut line = encode(&[7u8; 10], &mut buffer).unwrap();
    assert_eq!(
        decoder.take::<[u8; 10]>(&mut line),
        Some(Err(FrameError::TooLong))
    );
}

#[test]
fn a_buffer_too_small_is_refused_at_every_length() {
    let message = (u32::MAX, [0.5f64; 4]);
    let mut buffer = [0; 64];
    let needed = encode(&message, &mut buffer).unwrap().len();
    for bytes in 0..needed {
        let refused = encode(&message, &mut buffer[..bytes]);
        assert_eq!(refused, Err(BufferTooSmall { bytes }));
    }
    assert!(encode(&message, &mut buffer[..needed]).is_ok());
}

/// A minute at 921,600 baud, 10 bits a byte, of every kind of noise: counters, and the first good
/// frame behind it is heard.
#[test]
fn a_minute_of_garbage_costs_counters() {
    const BYTES: usize = 60 * 92_160;
    let mut random = 0x9E37_79B9_7F4A_7C15u64;
    let mut noise = |mask: u8| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (random >> 56) as u8 & mask
    };
    let message: Message = (1, std::vec![0, 9], None);
    // All bytes; a line stuck at one; without a zero; mostly zeros.
    let kinds: [&mut dyn FnMut() -> u8; 4] =
        [&mut || noise(0xFF), &mut || 0xFF, &mut || 0x55, &mut || 0];
    for kind in kinds {
        let mut decoder = Decoder::new();
        for _ in 0..BYTES {
            let heard = decoder.feed::<Message>(kind());
            assert!(!matches!(heard, Some(Ok(_))));
        }
        let mut line = std::vec![0];
        line.extend(frame(&message));
        assert_eq!(hear(&mut decoder, &line).last(), Some(&Ok(message.clone())));
        assert_eq!(decoder.counters().messages, 1);
    }
}

#[test]
fn a_line_opened_anew_starts_with_a_new_frame() {
    let message: Message = (3, Vec::new(), None);
    let frame = frame(&message);
    let mut decoder = Decoder::new();
    assert!(hear(&mut decoder, &frame[..frame.len() / 2]).is_empty());
    decoder.reset();
    assert_eq!(hear(&mut decoder, &frame), [Ok(message)]);
}

/// The message's bytes, neither checked nor stuffed.
fn plain(message: &Message) -> Vec<u8> {
    let mut buffer = [0; LONGEST];
    postcard::to_slice(message, &mut buffer).unwrap().to_vec()
}
