#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod canvas;
pub mod chart;
pub mod decimate;
pub mod document;
pub mod labels;
pub mod loglog;
pub mod panel;
pub mod plane;
pub mod scale;
pub mod style;
