//! Steppers on step and direction.
//!
//! ```text
//! tick ──> Steppers ──positions──> Line ──> Slots ──> step, direction, enable pins
//!          once per tick                    once per slot, above the tick
//! ```
//! A tick is divided into slots. [`Steppers`] turns each joint angle of a tick into a position with a fraction, in 2^-8 of a microstep. A timer calls
//! [`Slots`], which steps where the straight line between the positions of two ticks crosses the middle between two
//! microsteps. So the motors follow the ticks by one tick, with constant rates between two, whatever fraction of a
//! microstep belongs to a tick. The arithmetic is [`StepMotor`] and [`Schedule`].
//!
//! Positions are counted, never steps: each slot works on the difference between the wanted position and the
//! pulses given. A tick may come a slot early, a timer late, and drives may go off in the middle of a tick.
//! The missing pulses follow, and their sum is the rounded angle again.
//!
//! A joint that turns back takes the position along only after an eighth of a microstep: an angle whose last bits go up and
//! down between two microsteps does not step back and forth. The position is a sixteenth off the angle at most.
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
mod motor;
mod schedule;
mod slots;
mod tick;

pub use line::Line;
pub use motor::{StepMotor, StepsPerTurn, TooManySteps};
pub use schedule::{MICROSTEP, Schedule, Walk};
pub use slots::{Axis, Slots};
pub use tick::Steppers;

/// Most microsteps in a tick for a driver that takes `step_rate_limit_hz`.
pub const fn most_per_tick(step_rate_limit_hz: f64, tick_rate_hz: f64) -> u32 {
    // The cast cuts.
    (step_rate_limit_hz / tick_rate_hz) as u32
}

/// Slots in a tick of up to `most` microsteps: two for each, and one for a change of direction.
pub const fn slots_per_tick(most: u32) -> u32 {
    most.saturating_mul(2).saturating_add(1)
}

/// Rate of the slots, Hz: at least [`slots_per_tick`] of them in every tick, and one to spare. A tick that takes longer than the one
/// after it hands its positions over late: without the spare slot its last pulse would come in the next tick.
pub const fn slot_rate_hz(most: u32, tick_rate_hz: f64) -> f64 {
    (slots_per_tick(most) as f64 + 1.0) * tick_rate_hz
}
