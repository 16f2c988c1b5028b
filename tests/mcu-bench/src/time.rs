//! Time of the simulated board.

/// Time in 1/28560 of a microsecond. All clocks of the boards have whole periods: 170 at 168 MHz, 168 at 170 MHz, 340 at 84 MHz, 680 at
/// 42 MHz, 1785 at 16 MHz.
pub(crate) type Time = u64;

/// Units of time in a second.
pub(crate) const SECOND: Time = 28_560_000_000;

/// Units of time in a microsecond.
pub(crate) const MICROSECOND: Time = SECOND / 1_000_000;

/// Units of time in a millisecond.
pub(crate) const MS: Time = SECOND / 1000;

/// Returns the period of `hz`, to the nearest unit.
pub(crate) fn period(hz: u64) -> Time {
    (SECOND + hz / 2) / hz
}

/// Returns `time` in seconds.
pub(crate) fn seconds(time: Time) -> f64 {
    time as f64 / SECOND as f64
}

/// Returns `time` in microseconds.
pub(crate) fn micros(time: Time) -> f64 {
    seconds(time) * 1e6
}

/// Returns the time of `seconds`.
pub(crate) fn of_seconds(seconds: f64) -> Time {
    (seconds * SECOND as f64).round() as Time
}
