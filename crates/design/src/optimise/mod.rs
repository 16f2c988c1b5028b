//! Search for the machine that does a job best: values of a scene within bounds, and its working mode.
//!
//! A candidate is the scene with other values, read as every command reads it: what the reader refuses is infeasible. The search is a
//! swarm of particles for each working mode, then a simplex about the best point. All candidates of a generation are looked at on all
//! cores; their order, and so the result, does not depend on how many there are.

mod appraise;
mod front;
mod plan;
mod scene_file;
mod search;
mod shortfall;
mod space;
mod swarm;

pub use appraise::{Appraisal, CandidateFault, MapSettings, StudyScene};
pub use front::{best, front, knee};
pub use plan::{SearchPlan, SearchWatch};
pub use scene_file::{EditedScene, own_value, with_values};
pub use search::search;
pub use space::{DesignPoint, DesignSpace, SpaceRange, StudyMode, VariedKey};

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Quantity that a study makes as good as it can.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Objective {
    /// Area of the proven workspace that is connected with the start of the job, m^2: the most.
    Workspace,
    /// Radius of the largest circle in it, m: the most.
    Disc,
    /// Area of the largest rectangle in it, m^2: the most.
    Rectangle,
    /// Largest torque of a motor on the job, N m: the least.
    Torque,
    /// Largest root mean square of the torque of a motor on the job, N m: the least.
    Rms,
    /// Duration of the job, s: the least. That of a path is planned; moves are played faster until a limit acts.
    Time,
}

impl Objective {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Workspace,
        Self::Disc,
        Self::Rectangle,
        Self::Torque,
        Self::Rms,
        Self::Time,
    ];

    /// Name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Workspace => "workspace",
            Self::Disc => "disc",
            Self::Rectangle => "rectangle",
            Self::Torque => "torque",
            Self::Rms => "rms",
            Self::Time => "time",
        }
    }

    /// Head of a column: the name with its unit.
    pub fn column(self) -> &'static str {
        match self {
            Self::Workspace => "workspace_m2",
            Self::Disc => "disc_m",
            Self::Rectangle => "rectangle_m2",
            Self::Torque => "torque_nm",
            Self::Rms => "rms_nm",
            Self::Time => "time_s",
        }
    }

    /// The quantity and its unit in words.
    pub fn words(self) -> [&'static str; 2] {
        match self {
            Self::Workspace => ["connected workspace", "m^2"],
            Self::Disc => ["radius of the largest circle", "m"],
            Self::Rectangle => ["area of the largest rectangle", "m^2"],
            Self::Torque => ["peak torque", "N m"],
            Self::Rms => ["RMS torque", "N m"],
            Self::Time => ["duration of the job", "s"],
        }
    }

    /// Returns true if more is better.
    pub fn grows(self) -> bool {
        matches!(self, Self::Workspace | Self::Disc | Self::Rectangle)
    }

    /// Returns `value` with the sign that makes less better.
    pub fn cost(self, value: f64) -> f64 {
        if self.grows() { -value } else { value }
    }
}

impl fmt::Display for Objective {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Objective {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|each| each.name() == text);
        let names = Self::ALL.map(Self::name).join(", ");
        found.ok_or_else(|| format!("`{text}` is none of {names}"))
    }
}
