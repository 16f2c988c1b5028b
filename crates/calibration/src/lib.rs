#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod calibrate;
mod closure;
mod columns;
mod directions;
mod first_poses;
mod fit;
mod forecast;
mod gauge;
pub mod identify;
mod measurement;
mod outliers;
mod parameter;
mod patch;
mod propose;
mod reach;
mod refusal;
mod result;
mod setup;
mod sight;
mod table;

pub use calibrate::calibrate;
pub use columns::ColumnFault;
pub use forecast::PoseError;
pub use measurement::{DeviceReading, MeasuredRow, MeasurementNoise};
pub use parameter::{KinematicVector, PARAMETER_COUNT, ParameterGroup, is_angle, parameter_name};
pub use patch::ScenePatch;
pub use propose::{PlannedReading, Proposal, propose};
pub use reach::{MARGIN, SafeRegion};
pub use refusal::CalibrationRefusal;
pub use result::{Calibration, JudgedRow, ResidualSize};
pub use setup::CalibrationSetup;
pub use table::read_measurements;
