//! Boot loader of the STM32F405, at the beginning of its flash. It runs from the internal oscillator and leaves all peripherals as a
//! reset leaves them, the causes of the reset and the RAM included.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod start {
    #![allow(unsafe_code)]

    use cortex_m::peripheral::SCB;
    use trirrr_boot::stm32f405::{ChipFlash, watchdog};
    use trirrr_boot::{Layout, Started, boot, is_blank};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        const LAYOUT: Layout = Layout::STM32F405;
        // SAFETY: the only one, and the boot loader lies in sector 0, which is in no slot.
        let mut flash = unsafe { ChipFlash::take() };
        let started = boot(&mut flash, &LAYOUT);
        if is_blank(&flash, &LAYOUT.program) {
            // Flashed alone: the probe puts a program here.
            loop {
                cortex_m::asm::nop();
            }
        }
        match started {
            Ok(Started::Known) => {}
            // A program that hangs before it starts the watchdog itself would never end.
            Ok(Started::OnTrial) => watchdog::start(watchdog::Period::TRIAL),
            Err(_) => SCB::sys_reset(),
        }
        let vectors = LAYOUT.program.start as *const u32;
        // SAFETY: the slot begins with the vectors of a program. No interrupt is on, and the processor is as after a reset.
        unsafe {
            (*SCB::PTR).vtor.write(LAYOUT.program.start);
            cortex_m::asm::bootload(vectors)
        }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo) -> ! {
        SCB::sys_reset()
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("the boot loader is for a board: build it with `cargo fw-boot`");
    std::process::exit(2);
}
