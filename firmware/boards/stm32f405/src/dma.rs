//! DMA of the line's port, a stream for each direction (RM0090, chapter 10).
//!
//! An emulator has no DMA: its registers read 0 whatever is written. There these functions move the bytes, one in each look of the background.
#![allow(unsafe_code)]

use crate::board::{
    LINE_RECEIVE_REQUEST, LINE_RECEIVE_STREAM, LINE_TRANSMIT_REQUEST, LINE_TRANSMIT_STREAM,
    LineController, LinePort,
};
use crate::line::{ROUND, Ring, count_round};
use crate::parts::Rcc;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering, fence};
use stm32f4xx_hal::pac::{dma2, usart1};
use stm32f4xx_hal::rcc::Enable;

/// Bits of a stream's settings: on; interrupt at the end; to the port; round after round; the memory's address counts.
const ON: u32 = 1;
const INTERRUPT: u32 = 1 << 4;
const TO_PORT: u32 = 1 << 6;
const CIRCULAR: u32 = 1 << 8;
const COUNTS: u32 = 1 << 10;

/// A round may not wait: the next byte is 1,822 cycles away.
const RECEIVES: u32 = (LINE_RECEIVE_REQUEST as u32) << 25 | COUNTS | CIRCULAR | INTERRUPT;
const TRANSMITS: u32 = (LINE_TRANSMIT_REQUEST as u32) << 25 | COUNTS | TO_PORT;

/// All flags of a stream, and that of its end, at the place of stream 0.
const FLAGS: u32 = 0x3D;
const END: u32 = 1 << 5;

fn controller() -> &'static dma2::RegisterBlock {
    // SAFETY: only the functions of this module use the controller, those of the receiver's flags in any context: each such
    // access is a single read, or a write that leaves the other flags alone.
    unsafe { &*LineController::ptr() }
}

fn port() -> &'static usart1::RegisterBlock {
    // SAFETY: the HAL has started the port, and nothing else uses it afterwards.
    unsafe { &*LinePort::ptr() }
}

/// Place of a stream's flags in their register.
const fn place(stream: usize) -> u32 {
    [0, 6, 16, 22][stream % 4]
}

fn clear(stream: usize, flags: u32) {
    let flags = flags << place(stream);
    // SAFETY: a written 1 clears its flag, a 0 does nothing.
    unsafe {
        match stream < 4 {
            true => controller().lifcr().write(|w| w.bits(flags)),
            false => controller().hifcr().write(|w| w.bits(flags)),
        };
    }
}

/// Address of the first byte.
fn address(bytes: &'static [AtomicU8]) -> u32 {
    bytes.as_ptr() as u32
}

/// Starts to receive into `ring`, and sets the transmitter up. `data` are the addresses of the port's data, of receiver and transmitter.
pub(crate) fn start(ring: &'static Ring, data: [u32; 2], rcc: &mut Rcc) {
    LineController::enable(rcc);
    let streams = [
        (LINE_RECEIVE_STREAM, RECEIVES),
        (LINE_TRANSMIT_STREAM, TRANSMITS),
    ];
    for ((stream, settings), data) in streams.into_iter().zip(data) {
        let stream = controller().st(stream);
        // SAFETY: the stream is off, as after a reset, and the address is that of the port.
        unsafe {
            stream.par().write(|w| w.bits(data));
            stream.cr().write(|w| w.bits(settings));
        }
    }
    let stream = controller().st(LINE_RECEIVE_STREAM);
    // SAFETY: the DMA writes into a ring of atomic bytes, as many as it has.
    unsafe {
        stream.m0ar().write(|w| w.bits(address(ring)));
        stream.ndtr().write(|w| w.bits(ROUND));
        stream.cr().write(|w| w.bits(RECEIVES | ON));
    }
}

/// Returns the number of bytes that the round under way still takes.
pub(crate) fn left(ring: &'static Ring) -> u32 {
    match controller().st(LINE_RECEIVE_STREAM).ndtr().read().bits() {
        0 => left_without(ring),
        left => left,
    }
}

/// Returns true if a round is over that is not counted yet.
pub(crate) fn is_round_over() -> bool {
    let flags = match LINE_RECEIVE_STREAM < 4 {
        true => controller().lisr().read().bits(),
        false => controller().hisr().read().bits(),
    };
    flags & END << place(LINE_RECEIVE_STREAM) != 0
}

/// Clears the flag of a round that is over.
#[inline(always)]
pub(crate) fn clear_round() {
    clear(LINE_RECEIVE_STREAM, END);
}

/// Returns true until the last byte of what was to be sent is with the port.
pub(crate) fn is_sending() -> bool {
    controller().st(LINE_TRANSMIT_STREAM).cr().read().bits() & ON != 0
}

/// Sends the first `count` bytes. Only while nothing [is being sent](is_sending).
pub(crate) fn send(bytes: &'static [AtomicU8], count: u32) {
    let stream = controller().st(LINE_TRANSMIT_STREAM);
    clear(LINE_TRANSMIT_STREAM, FLAGS);
    // SAFETY: the stream is off, and only reads the bytes.
    unsafe {
        stream.m0ar().write(|w| w.bits(address(bytes)));
        stream.ndtr().write(|w| w.bits(count));
    }
    if stream.ndtr().read().bits() == 0 {
        return send_without(bytes, count);
    }
    // The bytes are in the memory before the DMA looks.
    fence(Ordering::Release);
    // SAFETY: the settings are those of the start.
    unsafe { stream.cr().write(|w| w.bits(TRANSMITS | ON)) };
}

/// Takes a byte from the port as the DMA would.
fn left_without(ring: &Ring) -> u32 {
    static TAKEN: AtomicU32 = AtomicU32::new(0);
    let taken = TAKEN.load(Ordering::Relaxed);
    if port().sr().read().rxne().bit_is_clear() {
        return ROUND - taken;
    }
    if let Some(place) = ring.get(taken as usize) {
        place.store(port().dr().read().bits() as u8, Ordering::Relaxed);
    }
    let taken = (taken + 1) % ROUND;
    TAKEN.store(taken, Ordering::Relaxed);
    if taken == 0 {
        count_round();
    }
    ROUND - taken
}

/// Gives bytes to the port as the DMA would. The port of an emulator never has to wait.
fn send_without(bytes: &[AtomicU8], count: u32) {
    for byte in bytes.iter().take(count as usize) {
        let byte = byte.load(Ordering::Relaxed);
        port().dr().write(|w| w.dr().set(byte.into()));
    }
}
