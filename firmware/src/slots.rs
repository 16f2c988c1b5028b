//! The slots of steppers: how many there are, and what the tick hands them.

use trirrr_drives::stepper::{Line, slot_rate_hz, slots_per_tick};
use trirrr_station::scene::TICK_RATE_HZ;
use trirrr_station::scene::drive::MOST_PER_TICK;

/// From the tick to the slots.
pub(crate) static LINE: Line = Line::new();

/// The most microsteps of any motor in a tick.
const MOST: u32 = {
    let [a, b, c] = MOST_PER_TICK;
    let most = if a > b { a } else { b };
    if most > c { most } else { c }
};

/// Slots in a tick.
pub(crate) const PER_TICK: u32 = slots_per_tick(MOST);

/// Slots per second, rounded up.
pub(crate) const SLOT_HZ: u32 = slot_rate_hz(MOST, TICK_RATE_HZ) as u32 + 1;
