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

use super::Breach;
use super::taylor::{Float, TaylorModel};
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
        let limit = |limits: Option<[Float<N>; 3]>| limits.map(|limits| limits[index]);
        let (what, value, limit, ramp) = 'broken: {
            if let Some(limit) = limit(limits.rate) {
                let value = rate.magnitude();
                if !(value <= limit) {
                    break 'broken (Bounded::Rate, value, limit, false);
                }
            }
            if let Some(limit) = limit(limits.acceleration) {
                let what = Bounded::Acceleration;
                let steady = scaled(self.acceleration, squared);
                let value = steady.magnitude();
                if !(value <= limit) {
                    break 'broken (what, value, limit, false);
                }
                let value = either_ramp(steady, scaled(self.ramp_acceleration, speed));
                if !(value <= limit) {
                    break 'broken (what, value, limit, true);
                }
            }
            let Some(torque) = self.torque.as_ref().filter(|_| M::TORQUES) else {
                return Ok(());
            };
            let at_rest = torque.at_rest;
            let steady = at_rest + scaled(torque.dynamic, squared);
            let ramp = scaled(torque.ramp, speed);
            let greatest = greater(either_ramp(steady, ramp), either_ramp(at_rest, ramp));
            if let Some(limit) = limit(limits.torque) {
                let what = Bounded::Torque;
                let value = greater(steady.magnitude(), at_rest.magnitude());
                if !(value <= limit) {
                    break 'broken (what, value, limit, false);
                }
                if !(greatest <= limit) {
                    break 'broken (what, greatest, limit, true);
                }
            }
            if let Some(limit) = limit(limits.power) {
                let what = Bounded::Power;
                let value = (rate * steady).magnitude();
                if !(value <= limit) {
                    break 'broken (what, value, limit, false);
                }
                // The product of the largest rate and the largest torque settles most cases.
                if !(rate.magnitude() * greatest <= limit) {
                    let value = greater(
                        greatest_power(rate, at_rest + ramp, steady + ramp),
                        greatest_power(rate, at_rest - ramp, steady - ramp),
                    );
                    if !(value <= limit) {
                        break 'broken (what, value, limit, true);
                    }
                }
            }
            return Ok(());
        };
        Err(Breach {
            what,
            index: Some(index as u8),
            value,
            limit,
            ramp,
        })
    }
}

/// `model` times `factor`, which is not negative.
#[inline(never)]
fn scaled<N: Enclose>(model: TaylorModel<N>, factor: Float<N>) -> TaylorModel<N> {
    TaylorModel {
        constant: model.constant * factor,
        linear: model.linear * factor,
        error: model.error * factor,
    }
}

/// Largest size on a ramp up or down.
#[inline(never)]
fn either_ramp<N: Enclose>(steady: TaylorModel<N>, ramp: TaylorModel<N>) -> Float<N> {
    greater((steady + ramp).magnitude(), (steady - ramp).magnitude())
}

/// Largest size of w u (a (1 - u^2) + c u^2) for 0 <= u <= 1: the power on a ramp with the torque
/// `a` at its slow end and `c` at its fast end.
///
/// It is linear in the two products w a and w c, so its greatest size is at corners of the
/// rectangle that they lie in.
fn greatest_power<N: Enclose>(w: TaylorModel<N>, a: TaylorModel<N>, c: TaylorModel<N>) -> Float<N> {
    let ends = |model: TaylorModel<N>| {
        let radius = model.radius();
        [model.constant - radius, model.constant + radius]
    };
    let (slow, fast) = (ends(w * a), ends(w * c));
    let mut greatest = <Float<N>>::ZERO;
    for slow in slow {
        for fast in fast {
            greatest = greater(greatest, peak(slow, fast));
        }
    }
    greatest
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

/// The greater of the two; what is not a number counts as greater.
fn greater<N: Arithmetic>(a: N, b: N) -> N {
    if a <= b { b } else { a }
}
