//! Steppers on step and direction.
//!
//! ```text
//! tick ──> Steppers ──positions──> Line ──> Slots ──> step, direction, enable pins
//!          once per tick                    once per slot, above the tick
//! ```
//! A tick is divided into slots. [`Steppers`] rounds each joint angle of a tick to a microstep;
//! [`Slots`], called by a timer, brings the motors there within the tick, the microsteps spread
//! evenly over it. So the motors follow the ticks by one tick, with constant rates between two.
//!
//! Position is what is counted, never steps: each slot works on the difference between where a
//! motor has to be and the pulses it has given. A tick that comes a slot early, drives that go off in
//! the middle of a tick, a timer that is late: what was not given is given afterwards, and the sum of
//! the pulses is the rounded angle again.
//!
//! # Timing, in slots
//! - A step pulse is one slot high and at least one low, so that two steps are at least two slots
//!   apart.
//! - The direction is set at least one slot before the first step in it and does not change until one
//!   slot after the rise of the last.
//! - After the enable line goes on, no step in that slot.
//!
//! [`slots_per_tick`] has room for all of it; [`slot_rate_hz`] is the timer's rate.

mod line;
mod slots;
mod tick;

pub use line::Line;
pub use slots::{Axis, Slots};
pub use tick::Steppers;

/// The most microsteps in a tick for a driver that takes `step_rate_limit_hz`.
pub const fn most_per_tick(step_rate_limit_hz: f64, tick_rate_hz: f64) -> u32 {
    // The cast cuts.
    (step_rate_limit_hz / tick_rate_hz) as u32
}

/// Slots in a tick of up to `most` microsteps: two for each, and one for the direction.
pub const fn slots_per_tick(most: u32) -> u32 {
    most.saturating_mul(2).saturating_add(1)
}

/// Rate of the slots, Hz: at least [`slots_per_tick`] of them in every tick.
pub const fn slot_rate_hz(most: u32, tick_rate_hz: f64) -> f64 {
    slots_per_tick(most) as f64 * tick_rate_hz
}
