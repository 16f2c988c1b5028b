//! Log: defmt's frames in a ring in RAM, which the background empties into a serial port.
//!
//! Only the start and the background log, below every interrupt. So the ring has one user, nothing waits for
//! it, and the tick is never held up. A frame without room is dropped as a whole.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;
use cortex_m::peripheral::SCB;
use cortex_m::peripheral::scb::VectActive;
use embedded_hal_nb::serial::Write;

/// Baud rate of the log.
pub const LOG_BAUD: u32 = 115_200;

/// Bytes of the ring; one stays empty.
const ROOM: usize = 256;

struct Ring {
    encoder: defmt::Encoder,
    bytes: [u8; ROOM],
    /// Index of the next byte to send, of the end of whole frames, and of the end of the frame that is
    /// being written.
    read: usize,
    committed: usize,
    written: usize,
    /// The frame that is being written found no room.
    is_full: bool,
}

/// Cell that is reached below every interrupt only.
struct Below<T>(UnsafeCell<T>);

// SAFETY: `with` hands out the content below every interrupt only, where code runs alone.
unsafe impl<T> Sync for Below<T> {}

static RING: Below<Ring> = Below(UnsafeCell::new(Ring {
    encoder: defmt::Encoder::new(),
    bytes: [0; ROOM],
    read: 0,
    committed: 0,
    written: 0,
    is_full: false,
}));

/// Calls `what` with the ring. In an interrupt, does nothing.
fn with<T>(what: impl FnOnce(&mut Ring) -> T) -> Option<T> {
    if SCB::vect_active() != VectActive::ThreadMode {
        return None;
    }
    // SAFETY: below every interrupt, and no interrupt gets past the check above: there is no other
    // reference. `what` does not call `with` again: the encoder knows no logger.
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

    /// Calls `encode` with the encoder and a sink for its bytes.
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

/// Sends bytes until `port` would have to wait.
pub(crate) fn drain(port: &mut impl Write<u8>) {
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
