//! No log: what is logged by code that images share is dropped.
#![allow(unsafe_code)]

#[defmt::global_logger]
struct NoLog;

// SAFETY: nothing is written.
unsafe impl defmt::Logger for NoLog {
    fn acquire() {}

    unsafe fn flush() {}

    unsafe fn release() {}

    unsafe fn write(_: &[u8]) {}
}
