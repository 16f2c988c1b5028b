//! Inputs of the machine: contacts by which a person stops it, a probe, limit switches.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Inputs of the machine, free of bounces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct InputStates {
    /// The emergency stop. Active: pressed, or its wire is broken.
    pub emergency_stop: InputState,
    /// The door. Active: open.
    pub door: InputState,
    /// The probe. Active: it touches.
    pub probe: InputState,
    /// Limit switches of the motors. Active: the motor stands beyond its range, or the wire is broken.
    pub limits: [InputState; 3],
}

/// State of one input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum InputState {
    /// The scene names no such input.
    #[default]
    Absent,
    /// Not active.
    Clear,
    /// It keeps the machine from moving; a probe touches.
    Active,
}

impl InputStates {
    /// Inputs of a scene that names none.
    pub const ABSENT: Self = Self {
        emergency_stop: InputState::Absent,
        door: InputState::Absent,
        probe: InputState::Absent,
        limits: [InputState::Absent; 3],
    };
}

impl InputState {
    /// State of an input that the scene names.
    pub const fn of(is_active: bool) -> Self {
        match is_active {
            true => Self::Active,
            false => Self::Clear,
        }
    }

    /// Returns true if the input is active.
    pub fn is_active(self) -> bool {
        self == Self::Active
    }
}
