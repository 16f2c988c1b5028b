//! Boot loader of the STM32G474, at the beginning of its flash. It runs from the internal oscillator and leaves all peripherals as a
//! reset leaves them, the causes of the reset and the RAM included; but for the watchdog, which runs.
#![cfg_attr(target_os = "none", no_std, no_main)]

trirrr_boot::loader!(stm32g474, STM32G474, "cargo fw-boot-g474");

/// A double word of the flash is lost. If it is one of the boot loader itself, the next start may read it.
#[cfg(target_os = "none")]
#[cortex_m_rt::exception]
#[allow(unsafe_code)]
unsafe fn NonMaskableInt() {
    if !trirrr_boot::stm32g474::is_expected() {
        cortex_m::peripheral::SCB::sys_reset();
    }
}
