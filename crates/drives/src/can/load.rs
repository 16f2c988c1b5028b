//! Load of a bus of classic CAN.

/// Bits of a frame of eight bytes with an eleven-bit identifier, the space behind it and the most stuffing included.
pub const FRAME_BITS: u32 = 135;

/// Bits of the shortest frame of eight bytes, without any stuffing: those of the drives have eight.
const SHORTEST_BITS: f64 = 111.0;

/// Frames of eight bytes that a bus of `bit_rate_hz` can carry in a tick, and one that was under way.
pub const fn frames_per_tick(bit_rate_hz: u32, tick_rate_hz: f64) -> u16 {
    // The cast cuts, and saturates.
    ((bit_rate_hz as f64 / (SHORTEST_BITS * tick_rate_hz)) as u16).saturating_add(2)
}
