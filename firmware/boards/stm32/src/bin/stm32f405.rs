//! Image for the STM32F405.
#![cfg_attr(target_os = "none", no_std, no_main)]

trirrr_app::image!(trirrr_stm32, "cargo fw");
