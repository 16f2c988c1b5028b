//! Holds the benchmarks of one tick: `cargo bench -p trirrr-tick-time`, and beside code that SymForce generates
//! `cargo bench -p trirrr-tick-time --features symforce --bench symforce`.

#[cfg(feature = "symforce")]
pub mod peer;
