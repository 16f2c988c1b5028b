//! Inputs by which a person stops the machine.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Inputs of the machine, free of bounces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct InputStates {
    /// The emergency stop. Active: pressed, or its wire is broken.
    pub emergency_stop: InputState,
    /// The door. Active: open.
    pub door: InputState,
}

/// State of one input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum InputState {
    /// The scene names no such input.
    #[default]
    Absent,
    /// It lets the machine move.
    Clear,
    /// It keeps the machine from moving.
    Active,
}

impl InputStates {
    /// Inputs of a scene that names none.
    pub const ABSENT: Self = Self {
        emergency_stop: InputState::Absent,
        door: InputState::Absent,
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

    /// Returns true if the input keeps the machine from moving.
    pub fn is_active(self) -> bool {
        self == Self::Active
    }
}
