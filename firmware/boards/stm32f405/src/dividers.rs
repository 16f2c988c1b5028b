//! Dividers of the clocks that [`clock`](crate::clock) has started. The HAL computes its own from the clock of
//! the reset.
#![allow(unsafe_code)]
// An image uses those of its scene's drives.
#![allow(dead_code)]

use crate::board::{LINE_IS_ON_APB2, LOG_IS_ON_APB2, LinePort, LogPort};
use crate::clock::Clocks;
use stm32f4xx_hal::pac::{TIM3, tim6, usart1};

/// Sets the baud rates of line and log.
pub(super) fn set_bauds(clocks: &Clocks, line: u32, log: u32) {
    // SAFETY: the HAL has configured both ports, and no byte is under way.
    let ports = unsafe { (&*LinePort::ptr(), &*LogPort::ptr()) };
    set_baud(ports.0, clocks.bus(LINE_IS_ON_APB2), line);
    set_baud(ports.1, clocks.bus(LOG_IS_ON_APB2), log);
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

/// Starts a basic timer, which counts at `timer_hz`, with `rate_hz` interrupts per second.
pub(super) fn start(timer: &tim6::RegisterBlock, timer_hz: u32, rate_hz: u32) {
    let (prescaler, last) = counts(timer_hz, rate_hz);
    timer.psc().write(|w| w.psc().set(prescaler));
    timer.arr().write(|w| w.arr().set(last));
    timer.egr().write(|w| w.ug().set_bit());
    // The forced update is no period.
    clear(timer);
    timer.dier().write(|w| w.uie().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
}

/// Clears the interrupt of a basic timer.
#[inline(always)]
pub(super) fn clear(timer: &tim6::RegisterBlock) {
    timer.sr().write(|w| w.uif().clear_bit());
}

/// Prescaler and reload value of a timer of 16 bits, both less by one.
pub(super) const fn counts(timer_hz: u32, rate_hz: u32) -> (u16, u16) {
    let counts = timer_hz / rate_hz;
    let prescaler = (counts - 1) / 0x1_0000;
    (prescaler as u16, (counts / (prescaler + 1) - 1) as u16)
}

const _: () = {
    assert!(matches!(counts(84_000_000, 20_000), (0, 4199)));
    assert!(matches!(counts(84_000_000, 1000), (1, 41_999)));
    assert!(matches!(counts(16_000_000, 100), (2, 53_332)));
};
