//! Dividers of the clocks that [`clock`](crate::clock) has started. The HAL computes its own from the clock of
//! the reset.
#![allow(unsafe_code)]
// An image uses those of its scene's drives.
#![allow(dead_code)]

#[cfg(not(usb))]
use crate::board::{LINE_IS_ON_APB2, LinePort};
use crate::board::{LOG_IS_ON_APB2, LogPort};
use crate::clock::Clocks;
use crate::counts::counts;
use stm32f4xx_hal::pac::{TIM3, usart1};

/// Sets the baud rates of line and log.
#[cfg(not(usb))]
pub(super) fn set_bauds(clocks: &Clocks, line: u32, log: u32) {
    // SAFETY: both ports are off: no byte is under way.
    let ports = unsafe { (&*LinePort::ptr(), &*LogPort::ptr()) };
    set_baud(ports.0, clocks.bus(LINE_IS_ON_APB2), line);
    set_baud(ports.1, clocks.bus(LOG_IS_ON_APB2), log);
}

/// Sets the baud rate of the log.
pub(super) fn set_log_baud(clocks: &Clocks, log: u32) {
    // SAFETY: the HAL has configured the port, and no byte is under way.
    let port = unsafe { &*LogPort::ptr() };
    set_baud(port, clocks.bus(LOG_IS_ON_APB2), log);
}

/// Sets one baud rate. The port samples each bit 16 times; the register counts sixteenths of a sample (RM0090,
/// 30.3.4).
fn set_baud(port: &usart1::RegisterBlock, bus_hz: u32, baud: u32) {
    let divider = (bus_hz + baud / 2) / baud;
    // SAFETY: any divider from 16 is one.
    port.brr().write(|w| unsafe { w.bits(divider as u16) });
}

/// Sets the PWM rate of TIM3, which counts at `timer_hz`, to `rate_hz`.
pub(super) fn set_pwm(timer_hz: u32, rate_hz: u32) {
    // SAFETY: the HAL has configured the timer. Its channels only read the second of these registers.
    let timer = unsafe { &*TIM3::ptr() };
    let (prescaler, last) = counts(timer_hz, rate_hz);
    timer.psc().write(|w| w.psc().set(prescaler));
    timer.arr().write(|w| w.arr().set(last));
    // An update loads both.
    timer.egr().write(|w| w.ug().set_bit());
}
