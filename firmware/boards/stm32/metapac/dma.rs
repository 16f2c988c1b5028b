//! DMA of the line's port, a channel for each direction, and the multiplexer of their requests (RM0440, chapters 12 and 13).

use crate::board::{
    LINE_CONTROLLER, LINE_RECEIVE_REQUEST, LINE_RECEIVE_STREAM, LINE_TRANSMIT_REQUEST,
    LINE_TRANSMIT_STREAM,
};
use crate::line::{ROUND, SharedBytes};
use crate::parts::Rcc;
use core::sync::atomic::{AtomicU8, Ordering, fence};
use stm32_metapac::bdma::vals::Dir;
use stm32_metapac::bdma::{Ch, regs};
use stm32_metapac::{DMAMUX1, RCC};

/// Indices of the channels, which the manual counts from 1.
const RECEIVE: usize = LINE_RECEIVE_STREAM - 1;
const TRANSMIT: usize = LINE_TRANSMIT_STREAM - 1;

const fn receiver() -> Ch {
    LINE_CONTROLLER.ch(RECEIVE)
}

const fn transmitter() -> Ch {
    LINE_CONTROLLER.ch(TRANSMIT)
}

/// Starts to receive into the first of `memories`, and sets the transmitter up to send from the second. `data` are the addresses of the port's
/// data, of receiver and transmitter.
pub(crate) fn start(memories: [&'static SharedBytes; 2], data: [u32; 2], _: &mut Rcc) {
    RCC.ahb1enr().modify(|w| {
        w.set_dma1en(true);
        w.set_dmamux1en(true);
    });
    // The channels of DMA1 are the first of the multiplexer.
    for (channel, request) in [
        (RECEIVE, LINE_RECEIVE_REQUEST),
        (TRANSMIT, LINE_TRANSMIT_REQUEST),
    ] {
        DMAMUX1.ccr(channel).write(|w| w.set_dmareq_id(request));
    }
    for ((channel, data), memory) in [receiver(), transmitter()]
        .into_iter()
        .zip(data)
        .zip(memories)
    {
        channel.par().write_value(data);
        channel.mar().write_value(memory.as_ptr() as u32);
    }
    receiver().ndtr().write(|w| w.set_ndt(ROUND as u16));
    receiver().cr().write(|w| {
        w.set_minc(true);
        w.set_circ(true);
        w.set_tcie(true);
        w.set_en(true);
    });
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

/// Sends `bytes`, from the beginning of the memory of the [start]. Only while nothing [is being sent](is_sending).
pub(crate) fn send(bytes: &'static [AtomicU8]) {
    // It stays on at its end, and takes a number only while it is off.
    transmitter().cr().write_value(regs::Cr(0));
    transmitter()
        .ndtr()
        .write(|w| w.set_ndt(bytes.len() as u16));
    // The bytes are in the memory before the DMA looks.
    fence(Ordering::Release);
    transmitter().cr().write(|w| {
        w.set_dir(Dir::FROM_MEMORY);
        w.set_minc(true);
        w.set_en(true);
    });
}
