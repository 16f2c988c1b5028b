//! The limits that a job must keep.

use crate::read::{Bound, Section};
use trirrr_core::limits::LimitParameters as Limits;

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
    let jerk_rad_s3 = motors("jerk_rad_s3");
    let serial = section.number_or("serial_distance_min", Bound::Fraction, serial);
    let parallel = section.number_or("parallel_distance_min", Bound::Fraction, parallel);
    Some(Limits {
        rate_rad_s,
        acceleration_rad_s2,
        torque_nm,
        power_w,
        jerk_rad_s3,
        serial_distance_min: serial?,
        parallel_distance_min: parallel?,
    })
}
