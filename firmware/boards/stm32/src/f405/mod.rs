//! STM32F405 (RM0090).

#[cfg(bus)]
pub(crate) mod bus;
pub(crate) mod clock;
#[cfg(not(any(usb, autonomous)))]
pub(crate) mod dma;
#[cfg(outputs)]
mod protection;
#[cfg(usb)]
pub(crate) mod usb;

pub(crate) use stm32_metapac::Interrupt::TIM7 as SLOTS;

use stm32_metapac::common::{RW, Reg};
use stm32_metapac::usart::Usart;
use stm32_metapac::usart::regs::{Dr, Sr};
use stm32_metapac::{DBGMCU, RCC};

#[cfg(drive = "moteus")]
compile_error!(
    "drive.protocol = \"moteus\": its frames take CAN FD, and the controllers of the STM32F405 are \
     of classic CAN"
);

/// Flag of RCC_CSR for a supply that sagged below the brown-out level; at power-on it comes with the flag of that.
pub(crate) const BROWN_OUT: Option<u32> = Some(1 << 25);

/// Switches the clocks of the peripherals on.
pub(crate) fn switch_on() {
    RCC.ahb1enr().modify(|w| {
        w.set_dma1en(true);
        w.set_dma2en(true);
    });
    RCC.apb1enr().modify(|w| {
        w.set_pwren(true);
        w.set_tim2en(true);
        w.set_tim3en(true);
        w.set_tim4en(true);
        w.set_tim5en(true);
        w.set_tim7en(true);
        w.set_usart2en(true);
        w.set_usart3en(true);
        w.set_can1en(true);
    });
    RCC.apb2enr().modify(|w| {
        w.set_tim1en(true);
        w.set_usart1en(true);
        w.set_usart6en(true);
    });
    // They come two cycles later (errata sheet ES0182). The register of PWR that is read before would lose the scale of the regulator.
    let _ = RCC.apb2enr().read();
    // Timers go on where a debugger holds the core: pulses of the tool, currents of the motors. The watchdog ends them.
    DBGMCU.apb1fzr().modify(|w| w.set_iwdg(!cfg!(outputs)));
}

/// Starts the clocks by `start` with a supply that is there, and is watched from then on, in an image with outputs.
pub(crate) fn protected<T>(start: impl FnOnce() -> T) -> T {
    #[cfg(outputs)]
    protection::await_supply();
    let started = start();
    #[cfg(outputs)]
    protection::watch_supply();
    started
}

/// Switches the clocks of ports on, the first bit that of port A.
pub(crate) fn switch_ports_on(ports: u32) {
    RCC.ahb1enr().modify(|w| w.0 |= ports);
    let _ = RCC.ahb1enr().read();
}

/// Resets the ports A to E.
pub(crate) fn reset_ports() {
    RCC.ahb1rstr().write(|w| w.0 = 0x1F);
}

/// Returns true in an emulator: only that has no identity.
pub(crate) fn is_emulated() -> bool {
    DBGMCU.idcode().read().0 == 0
}

/// Status of a serial port,
#[cfg_attr(autonomous, expect(dead_code, reason = "no port"))]
pub(crate) fn status(port: Usart) -> Reg<Sr, RW> {
    port.sr()
}

/// and data for its transmitter.
#[cfg_attr(autonomous, expect(dead_code, reason = "no port"))]
pub(crate) fn sent(port: Usart) -> Reg<Dr, RW> {
    port.dr()
}
