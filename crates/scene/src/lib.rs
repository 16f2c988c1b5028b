//! Scenes: a machine, its loads, drives and limits, and a job, in one TOML file in SI units.
//!
//! A scene is checked once, when it is read, and whole: everything wrong with it comes back in one
//! [`SceneError`], each [`Problem`] with line, key, value and reason. What is accepted can be
//! driven: every pose of the job is within reach and away from serial and parallel singularity,
//! between the given poses too.
//!
//! `docs/scene.md` describes the keys. [`cases`] reads tables of machines and setpoints. [`pipeline`]
//! chooses the core's types for a machine at run time, and gives a [`record::Record`] per setpoint.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

mod autonomous;
mod blocks;
mod carried;
pub mod cases;
mod contact;
mod controller;
mod drive;
mod duration;
mod error;
mod feedback;
mod homing;
mod homing_path;
mod in_order;
mod inputs;
mod io;
mod job;
mod job_move;
mod job_path;
mod judge;
mod kind;
mod levels;
mod limits;
mod long_job;
mod longest_stop;
mod machine;
mod missing_limits;
mod motors;
mod number_type;
mod obstacle;
pub mod offer;
mod outputs;
mod own_job;
mod path;
mod peak;
pub mod pipeline;
mod planning;
mod plant;
mod player;
mod power;
mod push;
mod range;
mod reach_map;
pub mod read;
pub mod record;
mod scene;
mod service;
mod settings;
mod spool;
mod stops;
pub mod tables;
mod tolerances;
mod tool;
mod tools;
mod unplanned;
mod values;
mod visible;
mod way;
mod whole;
pub mod words;

pub use autonomous::Autonomous;
pub use blocks::{BlockCutter, PathBlock};
pub use carried::{CarriedTools, ToolBody};
pub use contact::{Contact, ContactFriction};
pub use controller::{Controller, Timing};
pub use drive::{
    Bldc, Can, CanProtocol, Drive, DriveKind, EnableLevel, FaultInput, Knows, Mit, MitAnswer,
    PullOut, Stepper,
};
pub use error::{Problem, SceneError};
pub use feedback::Feedback;
pub use homing::Homing;
pub use inputs::{InputPorts, NormalContact};
pub use io::{SpareInput, SpareOutput, SparePins};
pub use job::Job;
pub use job_move::{JobMove, Tool};
pub use job_path::{Dwell, FreeAlpha, JobPath};
pub use kind::MachineKind;
pub use levels::{JobLevels, LevelRow};
pub use long_job::UntakenJob;
pub use longest_stop::LongestStop;
pub use missing_limits::MissingLimit;
pub use number_type::NumberType;
pub use obstacle::limited;
pub use outputs::{JobOutputs, OutputBits, PathOutputs};
pub use path::{MoveVerdict, judge_move};
pub use planning::{MOVE_COLUMNS, PlannedJob, plan_job};
pub use plant::{Friction, JointFriction, Method, Plant, Transmission};
pub use player::JobPlayer;
pub use power::Power;
pub use push::Push;
pub use range::{RangeError, units, units_of_scene, units_of_setpoints};
pub use reach_map::{ReachMap, Room};
pub use scene::Scene;
pub use service::Service;
pub use settings::settings;
pub use spool::{MoveSpool, SpooledMoves};
pub use tolerances::{BodyTolerances, Tolerances};
pub use tool::{ToolKind, ToolPort};
pub use tools::{MountableTool, ToolRack};
#[doc(hidden)]
pub use trirrr_core;
pub use trirrr_core::limits::LimitParameters as Limits;
pub use unplanned::Unplanned;
pub use values::values;
pub use visible::{visible, visible_lines};
pub use whole::{BOARDS, is_board_file};
