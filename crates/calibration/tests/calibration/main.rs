//! Calibrations of machines that are known, against measurements with noise.

mod accuracy;
mod blind;
mod proposals;
mod refusals;
mod true_machine;
