//! Slots of steppers: their number in a tick, and what the tick hands to them.

use crate::outputs::Steps;
use crate::scene::TICK_RATE_HZ;
use crate::scene::drive::{MOST_PER_TICK, PER_TURN, REVERSED};
use trirrr_drives::stepper::{Line, slot_rate_hz, slots_per_tick};

/// Positions from the tick to the slots.
pub static LINE: Line = Line::new();

/// Most microsteps of any motor in a tick.
const MOST: u32 = {
    let [a, b, c] = MOST_PER_TICK;
    let most = if a > b { a } else { b };
    if most > c { most } else { c }
};

/// Slots in a tick.
pub const PER_TICK: u32 = slots_per_tick(MOST);

/// Slots per second, rounded up.
pub const SLOT_HZ: u32 = slot_rate_hz(MOST, TICK_RATE_HZ) as u32 + 1;

/// Steps of the scene that is played.
#[inline]
pub fn steps() -> Steps {
    crate::played_steps().unwrap_or((PER_TURN, REVERSED))
}
