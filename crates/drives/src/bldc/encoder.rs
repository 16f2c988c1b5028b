//! Quadrature encoders: from counts of 16 bits to the angle and the rate of a joint.

/// A turn of a joint in counts of its encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderScale {
    /// 2^-64 of a turn of the joint per count, modulo a turn.
    pub per_count: u64,
}

impl EncoderScale {
    /// Scale of `counts_per_rev` counts per turn of the rotor, all edges of both channels, behind a gear of `gear_ratio` turns of
    /// the rotor per turn of the joint. With `reversed` the joint turns clockwise where the encoder counts up. Both numbers
    /// have to be positive, and their product greater than 1.
    pub const fn new(counts_per_rev: u32, gear_ratio: f64, reversed: bool) -> Self {
        const TURN: f64 = 18_446_744_073_709_551_616.0;
        let per_count = (TURN / (counts_per_rev as f64 * gear_ratio)) as u64;
        Self {
            per_count: match reversed {
                true => per_count.wrapping_neg(),
                false => per_count,
            },
        }
    }

    /// Angle of the joint after `count` counts, in 2^-32 of a turn, modulo a turn.
    #[inline(always)]
    fn turn(self, count: i32) -> u32 {
        // Whole turns fall off the top.
        ((count as u64).wrapping_mul(self.per_count) >> 32) as u32
    }
}

/// Encoder of a joint: counts without end, and a loop that follows them for the rate.
///
/// The loop has two gains, critically damped at its bandwidth b: the count is predicted by the rate, and the error of the
/// prediction corrects angle (2 b T) and rate (b^2 T). The rate is smoother than a difference of counts and lags by 2 / b
/// where it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Encoder {
    scale: EncoderScale,
    /// Last value of the counter,
    counter: u16,
    /// and everything that it has counted.
    count: i32,
    /// Angle that the loop has come to, in 2^-32 of a turn,
    followed: u32,
    /// and its rate in the same per sample.
    rate: f32,
    quick: f32,
    slow: f32,
}

impl Encoder {
    /// Encoder at count 0, followed with `bandwidth_rad_s` in samples that are `period_s` apart.
    pub(super) fn new(scale: EncoderScale, bandwidth_rad_s: f32, period_s: f32) -> Self {
        // One and more would ring: the difference of two counts then is the rate.
        let quick = (2.0 * bandwidth_rad_s * period_s).min(1.0);
        Self {
            scale,
            counter: 0,
            count: 0,
            followed: 0,
            rate: 0.0,
            quick,
            slow: 0.25 * quick * quick,
        }
    }

    /// Takes the value of the counter at a sample. Between two samples it turns less than 32,768 counts.
    #[inline(always)]
    pub(super) fn sample(&mut self, counter: u16) {
        let moved = counter.wrapping_sub(self.counter) as i16;
        self.counter = counter;
        self.count = self.count.wrapping_add(moved.into());
        let ahead = self.followed.wrapping_add(self.rate as i32 as u32);
        let error = self.turn().wrapping_sub(ahead) as i32 as f32;
        self.followed = ahead.wrapping_add((self.quick * error) as i32 as u32);
        self.rate += self.slow * error;
    }

    /// Angle of the joint in 2^-32 of a turn, from where it was at count 0.
    #[inline(always)]
    pub(super) fn turn(&self) -> u32 {
        self.scale.turn(self.count)
    }

    /// Rate of the joint in 2^-32 of a turn per sample.
    #[inline(always)]
    pub(super) fn rate(&self) -> f32 {
        self.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURN: f64 = 4_294_967_296.0;

    #[test]
    fn counts_are_angles_over_any_number_of_turns() {
        // A gear that does not divide.
        for (gear, reversed) in [(5.18, false), (9.0, true), (1.0, false)] {
            let mut encoder = Encoder::new(EncoderScale::new(4096, gear, reversed), 1000.0, 1e-4);
            let sign = if reversed { -1.0 } else { 1.0 };
            let mut count = 0i64;
            for step in 0..20_000i64 {
                count += if step < 12_000 { 31_000 } else { -17_003 };
                encoder.sample(count as u16);
                let turns = sign * count as f64 / (4096.0 * gear);
                let wanted = (turns - turns.floor()) * TURN;
                let off = (f64::from(encoder.turn()) - wanted) / TURN;
                let off = off - off.round();
                assert!(off.abs() < 1e-9, "{step}: {off:e}");
            }
        }
    }

    /// A steady rate is found, with far less noise than the difference of counts has.
    #[test]
    fn the_rate_is_that_of_the_joint() {
        let (counts, gear, period) = (4096, 9.0, 1e-4);
        let mut encoder = Encoder::new(EncoderScale::new(counts, gear, false), 1000.0, 1e-4);
        // 0.7 rad/s: 0.41 counts in a sample.
        let per_sample = 0.7 * period * f64::from(counts) * gear / core::f64::consts::TAU;
        let mut largest: f64 = 0.0;
        for step in 0..20_000 {
            encoder.sample((f64::from(step) * per_sample).round() as i64 as u16);
            let rate = f64::from(encoder.rate()) / TURN * core::f64::consts::TAU / period;
            if step > 1000 {
                largest = largest.max((rate - 0.7).abs());
            }
        }
        // A count in a sample is 1.7 rad/s.
        assert!(largest < 0.03, "{largest}");
    }

    #[test]
    fn a_bandwidth_beyond_the_samples_does_not_ring() {
        let mut encoder = Encoder::new(EncoderScale::new(4096, 1.0, false), 1e6, 1e-3);
        for step in 0..1000u16 {
            encoder.sample(step.wrapping_mul(40));
        }
        let per_sample = f64::from(encoder.rate()) / TURN * 4096.0;
        assert!((per_sample - 40.0).abs() < 0.01, "{per_sample}");
    }
}
