//! Work on several items at a time, whose results are taken in the order of the items.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Results that are taken one after the other.
struct Taken<K, E> {
    take: K,
    /// Number of the item whose result is taken next.
    next: usize,
    /// Nothing more is taken: an item has failed, or a thread.
    is_over: bool,
    end: Result<(), E>,
}

/// Does `work` on each of `items`, on all cores, and hands the results to `take` in the order of the items. Each thread holds one
/// item, or its result, so that memory does not grow with the number of items.
///
/// # Errors
/// The first in the order of the items: of an item itself, of the work on it, or of `take`.
pub(crate) fn in_order<T: Send, R, E: Send>(
    items: impl Iterator<Item = Result<T, E>> + Send,
    work: impl Fn(T) -> Result<R, E> + Sync,
    take: impl FnMut(R) -> Result<(), E> + Send,
) -> Result<(), E> {
    let items = Mutex::new(items.enumerate());
    let taken = Mutex::new(Taken {
        take,
        next: 0,
        is_over: false,
        end: Ok(()),
    });
    let turn = Condvar::new();
    let run = || {
        let guard = PanicGuard {
            taken: &taken,
            turn: &turn,
        };
        loop {
            let Some((index, item)) = locked(&items).next() else {
                return;
            };
            let result = item.and_then(&work);
            let mut taken = locked(guard.taken);
            while taken.next != index && !taken.is_over {
                taken = turn.wait(taken).unwrap_or_else(PoisonError::into_inner);
            }
            if taken.is_over {
                return;
            }
            if let Err(error) = result.and_then(&mut taken.take) {
                (taken.end, taken.is_over) = (Err(error), true);
            }
            taken.next += 1;
            turn.notify_all();
        }
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if cores == 1 {
        // A page of a browser has no threads to spawn.
        run();
    } else {
        std::thread::scope(|scope| {
            for _ in 0..cores {
                scope.spawn(run);
            }
        });
    }
    let taken = taken.into_inner();
    taken.unwrap_or_else(PoisonError::into_inner).end
}

/// A lock whose thread has panicked is as good as any: the panic goes on where the threads are joined.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Wakes the others up where a thread panics: they would wait for its result.
struct PanicGuard<'a, K, E> {
    taken: &'a Mutex<Taken<K, E>>,
    turn: &'a Condvar,
}

impl<K, E> Drop for PanicGuard<'_, K, E> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            locked(self.taken).is_over = true;
            self.turn.notify_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let mut all = Vec::new();
        let items = (0..200_u64).map(Ok::<u64, String>);
        let work = |item: u64| {
            // Later items are often done first.
            std::thread::sleep(Duration::from_micros(300 * (item % 3)));
            Ok(item)
        };
        let end = in_order(items, work, |item| {
            all.push(item);
            Ok(())
        });
        assert_eq!(end, Ok(()));
        assert_eq!(all, (0..200).collect::<Vec<_>>());
    }

    #[test]
    fn the_first_error_counts_and_ends_the_work() {
        let mut all = Vec::new();
        let items = (0..1000_u64).map(|item| match item {
            60 => Err("read"),
            item => Ok(item),
        });
        let work = |item: u64| match item {
            50 => {
                std::thread::sleep(Duration::from_millis(5));
                Err("fifty")
            }
            51 => Err("fifty-one"),
            item => Ok(item),
        };
        let end = in_order(items, work, |item| {
            all.push(item);
            Ok(())
        });
        assert_eq!(end, Err("fifty"));
        assert_eq!(all, (0..50).collect::<Vec<_>>());
    }

    #[test]
    #[should_panic(expected = "a scoped thread panicked")]
    fn a_panic_goes_on_and_no_thread_waits_for_it() {
        let items = (0..100_u64).map(Ok::<u64, String>);
        let work = |item: u64| match item {
            7 => panic!("of a test"),
            item => Ok(item),
        };
        let _ = in_order(items, work, |_| Ok(()));
    }
}
