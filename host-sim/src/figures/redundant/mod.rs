//! Figures of a redundant machine: against time for as many legs and sliders as there are, and the machine along its path.

mod charts;
mod job;
mod plant;

pub use job::RedundantTraces;
pub use plant::RedundantPlantTraces;
