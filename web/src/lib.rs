//! Core of the page: what `web/page` asks, answered by the crates that boards and host tools use.
//!
//! [`Reading`] checks the text of a scene. [`Machine`] answers for a pose: figures, the eight working modes, all assembly modes.
//! [`PlayedJob`] holds the job of a scene, tick by tick; [`Reading::with_job`] takes one from a file of its own. [`SimulatedPlant`] is what motors, gears and
//! friction of a scene with a plant make of it. [`BoardScene`] is what a conversation with the scene's board has to know. The page computes no kinematics of its own.
//!
//! Compiled for `wasm32-unknown-unknown` the crate is the page's module; natively its functions are the same, so that tests and
//! `examples/bits.rs` call what the page calls. Units are SI, angles radians. Lists of joints are x and y in turns, leg by leg, in the
//! fixed frame. Errors are sentences.

mod bits;
mod board;
mod figures;
mod job;
mod job_file;
mod machine;
mod modes;
mod plant;
mod reading;

pub use bits::bits_of;
pub use board::BoardScene;
pub use figures::{Figures, MotorLimits};
pub use job::{JobMode, PlayedJob};
pub use job_file::{GivenDrawing, JobInputs, is_drawing};
pub use machine::Machine;
pub use modes::{AssemblyList, AssemblyMode, WorkingMode};
pub use plant::SimulatedPlant;
pub use reading::{Problem, Reading, machine_file};
