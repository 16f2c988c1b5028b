//! Boot loader of the STM32F405, at the beginning of its flash. It runs from the internal oscillator and leaves all peripherals as a
//! reset leaves them, the causes of the reset and the RAM included; but for the watchdog, which runs, and behind a write to the flash the detector of the supply.
#![cfg_attr(target_os = "none", no_std, no_main)]

trirrr_boot::loader!(stm32f405, STM32F405, "cargo fw-boot");
