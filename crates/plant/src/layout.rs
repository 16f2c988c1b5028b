//! The state vector. What a scene does not name has no place in it.
//!
//! | part | variables | where |
//! |---|---|---|
//! | coordinates | x, y, alpha; near a stretched leg its two angles and alpha ([`Plant::leading`](crate::Plant::leading)) | always |
//! | their rates | | always |
//! | rotors behind an elastic transmission | phi_1..3, then phi'_1..3 | [`Layout::elastic`] |
//! | winding currents | i_1..3 | [`Layout::currents`] |
//! | records | work done by the motors' supply, losses | always, at the end |
//!
//! phi is the rotor's angle divided by the gear ratio: what the joint would have, were the
//! transmission rigid.

/// Parts of a state vector besides the platform and the records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Rotors turn against an elastic transmission.
    pub elastic: bool,
    /// Windings have a current.
    pub currents: bool,
}

/// First of the rates.
pub const RATES: usize = 3;
/// First of the rotors' angles, where there are any.
pub const ROTORS: usize = 6;
/// First of the rotors' rates, where there are any.
pub const ROTOR_RATES: usize = 9;

impl Layout {
    /// Number of state variables.
    pub const fn dimension(self) -> usize {
        6 + if self.elastic { 6 } else { 0 } + if self.currents { 3 } else { 0 } + 2
    }

    /// First of the currents, where there are any.
    #[inline(always)]
    pub const fn current(self) -> usize {
        if self.elastic { 12 } else { 6 }
    }

    /// Pairs (position, velocity).
    pub fn positions(self) -> &'static [(usize, usize)] {
        const PAIRS: [(usize, usize); 6] = [(0, 3), (1, 4), (2, 5), (6, 9), (7, 10), (8, 11)];
        if self.elastic { &PAIRS } else { &PAIRS[..3] }
    }
}

/// Three values from `first` on.
#[inline(always)]
pub fn three<T: Copy, const N: usize>(y: &[T; N], first: usize) -> [T; 3] {
    [y[first], y[first + 1], y[first + 2]]
}
