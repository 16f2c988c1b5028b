//! STM32F405: an image of the program that the STM32s share (`firmware/boards/stm32`).
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
#[path = "../../stm32/counts.rs"]
mod counts;
#[cfg(target_os = "none")]
mod dividers;
#[cfg(target_os = "none")]
mod drives;
#[cfg(target_os = "none")]
#[path = "../../stm32/fault_status.rs"]
mod fault_status;
#[cfg(target_os = "none")]
mod gpio;
#[cfg(all(target_os = "none", interlocks))]
#[path = "../../stm32/interlocks.rs"]
mod interlocks;
#[cfg(target_os = "none")]
mod parts;
#[cfg(target_os = "none")]
#[path = "../../stm32/pins.rs"]
mod pins;
#[cfg(target_os = "none")]
#[path = "../../stm32/program.rs"]
mod program;
#[cfg(all(target_os = "none", outputs))]
mod protection;
#[cfg(target_os = "none")]
mod serial;
#[cfg(target_os = "none")]
#[path = "../../stm32/switches.rs"]
mod switches;
#[cfg(target_os = "none")]
mod timers;
#[cfg(all(target_os = "none", not(tool = "none")))]
#[path = "../../stm32/tool.rs"]
mod tool;

#[cfg(not(target_os = "none"))]
fn main() {
    trirrr_app::refuse_host("cargo fw")
}
