//! The log: defmt's frames in a ring in RAM, which the background empties into a serial port.
//!
//! Only what runs below every interrupt logs: the start and the background. So the ring has one
//! user, nothing waits for it, and the tick is never held up. A frame that finds no room is dropped
//! as a whole and counted.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;
use cortex_m::peripheral::SCB;
use cortex_m::peripheral::scb::VectActive;
use embedded_hal_nb::serial::Write;

/// Bytes that may wait to be sent, and one that stays empty.
const ROOM: usize = 256;

struct Ring {
    encoder: defmt::Encoder,
    bytes: [u8; ROOM],
    /// Where the next byte is read, where the whole frames end, and where the frame being written
    /// does.
    read: usize,
    committed: usize,
    written: usize,
    /// The frame being written found no room.
    is_full: bool,
}

/// To be reached below every interrupt only.
struct Below<T>(UnsafeCell<T>);

// SAFETY: `with` hands it out below every interrupt only, where nothing runs side by side.
unsafe impl<T> Sync for Below<T> {}

static RING: Below<Ring> = Below(UnsafeCell::new(Ring {
    encoder: defmt::Encoder::new(),
    bytes: [0; ROOM],
    read: 0,
    committed: 0,
    written: 0,
    is_full: false,
}));

/// Does `what` with the ring, unless an interrupt asks for it.
fn with<T>(what: impl FnOnce(&mut Ring) -> T) -> Option<T> {
    if SCB::vect_active() != VectActive::ThreadMode {
        return None;
    }
    // SAFETY: below every interrupt, and none reaches the ring: there is no other reference. `what`
    // does not call this again: the encoder knows no logger.
    Some(what(unsafe { &mut *RING.0.get() }))
}

impl Ring {
    fn put(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let next = (self.written + 1) % ROOM;
            if next == self.read {
                self.is_full = true;
            }
            if self.is_full {
                return;
            }
            if let Some(place) = self.bytes.get_mut(self.written) {
                *place = byte;
            }
            self.written = next;
        }
    }

    /// Calls `encode` with the encoder and somewhere to put its bytes.
    fn encode(&mut self, encode: impl FnOnce(&mut defmt::Encoder, &mut dyn FnMut(&[u8]))) {
        let mut encoder = core::mem::replace(&mut self.encoder, defmt::Encoder::new());
        encode(&mut encoder, &mut |bytes| self.put(bytes));
        self.encoder = encoder;
    }
}

#[defmt::global_logger]
struct Logger;

// SAFETY: a frame is written from `acquire` to `release` below every interrupt, so no two mix.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        with(|ring| ring.encode(|encoder, put| encoder.start_frame(put)));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        with(|ring| {
            ring.encode(|encoder, put| encoder.end_frame(put));
            match ring.is_full {
                true => ring.written = ring.committed,
                false => ring.committed = ring.written,
            }
            ring.is_full = false;
        });
    }

    unsafe fn write(bytes: &[u8]) {
        with(|ring| ring.encode(|encoder, put| encoder.write(bytes, put)));
    }
}

/// Sends what `port` takes without waiting.
pub fn drain(port: &mut impl Write<u8>) {
    with(|ring| {
        while ring.read != ring.committed {
            let byte = ring.bytes.get(ring.read).copied().unwrap_or(0);
            if port.write(byte).is_err() {
                return;
            }
            ring.read = (ring.read + 1) % ROOM;
        }
    });
}
