//! Numbers without a pattern, the same in every run (splitmix64).

/// Generator, from its seed.
pub(crate) struct Draws(pub(crate) u64);

impl Draws {
    /// Returns a number from `low` to `high`.
    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        low + (high - low) * (z >> 11) as f64 * 0.5f64.powi(53)
    }

    /// Returns a number from `-size` to `size`.
    pub(crate) fn around(&mut self, size: f64) -> f64 {
        self.within(-size, size)
    }
}
