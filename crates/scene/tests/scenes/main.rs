//! Scenes: read, refused with key and reason, played.

mod autonomous;
mod common;
mod contact;
mod drivable;
mod fixed;
mod homing;
mod inputs;
mod io;
mod long_paths;
mod manual;
mod mutations;
mod parts;
mod paths;
mod refused_files;
mod refused_jobs;
mod refused_values;
mod shipped;
mod tool;
mod tool_point;
