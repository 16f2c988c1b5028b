//! `[plant.push]`: a push on the simulated platform, for a time.

use crate::read::{Bound, Section};

/// Constant force and moment that act on the platform for a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Start of the push, s after the start of the job.
    pub at_s: f64,
    /// Its duration, s.
    pub duration_s: f64,
    /// Force at D in the fixed frame, N.
    pub force_n: [f64; 2],
    /// Moment, N m, positive counter-clockwise.
    pub torque_nm: f64,
}

/// Reads `[plant.push]`; none without the table.
pub(crate) fn read_push(plant: &Section) -> Option<Option<Push>> {
    if !plant.has("push") {
        return Some(None);
    }
    let section = plant.section("push")?;
    let at = section.number("at_s", Bound::NotNegative);
    let duration = section.number("duration_s", Bound::Positive);
    let force = section.vector("force_n", Some([0.0; 2]));
    let torque = section.number_or("torque_nm", Bound::Finite, 0.0);
    let push = Push {
        at_s: at?,
        duration_s: duration?,
        force_n: force?,
        torque_nm: torque?,
    };
    if push.force_n == [0.0; 2] && push.torque_nm == 0.0 {
        plant.refuse("push", "pushes nothing: give force_n or torque_nm");
        return None;
    }
    Some(Some(push))
}
