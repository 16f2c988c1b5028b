//! Commands of `trirrr`: what they print and write, and what they refuse. `stream` has tests of its own.

#![allow(clippy::disallowed_methods)]

mod assemble;
mod calibrate;
mod common;
mod contract;
mod design;
mod eval;
mod figures;
mod files;
mod first_steps;
mod grbl;
mod job_remarks;
mod jobs;
mod linkage;
mod planning;
mod plant;
mod raster;
mod redundant;
mod results;
mod run;
mod schemas;
mod study;
mod tolerances;
mod tutorial;
mod ui;
