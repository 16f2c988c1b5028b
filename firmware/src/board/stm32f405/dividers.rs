//! Dividers of the clocks that [`clock`](super::clock) has started. The HAL knows of none of that and
//! works them out from the clock of the reset.
#![allow(unsafe_code)]
// An image has what its scene uses.
#![allow(dead_code)]

use stm32f4xx_hal::pac::{TIM3, USART2, USART3, tim6, usart1};

/// Makes USART2 and USART3, on a bus of `bus_hz`, send and receive so many bits per second.
pub(super) fn set_bauds(bus_hz: u32, usart2: u32, usart3: u32) {
    // SAFETY: the HAL has configured them and nothing is under way on them.
    let ports = unsafe { (&*USART2::ptr(), &*USART3::ptr()) };
    set_baud(ports.0, bus_hz, usart2);
    set_baud(ports.1, bus_hz, usart3);
}

/// Each bit is looked at 16 times, and the register counts sixteenths of a look (RM0090, 30.3.4).
fn set_baud(port: &usart1::RegisterBlock, bus_hz: u32, baud: u32) {
    let divider = (bus_hz + baud / 2) / baud;
    // SAFETY: any divider from 16 is one.
    port.brr().write(|w| unsafe { w.bits(divider as u16) });
}

/// Makes the PWM of TIM3, which counts at `timer_hz`, start anew `rate_hz` times per second.
pub(super) fn set_pwm(timer_hz: u32, rate_hz: u32) {
    // SAFETY: the HAL has configured it, and of these registers its channels do no more than read the second.
    let timer = unsafe { &*TIM3::ptr() };
    let (prescaler, last) = counts(timer_hz, rate_hz);
    timer.psc().write(|w| w.psc().set(prescaler));
    timer.arr().write(|w| w.arr().set(last));
    // Both hold from now on.
    timer.egr().write(|w| w.ug().set_bit());
}

/// Makes a basic timer, which counts at `timer_hz`, interrupt `rate_hz` times per second from now on.
pub(super) fn start(timer: &tim6::RegisterBlock, timer_hz: u32, rate_hz: u32) {
    let (prescaler, last) = counts(timer_hz, rate_hz);
    timer.psc().write(|w| w.psc().set(prescaler));
    timer.arr().write(|w| w.arr().set(last));
    timer.egr().write(|w| w.ug().set_bit());
    // That was no period.
    clear(timer);
    timer.dier().write(|w| w.uie().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
}

/// Takes note of a basic timer's period.
#[inline(always)]
pub(super) fn clear(timer: &tim6::RegisterBlock) {
    timer.sr().write(|w| w.uif().clear_bit());
}

/// What a timer of 16 bits counts to, and how often before it counts: both less by one.
const fn counts(timer_hz: u32, rate_hz: u32) -> (u16, u16) {
    let counts = timer_hz / rate_hz;
    let prescaler = (counts - 1) / 0x1_0000;
    (prescaler as u16, (counts / (prescaler + 1) - 1) as u16)
}

const _: () = {
    assert!(matches!(counts(84_000_000, 20_000), (0, 4199)));
    assert!(matches!(counts(84_000_000, 1000), (1, 41_999)));
    assert!(matches!(counts(16_000_000, 100), (2, 53_332)));
};
