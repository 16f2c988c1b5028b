//! Work on several things at a time.

use anyhow::Result;
use std::num::NonZero;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

/// As many workers as the machine has processors, two at least: one waits for an emulator while the other
/// builds.
pub(crate) fn workers() -> usize {
    thread::available_parallelism()
        .map_or(2, NonZero::get)
        .max(2)
}

/// Applies `work` to each item and returns the results in the order of the items. After a failure it
/// begins no further item. It then returns the failure of the first failed item in that order.
pub(crate) fn map<T: Sync, R: Send>(
    workers: usize,
    items: &[T],
    work: impl Fn(&T) -> Result<R> + Sync,
) -> Result<Vec<R>> {
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let results = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..workers.min(items.len()) {
            scope.spawn(|| {
                while !failed.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(index) else {
                        break;
                    };
                    let result = work(item);
                    if result.is_err() {
                        failed.store(true, Ordering::Relaxed);
                    }
                    let mut results = results.lock().expect("no worker panics");
                    results.push((index, result));
                }
            });
        }
    });
    let mut results = results.into_inner().expect("no worker panics");
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let squares = map(3, &[5_u64, 1, 3], |item| {
            thread::sleep(Duration::from_millis(*item));
            Ok(item * item)
        });
        assert_eq!(squares.expect("no failure"), [25, 1, 9]);
    }

    #[test]
    fn a_failure_ends_the_work_and_is_returned() {
        let items: Vec<usize> = (0..1000).collect();
        let done = AtomicUsize::new(0);
        let failure = map(2, &items, |item| {
            done.fetch_add(1, Ordering::Relaxed);
            thread::sleep(Duration::from_millis(1));
            anyhow::ensure!(*item != 3, "item 3");
            Ok(())
        });
        assert_eq!(failure.expect_err("item 3 fails").to_string(), "item 3");
        assert!(done.into_inner() < 100);
    }
}
