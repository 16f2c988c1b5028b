//! CAN controller (bxCAN, RM0090 chapter 32): three mailboxes out; three places in, which an interrupt empties into a
//! queue.
//!
//! Nothing waits without bound. Frames go out in the order in which they came. The controller repeats a frame
//! until a drive has acknowledged it. Frames come in from the drives alone: a filter for each of them keeps others out.
#![allow(unsafe_code)]

use super::can::handover::{self, Off};
use crate::clock::Clocks;
use embedded_can::{Id, StandardId};
use heapless::spsc::{Consumer, Producer};
use stm32f4xx_hal::pac::{CAN1, Interrupt, interrupt};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};
use trirrr_app::scene::drive::BIT_RATE_HZ;
pub(crate) use trirrr_drives::can::ClassicFrame as BusFrame;
use trirrr_drives::can::{BitTiming, Bus, ClassicFrame};

/// CAN1 as the tick sees it: all three mailboxes, and the queue of what came in.
pub(crate) struct BusController {
    can: CAN1,
    /// The start has not failed.
    runs: bool,
    inbox: Consumer<'static, ClassicFrame>,
}

/// CAN1 as its interrupt sees it: the places of received frames, and the queue.
pub(super) struct FrameReceiver {
    can: CAN1,
    frames: Producer<'static, ClassicFrame>,
}

/// Reads of an acknowledgement that comes within a bit.
const READS: u32 = 10_000;

impl BusController {
    /// Timing of the scene's bits, none if the clock is no multiple of their rate.
    pub(super) fn timing(clocks: &Clocks) -> Option<BitTiming> {
        BitTiming::new(clocks.apb1, BIT_RATE_HZ)
    }

    /// Starts the controller with this bit timing, or fails without one. It takes frames whose identifiers are those of
    /// `filters` in the bits that count. The controller takes part once the bus has been idle.
    pub(super) fn start(
        can: CAN1,
        rcc: &mut Rcc,
        timing: Option<BitTiming>,
        filters: &[(u16, u16); 3],
        frames: Producer<'static, ClassicFrame>,
        inbox: Consumer<'static, ClassicFrame>,
    ) -> Self {
        CAN1::enable(rcc);
        CAN1::reset(rcc);
        let runs = configure(&can, timing, filters);
        if !runs {
            defmt::error!("the CAN controller does not start");
        }
        let receiver = FrameReceiver {
            // SAFETY: the interrupt has the registers of reception for itself, the tick those of transmission.
            can: unsafe { CAN1::steal() },
            frames,
        };
        handover::hand_over(receiver, Interrupt::CAN1_RX0);
        Self { can, runs, inbox }
    }
}

/// Sets timing and filters. Returns `false` if that is not possible.
fn configure(can: &CAN1, timing: Option<BitTiming>, filters: &[(u16, u16); 3]) -> bool {
    let Some(timing) = timing else {
        return false;
    };
    can.mcr()
        .modify(|_, w| w.sleep().clear_bit().inrq().set_bit());
    if !(0..READS).any(|_| can.msr().read().inak().bit_is_set()) {
        return false;
    }
    // Back on the bus by itself after 128 times 11 recessive bits; mailboxes by the order of requests.
    can.mcr().modify(|_, w| w.abom().set_bit().txfp().set_bit());
    can.fmr().modify(|_, w| w.finit().set_bit());
    can.fs1r()
        .write(|w| w.fsc(0).set_bit().fsc(1).set_bit().fsc(2).set_bit());
    // SAFETY: fields of the timing are less by one than the numbers, which are within those of the register; it jumps
    // by two quanta. Any word is a filter: the identifier is above bit 20, bits 1 and 2 are remote and extended.
    unsafe {
        can.btr().write(|w| {
            w.brp().bits((timing.prescaler - 1) as u16);
            w.ts1().bits(timing.before_sample - 1);
            w.ts2().bits(timing.after_sample - 1);
            w.sjw().bits(1)
        });
        for (bank, (id, mask)) in filters.iter().enumerate() {
            let place = can.fb(bank);
            place.fr1().write(|w| w.bits(u32::from(*id) << 21));
            place
                .fr2()
                .write(|w| w.bits(u32::from(*mask) << 21 | 0b110));
        }
    }
    can.fa1r()
        .write(|w| w.fact(0).set_bit().fact(1).set_bit().fact(2).set_bit());
    can.fmr().modify(|_, w| w.finit().clear_bit());
    can.ier().write(|w| w.fmpie0().set_bit());
    can.mcr().modify(|_, w| w.inrq().clear_bit());
    true
}

impl FrameReceiver {
    /// Takes one frame into the queue. The interrupt comes again as long as there are others.
    #[inline(always)]
    pub(super) fn run(&mut self) {
        let status = self.can.rf0r().read();
        if status.fovr().bit_is_set() {
            self.can.rf0r().write(|w| w.fovr().set_bit());
            handover::count_lost();
        }
        // The place of the frame before may not be free yet.
        if status.rfom().bit_is_set() || status.fmp().bits() == 0 {
            return;
        }
        let place = self.can.rx(0);
        let id = StandardId::new(place.rir().read().stid().bits());
        let length = place.rdtr().read().dlc().bits();
        let [a, b, c, d] = place.rdlr().read().bits().to_le_bytes();
        let [e, f, g, h] = place.rdhr().read().bits().to_le_bytes();
        self.can.rf0r().write(|w| w.rfom().set_bit());
        let Some(id) = id else {
            return;
        };
        let frame = ClassicFrame::of(id.into(), length, [a, b, c, d, e, f, g, h]);
        handover::put(&mut self.frames, frame);
    }
}

/// Moves a frame from the bus into its queue. Above the tick, and everything else: the controller holds three frames,
/// and at 1 Mbit/s a fourth is there after 444 us, less than a tick may take.
#[interrupt]
fn CAN1_RX0() {
    static mut OWN: Option<FrameReceiver> = None;
    handover::run(OWN);
}

impl embedded_can::nb::Can for BusController {
    type Frame = ClassicFrame;
    type Error = Off;

    #[inline]
    fn transmit(&mut self, frame: &ClassicFrame) -> nb::Result<Option<ClassicFrame>, Off> {
        if !self.runs || self.can.esr().read().boff().bit_is_set() {
            return Err(nb::Error::Other(Off));
        }
        let empty = self.can.tsr().read();
        let mailbox = match (
            empty.tme0().bit_is_set(),
            empty.tme1().bit_is_set(),
            empty.tme2().bit_is_set(),
        ) {
            (true, _, _) => 0,
            (_, true, _) => 1,
            (_, _, true) => 2,
            _ => return Err(nb::Error::WouldBlock),
        };
        let Id::Standard(id) = embedded_can::Frame::id(frame) else {
            return Err(nb::Error::Other(Off));
        };
        let [low, high] = frame.words();
        let length = embedded_can::Frame::dlc(frame) as u8;
        let asks = embedded_can::Frame::is_remote_frame(frame);
        let place = self.can.tx(mailbox);
        // SAFETY: any bytes are data; a frame has at most eight, and an identifier eleven bits.
        unsafe {
            place.tdtr().write(|w| w.dlc().bits(length));
            place.tdlr().write(|w| w.bits(low));
            place.tdhr().write(|w| w.bits(high));
            place.tir().write(|w| {
                let w = w.stid().bits(id.as_raw()).rtr().bit(asks);
                w.txrq().set_bit()
            });
        }
        Ok(None)
    }

    #[inline]
    fn receive(&mut self) -> nb::Result<ClassicFrame, Off> {
        self.inbox.dequeue().ok_or(nb::Error::WouldBlock)
    }
}

impl Bus for BusController {
    fn abort(&mut self) {
        if self.runs {
            self.can
                .tsr()
                .write(|w| w.abrq0().set_bit().abrq1().set_bit().abrq2().set_bit());
            // A frame under way goes to its end: 135 bits.
            let _ = (0..READS).any(|_| {
                let status = self.can.tsr().read();
                let empty = [status.tme0(), status.tme1(), status.tme2()];
                empty.iter().all(|mailbox| mailbox.bit_is_set())
            });
        }
    }
}
