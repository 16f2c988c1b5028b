//! Progress of a report.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts the steps of a report, on any thread.
pub(crate) struct Progress<'a> {
    done: AtomicUsize,
    steps: usize,
    hear: &'a (dyn Fn(usize, usize) + Sync),
}

impl<'a> Progress<'a> {
    /// `hear` is told how many of the `steps` are done.
    pub(crate) fn new(steps: usize, hear: &'a (dyn Fn(usize, usize) + Sync)) -> Self {
        Self {
            done: AtomicUsize::new(0),
            steps,
            hear,
        }
    }

    /// Counts `result` as one step.
    pub(crate) fn step<T>(&self, result: T) -> T {
        let before = self.done.fetch_add(1, Ordering::Relaxed);
        (self.hear)(before + 1, self.steps);
        result
    }
}
