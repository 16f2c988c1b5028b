//! Durations counted in bounded memory, however long the run.

use std::time::Duration;

/// Counts of durations: exact up to 255 ns, to within 1/128 above; the least and the greatest
/// exactly.
#[derive(Clone, Debug)]
pub struct Histogram {
    counts: Vec<u64>,
    total: u64,
    least: u64,
    greatest: u64,
}

/// Steps that each doubling is divided into.
const STEPS: u64 = 128;

impl Default for Histogram {
    fn default() -> Self {
        Self {
            counts: Vec::new(),
            total: 0,
            least: u64::MAX,
            greatest: 0,
        }
    }
}

impl Histogram {
    /// Counts one duration.
    pub fn push(&mut self, duration: Duration) {
        // 584 years are enough.
        let nanoseconds = u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
        let bucket = bucket(nanoseconds);
        if bucket >= self.counts.len() {
            self.counts.resize(bucket + 1, 0);
        }
        self.counts[bucket] += 1;
        self.total += 1;
        self.least = self.least.min(nanoseconds);
        self.greatest = self.greatest.max(nanoseconds);
    }

    /// Number of durations counted.
    pub fn count(&self) -> u64 {
        self.total
    }

    /// The least duration, zero if none was counted.
    pub fn min(&self) -> Duration {
        Duration::from_nanos(if self.total == 0 { 0 } else { self.least })
    }

    /// The greatest duration, zero if none was counted.
    pub fn max(&self) -> Duration {
        Duration::from_nanos(self.greatest)
    }

    /// The duration that `percent` of the counted ones do not exceed (nearest rank).
    pub fn percentile(&self, percent: f64) -> Duration {
        let rank = (percent / 100.0 * self.total as f64).ceil().max(1.0) as u64;
        let mut below = 0;
        for (bucket, count) in self.counts.iter().enumerate() {
            below += count;
            if below >= rank {
                let value = greatest_in(bucket).clamp(self.least, self.greatest);
                return Duration::from_nanos(value);
            }
        }
        self.max()
    }
}

/// Values below 2 STEPS have buckets of their own; each doubling above has STEPS.
fn bucket(value: u64) -> usize {
    let shift = (value / STEPS).checked_ilog2().unwrap_or(0);
    (u64::from(shift) * STEPS + (value >> shift)) as usize
}

fn greatest_in(bucket: usize) -> u64 {
    let bucket = bucket as u64;
    let shift = (bucket / STEPS).saturating_sub(1);
    let step = bucket - shift * STEPS;
    // Minus one before the shift could lose the top bit of the last bucket.
    (step << shift) + ((1 << shift) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buckets_are_in_order_without_gaps_and_narrow() {
        let mut expected = 0;
        for value in 0..100_000 {
            let bucket = bucket(value);
            assert!(bucket == expected || bucket == expected + 1, "{value}");
            expected = bucket;
            let greatest = greatest_in(bucket);
            assert!(
                value <= greatest && greatest - value <= value / STEPS,
                "{value} {greatest}"
            );
        }
        assert_eq!(greatest_in(bucket(u64::MAX)), u64::MAX);
    }

    #[test]
    fn percentiles_of_a_known_row() {
        let mut histogram = Histogram::default();
        assert_eq!(histogram.percentile(50.0), Duration::ZERO);
        assert_eq!([histogram.min(), histogram.max()], [Duration::ZERO; 2]);
        for value in (1..=200).rev() {
            histogram.push(Duration::from_nanos(value));
        }
        assert_eq!(histogram.count(), 200);
        assert_eq!(histogram.min().as_nanos(), 1);
        assert_eq!(histogram.percentile(50.0).as_nanos(), 100);
        assert_eq!(histogram.percentile(99.0).as_nanos(), 198);
        assert_eq!(histogram.max().as_nanos(), 200);
        histogram.push(Duration::from_secs(1));
        assert_eq!(histogram.max(), Duration::from_secs(1));
        assert_eq!(histogram.percentile(100.0), Duration::from_secs(1));
    }
}
