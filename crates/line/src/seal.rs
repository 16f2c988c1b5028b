//! Seal of a TCP link: Noise with a key that both ends have. From the bytes of the line to those of the frames, and back, without
//! input and output of its own.
//!
//! ```text
//! client                                  machine
//!   00 30, 48 bytes: psk, e         ──>     refuses, in words, who has another key
//!     refuses what has another key  <──   00 30, 48 bytes: e, ee
//!   00 10, 16 bytes: an empty record ──>    knows now that this is no old recording
//!   records                         <─>   records
//! ```
//! A record has its length in front, two bytes, most significant first. It carries up to [`PLAIN`] bytes, sealed and counted: one that is
//! changed, repeated or left out ends the link. Each link has new keys, which nobody can compute later from the shared one.

use crate::key::SharedKey;
use crate::noise::{Handshake, Transport};
use crate::refusal::{KeyRefusal, ends, told};
use std::io;

/// Bytes of a length.
const PREFIX: usize = 2;

/// Bytes of each message of the handshake: a public key and a tag.
const GREETING: usize = 32 + TAG;

/// Bytes by which a sealed record is longer.
const TAG: usize = 16;

/// Most bytes in a record.
pub(crate) const PLAIN: usize = 4096;

/// Most bytes of a record on the line.
const RECORD: usize = PREFIX + PLAIN + TAG;

/// First two bytes of a client with a key. No plain client begins so: its first frame, a hello, is shorter than its first block
/// would be.
pub(crate) const WITH_KEY: [u8; PREFIX] = (GREETING as u16).to_be_bytes();

/// State of the conversation under the seal.
enum Noise {
    Greets(Box<Handshake>),
    /// The handshake is over. `heard`: a record of the far end was opened, so that it has the key.
    Sealed {
        transport: Box<Transport>,
        heard: bool,
    },
    /// The far end is refused.
    Refused,
}

/// Seal of one link.
pub(crate) struct Seal {
    noise: Noise,
    is_client: bool,
    /// Bytes of the line that are not opened, at most those of a record.
    incoming: Vec<u8>,
    /// Bytes for the line, at most those of a record and a refusal.
    outgoing: Vec<u8>,
    /// The last record, and the bytes of it that are taken.
    opened: Vec<u8>,
    taken: usize,
}

impl Seal {
    /// Creates the end that begins, with its greeting to be sent.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub(crate) fn of_client(key: &SharedKey) -> io::Result<Self> {
        let mut greets = Handshake::begin(key, true)?;
        let mut outgoing = Vec::new();
        put_record(&mut outgoing, GREETING, |record| greets.write(record))?;
        Ok(Self::new(greets, outgoing, true))
    }

    /// Creates the end that waits.
    ///
    /// # Errors
    /// As [`Self::of_client`].
    pub(crate) fn of_machine(key: &SharedKey) -> io::Result<Self> {
        let greets = Handshake::begin(key, false)?;
        Ok(Self::new(greets, Vec::new(), false))
    }

    fn new(greets: Handshake, outgoing: Vec<u8>, is_client: bool) -> Self {
        Self {
            noise: Noise::Greets(Box::new(greets)),
            is_client,
            incoming: Vec::new(),
            outgoing,
            opened: Vec::new(),
            taken: 0,
        }
    }

    /// Returns true once the far end has shown that it has the key.
    pub(crate) fn is_open(&self) -> bool {
        match &self.noise {
            Noise::Sealed { heard, .. } => *heard || self.is_client,
            _ => false,
        }
    }

    /// Bytes of the line that [`take`](Self::take) has room for; at least one wherever no whole record waits.
    pub(crate) fn room(&self) -> usize {
        RECORD.saturating_sub(self.incoming.len())
    }

    /// Takes bytes of the line.
    pub(crate) fn take(&mut self, bytes: &[u8]) {
        self.incoming.extend_from_slice(bytes);
    }

    /// Goes on with the handshake as far as the bytes of the line lead, up to the first record behind it.
    ///
    /// # Errors
    /// [`KeyRefusal`], as the client or the machine finds it. What is to be sent before the end is in [`outgoing`](Self::outgoing).
    pub(crate) fn greet(&mut self) -> io::Result<()> {
        let Noise::Greets(greets) = &mut self.noise else {
            return Ok(());
        };
        let refusal = match (self.is_client, prefix(&self.incoming)) {
            (_, None) => return Ok(()),
            (false, Some(start)) if start != WITH_KEY => KeyRefusal::Needed,
            (true, Some(start)) if start != WITH_KEY => {
                match told(&self.incoming, |words, so_far| words.starts_with(so_far)) {
                    None => KeyRefusal::Foreign,
                    // The rest of the words is on its way.
                    Some(_) if !ends(&self.incoming) => return Ok(()),
                    Some(refusal) => refusal,
                }
            }
            _ if self.incoming.len() < PREFIX + GREETING => return Ok(()),
            _ => {
                let greeting = &self.incoming[PREFIX..PREFIX + GREETING];
                match greets.read(greeting) {
                    true => return self.greeted(),
                    false => KeyRefusal::Other,
                }
            }
        };
        self.noise = Noise::Refused;
        if !self.is_client {
            self.outgoing.extend_from_slice(refusal.record());
        }
        Err(refusal.error())
    }

    /// Answers the greeting that was read, or says that the answer was.
    fn greeted(&mut self) -> io::Result<()> {
        self.incoming.drain(..PREFIX + GREETING);
        let Noise::Greets(mut greets) = std::mem::replace(&mut self.noise, Noise::Refused) else {
            return Ok(());
        };
        if !self.is_client {
            put_record(&mut self.outgoing, GREETING, |record| greets.write(record))?;
        }
        self.noise = Noise::Sealed {
            transport: Box::new(greets.into_transport()?),
            heard: false,
        };
        if self.is_client {
            self.seal(&[])?;
        }
        Ok(())
    }

    /// Opens records until bytes come out of one, and copies as many of these as fit. Returns their number, 0 where the line has to bring
    /// more.
    ///
    /// # Errors
    /// A record that the far end has not sealed, or not in this place.
    pub(crate) fn open(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.taken == self.opened.len() {
            if !self.open_record()? {
                return Ok(0);
            }
        }
        let left = &self.opened[self.taken..];
        let length = left.len().min(buffer.len());
        buffer[..length].copy_from_slice(&left[..length]);
        self.taken += length;
        Ok(length)
    }

    /// Opens the next record, if the line has brought all of it.
    fn open_record(&mut self) -> io::Result<bool> {
        let Noise::Sealed { transport, heard } = &mut self.noise else {
            return Ok(false);
        };
        let Some(start) = prefix(&self.incoming) else {
            return Ok(false);
        };
        let length = usize::from(u16::from_be_bytes(start));
        if !(TAG..=PLAIN + TAG).contains(&length) {
            return Err(damaged());
        }
        let Some(record) = self.incoming.get(PREFIX..PREFIX + length) else {
            return Ok(false);
        };
        self.opened.resize(length - TAG, 0);
        self.taken = 0;
        if !transport.read(record, &mut self.opened) {
            return Err(damaged());
        }
        *heard = true;
        self.incoming.drain(..PREFIX + length);
        Ok(true)
    }

    /// Seals the first of `bytes`, as many as a record takes, behind what is to be sent. Returns their number. Nothing is sealed before the
    /// handshake is over.
    ///
    /// # Errors
    /// As many records as Noise can count were sent.
    pub(crate) fn seal(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Noise::Sealed { transport, .. } = &mut self.noise else {
            return Ok(0);
        };
        let bytes = &bytes[..bytes.len().min(PLAIN)];
        put_record(&mut self.outgoing, bytes.len() + TAG, |record| {
            transport.write(bytes, record)
        })?;
        Ok(bytes.len())
    }

    /// Bytes to be sent.
    pub(crate) fn outgoing(&self) -> &[u8] {
        &self.outgoing
    }

    /// Takes note that the first `length` bytes were sent.
    pub(crate) fn sent(&mut self, length: usize) {
        self.outgoing.drain(..length);
    }
}

/// Appends a record of `length` bytes that `write` fills.
fn put_record(
    outgoing: &mut Vec<u8>,
    length: usize,
    write: impl FnOnce(&mut [u8]) -> io::Result<usize>,
) -> io::Result<()> {
    let start = outgoing.len();
    // A record is never longer than two bytes can say.
    outgoing.extend_from_slice(&(length as u16).to_be_bytes());
    outgoing.resize(start + PREFIX + length, 0);
    let written = write(&mut outgoing[start + PREFIX..])?;
    debug_assert_eq!(written, length);
    Ok(())
}

/// Length in front of what the line has brought.
fn prefix(bytes: &[u8]) -> Option<[u8; PREFIX]> {
    bytes.first_chunk().copied()
}

/// Error of a link on which somebody else has written.
fn damaged() -> io::Error {
    let reason = "a sealed record was changed on its way, or is not of the far end";
    io::Error::new(io::ErrorKind::InvalidData, reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Carries what one end has to send to the other, in pieces of `piece` bytes.
    fn carry(from: &mut Seal, to: &mut Seal, piece: usize) -> io::Result<()> {
        let bytes = from.outgoing().to_vec();
        from.sent(bytes.len());
        for bytes in bytes.chunks(piece) {
            assert!(bytes.len() <= to.room());
            to.take(bytes);
            to.greet()?;
            to.open(&mut [])?;
        }
        Ok(())
    }

    fn pair(client: &SharedKey, machine: &SharedKey, piece: usize) -> io::Result<[Seal; 2]> {
        let mut client = Seal::of_client(client)?;
        let mut machine = Seal::of_machine(machine)?;
        carry(&mut client, &mut machine, piece)?;
        assert!(!machine.is_open(), "a recording could have come so far");
        carry(&mut machine, &mut client, piece)?;
        carry(&mut client, &mut machine, piece)?;
        assert!(machine.is_open() && client.is_open());
        Ok([client, machine])
    }

    #[test]
    fn both_ends_with_the_key_understand_each_other() {
        let key = SharedKey::random().unwrap();
        for piece in [1, 7, 4096] {
            let [mut client, mut machine] = pair(&key, &key, piece).unwrap();
            let long: Vec<u8> = (0..PLAIN + 1).map(|i| i as u8).collect();
            assert_eq!(client.seal(&long).unwrap(), PLAIN);
            assert!(!client.outgoing().windows(8).any(|part| part == &long[..8]));
            carry(&mut client, &mut machine, piece).unwrap();
            let mut read = vec![0; 1000];
            let mut got = Vec::new();
            while let length @ 1.. = machine.open(&mut read).unwrap() {
                got.extend_from_slice(&read[..length]);
            }
            assert_eq!(got, long[..PLAIN]);
            machine.seal(b"an answer").unwrap();
            carry(&mut machine, &mut client, piece).unwrap();
            let length = client.open(&mut read).unwrap();
            assert_eq!(&read[..length], b"an answer");
        }
    }

    #[test]
    fn another_key_is_refused_in_words() {
        let [one, two] = [0, 1].map(|_| SharedKey::random().unwrap());
        for piece in [1, 4096] {
            let mut client = Seal::of_client(&one).unwrap();
            let mut machine = Seal::of_machine(&two).unwrap();
            let error = carry(&mut client, &mut machine, piece).unwrap_err();
            assert_eq!(KeyRefusal::of(&error), Some(KeyRefusal::Other));
            let error = carry(&mut machine, &mut client, piece).unwrap_err();
            assert_eq!(KeyRefusal::of(&error), Some(KeyRefusal::Other));
        }
    }

    #[test]
    fn a_record_that_is_changed_or_repeated_ends_the_link() {
        let key = SharedKey::random().unwrap();
        for repeated in [false, true] {
            let [mut client, mut machine] = pair(&key, &key, 4096).unwrap();
            client.seal(b"move").unwrap();
            let mut record = client.outgoing().to_vec();
            if repeated {
                machine.take(&record);
                assert_eq!(machine.open(&mut [0; 16]).unwrap(), 4);
            } else {
                record[PREFIX] ^= 1;
            }
            machine.take(&record);
            let error = machine.open(&mut [0; 16]).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidData);
        }
    }

    /// A greeting that was recorded leads to an answer, and to nothing more.
    #[test]
    fn a_recording_does_not_open_a_link() {
        let key = SharedKey::random().unwrap();
        let mut client = Seal::of_client(&key).unwrap();
        let mut recorded = client.outgoing().to_vec();
        let mut machine = Seal::of_machine(&key).unwrap();
        carry(&mut client, &mut machine, 4096).unwrap();
        carry(&mut machine, &mut client, 4096).unwrap();
        recorded.extend_from_slice(client.outgoing());

        let mut machine = Seal::of_machine(&key).unwrap();
        machine.take(&recorded);
        machine.greet().unwrap();
        let error = machine.open(&mut [0; 16]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidData);
        assert!(!machine.is_open());
    }

    #[test]
    fn a_length_beyond_a_record_is_no_room_to_fill() {
        let key = SharedKey::random().unwrap();
        let [_, mut machine] = pair(&key, &key, 4096).unwrap();
        machine.take(&[0xff, 0xff]);
        assert!(machine.open(&mut [0; 16]).is_err());
        for plain in [&b"\x02\x07\x0b"[..], b"\x00\x02\x07", b"GET / HTTP/1.1"] {
            let mut machine = Seal::of_machine(&key).unwrap();
            machine.take(plain);
            let error = machine.greet().unwrap_err();
            assert_eq!(KeyRefusal::of(&error), Some(KeyRefusal::Needed));
            assert_eq!(machine.outgoing(), KeyRefusal::Needed.record());
        }
    }

    #[test]
    fn what_is_no_machine_with_a_key_is_named() {
        let mut client = Seal::of_client(&SharedKey::random().unwrap()).unwrap();
        client.take(b"\x01\x18");
        let error = client.greet().unwrap_err();
        assert_eq!(KeyRefusal::of(&error), Some(KeyRefusal::Foreign));
    }
}
