//! CAN controller (bxCAN, RM0090 chapter 32): three mailboxes out, a queue of three frames in.
//!
//! Nothing waits without bound. Frames go out in the order in which they came. The controller repeats a frame
//! until a drive has acknowledged it.
#![allow(unsafe_code)]

use embedded_can::{ErrorKind, Id, StandardId};
use stm32f4xx_hal::pac::CAN1;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};
use trirrr_drives::can::{BitTiming, Bus, ClassicFrame};

/// CAN1, with all three mailboxes.
pub(crate) struct Controller {
    can: CAN1,
    state: BusState,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum BusState {
    /// On the bus.
    Running,
    /// The start has failed.
    Failed,
    /// Not there: an emulated board, which drops every frame.
    Absent,
}

/// The controller is off the bus, or did not start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Off;

impl embedded_can::Error for Off {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// Reads of an acknowledgement that comes within a bit.
const READS: u32 = 10_000;

impl Controller {
    /// The controller of an emulated board.
    pub(super) fn absent(can: CAN1) -> Self {
        Self {
            can,
            state: BusState::Absent,
        }
    }

    /// Starts the controller with this bit timing, or fails without one. The controller takes part once the
    /// bus has been idle.
    pub(super) fn start(can: CAN1, rcc: &mut Rcc, timing: Option<BitTiming>) -> Self {
        CAN1::enable(rcc);
        CAN1::reset(rcc);
        let started = configure(&can, timing);
        let state = match started {
            true => BusState::Running,
            false => BusState::Failed,
        };
        if !started {
            defmt::error!("the CAN controller does not start");
        }
        Self { can, state }
    }
}

/// Sets timing and filters. Returns `false` if that is not possible.
fn configure(can: &CAN1, timing: Option<BitTiming>) -> bool {
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
    // SAFETY: all fields are less by one than the numbers, which are within those of the register.
    can.btr().write(|w| unsafe {
        w.brp().bits((timing.prescaler - 1) as u16);
        w.ts1().bits(timing.before_sample - 1);
        w.ts2().bits(timing.after_sample - 1)
    });
    // Filter 0: standard data frames, all of them, into queue 0. Bits 1 and 2 are remote and extended.
    can.fmr().modify(|_, w| w.finit().set_bit());
    can.fs1r().write(|w| w.fsc(0).set_bit());
    // SAFETY: any word is a filter.
    unsafe {
        can.fb(0).fr1().write(|w| w.bits(0));
        can.fb(0).fr2().write(|w| w.bits(0b110));
    }
    can.fa1r().write(|w| w.fact(0).set_bit());
    can.fmr().modify(|_, w| w.finit().clear_bit());
    can.mcr().modify(|_, w| w.inrq().clear_bit());
    true
}

impl embedded_can::nb::Can for Controller {
    type Frame = ClassicFrame;
    type Error = Off;

    #[inline]
    fn transmit(&mut self, frame: &ClassicFrame) -> nb::Result<Option<ClassicFrame>, Off> {
        match self.state {
            BusState::Running => {}
            BusState::Failed => return Err(nb::Error::Other(Off)),
            BusState::Absent => return Ok(None),
        }
        if self.can.esr().read().boff().bit_is_set() {
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
        let place = self.can.tx(mailbox);
        // SAFETY: any bytes are data; a frame has at most eight, and an identifier eleven bits.
        unsafe {
            place.tdtr().write(|w| w.dlc().bits(length));
            place.tdlr().write(|w| w.bits(low));
            place.tdhr().write(|w| w.bits(high));
            place
                .tir()
                .write(|w| w.stid().bits(id.as_raw()).txrq().set_bit());
        }
        Ok(None)
    }

    #[inline]
    fn receive(&mut self) -> nb::Result<ClassicFrame, Off> {
        if self.state != BusState::Running || self.can.rf0r().read().fmp().bits() == 0 {
            return Err(nb::Error::WouldBlock);
        }
        let place = self.can.rx(0);
        let id = StandardId::new(place.rir().read().stid().bits());
        let length = place.rdtr().read().dlc().bits();
        let [a, b, c, d] = place.rdlr().read().bits().to_le_bytes();
        let [e, f, g, h] = place.rdhr().read().bits().to_le_bytes();
        self.can.rf0r().write(|w| w.rfom().set_bit());
        match id {
            Some(id) => Ok(ClassicFrame::of(
                id.into(),
                length,
                [a, b, c, d, e, f, g, h],
            )),
            None => Err(nb::Error::WouldBlock),
        }
    }
}

impl Bus for Controller {
    fn abort(&mut self) {
        if self.state == BusState::Running {
            self.can
                .tsr()
                .write(|w| w.abrq0().set_bit().abrq1().set_bit().abrq2().set_bit());
        }
    }
}
