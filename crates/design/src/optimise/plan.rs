//! Plan of a search, and its parts for several programs.

use super::{DesignSpace, Objective, StudyMode};
use std::sync::atomic::AtomicBool;

/// Candidates that a search looks at.
#[derive(Clone, Debug)]
pub struct SearchPlan<'a> {
    /// Values that are varied.
    pub space: &'a DesignSpace,
    /// Working modes; none: that of the scene.
    pub modes: Vec<Option<StudyMode>>,
    /// Values of the scene itself: the search begins with them.
    pub own: Vec<f64>,
    /// Quantities, one or two.
    pub objectives: &'a [Objective],
    /// Most candidates.
    pub evaluations: usize,
    /// Begin of the random numbers: the same seed gives the same candidates.
    pub seed: u64,
}

/// Means to follow a search and to end it.
pub struct SearchWatch<'a> {
    /// Ends the search: candidates that were looked at count.
    pub stop: &'a AtomicBool,
    /// Called after each candidate.
    pub told: &'a (dyn Fn() + Sync),
}

/// Seed of a part of a search: splitmix64 of Steele, Lea and Flood.
pub(super) fn mixed(seed: u64, part: u64) -> u64 {
    let mut mixed = seed.wrapping_add((part + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}

impl SearchPlan<'_> {
    /// Takes part `index` of `count` of a search, from 0: its own seed, its share of the evaluations and, where there are modes enough,
    /// its own modes.
    pub fn take_part(&mut self, index: usize, count: usize) {
        self.seed = mixed(self.seed, index as u64);
        let shares = |parts: usize| self.evaluations * parts / count;
        self.evaluations = shares(index + 1) - shares(index);
        if self.modes.len() >= count {
            let modes = self.modes.iter().copied().enumerate();
            let own = modes.filter(|(place, _)| place % count == index);
            self.modes = own.map(|(_, mode)| mode).collect();
        }
    }
}
