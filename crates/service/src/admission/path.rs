//! One interval of a move, measured: the very stages of the tick, run on Taylor models.

use super::bounds::{JerkBounds, MotorBounds, TorqueBounds};
use super::breach::{Breach, Extent};
use super::legs::{add_motion, jerk, lines, solve, torques, unsolved};
use super::taylor::{Float, TaylorModel};
use crate::admission::Enclose;
use crate::pace::{Pace, Ramp};
use nalgebra::Vector3;
use trirrr_core::dyad::{Accelerations, Rates};
use trirrr_core::inverse::{LegMotion, Rotation};
use trirrr_core::limits::Limits;
use trirrr_core::machine::{BuildError, LegParameters};
use trirrr_core::model::{Model, OfKind};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{CurveKind, Segment, Setpoint};
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::Tick;
use trirrr_core::to_source;
use trirrr_core::torque::lines::DistalLines;
use trirrr_protocol::message::Bounded;

/// A jump of the acceleration counts as rounding up to this part of what a limit of jerk allows in a tick.
const ROUNDING: u32 = 256;

/// A machine with its limits, ready to measure intervals of moves: the coefficients of the
/// admission.
#[derive(Clone, Copy, Debug)]
pub struct Path<M: Model<N: Enclose>> {
    /// The tick, on Taylor models.
    pub(crate) tick: Tick<M::Over<TaylorModel<M::N>>>,
    /// The distances, likewise.
    pub(crate) distances: Distances<TaylorModel<M::N>>,
    /// Limits that the admission compares with.
    pub(crate) limits: Limits<Float<M::N>>,
    /// Seconds, or the machine's unit of time, per tick.
    pub(crate) period: Float<M::N>,
    /// r: largest rate of change of the speed along the path, in normal speeds per unit of time.
    pub(crate) ramp: TaylorModel<M::N>,
    /// Rates of the pace, in parts of it, that every move leaves room for.
    pub(crate) least: Pace,
    /// True if the motors may have to hold something at rest: gravity or a wrench.
    pub(crate) loaded: bool,
    /// Size of a velocity, an acceleration and 1 / (r1 x r2) that do not bring rates and accelerations out of range.
    pub(crate) moderate: Float<M::N>,
}

to_source!([M: Model<N: Enclose>] Path [M] in trirrr_service::admission {
    tick: Tick<M::Over<TaylorModel<M::N>>>,
    distances: Distances<TaylorModel<M::N>>,
    limits: Limits<Float<M::N>>,
    period: Float<M::N>,
    ramp: TaylorModel<M::N>,
    least: Pace,
    loaded: bool,
    moderate: Float<M::N>,
});

impl<N: Enclose, M: Model<N = N>> Path<M> {
    /// Builds the coefficients. A hold or a stop takes `ramp`; a tick lasts `period_s`.
    ///
    /// # Errors
    /// The first quantity of the machine that is refused.
    pub fn build<'a>(
        machine: impl Into<OfKind<'a>>,
        limits: Limits<Float<N>>,
        ramp: Ramp,
        period_s: f64,
    ) -> Result<Self, BuildError> {
        let machine = machine.into();
        let parameters = machine.parameters;
        // The tick's own: a service is given no other, and a reader of scenes has to judge as a service does.
        let period_s = N::factor_to_f64(N::factor_from_f64(period_s));
        let slope = 1.0 / (f64::from(ramp.ticks.max(1)) * period_s);
        // With lengths below l, at least 1, and all below m, a rate is below 4 l^2 m^2, and an acceleration below
        // 64 l^6 m^5: at most 2^124.
        let lengths =
            |leg: &LegParameters| leg.proximal_m + leg.distal_m + leg.joint_radius_m.abs();
        let is_short = parameters.legs.iter().map(lengths).sum::<f64>() < 8.0;
        let moderate = if is_short { 1_048_576.0 } else { 0.0 };
        Ok(Self {
            moderate: <Float<N>>::from_f64(moderate),
            tick: Tick::build(machine)?,
            distances: Distances::build(parameters),
            limits,
            period: <Float<N>>::from_f64(period_s),
            ramp: TaylorModel::from_f64(slope),
            least: ramp.least,
            loaded: parameters.is_loaded_at_rest(),
        })
    }

    /// The tick, on Taylor models.
    pub fn tick(&self) -> &Tick<M::Over<TaylorModel<N>>> {
        &self.tick
    }

    /// The distances to the singularities, likewise.
    pub fn distances(&self) -> &Distances<TaylorModel<N>> {
        &self.distances
    }

    /// The limits.
    pub fn limits(&self) -> &Limits<Float<N>> {
        &self.limits
    }

    /// Returns true if the motors may have to hold something at rest.
    pub fn is_loaded(&self) -> bool {
        self.loaded
    }

    /// Checks that every limit is kept for certain during the interval `s`. The error is the first that is not. Lowers the
    /// rates of `pace` until they are kept, too.
    /// `side` is the sign of det A, which may not change on the way; none where it is not known yet.
    pub(super) fn check<K: CurveKind>(
        &self,
        segment: &Segment<TaylorModel<N>, K>,
        s: TaylorModel<N>,
        side: &mut Option<bool>,
        pace: &mut Pace,
    ) -> Result<(), Breach<Float<N>>> {
        let mut motors = [MotorBounds::UNMEASURED; 3];
        let mut jerks = [JerkBounds::UNMEASURED; 3];
        let jerks: &mut [_] = if K::JERK { &mut jerks } else { &mut [] };
        self.measure(segment, s, side, &mut motors, jerks)?;
        let (limits, normal) = (&self.limits, <Float<N>>::ONE);
        for (index, motor) in motors.iter().enumerate() {
            motor.lower::<M, K>(index, jerks.get(index), limits, normal, &self.least, pace)?;
        }
        Ok(())
    }

    /// Checks that the acceleration may begin or end with that of `segment` at its fraction `at`: that no motor's jumps there,
    /// but for [`ROUNDING`]. Places out of reach are left to [`check`](Self::check).
    #[inline(never)]
    pub(super) fn check_jump<K: CurveKind>(
        &self,
        segment: &Segment<TaylorModel<N>, K>,
        at: Float<N>,
    ) -> Result<(), Breach<Float<N>>> {
        let Some(limits) = self.limits.jerk.filter(|_| K::JERK) else {
            return Ok(());
        };
        let setpoint = segment.at_fraction(TaylorModel::point(at));
        let rotation = Rotation::new(setpoint.pose.angle);
        let mut legs = [unsolved(); 3];
        if self.solve(&setpoint, &rotation, &mut legs).is_err() {
            return Ok(());
        }
        for (index, (leg, motion)) in self.tick.geometry().legs().iter().zip(&legs).enumerate() {
            // Without the part of the velocities, which do not jump.
            let jump = leg.motor_rate(&motion.position, &setpoint.acceleration);
            let size = jump.extent();
            let limit = limits[index] * self.period * <Float<N>>::ratio(1, ROUNDING);
            if !(size.greatest <= limit) {
                let what = Bounded::AccelerationJump;
                return Err(Breach::above(what, index, &size, limit, false));
            }
        }
        Ok(())
    }

    /// Measures what the `motors` do over the interval `s` of fractions of `segment`, and as many `jerks` as asked, where one is
    /// limited.
    /// It fails unless the interval is within reach and away from singularities for certain.
    #[inline(never)]
    pub(super) fn measure<K: CurveKind>(
        &self,
        segment: &Segment<TaylorModel<N>, K>,
        s: TaylorModel<N>,
        side: &mut Option<bool>,
        motors: &mut [MotorBounds<N>; 3],
        jerks: &mut [JerkBounds<N>],
    ) -> Result<(), Breach<Float<N>>> {
        let mut setpoint = segment.at_fraction(s);
        let rotation = Rotation::new(setpoint.pose.angle);
        let mut legs = [unsolved(); 3];
        self.solve(&setpoint, &rotation, &mut legs)
            .map_err(|status| self.breach(status, &setpoint, &rotation))?;
        let lines = lines(&legs);
        self.keeps_distance(&legs, lines.det_a, side)?;
        self.add_motion::<K>(&setpoint, &mut legs);
        for (motor, leg) in motors.iter_mut().zip(&legs) {
            motor.rate = leg.rates.proximal;
            motor.acceleration = leg.accelerations.proximal;
            motor.ramp_acceleration = leg.rates.proximal * self.ramp;
        }
        if K::JERK && self.limits.jerk.is_some() {
            let third = segment.jerk_at_fraction(s, TaylorModel::near(self.period));
            let moving = self.tick.geometry().legs().iter().zip(&legs);
            for (bounds, (leg, motion)) in jerks.iter_mut().zip(moving) {
                let ramp = motion.accelerations.proximal * self.ramp;
                *bounds = JerkBounds {
                    steady: jerk(leg, motion, &setpoint, &third),
                    ramp: ramp + ramp + ramp,
                };
            }
        }
        if self.needs_torques() {
            self.add_torques(motors, &lines, &mut legs, &mut setpoint, &rotation)
                .map_err(|status| self.breach(status, &setpoint, &rotation))?;
        }
        // An acceleration is the last that leaves the range.
        let mut sum = TaylorModel::ZERO;
        for motor in motors {
            sum += motor.acceleration;
            if let Some(torque) = &motor.torque {
                sum += torque.dynamic;
            }
        }
        if sum.is_finite() {
            Ok(())
        } else {
            Err(Breach::out_of_range())
        }
    }

    /// Returns `true` if a limit asks for the dynamics.
    fn needs_torques(&self) -> bool {
        M::TORQUES && (self.limits.torque.is_some() || self.limits.power.is_some())
    }

    /// Finds the positions of the legs.
    fn solve(
        &self,
        setpoint: &Setpoint<TaylorModel<N>>,
        rotation: &Rotation<TaylorModel<N>>,
        motions: &mut [LegMotion<TaylorModel<N>>; 3],
    ) -> Result<(), Status> {
        let legs = &self.tick.geometry().legs();
        for (index, (leg, motion)) in legs.iter().zip(motions.iter_mut()).enumerate() {
            solve(index, leg, setpoint, rotation, motion)?;
        }
        Ok(())
    }

    /// Adds rates and accelerations to the positions of the legs, if a limit asks for them.
    fn add_motion<K: CurveKind>(
        &self,
        setpoint: &Setpoint<TaylorModel<N>>,
        motions: &mut [LegMotion<TaylorModel<N>>; 3],
    ) {
        let limits = &self.limits;
        let is_limited = limits.rate.is_some()
            || limits.acceleration.is_some()
            || (K::JERK && limits.jerk.is_some())
            || self.needs_torques();
        if is_limited || !self.motion_is_finite(setpoint, motions) {
            for (leg, motion) in self.tick.geometry().legs().iter().zip(motions) {
                add_motion(leg, setpoint, motion);
            }
        }
    }

    /// Returns `true` if rates and accelerations cannot leave the range, because velocity and acceleration of the
    /// platform and each 1 / (r1 x r2) are moderate.
    #[inline(never)]
    fn motion_is_finite(
        &self,
        setpoint: &Setpoint<TaylorModel<N>>,
        legs: &[LegMotion<TaylorModel<N>>; 3],
    ) -> bool {
        let inverses = legs.each_ref().map(|leg| leg.position.links.inverse_cross);
        let mut size = <Float<N>>::ZERO;
        for sizes in [
            setpoint.velocity.into(),
            setpoint.acceleration.into(),
            inverses,
        ] {
            for model in sizes {
                size += model.magnitude();
            }
        }
        size <= self.moderate
    }

    /// Checks that the singularities are as far as the limits ask, for the determinant `det_a`.
    #[inline(never)]
    fn keeps_distance(
        &self,
        legs: &[LegMotion<TaylorModel<N>>; 3],
        det_a: TaylorModel<N>,
        side: &mut Option<bool>,
    ) -> Result<(), Breach<Float<N>>> {
        let least = self.limits.serial_distance;
        for (index, leg) in legs.iter().enumerate() {
            let size = self.distances.serial_of(index, &leg.position).extent();
            if !(size.least >= least) {
                let what = Bounded::SerialDistance;
                return Err(Breach::below(what, Some(index), &size, least));
            }
        }
        let least = self.limits.parallel_distance;
        let signed = self.distances.signed_parallel(det_a);
        let zero = <Float<N>>::ZERO;
        let mut size = signed.extent();
        if size.least >= least && size.least > zero {
            let positive = signed > TaylorModel::ZERO;
            if *side.get_or_insert(positive) == positive {
                return Ok(());
            }
            // It has been zero on the way.
            size = Extent {
                least: zero,
                value: zero,
                greatest: zero,
                curved: zero,
            };
        }
        Err(Breach::below(Bounded::ParallelDistance, None, &size, least))
    }

    /// Three times the dynamics: of the motion at normal speed; of the motion that starts from rest with the ramp's
    /// rate, which is an acceleration of q' r without any rate; and of the load at rest. They are linear in the load:
    /// weight and wrench are in the last alone. `legs` and `setpoint` are given at normal speed and left at
    /// rest.
    #[inline(never)]
    fn add_torques(
        &self,
        motors: &mut [MotorBounds<N>; 3],
        lines: &DistalLines<TaylorModel<N>>,
        legs: &mut [LegMotion<TaylorModel<N>>; 3],
        setpoint: &mut Setpoint<TaylorModel<N>>,
        rotation: &Rotation<TaylorModel<N>>,
    ) -> Result<(), Status> {
        let inertial = self.tick.model().inertial();
        let dynamic = torques(&inertial, lines, legs, setpoint, rotation)?;

        let zero = Vector3::from([TaylorModel::ZERO; 3]);
        setpoint.acceleration = setpoint.velocity * self.ramp;
        setpoint.velocity = zero;
        for leg in legs.iter_mut() {
            leg.accelerations.proximal = leg.rates.proximal * self.ramp;
            leg.accelerations.distal = leg.rates.distal * self.ramp;
            leg.rates = Rates {
                proximal: TaylorModel::ZERO,
                distal: TaylorModel::ZERO,
            };
        }
        let ramp = torques(&inertial, lines, legs, setpoint, rotation)?;

        let mut at_rest = [TaylorModel::ZERO; 3];
        if self.loaded {
            setpoint.acceleration = zero;
            for leg in legs.iter_mut() {
                leg.accelerations = Accelerations {
                    proximal: TaylorModel::ZERO,
                    distal: TaylorModel::ZERO,
                };
            }
            at_rest = torques(self.tick.model(), lines, legs, setpoint, rotation)?;
        }
        for (index, motor) in motors.iter_mut().enumerate() {
            motor.torque = Some(TorqueBounds {
                at_rest: at_rest[index],
                dynamic: dynamic[index],
                ramp: ramp[index],
            });
        }
        Ok(())
    }
}
