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
#[cfg(not(autonomous))]
mod log;
#[cfg(autonomous)]
mod no_line;
mod pins;
mod program;
mod start;
#[cfg(not(any(usb, autonomous)))]
mod uart;
#[cfg(usb)]
mod usb;

#[cfg(not(any(usb, autonomous)))]
use uart as line;
#[cfg(usb)]
use usb as line;
#[cfg(autonomous)]
use {no_line as line, no_line as log};
