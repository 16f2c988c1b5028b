//! Bounds of what the motors do over an interval of a move. They hold at normal speed and while a
//! hold, a stop or a resume scales the speed along the path.
//!
//! With u the speed along the path in parts of normal speed and u' its rate of change, the
//! setpoint has velocity q' u and acceleration q'' u^2 + q' u'. So at a point of the path
//!
//! ```text
//! rate         = w u
//! acceleration = e u^2 + w u'
//! torque       = g + d u^2 + v u'          g at rest, g + d at normal speed
//! power        = w u (g + d u^2 + v u')
//! ```
//!
//! Acceleration and torque are affine in (u^2, u'), so their extremes over 0 <= u <= 1 and
//! |u'| <= r are those at the corners; the power is a cubic of u between two ramps.

use super::breach::{Breach, Extent, greater};
use super::enclose::Centre;
use super::taylor::{Float, Middle, TaylorModel};
use crate::admission::Enclose;
use trirrr_core::limits::Limits;
use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_protocol::message::Bounded;

/// One motor over an interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotorBounds<N: Enclose> {
    /// w.
    pub(super) rate: TaylorModel<N>,
    /// e.
    pub(super) acceleration: TaylorModel<N>,
    /// w r.
    pub(super) ramp_acceleration: TaylorModel<N>,
    /// The dynamics, if a limit asks for them.
    pub(super) torque: Option<TorqueBounds<N>>,
}

/// Torque of one motor over an interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct TorqueBounds<N: Enclose> {
    /// g.
    pub(super) at_rest: TaylorModel<N>,
    /// d.
    pub(super) dynamic: TaylorModel<N>,
    /// v r.
    pub(super) ramp: TaylorModel<N>,
}

impl<N: Enclose> MotorBounds<N> {
    /// To be filled in.
    pub(super) const UNMEASURED: Self = Self {
        rate: TaylorModel::ZERO,
        acceleration: TaylorModel::ZERO,
        ramp_acceleration: TaylorModel::ZERO,
        torque: None,
    };

    /// Checks that motor `index` keeps `limits` when the move takes 1 / `speed` times as long, 0 to 1.
    /// The error is the broken limit. A larger `speed` never breaks less: the speeds and ramps of a
    /// slower move are among those of a faster one. `M` says whether there are torques to look at.
    pub(super) fn check<M: Model<N: Enclose>>(
        &self,
        index: usize,
        limits: &Limits<Float<N>>,
        speed: Float<N>,
    ) -> Result<(), Breach<Float<N>>> {
        let squared = speed * speed;
        let rate = scaled(self.rate, speed);
        let all = [
            (Bounded::Rate, &limits.rate),
            (Bounded::Acceleration, &limits.acceleration),
            (Bounded::Torque, &limits.torque),
            (Bounded::Power, &limits.power),
        ];
        let torque = self.torque.as_ref().filter(|_| M::TORQUES);
        let torque = torque.map(|torque| {
            let steady = torque.at_rest + scaled(torque.dynamic, squared);
            (torque.at_rest, steady, scaled(torque.ramp, speed))
        });
        for (what, limits) in all {
            let Some(limit) = limits.map(|limits| limits[index]) else {
                continue;
            };
            let (steady, ramp) = match (what, &torque) {
                (Bounded::Acceleration, _) => {
                    let steady = scaled(self.acceleration, squared);
                    let ramp = scaled(self.ramp_acceleration, speed);
                    (steady.extent(), either_ramp(steady, ramp))
                }
                (Bounded::Torque, &Some((at_rest, steady, ramp))) => (
                    steady.extent().or(at_rest.extent()),
                    either_ramp(steady, ramp).or(either_ramp(at_rest, ramp)),
                ),
                (Bounded::Power, &Some((at_rest, steady, ramp))) => {
                    let size = (rate * steady).extent();
                    let torque = either_ramp(steady, ramp).or(either_ramp(at_rest, ramp));
                    // The product of the largest rate and the largest torque settles most cases.
                    let settled = rate.magnitude() * torque.greatest <= limit;
                    let on_ramp = |ramp| greatest_power(rate, at_rest + ramp, steady + ramp);
                    let ramps = match settled {
                        true => size,
                        false => on_ramp(ramp).or(on_ramp(-ramp)),
                    };
                    (size, ramps)
                }
                (Bounded::Rate, _) => (rate.extent(), rate.extent()),
                _ => continue,
            };
            for (size, ramp) in [(steady, false), (ramp, true)] {
                // What is not a number is beyond its limit.
                if !(size.greatest <= limit) {
                    return Err(Breach::above(what, index, &size, limit, ramp));
                }
            }
        }
        Ok(())
    }
}

/// `model` times `factor`, which is not negative.
#[inline(never)]
fn scaled<N: Enclose>(model: TaylorModel<N>, factor: Float<N>) -> TaylorModel<N> {
    if factor == <Float<N>>::ONE {
        return model;
    }
    TaylorModel {
        constant: model.constant * <Middle<N>>::exactly(factor),
        linear: model.linear * factor,
        error: model.error * factor,
    }
}

/// Largest size on a ramp up or down.
#[inline(never)]
fn either_ramp<N: Enclose>(steady: TaylorModel<N>, ramp: TaylorModel<N>) -> Extent<Float<N>> {
    (steady + ramp).extent().or((steady - ramp).extent())
}

/// Largest size of w u (a (1 - u^2) + c u^2) for 0 <= u <= 1: the power on a ramp with the torque
/// `a` at its slow end and `c` at its fast end.
///
/// It is linear in the two products w a and w c, so its greatest size is at corners of the
/// rectangle that they lie in. It changes by less than the two do together.
fn greatest_power<N: Enclose>(
    w: TaylorModel<N>,
    a: TaylorModel<N>,
    c: TaylorModel<N>,
) -> Extent<Float<N>> {
    let (slow, fast) = (w * a, w * c);
    let mut greatest = <Float<N>>::ZERO;
    for slow in slow.ends() {
        for fast in fast.ends() {
            greatest = greater(greatest, peak(slow, fast));
        }
    }
    let value = peak(slow.middle(), fast.middle());
    let rounding = N::roundoff(greatest + greatest);
    let eight = (rounding + rounding) + (rounding + rounding);
    Extent {
        least: value - (slow.radius() + fast.radius() + eight),
        value,
        greatest,
        curved: slow.curvature() + fast.curvature(),
    }
}

/// Largest size of u (slow + (fast - slow) u^2) for 0 <= u <= 1: at u = 1, or where the derivative
/// slow - 3 (slow - fast) u^2 vanishes, where it is 2/3 slow u.
fn peak<N: Arithmetic>(slow: N, fast: N) -> N {
    let drop = slow - fast;
    let drop = drop + drop + drop;
    // 0 < slow / drop < 1.
    let inside = if slow > N::ZERO {
        drop > slow
    } else {
        slow < N::ZERO && drop < slow
    };
    if !inside {
        return fast.abs();
    }
    let at = slow.div(drop).sqrt();
    greater(fast.abs(), slow.abs() * at * N::ratio(2, 3))
}
