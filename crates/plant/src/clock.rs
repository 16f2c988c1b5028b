//! Time of a run: samples, rows and the end; and the time that the simulation takes.

use std::time::Duration;
#[cfg(not(target_family = "wasm"))]
use std::time::Instant;

/// Clock of the computer. In WebAssembly there is none: no time passes.
pub(crate) struct Stopwatch {
    #[cfg(not(target_family = "wasm"))]
    started: Instant,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self {
            #[cfg(not(target_family = "wasm"))]
            started: Instant::now(),
        }
    }

    pub(crate) fn elapsed(&self) -> Duration {
        #[cfg(not(target_family = "wasm"))]
        return self.started.elapsed();
        #[cfg(target_family = "wasm")]
        Duration::ZERO
    }
}

/// Samples, rows and the end, in the order of time.
pub(crate) struct RunClock {
    pub(crate) t: f64,
    /// The next sample and row.
    pub(crate) sample: u64,
    pub(crate) row: u64,
    pub(crate) rate: Option<f64>,
    pub(crate) record_s: f64,
    pub(crate) end: f64,
    /// Start and end of a push on the platform.
    pub(crate) push: Option<[f64; 2]>,
}

impl RunClock {
    /// Instants closer than this are one.
    fn together(&self) -> f64 {
        1e-9 * self
            .record_s
            .min(self.rate.map_or(f64::INFINITY, |rate| 1.0 / rate))
    }

    fn sample_t(&self) -> f64 {
        self.rate
            .map_or(f64::INFINITY, |rate| self.sample as f64 / rate)
    }

    /// The next row; on a sample where it is one within rounding.
    fn row_t(&self) -> f64 {
        self.on_sample(self.row as f64 * self.record_s)
    }

    /// `t`, on a sample where it is one within rounding.
    fn on_sample(&self, t: f64) -> f64 {
        let Some(rate) = self.rate else { return t };
        let sample = (t * rate).round() / rate;
        if (sample - t).abs() <= self.together() {
            sample
        } else {
            t
        }
    }

    pub(crate) fn samples_now(&self) -> bool {
        self.sample_t() <= self.t
    }

    pub(crate) fn records_now(&self) -> bool {
        self.row_t() <= self.t + self.together()
    }

    /// Returns `true` while the push acts.
    pub(crate) fn pushes_now(&self) -> bool {
        let now = self.t + self.together();
        self.push.is_some_and(|[from, to]| from <= now && now < to)
    }

    /// The next start or end of the push.
    fn push_t(&self) -> f64 {
        let now = self.t + self.together();
        let edge = self.push.iter().flatten().find(|edge| **edge > now);
        edge.map_or(f64::INFINITY, |edge| self.on_sample(*edge))
    }

    pub(crate) fn next(&self) -> f64 {
        let next = self.sample_t().min(self.row_t()).min(self.push_t());
        // A last interval too short for a step belongs to the one before.
        if self.end - next <= self.together() {
            self.end
        } else {
            next
        }
    }
}
