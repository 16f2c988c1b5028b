//! Thresholds of contact detection, its filter, and the friction that it allows for.

use crate::settings::StopCategory;
use core::f64::consts::TAU;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::to_source;

/// Settings of contact detection, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct ContactParameters {
    /// Greatest force on the platform that is no contact, N, positive,
    pub force_n: f64,
    /// and greatest moment about D, N m, positive.
    pub torque_nm: f64,
    /// Bandwidth of the observer, Hz, positive.
    pub bandwidth_hz: f64,
    /// Ticks in a row beyond a threshold that are a contact; positive.
    pub confirm_ticks: u16,
    /// Ticks from one model of a pose to the next; positive.
    pub model_ticks: u16,
    /// Coulomb friction of each motor at the joint, N m, not negative.
    pub coulomb_nm: [f64; 3],
    /// Viscous friction of each motor at the joint, N m s/rad, not negative.
    pub viscous_nm_s_rad: [f64; 3],
    /// Joint rate from which on a joint slides for certain, rad/s, positive.
    pub sliding_rad_s: f64,
    /// Ticks by which a drive answers late: 1 where its answer to a command tells the motion before the command.
    pub late_ticks: u16,
    /// Part of a tick from a command to the instant of the motion that is told, 0 to 1.
    pub told_after: f64,
    /// Stop at a contact.
    pub reaction: StopCategory,
    /// Ticks of the path by which the machine goes back once it has come to rest; 0 for none. Only a scene that
    /// retreats does.
    pub retreat_ticks: u32,
}

/// Coefficients of contact detection: plain numbers, so that whoever builds an image can write them as constants. In SI
/// units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactCoefficients<N> {
    /// Weight of the momentum: g / (1 + g T), g 2 pi times the bandwidth, T the length of a tick, 1/s.
    pub(crate) weight: N,
    /// Share of the estimate that a tick leaves: 1 / (1 + g T),
    pub(crate) decay: N,
    /// and that of the tick itself: g T / (1 + g T).
    pub(crate) share: N,
    /// Time from a command to the motion that is told, s.
    pub(crate) told_after: N,
    pub(crate) coulomb: [N; 3],
    pub(crate) viscous: [N; 3],
    /// 1 / the rate from which on a joint slides.
    pub(crate) per_sliding: N,
    pub(crate) thresholds: ContactThresholds<N>,
}

/// Thresholds of a contact, and times of the watch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactThresholds<N> {
    /// Square of the force, N^2.
    pub(crate) force_sq: N,
    pub(crate) moment: N,
    pub(crate) confirm_ticks: u16,
    pub(crate) model_ticks: u16,
    pub(crate) late_ticks: u16,
    pub(crate) reaction: StopCategory,
    pub(crate) retreat_ticks: u32,
}

to_source!([N: Number] ContactCoefficients [N] in trirrr_service::coefficients {
    weight: N,
    decay: N,
    share: N,
    told_after: N,
    coulomb: [N; 3],
    viscous: [N; 3],
    per_sliding: N,
    thresholds: ContactThresholds<N>,
});

to_source!([N: Number] ContactThresholds [N] in trirrr_service::features {
    force_sq: N,
    moment: N,
    confirm_ticks: u16,
    model_ticks: u16,
    late_ticks: u16,
    reaction: StopCategory,
    retreat_ticks: u32,
});

impl<N: Number> ContactCoefficients<N> {
    /// Builds the coefficients for ticks of `period_s`. `None` in a number type with units of its own: its range has no
    /// room for the differences that a contact makes.
    pub fn build(contact: &ContactParameters, period_s: f64) -> Option<Self> {
        if !N::PROPAGATES_NON_FINITE {
            return None;
        }
        let gain = TAU * contact.bandwidth_hz;
        Some(Self {
            weight: N::from_f64(gain / (1.0 + gain * period_s)),
            decay: N::from_f64(1.0 / (1.0 + gain * period_s)),
            share: N::from_f64(gain * period_s / (1.0 + gain * period_s)),
            told_after: N::from_f64(contact.told_after * period_s),
            coulomb: contact.coulomb_nm.map(N::from_f64),
            viscous: contact.viscous_nm_s_rad.map(N::from_f64),
            per_sliding: N::from_f64(1.0 / contact.sliding_rad_s),
            thresholds: ContactThresholds {
                force_sq: N::from_f64(contact.force_n * contact.force_n),
                moment: N::from_f64(contact.torque_nm),
                confirm_ticks: contact.confirm_ticks,
                model_ticks: contact.model_ticks,
                late_ticks: contact.late_ticks,
                reaction: contact.reaction,
                retreat_ticks: contact.retreat_ticks,
            },
        })
    }
}
