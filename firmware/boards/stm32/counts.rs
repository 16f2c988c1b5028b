//! Rates of timers.

/// Prescaler and reload value of a timer of 16 bits, both less by one.
pub(crate) const fn counts(timer_hz: u32, rate_hz: u32) -> (u16, u16) {
    let counts = timer_hz / rate_hz;
    let prescaler = (counts - 1) / 0x1_0000;
    (prescaler as u16, (counts / (prescaler + 1) - 1) as u16)
}

const _: () = {
    assert!(matches!(counts(84_000_000, 20_000), (0, 4199)));
    assert!(matches!(counts(84_000_000, 1000), (1, 41_999)));
    assert!(matches!(counts(16_000_000, 100), (2, 53_332)));
};
