//! STM32G474 (RM0440).

#[cfg(bus)]
pub(crate) mod bus;
pub(crate) mod clock;
#[cfg(not(any(usb, autonomous)))]
pub(crate) mod dma;
#[cfg(any(outputs, update))]
mod protection;
#[cfg(usb)]
pub(crate) mod usb;

pub(crate) use stm32_metapac::Interrupt::TIM7_DAC as SLOTS;

use stm32_metapac::common::{R, Reg, W};
use stm32_metapac::rcc::vals::Fdcansel;
use stm32_metapac::usart::Usart;
use stm32_metapac::usart::regs::{Dr, Isr};
use stm32_metapac::{DBGMCU, RCC};

#[cfg(drive = "bldc")]
compile_error!(
    "drive.kind = \"bldc\": the firmware for this board drives steppers, drives on CAN or nothing"
);

/// A supply that sagged has no flag of its own: it is that of power-on.
pub(crate) const BROWN_OUT: Option<u32> = None;

/// Switches the clocks of the peripherals on.
pub(crate) fn switch_on() {
    RCC.ahb1enr().modify(|w| {
        w.set_dma1en(true);
        w.set_dmamux1en(true);
    });
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
}

/// Switches the clocks of ports on, the first bit that of port A.
pub(crate) fn switch_ports_on(ports: u32) {
    RCC.ahb2enr().modify(|w| w.0 |= ports);
}

/// Resets the ports A to G.
pub(crate) fn reset_ports() {
    RCC.ahb2rstr().write(|w| w.0 = 0x7F);
}

/// Starts the clocks by `start`. No detector looks at the supply.
pub(crate) fn protected<T>(start: impl FnOnce() -> T) -> T {
    start()
}

/// Returns false: no emulator of this chip is without PLL.
pub(crate) const fn is_emulated() -> bool {
    false
}

/// Status of a serial port,
#[cfg_attr(autonomous, expect(dead_code, reason = "no port"))]
pub(crate) fn status(port: Usart) -> Reg<Isr, R> {
    port.isr()
}

/// and data for its transmitter.
#[cfg_attr(autonomous, expect(dead_code, reason = "no port"))]
pub(crate) fn sent(port: Usart) -> Reg<Dr, W> {
    port.tdr()
}
