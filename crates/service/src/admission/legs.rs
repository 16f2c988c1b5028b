//! Stages of the tick for three legs over an interval. Each is a function of its own, so that an image holds it once.

use super::taylor::TaylorModel;
use crate::admission::Enclose;
use nalgebra::{Vector2, Vector3};
use trirrr_core::dyad::{Accelerations, DyadPosition, Rates};
use trirrr_core::inverse::{LegMotion, LegPosition, Rotation};
use trirrr_core::machine::Leg;
use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_core::torque::lines::DistalLines;

/// Distal lines of the legs. As a part of another function the copy of its results would be larger.
#[inline(never)]
pub(super) fn lines<N: Enclose>(
    legs: &[LegMotion<TaylorModel<N>>; 3],
) -> DistalLines<TaylorModel<N>> {
    let [leg1, leg2, leg3] = legs;
    DistalLines::of([&leg1.position, &leg2.position, &leg3.position])
}

/// Torques of one load. A function of its own, for its three calls.
#[inline(never)]
pub(super) fn torques<M: Model>(
    model: &M,
    lines: &DistalLines<M::N>,
    legs: &[LegMotion<M::N>; 3],
    setpoint: &Setpoint<M::N>,
    rotation: &Rotation<M::N>,
) -> Result<[M::N; 3], Status> {
    model.torques(Some(lines), legs, setpoint, rotation)
}

/// A leg to be filled in. No constant, which would take its place in an image.
pub(super) fn unsolved<N: Enclose>() -> LegMotion<TaylorModel<N>> {
    let zero = Vector2::new(TaylorModel::ZERO, TaylorModel::ZERO);
    LegMotion {
        position: LegPosition {
            platform_joint: zero,
            links: DyadPosition {
                r1: zero,
                r2: zero,
                r1_cross_r2: TaylorModel::ZERO,
                inverse_cross: TaylorModel::ZERO,
                r1_dot_r2: TaylorModel::ZERO,
            },
        },
        rates: Rates {
            proximal: TaylorModel::ZERO,
            distal: TaylorModel::ZERO,
        },
        accelerations: Accelerations {
            proximal: TaylorModel::ZERO,
            distal: TaylorModel::ZERO,
        },
    }
}

/// Solves leg `index`.
#[inline(never)]
pub(super) fn solve<N: Enclose>(
    index: usize,
    leg: &Leg<TaylorModel<N>>,
    setpoint: &Setpoint<TaylorModel<N>>,
    rotation: &Rotation<TaylorModel<N>>,
    motion: &mut LegMotion<TaylorModel<N>>,
) -> Result<(), Status> {
    let (platform_joint, span) = leg.span(setpoint.pose.position, rotation);
    motion.position.platform_joint = platform_joint;
    motion.position.links = leg
        .dyad()
        .position(span)
        .map_err(|refused| refused.of_leg(index))?;
    if N::IS_ROUGH_FIRST && span.x.is_rough() {
        let lengths = leg.dyad().squared_lengths().map(TaylorModel::middle);
        TaylorModel::narrow(&mut motion.position.links, &span, lengths);
    }
    Ok(())
}

/// Adds rates and accelerations to the position of a leg.
#[inline(never)]
pub(super) fn add_motion<N: Enclose>(
    leg: &Leg<TaylorModel<N>>,
    setpoint: &Setpoint<TaylorModel<N>>,
    motion: &mut LegMotion<TaylorModel<N>>,
) {
    motion.rates = leg.rates(&motion.position, &setpoint.velocity);
    motion.accelerations = leg.accelerations(&motion.position, &motion.rates, setpoint);
}

/// Jerk of the motor of a leg while the platform has the jerk `third`.
#[inline(never)]
pub(super) fn jerk<N: Enclose>(
    leg: &Leg<TaylorModel<N>>,
    motion: &LegMotion<TaylorModel<N>>,
    setpoint: &Setpoint<TaylorModel<N>>,
    third: &Vector3<TaylorModel<N>>,
) -> TaylorModel<N> {
    leg.motor_jerk(motion, setpoint, third)
}
