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
//! jerk         = j u^3 + 3 e u u'             but for jumps of u'
//! ```
//!
//! Acceleration and torque are affine in (u^2, u'), so what keeps the limits is convex: with (0, a) and (1, b) all that
//! lies between them does, and with both signs of u' a constant pace, too. Power and jerk at some u are affine in u',
//! and cubics of u on the line from (0, a) to (1, b).

use super::breach::{Breach, Extent, greater};
use super::enclose::Centre;
use super::taylor::{Float, Middle, TaylorModel};
use crate::admission::Enclose;
use crate::pace::{FULL, Pace};
use trirrr_core::limits::Limits;
use trirrr_core::model::Model;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::CurveKind;
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

/// Jerk of one motor over an interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct JerkBounds<N: Enclose> {
    /// j.
    pub(super) steady: TaylorModel<N>,
    /// 3 e r.
    pub(super) ramp: TaylorModel<N>,
}

impl<N: Enclose> JerkBounds<N> {
    /// To be filled in.
    pub(super) const UNMEASURED: Self = Self {
        steady: TaylorModel::ZERO,
        ramp: TaylorModel::ZERO,
    };

    /// Bounds at the speed `speed`, where the pace changes at these parts of the ramp's rate.
    #[inline(never)]
    fn extent(&self, speed: Float<N>, [at_rest, at_speed]: [Float<N>; 2]) -> Extent<Float<N>> {
        let squared = speed * speed;
        let ramp = scaled(self.ramp, squared);
        let steady = scaled(self.steady, squared * speed);
        greatest_between(scaled(ramp, at_rest), steady + scaled(ramp, at_speed))
    }
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

    /// Checks that motor `index` keeps `limits` when the move takes 1 / `speed` times as long, 0 to 1, and the pace changes
    /// at no more than the rates `least`. The error is the broken limit. A larger `speed` never breaks less: the
    /// paces of a slower move are among those of a faster one. `M` says whether there are torques to look at, `K` whether
    /// there is a `jerk`.
    pub(super) fn check<M: Model<N: Enclose>, K: CurveKind>(
        &self,
        index: usize,
        jerk: Option<&JerkBounds<N>>,
        limits: &Limits<Float<N>>,
        speed: Float<N>,
        least: &Pace,
    ) -> Result<(), Breach<Float<N>>> {
        let mut pace = *least;
        self.lower::<M, K>(index, jerk, limits, speed, least, &mut pace)
    }

    /// Checks as [`check`](Self::check) does, and lowers the rates of `pace` until they keep the limits, down to `least`.
    pub(super) fn lower<M: Model<N: Enclose>, K: CurveKind>(
        &self,
        index: usize,
        jerk: Option<&JerkBounds<N>>,
        limits: &Limits<Float<N>>,
        speed: Float<N>,
        least: &Pace,
        pace: &mut Pace,
    ) -> Result<(), Breach<Float<N>>> {
        let keeps = |slower: bool, [rest, normal]: [u8; 2]| {
            let part = |levels: u8| {
                let part = <Float<N>>::ratio(u32::from(levels), u32::from(FULL));
                if slower { -part } else { part }
            };
            let rates = [part(rest), part(normal)];
            let kept = self.keeps::<M>(index, limits, speed, rates);
            match (K::JERK, jerk, limits.jerk) {
                (true, Some(jerk), Some(limits)) => kept.and_then(|()| {
                    let size = jerk.extent(speed, rates);
                    within(Bounded::Jerk, index, &size, limits[index], rates)
                }),
                _ => kept,
            }
        };
        let both = [
            (true, &least.slower, &mut pace.slower),
            (false, &least.faster, &mut pace.faster),
        ];
        for (slower, least, rates) in both {
            let Err(breach) = keeps(slower, *rates) else {
                continue;
            };
            // A limit that is broken at a constant pace says more.
            keeps(slower, [0, 0])?;
            if rates == least {
                return Err(breach);
            }
            keeps(slower, *least)?;
            let [rest, normal] = *least;
            rates[0] = greatest(rest, rates[0], |rest| keeps(slower, [rest, normal]).is_ok());
            let most = rates[1].min(rates[0]);
            rates[1] = greatest(normal, most, |normal| {
                keeps(slower, [rates[0], normal]).is_ok()
            });
        }
        Ok(())
    }

    /// Checks that motor `index` keeps `limits` where the pace changes at these parts of the ramp's rate: at rest, at normal
    /// speed, and what lies between.
    #[inline(never)]
    fn keeps<M: Model<N: Enclose>>(
        &self,
        index: usize,
        limits: &Limits<Float<N>>,
        speed: Float<N>,
        [at_rest, at_speed]: [Float<N>; 2],
    ) -> Result<(), Breach<Float<N>>> {
        let squared = speed * speed;
        let rate = scaled(self.rate, speed);
        let torques = self.torque.as_ref().filter(|_| M::TORQUES).map(|torque| {
            let ramp = scaled(torque.ramp, speed);
            let steady = torque.at_rest + scaled(torque.dynamic, squared);
            [
                torque.at_rest + scaled(ramp, at_rest),
                steady + scaled(ramp, at_speed),
            ]
        });
        let all = [
            (Bounded::Rate, &limits.rate),
            (Bounded::Acceleration, &limits.acceleration),
            (Bounded::Torque, &limits.torque),
            (Bounded::Power, &limits.power),
        ];
        for (what, limits) in all {
            let Some(limit) = limits.map(|limits| limits[index]) else {
                continue;
            };
            let size = match (what, &torques) {
                (Bounded::Rate, _) => rate.extent(),
                (Bounded::Acceleration, _) => {
                    let ramp = scaled(self.ramp_acceleration, speed);
                    let steady = scaled(self.acceleration, squared);
                    let slow = scaled(ramp, at_rest).extent();
                    slow.or((steady + scaled(ramp, at_speed)).extent())
                }
                (Bounded::Torque, &Some([slow, fast])) => slow.extent().or(fast.extent()),
                (Bounded::Power, &Some([slow, fast])) => {
                    // The product of the largest rate and the largest torque settles most cases.
                    let greatest = slow.extent().or(fast.extent()).greatest;
                    match rate.magnitude() * greatest <= limit {
                        true => continue,
                        false => greatest_power(rate, slow, fast),
                    }
                }
                _ => continue,
            };
            within(what, index, &size, limit, [at_rest, at_speed])?;
        }
        Ok(())
    }
}

/// Checks that a size of motor `index` is at most `limit`, where the pace changes at these parts of the ramp's rate.
#[inline(always)]
fn within<B: Number>(
    what: Bounded,
    index: usize,
    size: &Extent<B>,
    limit: B,
    [at_rest, at_speed]: [B; 2],
) -> Result<(), Breach<B>> {
    // What is not a number is beyond its limit.
    if size.greatest <= limit {
        return Ok(());
    }
    let is_ramp = at_rest != B::ZERO || at_speed != B::ZERO;
    let ramp = is_ramp && what != Bounded::Rate;
    Err(Breach::above(what, index, size, limit, ramp))
}

/// The greatest number from `least`, which is good, to `most` that `is_good`, where all below one that is are good.
fn greatest(least: u8, most: u8, is_good: impl Fn(u8) -> bool) -> u8 {
    let (mut good, mut bad) = (least, most.saturating_add(1));
    while bad - good > 1 {
        let middle = good + (bad - good) / 2;
        match is_good(middle) {
            true => good = middle,
            false => bad = middle,
        }
    }
    good
}

/// `model` times `factor`.
#[inline(never)]
fn scaled<N: Enclose>(model: TaylorModel<N>, factor: Float<N>) -> TaylorModel<N> {
    if factor == <Float<N>>::ONE {
        return model;
    }
    TaylorModel {
        constant: model.constant * <Middle<N>>::exactly(factor),
        linear: model.linear * factor,
        error: model.error * factor.abs(),
    }
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
    greatest_between(w * a, w * c)
}

/// Largest size of u (slow (1 - u^2) + fast u^2) for 0 <= u <= 1, for independent bounds of both.
fn greatest_between<N: Enclose>(slow: TaylorModel<N>, fast: TaylorModel<N>) -> Extent<Float<N>> {
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
