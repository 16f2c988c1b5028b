//! Boot loader of the STM32G474, at the beginning of its flash. It runs from the internal oscillator and leaves all peripherals as a
//! reset leaves them, the causes of the reset and the RAM included; but for the watchdog, which runs.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod loader {
    #![allow(unsafe_code)]

    use cortex_m::peripheral::SCB;
    use trirrr_boot::Layout;
    use trirrr_boot::start::start;
    use trirrr_boot::stm32g474::{ChipFlash, is_expected};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        const LAYOUT: Layout = Layout::STM32G474;
        // SAFETY: the only one, and the boot loader lies in front of all slots. It has come from a reset.
        unsafe { start(ChipFlash::take(), &LAYOUT) }
    }

    /// A double word of the flash is lost. If it is one of the boot loader itself, the next start may read it.
    #[cortex_m_rt::exception]
    unsafe fn NonMaskableInt() {
        if !is_expected() {
            SCB::sys_reset();
        }
    }

    #[cortex_m_rt::exception]
    unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
        SCB::sys_reset()
    }

    #[cortex_m_rt::exception]
    unsafe fn DefaultHandler(_: i16) -> ! {
        SCB::sys_reset()
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo) -> ! {
        SCB::sys_reset()
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("the boot loader is for a board: build it with `cargo fw-boot-g474`");
    std::process::exit(2);
}
