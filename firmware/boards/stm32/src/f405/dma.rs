//! DMA of the line's port, a stream for each direction (RM0090, chapter 10).
//!
//! An emulator has none: there the background moves the bytes.

use crate::board::{
    LINE_CONTROLLER, LINE_PORT, LINE_RECEIVE_REQUEST, LINE_RECEIVE_STREAM, LINE_TRANSMIT_REQUEST,
    LINE_TRANSMIT_STREAM,
};
use core::sync::atomic::{AtomicU8, Ordering, fence};
use stm32_metapac::dma::St;
use stm32_metapac::dma::regs::{Cr, Ixr};
use stm32_metapac::dma::vals::Dir;

/// Flags of a stream in its register: the places of the first are those of stream 0.
const fn flags(stream: usize, of_first: u32) -> Ixr {
    Ixr(of_first << [0, 6, 16, 22][stream % 4])
}

/// All flags of a stream, and that of its end, at the place of stream 0.
const ALL: u32 = 0x3D;
const END: u32 = 1 << 5;

const fn receiver() -> St {
    LINE_CONTROLLER.st(LINE_RECEIVE_STREAM)
}

const fn transmitter() -> St {
    LINE_CONTROLLER.st(LINE_TRANSMIT_STREAM)
}

/// Settings of both streams, which move single bytes.
fn receives() -> Cr {
    let mut settings = Cr(0);
    settings.set_chsel(LINE_RECEIVE_REQUEST);
    settings.set_minc(true);
    settings.set_circ(true);
    settings.set_tcie(true);
    settings
}

fn transmits() -> Cr {
    let mut settings = Cr(0);
    settings.set_chsel(LINE_TRANSMIT_REQUEST);
    settings.set_minc(true);
    settings.set_dir(Dir::MEMORY_TO_PERIPHERAL);
    settings
}

/// Starts to receive into `ring`, and sets the transmitter up.
pub(crate) fn start(ring: &'static [AtomicU8]) {
    for (stream, settings) in [(receiver(), receives()), (transmitter(), transmits())] {
        stream.par().write_value(LINE_PORT.dr().as_ptr() as u32);
        stream.cr().write_value(settings);
    }
    set_memory(receiver(), ring);
    switch_on(receiver(), receives());
}

/// Gives a stream that is off its memory.
fn set_memory(stream: St, bytes: &'static [AtomicU8]) {
    stream.m0ar().write_value(bytes.as_ptr() as u32);
    stream.ndtr().write(|w| w.set_ndt(bytes.len() as u16));
}

fn switch_on(stream: St, mut settings: Cr) {
    settings.set_en(true);
    stream.cr().write_value(settings);
}

/// Returns false in an emulator, whose registers read 0 whatever is written.
pub(crate) fn is_there() -> bool {
    // It receives for ever.
    receiver().cr().read().en()
}

/// Returns the number of bytes that the round under way still takes.
pub(crate) fn left() -> u32 {
    receiver().ndtr().read().ndt().into()
}

/// Returns true if a round is over that is not counted yet.
pub(crate) fn is_round_over() -> bool {
    let raised = LINE_CONTROLLER.isr(LINE_RECEIVE_STREAM / 4).read();
    raised.0 & const { flags(LINE_RECEIVE_STREAM, END) }.0 != 0
}

/// Clears the flag of a round that is over.
#[inline(always)]
pub(crate) fn clear_round() {
    let register = LINE_CONTROLLER.ifcr(LINE_RECEIVE_STREAM / 4);
    register.write_value(const { flags(LINE_RECEIVE_STREAM, END) });
}

/// Returns true until the last byte of what was to be sent is with the port.
pub(crate) fn is_sending() -> bool {
    transmitter().cr().read().en()
}

/// Sends `bytes`. Only while no others [are being sent](is_sending).
pub(crate) fn send(bytes: &'static [AtomicU8]) {
    let register = LINE_CONTROLLER.ifcr(LINE_TRANSMIT_STREAM / 4);
    register.write_value(const { flags(LINE_TRANSMIT_STREAM, ALL) });
    set_memory(transmitter(), bytes);
    // The bytes are in the memory before the DMA looks.
    fence(Ordering::Release);
    switch_on(transmitter(), transmits());
}

/// Takes a byte from the port, where no DMA does.
pub(crate) fn byte_without() -> Option<u8> {
    let has_come = LINE_PORT.sr().read().rxne();
    has_come.then(|| LINE_PORT.dr().read().dr() as u8)
}

/// Gives a byte to the port, where no DMA does. That of an emulator never has to wait.
pub(crate) fn put_without(byte: u8) {
    LINE_PORT.dr().write(|w| w.set_dr(byte.into()));
}
