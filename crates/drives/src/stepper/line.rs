//! From the tick to the slots.

use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU32, Ordering};

/// Wanted positions of the motors. The tick writes, the slots read, neither waits. The slots preempt the tick
/// and never see half a set: positions count once the round has changed.
#[derive(Debug)]
pub struct Line {
    positions: [AtomicI32; 3],
    /// Counts the ticks that gave positions.
    round: AtomicU32,
    on: AtomicBool,
}

impl Default for Line {
    fn default() -> Self {
        Self::new()
    }
}

impl Line {
    /// Off, all motors at position 0.
    pub const fn new() -> Self {
        Self {
            positions: [const { AtomicI32::new(0) }; 3],
            round: AtomicU32::new(0),
            on: AtomicBool::new(false),
        }
    }

    /// Starts the next round: positions in 2^-8 of a microstep, drives on.
    #[inline(always)]
    pub(super) fn give(&self, positions: [i32; 3]) {
        for (place, position) in self.positions.iter().zip(positions) {
            place.store(position, Ordering::Relaxed);
        }
        // No read-modify-write, which a Cortex-M0+ lacks: the tick alone writes.
        let round = self.round.load(Ordering::Relaxed);
        self.round.store(round.wrapping_add(1), Ordering::Release);
        self.on.store(true, Ordering::Release);
    }

    /// Switches the drives off: no pulse from the next slot on.
    #[inline(always)]
    pub(super) fn off(&self) {
        self.on.store(false, Ordering::Release);
    }

    #[inline(always)]
    pub(super) fn is_on(&self) -> bool {
        self.on.load(Ordering::Acquire)
    }

    #[inline(always)]
    pub(super) fn round(&self) -> u32 {
        self.round.load(Ordering::Acquire)
    }

    #[inline(always)]
    pub(super) fn positions(&self) -> [i32; 3] {
        self.positions
            .each_ref()
            .map(|position| position.load(Ordering::Relaxed))
    }
}
