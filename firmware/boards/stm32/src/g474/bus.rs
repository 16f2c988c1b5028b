//! CAN controller FDCAN1 with its message RAM (RM0440, chapter 44): three buffers out; three places in, which an interrupt
//! empties into a queue. CAN FD for moteus, classic CAN for the others.
#![allow(unsafe_code)]

use crate::clock::Clocks;
use crate::drives::bus::{self, Off, Received};
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use stm32_metapac::can::regs::{Rxgfc, Txbar, Txbcr};
use stm32_metapac::can::vals::Tfqm;
use stm32_metapac::{FDCAN1, FDCANRAM1, Interrupt, interrupt};
use trirrr_app::scene::drive::BIT_RATE_HZ;
#[cfg(not(drive = "moteus"))]
pub(crate) use trirrr_drives::can::ClassicFrame as BusFrame;
#[cfg(drive = "moteus")]
pub(crate) use trirrr_drives::can::FdFrame as BusFrame;
use trirrr_drives::can::{BitTiming, FdTiming, Moteus, length_code, length_of};

/// CAN FD, with another rate in the data.
const IS_FD: bool = cfg!(drive = "moteus");

/// Interrupt of reception.
pub(crate) const INTERRUPT: Interrupt = Interrupt::FDCAN1_IT0;

/// Reads of an acknowledgement that comes within a frame.
const READS: u32 = 10_000;

/// Bits on the bus.
pub(crate) enum BusTiming {
    /// Of one rate.
    Classic(BitTiming),
    /// Of a higher rate in the data.
    Fd(FdTiming),
}

/// Timing with the clock of the PLL. An image whose bits would take another time is not built.
const TIMING: BusTiming = {
    let clock_hz = crate::clock::FAST.apb1;
    match IS_FD {
        true => match FdTiming::new(clock_hz, BIT_RATE_HZ, Moteus::DATA_RATE_HZ) {
            Some(timing) => BusTiming::Fd(timing),
            None => panic!("the clock of the controller is no multiple of the bit rates of moteus"),
        },
        false => match BitTiming::new(clock_hz, BIT_RATE_HZ) {
            Some(timing) => BusTiming::Classic(timing),
            None => {
                panic!("bit_rate_hz of the scene: the clock of the controller is no multiple of it")
            }
        },
    }
};

/// Words of a frame in the message RAM: two of its head, 16 of data.
const PLACE: usize = 18;

/// Timing of the scene's bits. Only for a board that runs from its crystal and the PLL.
pub(crate) fn timing(_: &Clocks) -> Option<BusTiming> {
    Some(TIMING)
}

/// Sets timing and filters, which take frames whose identifiers are those of `filters` in the bits that count. Returns `false` if that is
/// not possible.
pub(crate) fn configure(timing: BusTiming, filters: &[(u16, u16); 3]) -> bool {
    FDCAN1.cccr().modify(|w| w.set_init(true));
    if !(0..READS).any(|_| FDCAN1.cccr().read().init()) {
        return false;
    }
    FDCAN1.cccr().modify(|w| w.set_cce(true));
    let nominal = match timing {
        BusTiming::Classic(nominal) => nominal,
        BusTiming::Fd(FdTiming {
            nominal,
            data,
            compensation,
        }) => {
            FDCAN1.cccr().modify(|w| {
                w.set_fdoe(true);
                w.set_brse(true);
            });
            FDCAN1.dbtp().write(|w| {
                w.set_dbrp((data.prescaler - 1) as u8);
                w.set_dtseg1(data.before_sample - 1);
                w.set_dtseg2(data.after_sample - 1);
                w.set_dsjw(data.after_sample - 1);
                // A bit comes back later than it lasts: sampled where the measured delay puts it.
                w.set_tdc(true);
            });
            FDCAN1.tdcr().write(|w| w.set_tdco(compensation));
            nominal
        }
    };
    FDCAN1.nbtp().write(|w| {
        w.set_nbrp((nominal.prescaler - 1) as u16);
        w.set_ntseg1(nominal.before_sample - 1);
        w.set_ntseg2(nominal.after_sample - 1);
        w.set_nsjw((nominal.after_sample - 1).min(15));
    });
    // The RAM is noise after power-on, and a place without a filter would be one.
    const { assert!(PLACE * 3 == 54) };
    for (index, (id, mask)) in filters.iter().enumerate() {
        let (id, mask) = (u32::from(*id), u32::from(*mask));
        // Both kinds of identifiers, each into FIFO 0 by identifier and mask (RM0440, 44.3.9 and 44.3.10). An identifier
        // of more than eleven bits is of the long kind alone.
        let standard = match id > 0x7FF {
            true => 0,
            false => 2 << 30 | 1 << 27 | id << 16 | mask & 0x7FF,
        };
        FDCANRAM1.flssa(index).write_value(standard);
        // Bits beyond the mask have to be 0.
        let extended = [1 << 29 | id, 2 << 30 | 0x1FFF_8000 | mask];
        for (word, value) in extended.into_iter().enumerate() {
            FDCANRAM1.flesa(2 * index + word).write_value(value);
        }
    }
    // Three filters of each kind. All else, and every remote frame, is rejected.
    let long = if IS_FD { 3 << 24 } else { 0 };
    FDCAN1
        .rxgfc()
        .write_value(Rxgfc(long | 3 << 16 | 0b10 << 4 | 0b10 << 2 | 0b11));
    FDCAN1.txbc().write(|w| w.set_tfqm(Tfqm::FIFO));
    FDCAN1.ie().write(|w| {
        w.set_rfne(0, true);
        w.set_rfle(0, true);
    });
    FDCAN1.ile().write(|w| w.set_eint0(true));
    FDCAN1.cccr().modify(|w| w.set_init(false));
    true
}

/// Takes the frames that are there into the queue. One that comes meanwhile calls the interrupt again.
#[inline(always)]
pub(crate) fn receive(frames: &mut Received) {
    let flags = FDCAN1.ir().read();
    FDCAN1.ir().write_value(flags);
    if flags.rfl(0) {
        bus::count_lost();
    }
    for _ in 0..3 {
        let status = FDCAN1.rxfs(0).read();
        if status.ffl() == 0 {
            return;
        }
        let place = status.fgi();
        let frame = received(usize::from(place.min(2)) * PLACE);
        FDCAN1.rxfa(0).write(|w| w.set_fai(place));
        if let Some(frame) = frame {
            bus::put(frames, frame);
        }
    }
}

/// Word of the message RAM at `first` behind `start`.
#[inline(always)]
fn word(start: *mut u32, first: usize) -> *mut u32 {
    start.wrapping_add(first)
}

/// The frame of FIFO 0 at word `first`, of which there are 54.
#[inline(always)]
fn received(first: usize) -> Option<BusFrame> {
    let start = word(FDCANRAM1.rxfifo0(0).as_ptr(), first);
    // SAFETY: a word of the message RAM, whose places begin within 54 words and are 18 words long.
    let read = |at: usize| unsafe { word(start, at).read_volatile() };
    let (head, kind) = (read(0), read(1));
    let id = match head & 1 << 30 != 0 {
        true => ExtendedId::new(head & 0x1FFF_FFFF).map(Id::Extended),
        false => StandardId::new((head >> 18 & 0x7FF) as u16).map(Id::Standard),
    };
    let mut data = [0; 64];
    for (at, bytes) in data.as_chunks_mut().0.iter_mut().enumerate() {
        *bytes = read(2 + at).to_le_bytes();
    }
    // A classic frame may say that it has more than eight bytes, and has eight.
    let length = match (kind >> 21 & 1 != 0, length_of((kind >> 16) as u8)) {
        (true, length) => length,
        (false, length) => length.min(8),
    };
    BusFrame::new(id?, data.get(..length)?)
}

/// Moves frames from the bus into their queue. Above the tick, and everything else: the controller holds three frames, and a tick may
/// take longer than three take to come.
#[interrupt]
fn FDCAN1_IT0() {
    static mut OWN: Option<Received> = None;
    bus::run(OWN);
}

/// Puts a frame into a buffer.
#[inline]
pub(crate) fn transmit(frame: &BusFrame) -> nb::Result<(), Off> {
    if FDCAN1.psr().read().bo() {
        // Back on the bus after 128 times 11 recessive bits.
        FDCAN1.cccr().modify(|w| w.set_init(false));
        return Err(nb::Error::Other(Off));
    }
    let status = FDCAN1.txfqs().read();
    if status.tfqf() {
        return Err(nb::Error::WouldBlock);
    }
    let Some(code) = length_code(frame.dlc()) else {
        return Err(nb::Error::Other(Off));
    };
    let place = status.tfqpi().min(2);
    let start = word(FDCANRAM1.txbuf(0).as_ptr(), usize::from(place) * PLACE);
    // SAFETY: a word of the message RAM, whose places begin within 54 words and are 18 words long; the controller reads
    // none of a place before it is asked to.
    let write = |at: usize, value: u32| unsafe { word(start, at).write_volatile(value) };
    let remote = u32::from(frame.is_remote_frame()) << 29;
    write(
        0,
        remote
            | match frame.id() {
                Id::Standard(id) => u32::from(id.as_raw()) << 18,
                Id::Extended(id) => 1 << 30 | id.as_raw(),
            },
    );
    // CAN FD with its other rate in the data.
    let fd = if IS_FD { 0b11 << 20 } else { 0 };
    write(1, fd | u32::from(code) << 16);
    for (at, bytes) in frame.data().chunks(4).enumerate() {
        let mut whole = [0; 4];
        for (to, from) in whole.iter_mut().zip(bytes) {
            *to = *from;
        }
        write(2 + at, u32::from_le_bytes(whole));
    }
    FDCAN1.txbar().write_value(Txbar(1 << place));
    Ok(())
}

/// Empties the buffers. A frame under way goes to its end: 135 bits.
pub(crate) fn abort() {
    FDCAN1.txbcr().write_value(Txbcr(0b111));
    let _ = (0..READS).any(|_| FDCAN1.txbrp().read().0 & 0b111 == 0);
}
