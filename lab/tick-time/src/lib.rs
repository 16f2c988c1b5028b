//! Holds the benchmark of one tick: `cargo bench -p trirrr-tick-time`.
