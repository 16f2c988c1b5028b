//! Line: bytes by DMA, through a ring in each direction.
//!
//! The receiver's DMA fills its ring round after round. An interrupt counts the rounds, so the number of bytes that have come is exact at any time,
//! and a background that was late by a round knows how many it has missed. It looks at that number in each of its turns, and needs
//! no interrupt at a byte, nor where the line falls idle. The transmitter's DMA takes what lies in its ring, and the background starts it anew.

use crate::dma;
use crate::parts::Rcc;
use core::convert::Infallible;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use embedded_hal_nb::serial::{ErrorType, Write};
use trirrr_app::{RECEIVED, ReceivedBytes};

/// Bytes that a DMA and the background share.
pub(crate) type Ring = [AtomicU8; ROOM];

/// Places of each ring, bytes. The size of a round divides the 2^32 at which counts begin anew.
const ROOM: usize = RECEIVED.next_power_of_two();

/// The same as a count.
pub(crate) const ROUND: u32 = ROOM as u32;

static COMING: Ring = [const { AtomicU8::new(0) }; ROOM];
static LEAVING: Ring = [const { AtomicU8::new(0) }; ROOM];

/// Rounds that the receiver's DMA has ended, modulo 2^32.
static ROUNDS: AtomicU32 = AtomicU32::new(0);

/// Starts the DMA of the port whose data registers, of receiver and transmitter, are at these addresses.
pub(crate) fn start(data: [u32; 2], rcc: &mut Rcc) -> (LineTransmitter, LineReceiver) {
    dma::start(&COMING, data, rcc);
    let transmitter = LineTransmitter {
        written: 0,
        sent: 0,
        under_way: 0,
    };
    let receiver = LineReceiver {
        come: 0,
        read: 0,
        lost: 0,
    };
    (transmitter, receiver)
}

/// Counts a round of the receiver's ring, in the interrupt at its end.
#[inline(always)]
pub(crate) fn count_round() {
    dma::clear_round();
    let rounds = ROUNDS.load(Ordering::Relaxed);
    ROUNDS.store(rounds.wrapping_add(1), Ordering::Release);
}

/// Receiver of the line.
pub(crate) struct LineReceiver {
    /// Bytes that had come by the last look, bytes that were read, and bytes that were written over before; modulo 2^32.
    come: u32,
    read: u32,
    lost: u32,
}

impl LineReceiver {
    /// Returns the number of bytes that have come, modulo 2^32.
    #[inline(never)]
    fn look() -> u32 {
        loop {
            let rounds = ROUNDS.load(Ordering::Acquire);
            let left = dma::left(&COMING);
            // A round that ends meanwhile belongs to one of both numbers, and it is not known to which.
            if !dma::is_round_over() && ROUNDS.load(Ordering::Acquire) == rounds {
                return rounds
                    .wrapping_mul(ROUND)
                    .wrapping_add(ROUND)
                    .wrapping_sub(left);
            }
        }
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
            .map(|place| place.load(Ordering::Acquire));
        // Only now it is known that nothing was written over it.
        self.come = Self::look();
        let waiting = self.come.wrapping_sub(self.read);
        if waiting >= ROUND {
            // Nobody knows which of them are whole. Their frames are damaged, and the host repeats them.
            self.read = self.come;
            self.lost = self.lost.wrapping_add(waiting);
            defmt::warn!("the line has lost {=u32} bytes", self.lost);
            return None;
        }
        self.read = self.read.wrapping_add(1);
        byte
    }
}

/// Transmitter of the line.
pub(crate) struct LineTransmitter {
    /// Bytes that were put into the ring, bytes that have left, modulo 2^32, and those with the DMA.
    written: u32,
    sent: u32,
    under_way: u32,
}

impl LineTransmitter {
    /// Hands the next bytes to the DMA if it has sent those before: up to the ring's end, from where the next start goes on.
    #[inline(never)]
    fn go_on(&mut self) {
        if dma::is_sending() {
            return;
        }
        self.sent = self.sent.wrapping_add(self.under_way);
        let from = self.sent as usize % ROOM;
        self.under_way = self
            .written
            .wrapping_sub(self.sent)
            .min(ROUND - from as u32);
        if self.under_way > 0 {
            dma::send(LEAVING.get(from..).unwrap_or(&[]), self.under_way);
        }
    }

    fn is_full(&self) -> bool {
        self.written.wrapping_sub(self.sent) >= ROUND
    }
}

impl ErrorType for LineTransmitter {
    type Error = Infallible;
}

impl Write<u8> for LineTransmitter {
    #[inline(never)]
    fn write(&mut self, byte: u8) -> nb::Result<(), Infallible> {
        if self.is_full() {
            self.go_on();
            if self.is_full() {
                return Err(nb::Error::WouldBlock);
            }
        }
        if let Some(place) = LEAVING.get(self.written as usize % ROOM) {
            place.store(byte, Ordering::Relaxed);
        }
        self.written = self.written.wrapping_add(1);
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), Infallible> {
        self.go_on();
        match self.written == self.sent {
            true => Ok(()),
            false => Err(nb::Error::WouldBlock),
        }
    }
}
