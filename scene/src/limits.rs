//! The limits that a job must keep.

use crate::read::{Bound, Section};

/// Limits at the three motors and of the distances to singularity. `None`: no limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest joint rate of either sign, rad/s.
    pub rate_rad_s: Option<[f64; 3]>,
    /// Largest joint acceleration of either sign, rad/s^2.
    pub acceleration_rad_s2: Option<[f64; 3]>,
    /// Largest torque at the joint of either sign, N m.
    pub torque_nm: Option<[f64; 3]>,
    /// Largest mechanical power of either sign, W.
    pub power_w: Option<[f64; 3]>,
    /// Least [distance](trirrr_core::singularity) of each leg from its serial singularity,
    /// |r1 x r2| / (l1 l2): the sine of the angle between its links.
    pub serial_distance_min: f64,
    /// Least [distance](trirrr_core::singularity) of the machine from its parallel singularity,
    /// |det A| over the greatest value it can have.
    pub parallel_distance_min: f64,
}

impl Limits {
    /// A joint rate is inversely proportional to this distance.
    pub const SERIAL_DISTANCE_MIN: f64 = 0.01;
    /// A torque is inversely proportional to this distance.
    pub const PARALLEL_DISTANCE_MIN: f64 = 0.01;
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            rate_rad_s: None,
            acceleration_rad_s2: None,
            torque_nm: None,
            power_w: None,
            serial_distance_min: Self::SERIAL_DISTANCE_MIN,
            parallel_distance_min: Self::PARALLEL_DISTANCE_MIN,
        }
    }
}

/// Reads `[limits]`; left out, it is [`Limits::default`].
pub(crate) fn read_limits(root: &Section) -> Option<Limits> {
    if !root.has("limits") {
        return Some(Limits::default());
    }
    let section = root.section("limits")?;
    let motors = |key| section.number_or_three(key, Bound::Positive);
    let (serial, parallel) = (Limits::SERIAL_DISTANCE_MIN, Limits::PARALLEL_DISTANCE_MIN);
    let rate_rad_s = motors("rate_rad_s");
    let acceleration_rad_s2 = motors("acceleration_rad_s2");
    let torque_nm = motors("torque_nm");
    let power_w = motors("power_w");
    let serial = section.number_or("serial_distance_min", Bound::Fraction, serial);
    let parallel = section.number_or("parallel_distance_min", Bound::Fraction, parallel);
    Some(Limits {
        rate_rad_s,
        acceleration_rad_s2,
        torque_nm,
        power_w,
        serial_distance_min: serial?,
        parallel_distance_min: parallel?,
    })
}
