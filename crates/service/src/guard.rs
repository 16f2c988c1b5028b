//! The last look at a tick's results before they go out.

use crate::admission::Enclose;
use trirrr_core::limits::Limits;
use trirrr_core::model::Model;
use trirrr_core::number::Number;
use trirrr_core::setpoint::JointSetpoint;
use trirrr_core::status::Status;
use trirrr_core::tick::Motion;
use trirrr_protocol::message::{Bounded, FaultCode};

/// Breach of a limit by a tick's results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LimitBreach<N> {
    pub(super) code: FaultCode,
    pub(super) index: Option<u8>,
    pub(super) value: N,
    pub(super) limit: N,
}

impl<N: Number> LimitBreach<N> {
    /// A setpoint without a motion.
    pub(super) fn of(status: Status) -> Self {
        let (code, index) = FaultCode::of(status);
        Self {
            code,
            index,
            value: N::ZERO,
            limit: N::ZERO,
        }
    }
}

/// Limits of what a tick computes: the others are left to the admission, and take no room here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ResultLimits<N> {
    pub(super) rate: Option<[N; 3]>,
    acceleration: Option<[N; 3]>,
    torque: Option<[N; 3]>,
    power: Option<[N; 3]>,
}

/// The limits that a tick's results have to keep.
pub(super) struct Guard<N> {
    limits: ResultLimits<N>,
    /// False if there is nothing to check: one look instead of one for each limit.
    has_limits: bool,
}

impl<N: Number> Guard<N> {
    /// The guard of `limits`, as they are.
    pub(super) fn holding(limits: Limits<N>) -> Self {
        let Limits {
            rate,
            acceleration,
            torque,
            power,
            ..
        } = limits;
        let has_limits = [rate, acceleration, torque, power]
            .iter()
            .any(Option::is_some);
        let limits = ResultLimits {
            rate,
            acceleration,
            torque,
            power,
        };
        Self { limits, has_limits }
    }

    /// The guard for machine limits that the admission holds the motion to.
    pub(super) fn of_results(limits: &Limits<N>) -> Self
    where
        N: Enclose,
    {
        Self::holding(limits.map(N::of_result))
    }

    /// Checks that the motors keep the limits in `motion`. It leaves the distances to the singularities to the
    /// admission: near a singularity it is rate and torque that grow.
    ///
    /// `M` says whether the motion has torques.
    #[inline]
    pub(super) fn check<M: Model<N = N>>(&self, motion: &Motion<N>) -> Result<(), LimitBreach<N>> {
        match self.has_limits {
            true => check::<M>(&self.limits, motion),
            false => Ok(()),
        }
    }

    /// Checks that the motors keep the limits one by one, without torque.
    pub(super) fn check_joints(&self, joints: &JointSetpoint<N>) -> Result<(), LimitBreach<N>> {
        within(Bounded::Rate, &self.limits.rate, joints.rates)?;
        within(
            Bounded::Acceleration,
            &self.limits.acceleration,
            joints.accelerations,
        )
    }

    #[cfg(test)]
    pub(super) fn limits(&self) -> &ResultLimits<N> {
        &self.limits
    }
}

#[inline]
fn check<M: Model>(
    limits: &ResultLimits<M::N>,
    motion: &Motion<M::N>,
) -> Result<(), LimitBreach<M::N>> {
    let [a, b, c] = &motion.motors;
    within(Bounded::Rate, &limits.rate, [a.rate, b.rate, c.rate])?;
    let accelerations = [a.acceleration, b.acceleration, c.acceleration];
    within(Bounded::Acceleration, &limits.acceleration, accelerations)?;
    if !M::TORQUES {
        return Ok(());
    }
    within(
        Bounded::Torque,
        &limits.torque,
        [a.torque, b.torque, c.torque],
    )?;
    if limits.power.is_some() {
        let powers = [a.torque * a.rate, b.torque * b.rate, c.torque * c.rate];
        within(Bounded::Power, &limits.power, powers)?;
    }
    Ok(())
}

/// Checks that the peaks of a joint move keep `limits`. Returns what they break otherwise.
pub(super) fn within<N: Number>(
    what: Bounded,
    limits: &Option<[N; 3]>,
    values: [N; 3],
) -> Result<(), LimitBreach<N>> {
    let Some(limits) = limits else {
        return Ok(());
    };
    for (index, (value, limit)) in values.into_iter().zip(limits).enumerate() {
        if !(value.abs() <= *limit) {
            return Err(LimitBreach {
                code: FaultCode::Limit(what),
                index: Some(index as u8),
                value,
                limit: *limit,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_in_f32_have_room_for_rounding() {
        let limits = Limits {
            rate: Some([2.0; 3]),
            acceleration: None,
            torque: None,
            power: None,
            jerk: None,
            serial_distance: 0.0,
            parallel_distance: 0.0,
        };
        assert_eq!(
            Guard::<f64>::of_results(&limits).limits,
            Guard::holding(limits).limits
        );
        let limits = Guard::of_results(&limits.map(|limit| limit as f32)).limits;
        let check = |rate: f32| within(Bounded::Rate, &limits.rate, [0.0, -rate, 0.0]);
        assert_eq!(check(2.001), Ok(()));
        let broken = check(2.002).expect_err("beyond rounding");
        assert_eq!((broken.index, broken.value), (Some(1), -2.002));
    }
}
