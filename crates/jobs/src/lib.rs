//! Jobs in files of their own, on the machine of a scene: G-code, drawings and tables become the path of a job.
//!
//! [`gcode_job`], [`drawing_job`] and [`table_job`] read a file and place it. [`ReadJob::plan`] plans the path under the limits of the scene.
//! A refusal is a [`JobRefusal`]: the line or the shape of the file, and the reason.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

mod drawing;
mod fit;
mod options;
mod path;
mod places;
mod read;
mod remarks;

pub use drawing::{PlacedDrawing, place};
pub use fit::{Fitted, fit};
pub use options::{DrawingOptions, JobOptions, PenOption};
pub use path::{
    PathBuilder, PathReader, PathSink, TOLERANCE_M, TOLERANCE_RAD, has_length, piece_from, pose_of,
    too_often, tool_of,
};
pub use places::{ElementPlaces, JobRefusal, PlacesIn, breach, in_line, number};
pub use read::{
    ReadJob, drawing_job, element_job, finish_job, gcode_job, gcode_setup, job_scene,
    level_origin_m, table_job,
};
pub use remarks::JobWatch;
