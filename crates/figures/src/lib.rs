#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod canvas;
pub mod chart;
pub mod decimate;
pub mod document;
mod frame;
pub mod labels;
pub mod panel;
pub mod plane;
pub mod scale;
pub mod scatter;
pub mod sketch;
pub mod style;
