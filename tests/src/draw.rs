//! Random numbers and machines one at a time, for tests that draw what suits what was drawn before.

use crate::random::{Case, case};
use core::f64::consts::TAU;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Numbers that are the same in every run: splitmix64.
pub struct Draw(u64);

impl Draw {
    /// Numbers of `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform from `low` to `high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Even in its logarithm.
    pub fn log_within(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    /// True in `part` of all cases.
    pub fn chance(&mut self, part: f64) -> bool {
        self.within(0.0, 1.0) < part
    }
}

/// Random machines, each in a pose away from singularities.
pub fn machines(seed: u64) -> impl Iterator<Item = Case> {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let config = Config {
        max_local_rejects: u32::MAX,
        max_global_rejects: u32::MAX,
        ..Config::default()
    };
    let mut runner = TestRunner::new_with_rng(config, rng);
    core::iter::from_fn(move || Some(case().new_tree(&mut runner).ok()?.current()))
}

/// `case` without the whole turns in its angle.
pub fn within_a_turn(case: &Case) -> Case {
    let mut case = *case;
    case.setpoint.pose.angle %= TAU;
    case
}
