//! STM32F405: an image of the program that the STM32s share.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod dividers;
#[cfg(all(target_os = "none", not(usb)))]
mod dma;
#[cfg(target_os = "none")]
mod drives;
#[cfg(target_os = "none")]
mod gpio;
#[cfg(target_os = "none")]
mod parts;
#[cfg(all(target_os = "none", outputs))]
mod protection;
#[cfg(target_os = "none")]
mod serial;
#[cfg(target_os = "none")]
#[path = "../../stm32/mod.rs"]
mod stm32;
#[cfg(target_os = "none")]
mod timers;
#[cfg(all(target_os = "none", usb))]
mod usb;
#[cfg(target_os = "none")]
use stm32::*;

#[cfg(not(target_os = "none"))]
fn main() {
    trirrr_app::refuse_host("cargo fw")
}
