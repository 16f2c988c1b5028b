//! CAN controller CAN1 (bxCAN, RM0090 chapter 32): three mailboxes out; three places in, which an interrupt empties into a
//! queue.

use crate::clock::Clocks;
use crate::drives::bus::{self, Off, Received};
use embedded_can::{Frame, Id, StandardId};
use stm32_metapac::can::regs::{Fr1, Fr2};
use stm32_metapac::can::vals::Rtr;
use stm32_metapac::{CAN1, Interrupt, interrupt};
use trirrr_app::scene::drive::BIT_RATE_HZ;
pub(crate) use trirrr_drives::can::{BitTiming as BusTiming, ClassicFrame as BusFrame};

/// Interrupt of reception.
pub(crate) const INTERRUPT: Interrupt = Interrupt::CAN1_RX0;

/// Reads of an acknowledgement that comes within a bit.
const READS: u32 = 10_000;

/// Timing of the scene's bits, none if the clock is no multiple of their rate.
pub(crate) fn timing(clocks: &Clocks) -> Option<BusTiming> {
    BusTiming::new(clocks.apb1, BIT_RATE_HZ)
}

/// Sets timing and filters, which take frames whose identifiers are those of `filters` in the bits that count. Returns `false` if that is
/// not possible.
pub(crate) fn configure(timing: BusTiming, filters: &[(u16, u16); 3]) -> bool {
    CAN1.mcr().modify(|w| {
        w.set_sleep(false);
        w.set_inrq(true);
    });
    if !(0..READS).any(|_| CAN1.msr().read().inak()) {
        return false;
    }
    // Back on the bus by itself after 128 times 11 recessive bits; mailboxes by the order of requests.
    CAN1.mcr().modify(|w| {
        w.set_abom(true);
        w.set_txfp(true);
    });
    CAN1.fmr().modify(|w| w.set_finit(true));
    CAN1.fs1r().write(|w| w.0 = 0b111);
    // Fields of the timing are less by one than the numbers; it jumps by two quanta.
    CAN1.btr().write(|w| {
        w.set_brp((timing.prescaler - 1) as u16);
        w.set_ts(0, timing.before_sample - 1);
        w.set_ts(1, timing.after_sample - 1);
        w.set_sjw(1);
    });
    // The identifier is above bit 20, bits 1 and 2 are remote and extended.
    for (bank, (id, mask)) in filters.iter().enumerate() {
        let place = CAN1.fb(bank);
        place.fr1().write_value(Fr1(u32::from(*id) << 21));
        place.fr2().write_value(Fr2(u32::from(*mask) << 21 | 0b110));
    }
    CAN1.fa1r().write(|w| w.0 = 0b111);
    CAN1.fmr().modify(|w| w.set_finit(false));
    CAN1.ier().write(|w| w.set_fmpie(0, true));
    CAN1.mcr().modify(|w| w.set_inrq(false));
    true
}

/// Takes one frame into the queue. The interrupt comes again as long as there are others.
#[inline(always)]
pub(crate) fn receive(frames: &mut Received) {
    let status = CAN1.rfr(0).read();
    if status.fovr() {
        CAN1.rfr(0).write(|w| w.set_fovr(true));
        bus::count_lost();
    }
    // The place of the frame before may not be free yet.
    if status.rfom() || status.fmp() == 0 {
        return;
    }
    let place = CAN1.rx(0);
    let id = StandardId::new(place.rir().read().stid());
    let length = place.rdtr().read().dlc();
    let [a, b, c, d] = place.rdlr().read().0.to_le_bytes();
    let [e, f, g, h] = place.rdhr().read().0.to_le_bytes();
    CAN1.rfr(0).write(|w| w.set_rfom(true));
    let Some(id) = id else {
        return;
    };
    bus::put(
        frames,
        BusFrame::of(id.into(), length, [a, b, c, d, e, f, g, h]),
    );
}

/// Moves a frame from the bus into its queue. Above the tick, and everything else: the controller holds three frames,
/// and at 1 Mbit/s a fourth is there after 444 us, less than a tick may take.
#[interrupt]
fn CAN1_RX0() {
    static mut OWN: Option<Received> = None;
    bus::run(OWN);
}

/// Puts a frame into a mailbox.
#[inline]
pub(crate) fn transmit(frame: &BusFrame) -> nb::Result<(), Off> {
    if CAN1.esr().read().boff() {
        return Err(nb::Error::Other(Off));
    }
    let status = CAN1.tsr().read();
    let mailbox = (0..3).find(|mailbox| status.tme(*mailbox));
    let place = CAN1.tx(mailbox.ok_or(nb::Error::WouldBlock)?);
    let Id::Standard(id) = frame.id() else {
        return Err(nb::Error::Other(Off));
    };
    let [low, high] = frame.words();
    place.tdtr().write(|w| w.set_dlc(frame.dlc() as u8));
    place.tdlr().write(|w| w.0 = low);
    place.tdhr().write(|w| w.0 = high);
    place.tir().write(|w| {
        w.set_stid(id.as_raw());
        w.set_rtr(Rtr::from_bits(frame.is_remote_frame().into()));
        w.set_txrq(true);
    });
    Ok(())
}

/// Empties the mailboxes. A frame under way goes to its end: 135 bits.
pub(crate) fn abort() {
    let all = 0..3;
    CAN1.tsr().write(|w| {
        for mailbox in all.clone() {
            w.set_abrq(mailbox, true);
        }
    });
    let _ = (0..READS).any(|_| {
        let status = CAN1.tsr().read();
        all.clone().all(|mailbox| status.tme(mailbox))
    });
}
