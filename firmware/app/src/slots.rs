//! Slots of steppers: their number in a tick, and what the tick hands to them.

use crate::scene::TICK_RATE_HZ;
use crate::scene::drive::{MOST_PER_TICK, PER_TURN, REVERSED};
use trirrr_drives::stepper::{Line, StepsPerTurn, slot_rate_hz, slots_per_tick};

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

/// Steps in a turn of each joint, and the motors that turn against theirs.
#[inline]
pub fn steps() -> ([StepsPerTurn; 3], [bool; 3]) {
    #[cfg(scene_over_line)]
    if let Some(steps) = crate::stored_scene::steps() {
        return steps;
    }
    (PER_TURN, REVERSED)
}
