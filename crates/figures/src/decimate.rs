//! Long jobs in bounded memory: a stretch of ticks is kept as its first, last and extreme points,
//! so that the curve drawn shows every peak.

/// Points kept per series at most: about four for each of [`STRETCHES`].
const STRETCHES: u64 = 1000;

/// Points (key, values) of which each of the `K` values keeps its extremes.
///
/// Up to 2000 points are kept as they are; beyond, first, last, least and greatest of each
/// stretch of equal length.
#[derive(Clone, Debug)]
pub struct Decimator<const K: usize> {
    /// Ticks per stretch.
    stretch: u64,
    kept: Vec<(f64, [f64; K])>,
    open: Vec<(f64, [f64; K])>,
    seen: u64,
}

impl<const K: usize> Decimator<K> {
    /// A decimator for a series of about `expected` points.
    pub fn new(expected: u64) -> Self {
        let stretch = if expected <= 2 * STRETCHES {
            1
        } else {
            expected.div_ceil(STRETCHES)
        };
        Self {
            stretch,
            kept: Vec::new(),
            open: Vec::new(),
            seen: 0,
        }
    }

    /// Adds the next point.
    pub fn push(&mut self, key: f64, values: [f64; K]) {
        // `open` holds first, (least, greatest) of each value, last.
        if self.open.is_empty() {
            self.open = vec![(key, values); 2 + 2 * K];
        }
        for k in 0..K {
            if values[k] < self.open[1 + 2 * k].1[k] {
                self.open[1 + 2 * k] = (key, values);
            }
            if values[k] > self.open[2 + 2 * k].1[k] {
                self.open[2 + 2 * k] = (key, values);
            }
        }
        self.open[1 + 2 * K] = (key, values);
        self.seen += 1;
        if self.seen.is_multiple_of(self.stretch) {
            self.close();
        }
    }

    fn close(&mut self) {
        self.open.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.open.dedup_by(|a, b| a.0 == b.0);
        self.kept.append(&mut self.open);
    }

    /// The points kept, in order of their keys.
    pub fn finish(mut self) -> Vec<(f64, [f64; K])> {
        self.close();
        self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_series_are_kept_whole() {
        let mut series = Decimator::new(101);
        for tick in 0..101 {
            series.push(f64::from(tick), [f64::from(tick % 7)]);
        }
        let kept = series.finish();
        assert_eq!(kept.len(), 101);
        assert!(
            kept.iter()
                .enumerate()
                .all(|(i, p)| *p == (i as f64, [(i % 7) as f64]))
        );
    }

    #[test]
    fn long_series_keep_ends_and_every_peak() {
        let ticks = 1_000_003;
        let mut series = Decimator::new(ticks);
        let value = |tick: u64| match tick {
            123_456 => 50.0,
            777_777 => -60.0,
            _ => (tick as f64 * 0.001).sin(),
        };
        for tick in 0..ticks {
            series.push(tick as f64, [value(tick), -value(tick)]);
        }
        let kept = series.finish();
        assert!(kept.len() <= 6 * 1000, "{}", kept.len());
        assert_eq!(kept.first().unwrap().0, 0.0);
        assert_eq!(kept.last().unwrap().0, (ticks - 1) as f64);
        assert!(kept.contains(&(123_456.0, [50.0, -50.0])));
        assert!(kept.contains(&(777_777.0, [-60.0, 60.0])));
        assert!(kept.is_sorted_by(|a, b| a.0 < b.0));
    }

    #[test]
    fn an_unfinished_stretch_is_not_lost() {
        let mut series = Decimator::new(10_000);
        for tick in 0..5 {
            series.push(f64::from(tick), [f64::from(tick)]);
        }
        assert_eq!(series.finish().last(), Some(&(4.0, [4.0])));
    }
}
