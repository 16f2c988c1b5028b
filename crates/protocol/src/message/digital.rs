//! Spare digital inputs and outputs of a machine.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most spare inputs of a machine, and most spare outputs.
pub const DIGITAL: usize = 8;

/// Levels of the spare inputs and outputs: a bit for each in the order of the scene, the first is bit 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct DigitalStates {
    /// Inputs that are active, free of bounces.
    pub inputs: u8,
    /// Outputs that are on.
    pub outputs: u8,
    /// Tick of the last change, as telemetry counts them; 0 before the first.
    pub tick: u32,
}

/// Spare outputs that change in the tick in which a move begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct OutputSwitch {
    /// Number of the move: the next to offer.
    pub number: u32,
    /// Outputs that go on, a bit for each: bit 0 is the first of the scene.
    pub on: u8,
    /// Outputs that go off. One of both goes on.
    pub off: u8,
}
