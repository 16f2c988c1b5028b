//! Image of an STM32: one program, on the chip that a feature of the package names. `f405` and `g474` hold all in which the chips differ.
#![cfg(target_os = "none")]
#![no_std]

mod board;
mod clock;
mod drives;
#[cfg(tool = "duty")]
mod duty;
#[cfg(feature = "stm32f405")]
mod f405;
mod failure;
#[cfg(feature = "stm32g474")]
mod g474;
mod gpio;
#[cfg(not(any(usb, autonomous)))]
mod line;
#[cfg(autonomous)]
mod no_line;
mod pins;
mod program;
#[cfg(not(autonomous))]
mod serial;
mod start;
mod timers;
mod watchdog;

#[cfg(usb)]
use chip::usb as line;
#[cfg(feature = "stm32f405")]
use f405 as chip;
#[cfg(feature = "stm32g474")]
use g474 as chip;
#[cfg(autonomous)]
use {no_line as line, no_line as serial};
