//! DMA of the line's port, a stream for each direction (RM0090, chapter 10).
//!
//! An emulator has none: there the background moves the bytes.
#![allow(unsafe_code)]

use crate::board::{
    LINE_RECEIVE_REQUEST, LINE_RECEIVE_STREAM, LINE_TRANSMIT_REQUEST, LINE_TRANSMIT_STREAM,
    LineController, LinePort,
};
use crate::line::SharedBytes;
use crate::parts::Rcc;
use core::sync::atomic::{AtomicU8, Ordering, fence};
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

/// Starts to receive into the first of `memories`, and sets the transmitter up to send from the second. `data` are the addresses of the port's
/// data, of receiver and transmitter.
pub(crate) fn start(memories: [&'static SharedBytes; 2], data: [u32; 2], rcc: &mut Rcc) {
    LineController::enable(rcc);
    let streams = [
        (LINE_RECEIVE_STREAM, RECEIVES),
        (LINE_TRANSMIT_STREAM, TRANSMITS),
    ];
    for (((stream, settings), data), memory) in streams.into_iter().zip(data).zip(memories) {
        let stream = controller().st(stream);
        // SAFETY: the stream is off, as after a reset; the address is that of the port; the bytes are atomic, and as many as a round.
        unsafe {
            stream.par().write(|w| w.bits(data));
            stream.m0ar().write(|w| w.bits(memory.as_ptr() as u32));
            stream.ndtr().write(|w| w.bits(memory.len() as u32));
            stream.cr().write(|w| w.bits(settings));
        }
    }
    switch_on(LINE_RECEIVE_STREAM, RECEIVES);
}

fn switch_on(stream: usize, settings: u32) {
    // SAFETY: the settings of the start, which stay as they are.
    unsafe {
        controller()
            .st(stream)
            .cr()
            .write(|w| w.bits(settings | ON))
    };
}

/// Returns false in an emulator, whose registers read 0 whatever is written.
pub(crate) fn is_there() -> bool {
    // It receives for ever.
    controller().st(LINE_RECEIVE_STREAM).cr().read().bits() & ON != 0
}

/// Returns the number of bytes that the round under way still takes.
pub(crate) fn left() -> u32 {
    controller().st(LINE_RECEIVE_STREAM).ndtr().read().bits()
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

/// Sends `bytes`, from the beginning of the memory of the [start]. Only while nothing [is being sent](is_sending).
pub(crate) fn send(bytes: &'static [AtomicU8]) {
    clear(LINE_TRANSMIT_STREAM, FLAGS);
    let number = controller().st(LINE_TRANSMIT_STREAM).ndtr();
    // SAFETY: the stream is off, and the bytes are no more.
    unsafe { number.write(|w| w.bits(bytes.len() as u32)) };
    // The bytes are in the memory before the DMA looks.
    fence(Ordering::Release);
    switch_on(LINE_TRANSMIT_STREAM, TRANSMITS);
}

/// Takes a byte from the port, where no DMA does.
pub(crate) fn byte_without() -> Option<u8> {
    let has_come = port().sr().read().rxne().bit_is_set();
    has_come.then(|| port().dr().read().bits() as u8)
}

/// Gives a byte to the port, where no DMA does. That of an emulator never has to wait.
pub(crate) fn put_without(byte: u8) {
    port().dr().write(|w| w.dr().set(byte.into()));
}
