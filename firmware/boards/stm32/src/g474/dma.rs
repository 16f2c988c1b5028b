//! DMA of the line's port, a channel for each direction, and the multiplexer of their requests (RM0440, chapters 12 and 13).

use crate::board::{
    LINE_CONTROLLER, LINE_PORT, LINE_RECEIVE_REQUEST, LINE_RECEIVE_STREAM, LINE_TRANSMIT_REQUEST,
    LINE_TRANSMIT_STREAM,
};
use core::sync::atomic::{AtomicU8, Ordering, fence};
use stm32_metapac::DMAMUX1;
use stm32_metapac::bdma::vals::Dir;
use stm32_metapac::bdma::{Ch, regs};

/// Indices of the channels, which the manual counts from 1.
const RECEIVE: usize = LINE_RECEIVE_STREAM - 1;
const TRANSMIT: usize = LINE_TRANSMIT_STREAM - 1;

const fn receiver() -> Ch {
    LINE_CONTROLLER.ch(RECEIVE)
}

const fn transmitter() -> Ch {
    LINE_CONTROLLER.ch(TRANSMIT)
}

/// Starts to receive into `ring`, and sets the transmitter up.
pub(crate) fn start(ring: &'static [AtomicU8]) {
    // The channels of DMA1 are the first of the multiplexer.
    for (channel, request) in [
        (RECEIVE, LINE_RECEIVE_REQUEST),
        (TRANSMIT, LINE_TRANSMIT_REQUEST),
    ] {
        DMAMUX1.ccr(channel).write(|w| w.set_dmareq_id(request));
    }
    receiver()
        .par()
        .write_value(LINE_PORT.rdr().as_ptr() as u32);
    transmitter()
        .par()
        .write_value(LINE_PORT.tdr().as_ptr() as u32);
    set_memory(receiver(), ring);
    receiver().cr().write(|w| {
        w.set_minc(true);
        w.set_circ(true);
        w.set_tcie(true);
        w.set_en(true);
    });
}

/// Gives a channel that is off its memory.
fn set_memory(channel: Ch, bytes: &'static [AtomicU8]) {
    channel.mar().write_value(bytes.as_ptr() as u32);
    channel.ndtr().write(|w| w.set_ndt(bytes.len() as u16));
}

/// Returns true: no emulator of this chip is without.
pub(crate) const fn is_there() -> bool {
    true
}

/// Takes no byte: the DMA does.
pub(crate) const fn byte_without() -> Option<u8> {
    None
}

/// Gives no byte to the port: the DMA does.
pub(crate) const fn put_without(_: u8) {}

/// Returns the number of bytes that the round under way still takes.
pub(crate) fn left() -> u32 {
    receiver().ndtr().read().ndt().into()
}

/// Returns true if a round is over that is not counted yet.
pub(crate) fn is_round_over() -> bool {
    LINE_CONTROLLER.isr().read().tcif(RECEIVE)
}

/// Clears the flag of a round that is over.
#[inline(always)]
pub(crate) fn clear_round() {
    LINE_CONTROLLER.ifcr().write(|w| w.set_tcif(RECEIVE, true));
}

/// Returns true until the last byte of what was to be sent is with the port.
pub(crate) fn is_sending() -> bool {
    transmitter().ndtr().read().ndt() != 0
}

/// Sends `bytes`. Only while no others [are being sent](is_sending).
pub(crate) fn send(bytes: &'static [AtomicU8]) {
    // It stays on at its end, and takes a memory only while it is off.
    transmitter().cr().write_value(regs::Cr(0));
    set_memory(transmitter(), bytes);
    // The bytes are in the memory before the DMA looks.
    fence(Ordering::Release);
    transmitter().cr().write(|w| {
        w.set_dir(Dir::FROM_MEMORY);
        w.set_minc(true);
        w.set_en(true);
    });
}
