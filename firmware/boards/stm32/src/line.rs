//! Line: bytes by DMA, in both directions.
//!
//! The receiver's DMA fills its ring round after round. An interrupt counts the rounds, so the number of bytes that have come is exact at any time,
//! and a background that was late by a round knows how many it has missed. It looks at that number in each of its turns, and needs
//! no interrupt at a byte, nor where the line falls idle. The transmitter's DMA sends one half while the background fills the other.

pub(crate) use self::NoPackets as PacketReceiver;
use crate::board::{LINE_FUNCTION, LINE_PORT, LinePins};
use crate::chip::dma;
use crate::clock::Clocks;
use crate::gpio::Pull;
use crate::serial;
use core::convert::Infallible;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering, compiler_fence};
use embedded_hal_nb::serial::{ErrorType, Write};
use trirrr_app::{BAUD, ReceivedBytes};

/// Places of the receiver, bytes. At 921,600 baud they last for 11 ms. The size of a round divides the 2^32 at which counts begin anew.
const ROOM: usize = 1024;

/// The same as a count.
const ROUND: u32 = ROOM as u32;

/// Places in each half of the transmitter, bytes. A longer frame leaves in two parts.
const HALF: usize = 160;

static COMING: [AtomicU8; ROOM] = [const { AtomicU8::new(0) }; ROOM];
static LEAVING: [[AtomicU8; HALF]; 2] = [const { [const { AtomicU8::new(0) }; HALF] }; 2];

/// Rounds that the receiver's DMA has ended, modulo 2^32.
static ROUNDS: AtomicU32 = AtomicU32::new(0);

/// Bytes that were written over before the background took them, modulo 2^32.
static MISSED: AtomicU32 = AtomicU32::new(0);

/// Memory beside the one of the DMA.
pub(crate) struct LineMemory;

impl LineMemory {
    pub(crate) const fn new() -> Self {
        Self
    }
}

/// Part of the line in the interrupt of USB: none.
pub(crate) type NoPackets = ();

/// Starts the port at its pins.
pub(crate) fn start(
    _: &'static mut LineMemory,
    pins: LinePins,
    clocks: &Clocks,
) -> (NoPackets, LineReceiver, LineTransmitter) {
    // At rest the line is high: without an adapter at the pin noise would be bytes.
    let _ = (
        pins.line_transmit.into_alternate::<LINE_FUNCTION>(),
        pins.line_receive
            .into_alternate::<LINE_FUNCTION>()
            .internal_resistor(Pull::Up),
    );
    // The first byte finds the DMA waiting.
    dma::start(&COMING);
    serial::configure(LINE_PORT, BAUD, true, clocks);
    let transmitter = LineTransmitter {
        half: &LEAVING[0],
        waiting: 0,
    };
    ((), LineReceiver { come: 0, read: 0 }, transmitter)
}

/// Waits for nothing: the DMA has room for all that comes.
pub(crate) fn resume() {}

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
    fn look(&self) -> u32 {
        if dma::is_there() {
            loop {
                let rounds = ROUNDS.load(Ordering::Relaxed);
                in_order();
                let left = dma::left();
                // A round that ends meanwhile belongs to one of both numbers, and it is not known to which.
                let is_over = dma::is_round_over();
                in_order();
                let ends = rounds.wrapping_add(1).wrapping_mul(ROUND);
                let come = ends.wrapping_sub(left);
                // Fewer than at the last look: the DMA has begun a round, and its flag comes some cycles later.
                let is_behind = (come.wrapping_sub(self.come) as i32) < 0;
                if !is_over && !is_behind && ROUNDS.load(Ordering::Relaxed) == rounds {
                    return come;
                }
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
            self.come = self.look();
            if self.come == self.read {
                return None;
            }
        }
        let byte = COMING
            .get(self.read as usize % ROOM)
            .map(|place| place.load(Ordering::Relaxed));
        in_order();
        // Only now it is known that nothing was written over it.
        self.come = self.look();
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

/// Transmitter of the line: frames are put beside each other while those before are being sent.
pub(crate) struct LineTransmitter {
    /// Half that is being filled, and the bytes in it.
    half: &'static [AtomicU8; HALF],
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
        let place = self.half.get(self.waiting);
        let place = place.ok_or(nb::Error::WouldBlock)?;
        place.store(byte, Ordering::Relaxed);
        self.waiting += 1;
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), Infallible> {
        if dma::is_sending() {
            return Err(nb::Error::WouldBlock);
        }
        if let Some(bytes @ [_, ..]) = self.half.get(..self.waiting) {
            dma::send(bytes);
            let [first, second] = &LEAVING;
            self.half = match core::ptr::eq(self.half, first) {
                true => second,
                false => first,
            };
            self.waiting = 0;
        }
        Ok(())
    }
}
