//! Threads of the computations.

use pyo3::PyResult;
use pyo3::exceptions::PyRuntimeError;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

/// Threads of this process, and its number: a process that was forked has the memory of its parent, and not its threads.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let here = process::id();
    if let Some((of, pool)) = &*kept
        && *of == here
    {
        return Ok(Arc::clone(pool));
    }
    // As many threads as RAYON_NUM_THREADS says, or cores.
    let pool = ThreadPoolBuilder::new()
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("no threads to compute with: {error}")))?;
    let pool = Arc::new(pool);
    // Threads of the parent cannot be ended here.
    std::mem::forget(kept.replace((here, Arc::clone(&pool))));
    Ok(pool)
}

/// Runs `work` on the threads of this process.
pub(crate) fn install<R: Send>(work: impl FnOnce() -> R + Send) -> PyResult<R> {
    Ok(pool()?.install(work))
}
