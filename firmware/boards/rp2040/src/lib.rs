//! Image of an RP2040.
#![cfg(target_os = "none")]
#![no_std]

mod board;
mod chip;
mod clock;
mod critical;
mod drives;
#[cfg(tool = "duty")]
mod duty;
mod pins;
mod program;
mod start;
#[cfg(not(usb))]
mod uart;
#[cfg(usb)]
mod usb;

#[cfg(not(usb))]
use uart as line;
#[cfg(usb)]
use usb as line;
