//! Line: bytes by DMA, in both directions.
//!
//! The receiver's DMA fills its ring round after round. An interrupt counts the rounds, so the number of bytes that have come is exact at any time,
//! and a background that was late by a round knows how many it has missed. It looks at that number in each of its turns, and needs
//! no interrupt at a byte, nor where the line falls idle. The transmitter's DMA sends what the background has put beside each other, a frame, while that makes the next one.

use crate::dma;
use crate::parts::Rcc;
use core::convert::Infallible;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering, compiler_fence};
use embedded_hal_nb::serial::{ErrorType, Write};
use trirrr_app::ReceivedBytes;

/// Bytes that a DMA and the background share.
pub(crate) type SharedBytes = [AtomicU8];

/// Places of the receiver, bytes. At 921,600 baud they last for 11 ms. The size of a round divides the 2^32 at which counts begin anew.
const ROOM: usize = 1024;

/// The same as a count.
pub(crate) const ROUND: u32 = ROOM as u32;

/// Places of the transmitter, bytes: most frames are shorter. The rest of a longer one follows.
const FRAME: usize = 256;

static COMING: [AtomicU8; ROOM] = [const { AtomicU8::new(0) }; ROOM];
static LEAVING: [AtomicU8; FRAME] = [const { AtomicU8::new(0) }; FRAME];

/// Rounds that the receiver's DMA has ended, modulo 2^32.
static ROUNDS: AtomicU32 = AtomicU32::new(0);

/// Bytes that were written over before the background took them, modulo 2^32.
static MISSED: AtomicU32 = AtomicU32::new(0);

/// Starts the DMA of the port whose data registers, of receiver and transmitter, are at these addresses.
pub(crate) fn start(data: [u32; 2], rcc: &mut Rcc) -> (LineTransmitter, LineReceiver) {
    dma::start([&COMING, &LEAVING], data, rcc);
    let transmitter = LineTransmitter { waiting: 0 };
    let receiver = LineReceiver { come: 0, read: 0 };
    (transmitter, receiver)
}

/// Counts a round of the receiver's ring, in the interrupt at its end.
#[inline(always)]
pub(crate) fn count_round() {
    dma::clear_round();
    let rounds = ROUNDS.load(Ordering::Relaxed);
    ROUNDS.store(rounds.wrapping_add(1), Ordering::Relaxed);
}

/// Keeps accesses before it from those behind it. The core itself leaves them in order.
fn in_order() {
    compiler_fence(Ordering::SeqCst);
}

/// Receiver of the line.
pub(crate) struct LineReceiver {
    /// Bytes that had come by the last look, and bytes that were read; modulo 2^32.
    come: u32,
    read: u32,
}

impl LineReceiver {
    /// Returns the number of bytes that have come, modulo 2^32.
    #[inline(never)]
    fn look() -> u32 {
        while dma::is_there() {
            let rounds = ROUNDS.load(Ordering::Relaxed);
            in_order();
            let left = dma::left();
            // A round that ends meanwhile belongs to one of both numbers, and it is not known to which.
            let is_over = dma::is_round_over();
            in_order();
            if !is_over && ROUNDS.load(Ordering::Relaxed) == rounds {
                return rounds
                    .wrapping_add(1)
                    .wrapping_mul(ROUND)
                    .wrapping_sub(left);
            }
        }
        // In an emulator nobody moves bytes but this function, one at a time, and bytes are counted for rounds.
        let come = ROUNDS.load(Ordering::Relaxed);
        let Some(byte) = dma::byte_without() else {
            return come;
        };
        if let Some(place) = COMING.get(come as usize % ROOM) {
            place.store(byte, Ordering::Relaxed);
        }
        ROUNDS.store(come.wrapping_add(1), Ordering::Relaxed);
        come.wrapping_add(1)
    }
}

impl ReceivedBytes for LineReceiver {
    #[inline(never)]
    fn next_byte(&mut self) -> Option<u8> {
        if self.come == self.read {
            self.come = Self::look();
            if self.come == self.read {
                return None;
            }
        }
        let byte = COMING
            .get(self.read as usize % ROOM)
            .map(|place| place.load(Ordering::Relaxed));
        in_order();
        // Only now it is known that nothing was written over it.
        self.come = Self::look();
        let waiting = self.come.wrapping_sub(self.read);
        if waiting >= ROUND {
            // Nobody knows which of them are whole. Their frames are damaged, and the host repeats them.
            self.read = self.come;
            let missed = MISSED.load(Ordering::Relaxed).wrapping_add(waiting);
            MISSED.store(missed, Ordering::Relaxed);
            defmt::warn!("{=u32} bytes of the line were missed", missed);
            return None;
        }
        self.read = self.read.wrapping_add(1);
        byte
    }
}

/// Transmitter of the line: bytes are put beside each other, and leave together when they are flushed.
pub(crate) struct LineTransmitter {
    /// Bytes that wait for it. None while others are being sent.
    waiting: usize,
}

impl ErrorType for LineTransmitter {
    type Error = Infallible;
}

impl Write<u8> for LineTransmitter {
    // A call: the loop around it would be unrolled.
    #[inline(never)]
    fn write(&mut self, byte: u8) -> nb::Result<(), Infallible> {
        if !dma::is_there() {
            dma::put_without(byte);
            return Ok(());
        }
        match LEAVING.get(self.waiting) {
            Some(place) if !dma::is_sending() => {
                place.store(byte, Ordering::Relaxed);
                self.waiting += 1;
                Ok(())
            }
            _ => Err(nb::Error::WouldBlock),
        }
    }

    fn flush(&mut self) -> nb::Result<(), Infallible> {
        if let Some(bytes @ [_, ..]) = LEAVING.get(..self.waiting) {
            dma::send(bytes);
            self.waiting = 0;
        }
        match dma::is_sending() {
            true => Err(nb::Error::WouldBlock),
            false => Ok(()),
        }
    }
}
