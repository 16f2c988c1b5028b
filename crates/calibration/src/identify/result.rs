//! Settings, refusals and result of an identification.

use super::bodies::{BODY_COUNT, BodyGroup, BodyVector};
use crate::columns::ColumnFault;
use crate::sight::LEAST_RATIO;
use std::fmt;

/// Samples without which nothing is identified.
pub(super) const LEAST_SAMPLES: usize = 50;

/// Equations without which nothing is identified.
pub(super) const LEAST_EQUATIONS: usize = 60;

/// Settings of an identification.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentificationSetup {
    /// Parameters that are identified.
    pub free: Vec<BodyGroup>,
    /// Width sigma of the filter, s; none: six distances of samples.
    pub width_s: Option<f64>,
    /// Rate from which on a joint slides for certain, rad/s.
    pub sliding_rad_s: f64,
}

impl Default for IdentificationSetup {
    /// Platform and motors.
    fn default() -> Self {
        Self {
            free: vec![BodyGroup::Platform, BodyGroup::Motors],
            width_s: None,
            sliding_rad_s: 0.05,
        }
    }
}

/// Reason for which telemetry identifies nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentificationRefusal {
    /// The machine is none, or has no pose at the start.
    #[error("the scene's machine has no pose at the start of its job")]
    Machine,
    /// A row that fits no pose of the machine.
    #[error("{0}")]
    Row(ColumnFault),
    /// Too few samples.
    #[error(
        "{samples} samples, of which {used} equations can be used; at least {LEAST_SAMPLES} samples and {LEAST_EQUATIONS} equations are needed: {hint}"
    )]
    TooFew {
        /// Samples in the table.
        samples: usize,
        /// Equations that are left.
        used: usize,
        /// Remedy in words.
        hint: &'static str,
    },
    /// All torques are 0.
    #[error("all torques are 0: the drives told none")]
    NoTorque,
    /// Torques that no machine like that of the scene takes.
    #[error("{0}")]
    Factor(TorqueFactor),
    /// Nothing is free, or nothing that is free is seen.
    #[error(
        "the motion sees none of the free parameters better than they are known: {0}; move farther and faster"
    )]
    Blind(String),
}

/// Torques of a table against those of the scene's bodies in the same motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueFactor {
    /// Torques of the table in parts of those of the scene.
    pub factor: f64,
    /// Root mean square of the torques of the table, N m.
    pub measured_nm: f64,
    /// Root mean square of those of the scene, N m.
    pub expected_nm: f64,
}

impl fmt::Display for TorqueFactor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            factor,
            measured_nm,
            expected_nm,
        } = self;
        let hint = match *factor {
            factor if factor < 0.0 => {
                "turn their sign: a torque that turns the joint counter-clockwise is positive"
            }
            factor if (200.0..5000.0).contains(&factor) => "divide torques in N mm by 1000",
            factor if factor > 1.0 => {
                "give them in N m, or the scene masses that are nearer to those of the machine"
            }
            _ => {
                "multiply torques of motors in front of a gear by its ratio, or give the scene masses that are nearer to those of the machine"
            }
        };
        write!(
            f,
            "the torques are {factor:.3} times those that the bodies of the scene take in this motion ({measured_nm:.3} N m, where \
             {expected_nm:.3} N m are expected, RMS): columns tau1 to tau3 are N m at the joints; {hint}"
        )
    }
}

/// Torques of a motor over time: measured, by the parameters as they were, and as they were found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExplainedTorque {
    /// Time, s.
    pub t: f64,
    /// Motor, from 0.
    pub motor: usize,
    /// Measured, smoothed, N m.
    pub measured_nm: f64,
    /// By the nominal parameters.
    pub before_nm: f64,
    /// By those that were found.
    pub after_nm: f64,
}

/// Identified parameters.
#[derive(Clone, Debug)]
pub struct Identification {
    /// Parameters before.
    pub nominal: BodyVector,
    /// Parameters that fit.
    pub values: BodyVector,
    /// Standard deviations, in the directions that are seen; none for what is held.
    pub deviations: [Option<f64>; BODY_COUNT],
    /// Parts of the parameters that the motion sees, 0 to 1; the rest stays nominal.
    pub shares: [f64; BODY_COUNT],
    /// Indices of the free parameters.
    pub free: Vec<usize>,
    /// Ratios of signal to noise along the directions, the greatest first.
    pub ratios: Vec<f64>,
    /// Directions that the motion does not see at all, in words; held.
    pub blind: Vec<String>,
    /// Directions that are seen less than they are known, in words; held.
    pub weak: Vec<String>,
    /// Parameters that would have been negative, and are 0.
    pub at_zero: Vec<usize>,
    /// Bodies that cannot be, in words.
    pub impossible: Vec<String>,
    /// Torques of all equations.
    pub torques: Vec<ExplainedTorque>,
    /// Root mean square of the torque that is not explained, N m, before and after.
    pub residual_nm: [f64; 2],
    /// The same of blocks of time that a fit of the others did not see; none where too little is left.
    pub check_nm: Option<[f64; 2]>,
    /// Usual distance of samples, and width of the filter, s.
    pub period_s: f64,
    /// Width sigma of the filter, s.
    pub width_s: f64,
}

impl Identification {
    /// Number of directions that are seen.
    pub fn seen(&self) -> usize {
        self.ratios
            .iter()
            .filter(|ratio| **ratio >= LEAST_RATIO)
            .count()
    }
}
