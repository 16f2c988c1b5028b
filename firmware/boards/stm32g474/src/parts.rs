//! ChipParts of the chip, as the program takes them.

use crate::ChipParts;
use crate::clock;
pub(crate) use crate::timers::{SlotRegisters, ToolCounter};
pub(crate) use crate::watchdog::{StoppedWatchdog, Watchdog};
use stm32_metapac::rcc::vals::Fdcansel;
use stm32_metapac::{DBGMCU, RCC};
use trirrr_app::cause;
use trirrr_protocol::message::Start;

/// The device as RTIC sees it.
pub(crate) mod device {
    #![allow(unsafe_code)]

    pub(crate) use crate::metapac::device::*;
    pub(crate) use stm32_metapac::Interrupt::TIM7_DAC as SLOTS;

    #[cfg(drive = "stepper")]
    crate::board::entry!(TIM7_DAC, TIM7);
}

/// Clocks of peripherals: all on from the start.
pub(crate) struct Rcc;

/// The ports, of which [`Pins`](crate::board::Pins) takes those of the board file.
pub(crate) struct PortClocks;
pub(crate) use self::PortClocks as Ports;

impl PortClocks {
    /// Switches the port of this letter on.
    pub(crate) fn switch_on(&self, port: char, _: &mut Rcc) {
        RCC.ahb2enr()
            .modify(|w| w.0 |= 1 << (port as u32 - 'A' as u32));
    }
}

/// Peripherals for drives.
// Each kind of drive takes some of them.
#[allow(dead_code)]
pub(crate) struct DrivePeripherals {
    pub(crate) slots: SlotRegisters,
    pub(crate) can: stm32_metapac::can::Fdcan,
}

/// Starts the clocks and hands out the rest.
pub(crate) fn start(_: device::Peripherals) -> ChipParts {
    let start = cause_of_start();
    RCC.apb1enr1().modify(|w| {
        w.set_pwren(true);
        w.set_tim2en(true);
        w.set_tim7en(true);
        w.set_usart2en(true);
        w.set_usart3en(true);
        w.set_fdcanen(true);
    });
    RCC.apb2enr().modify(|w| w.set_usart1en(true));
    RCC.ccipr().modify(|w| w.set_fdcansel(Fdcansel::PCLK1));
    // Timers go on where a debugger holds the core: pulses of the tool. The watchdog ends them.
    DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(!cfg!(outputs)));
    let (clock, clocks) = clock::start(&start);
    ChipParts {
        start,
        clock,
        clocks,
        rcc: Rcc,
        ports: PortClocks,
        drives: DrivePeripherals {
            slots: stm32_metapac::TIM7,
            can: stm32_metapac::FDCAN1,
        },
        tool: stm32_metapac::TIM2,
        watchdog: StoppedWatchdog(stm32_metapac::IWDG),
    }
}

/// Combines the cause that the run before has kept with the flags of the reset, and clears both.
fn cause_of_start() -> Start {
    let flags = RCC.csr().read();
    RCC.csr().modify(|w| w.set_rmvf(true));
    let kept = cause::take();
    // After power-on the RAM is noise, whatever it seems to hold.
    match (flags.borrstf(), kept, flags.iwdgrstf()) {
        (true, _, _) => Start::Power,
        (_, Some(start), _) => start,
        (_, _, true) => Start::Watchdog,
        _ => Start::Reset,
    }
}
