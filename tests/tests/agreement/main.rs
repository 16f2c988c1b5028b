//! The number types agree with f64, each within what its format explains: over every tick of the
//! shipped scenes, over the extreme machines, over 10,000 random machines.
//!
//! Every bound is a sum over what the format rounds: |dq/dp| times how far p may be off, q being a
//! result. Every bracket has two ends: above it is a defect; below it, something became better
//! than the bound knows, and the bound has to follow.

mod bounds;
mod extremes;
mod format;
mod random;
mod scenes;
