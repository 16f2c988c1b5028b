//! ChipParts of the chip, as the program takes them.

use crate::ChipParts;
use crate::clock;
pub(crate) use crate::timers::ToolCounter;
use stm32f4xx_hal::pac::{
    CAN1, DBGMCU, GPIOA, GPIOB, GPIOC, GPIOD, GPIOE, IWDG, Peripherals, RCC, TIM1, TIM3, TIM4,
    TIM5, TIM7, USART1, USART2, USART3, USART6,
};
use stm32f4xx_hal::prelude::*;
pub(crate) use stm32f4xx_hal::rcc::Rcc;
pub(crate) use stm32f4xx_hal::watchdog::IndependentWatchdog as Watchdog;
use trirrr_app::{WATCHDOG_MS, cause};
use trirrr_protocol::message::Start;

/// The device as RTIC sees it.
pub(crate) mod device {
    pub(crate) use stm32f4xx_hal::pac::Interrupt::TIM7 as SLOTS;
    pub(crate) use stm32f4xx_hal::pac::*;
}

/// The ports, of which [`Pins`](crate::board::Pins) takes those of the board file.
// An image takes those of its scene's functions.
#[allow(dead_code)]
pub(crate) struct Ports {
    pub(crate) a: GPIOA,
    pub(crate) b: GPIOB,
    pub(crate) c: GPIOC,
    pub(crate) d: GPIOD,
    pub(crate) e: GPIOE,
    pub(crate) usart1: USART1,
    pub(crate) usart2: USART2,
    pub(crate) usart3: USART3,
    pub(crate) usart6: USART6,
}

/// Peripherals for drives.
// Each kind of drive takes some of them.
#[allow(dead_code)]
pub(crate) struct DrivePeripherals {
    pub(crate) slots: TIM7,
    pub(crate) tim1: TIM1,
    pub(crate) tim3: TIM3,
    pub(crate) tim4: TIM4,
    pub(crate) tim5: TIM5,
    pub(crate) can: CAN1,
}

/// The watchdog, before it runs.
pub(crate) struct StoppedWatchdog(IWDG, DBGMCU);

impl StoppedWatchdog {
    /// Starts the watchdog.
    pub(crate) fn start(self) -> Watchdog {
        let mut watchdog = Watchdog::new(self.0);
        // Timers go on where a debugger holds the core: pulses of the tool, currents of the motors. The watchdog ends them.
        watchdog.stop_on_debug(&self.1, !cfg!(outputs));
        watchdog.start(WATCHDOG_MS.millis());
        watchdog
    }
}

/// Starts the clocks and hands out the rest.
pub(crate) fn start(device: Peripherals) -> ChipParts {
    let start = cause_of_start(&device.RCC);
    #[cfg(outputs)]
    crate::protection::await_supply(&device.RCC, &device.PWR);
    let (clock, clocks) = clock::start(
        &device.RCC,
        &device.FLASH,
        &device.DBGMCU,
        &device.TIM11,
        &start,
    );
    #[cfg(outputs)]
    crate::protection::watch_supply(&device.EXTI, &device.PWR);
    ChipParts {
        start,
        clock,
        clocks,
        rcc: device.RCC.constrain(),
        ports: Ports {
            a: device.GPIOA,
            b: device.GPIOB,
            c: device.GPIOC,
            d: device.GPIOD,
            e: device.GPIOE,
            usart1: device.USART1,
            usart2: device.USART2,
            usart3: device.USART3,
            usart6: device.USART6,
        },
        drives: DrivePeripherals {
            slots: device.TIM7,
            tim1: device.TIM1,
            tim3: device.TIM3,
            tim4: device.TIM4,
            tim5: device.TIM5,
            can: device.CAN1,
        },
        tool: device.TIM2,
        watchdog: StoppedWatchdog(device.IWDG, device.DBGMCU),
    }
}

/// Combines the cause that the run before has kept with the flags of the reset, and clears both.
fn cause_of_start(rcc: &RCC) -> Start {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().clear());
    let kept = cause::take();
    // After power-on the RAM is noise, whatever it seems to hold.
    if flags.porrstf().bit_is_set() {
        return Start::Power;
    }
    if let Some(start) = kept {
        return start;
    }
    match (flags.wdgrstf().bit_is_set(), flags.bits() >> 24) {
        (true, _) => Start::Watchdog,
        // An emulator sets no flag.
        (_, 0) => Start::Power,
        _ => Start::Reset,
    }
}
