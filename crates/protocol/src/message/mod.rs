//! Messages between a host and a machine. Commands go one way; replies, events and telemetry go the
//! other.
//!
//! # Numbers and units
//! A message is generic over the scene's own number type `N`: what the machine computes is what it
//! sends, bit for bit, and an image without `f64` arithmetic needs none to talk. Lengths, times and
//! masses are in the machine's own units, which [`Identity`] names; for the float types they are SI.
//! Angles are an `N::Angle`. Signs and frames are those of the core: everything in the fixed frame,
//! counter-clockwise positive, motors and legs counted from 0. The sections of a scene
//! ([`scene`]) are the one exception: binary64 in SI, as the scene's file has them.
//!
//! # Encoding
//! Every type is a serde type of fixed layout: no maps, no strings, no sequences of unknown
//! length. A variant is known by its place, so variants are added at the end and never moved.

mod board;
mod command;
mod digital;
mod drive;
mod inputs;
mod levels;
mod moves;
mod part;
mod path;
mod probe;
mod refusal;
mod report;
pub mod scene;
mod scene_types;
mod state;
mod telemetry;
#[cfg(test)]
mod tests;
mod update;
mod violation;

pub use board::{AngleReference, Board, Clock, Firmware, NAME_CAPACITY, Registers, Start};
pub use command::{
    AllMoves, Command, Goal, Hello, JobLabel, MoveContents, OfferedMoves, Recovery, Request,
};
pub use digital::{DIGITAL, DigitalStates, OutputSwitch};
pub use drive::{DriveReading, DriveSample, DriveState, NotEnabled};
pub use inputs::{InputState, InputStates};
pub use levels::{FULL_LEVEL, LEVEL_PARTS, LEVELS, LISTED, LevelPiece, LevelRange, ListedMove};
pub use moves::{AnyMove, BATCH, Move, MoveBatch, MoveStep, QuinticMove, ToolSetting};
pub use part::{Content, Unread, Written};
pub use path::{PathCurve, PathPiece};
pub use probe::{ProbeContact, ProbeRun};
pub use refusal::Refusal;
pub use report::{
    Cut, Event, Identity, Interruption, JobAccount, Message, MessageRef, Reply, Status, Verdict,
};
pub use scene_types::{SCENE_KEYS, SceneHeader, SceneNeed, SceneNeeds, SceneRoom, SceneTypes};
pub use state::{Acting, State};
pub use telemetry::{Telemetry, TelemetryFields};
pub use update::{
    BLOCK, IMAGE_MARK, ImageBlock, ImageHeader, UpdateOutcome, UpdateRefusal, UpdateStatus,
    UpdateStep,
};
pub use violation::{Bounded, DriveFault, Fault, FaultCode, LeastDuration, Violation};

use postcard_schema::Schema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use trirrr_core::number::Number;

/// A number type that messages can carry.
pub trait Transmit:
    Number<Angle: Serialize + DeserializeOwned + Schema> + Serialize + DeserializeOwned + Schema
{
}

impl<N> Transmit for N where
    N: Number<Angle: Serialize + DeserializeOwned + Schema> + Serialize + DeserializeOwned + Schema
{
}

/// Version of the protocol: what commands mean, in which order they are to be given. A change of a
/// message's layout changes the schema key instead.
pub const PROTOCOL: u16 = 4;

/// Requests that a machine takes before the host has the answer to the first of them.
pub const WINDOW: usize = 8;
