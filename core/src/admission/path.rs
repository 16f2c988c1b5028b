//! One interval of a move, measured: the very stages of the tick, run on Taylor models.

use super::Breach;
use super::bounds::{MotorBounds, TorqueBounds};
use super::taylor::{Float, TaylorModel};
use crate::inverse::{LegMotion, LegPosition, Position, Rotation};
use crate::limits::Limits;
use crate::linkage::rrr::{Accelerations, Rates};
use crate::machine::{BuildError, Parameters};
use crate::message::Bounded;
use crate::number::{Number, dot};
use crate::setpoint::{Segment, Setpoint};
use crate::singularity::Distances;
use crate::status::Status;
use crate::tick::Tick;
use crate::torque::balance::Solve;
use crate::torque::links::Links;
use crate::torque::payload::Payload;
use nalgebra::Vector3;

/// A machine with its limits, ready to measure intervals of moves: the coefficients of the
/// admission.
#[derive(Clone, Copy, Debug)]
pub struct Path<N: Number, P: Payload<TaylorModel<N>>, L> {
    /// The tick, on Taylor models.
    pub tick: Tick<TaylorModel<N>, P, L>,
    /// The distances, likewise.
    pub distances: Distances<TaylorModel<N>>,
    /// What is compared with.
    pub limits: Limits<Float<N>>,
    /// Seconds, or the machine's unit of time, per tick.
    pub period: Float<N>,
    /// r: largest rate of change of the speed along the path, in normal speeds per unit of time.
    pub ramp: TaylorModel<N>,
    /// Whether the motors may have to hold something at rest: gravity or a wrench.
    pub loaded: bool,
}

type Model<N> = TaylorModel<N>;

impl<N, P, L> Path<N, P, L>
where
    N: Number,
    P: Payload<Model<N>>,
    L: Links<Model<N>>,
{
    /// Builds the coefficients. `ramp_ticks`, positive, is how long a hold or a stop takes from
    /// normal speed to rest; a tick lasts `period_s`.
    ///
    /// # Errors
    /// The first quantity of the machine that is refused.
    pub fn build(
        parameters: &Parameters,
        limits: Limits<Float<N>>,
        ramp_ticks: u16,
        period_s: f64,
    ) -> Result<Self, BuildError> {
        let ramp = <Float<N>>::from_f64(1.0 / (f64::from(ramp_ticks.max(1)) * period_s));
        let loads = [
            parameters.gravity_m_s2.x,
            parameters.gravity_m_s2.y,
            parameters.wrench_force_n.x,
            parameters.wrench_force_n.y,
            parameters.wrench_torque_nm,
        ];
        Ok(Self {
            tick: Tick::build(parameters)?,
            distances: Distances::build(parameters),
            limits,
            period: <Float<N>>::from_f64(period_s),
            ramp: Model::near(ramp),
            loaded: loads.iter().any(|&load| load != 0.0),
        })
    }

    /// Whether every limit is kept for certain during the interval `s`: what is broken otherwise.
    pub(super) fn check(
        &self,
        segment: &Segment<Model<N>>,
        s: Model<N>,
    ) -> Result<(), Breach<Float<N>>> {
        let motors = self.measure(segment, s)?;
        for (index, motor) in motors.iter().enumerate() {
            motor.check::<P::Balance>(index, &self.limits, <Float<N>>::ONE)?;
        }
        Ok(())
    }

    /// What the motors do while the fraction `s` of `segment` has passed, if the interval is within
    /// reach and away from singularities for certain.
    #[inline(never)]
    pub(super) fn measure(
        &self,
        segment: &Segment<Model<N>>,
        s: Model<N>,
    ) -> Result<[MotorBounds<N>; 3], Breach<Float<N>>> {
        let setpoint = segment.at_fraction(s);
        let rotation = Rotation::new(setpoint.pose.angle);
        let position = self.position(&setpoint, &rotation)?;

        let velocity = setpoint.velocity;
        let rates =
            |leg: usize| self.tick.geometry().legs[leg].rates(&position.legs[leg], &velocity);
        let rates = [rates(0), rates(1), rates(2)];
        let steady = self.accelerations(&position.legs, &rates, &setpoint);

        let limited = self.limits.torque.is_some() || self.limits.power.is_some();
        let torque = if P::Balance::TORQUES && limited {
            self.torques(&position, &rotation, &rates, &steady, &setpoint)?
                .map(Some)
        } else {
            [None; 3]
        };
        let bounds = |motor: usize| MotorBounds {
            rate: rates[motor].proximal,
            acceleration: steady[motor].proximal,
            ramp_acceleration: rates[motor].proximal * self.ramp,
            torque: torque[motor],
        };
        let bounds = [bounds(0), bounds(1), bounds(2)];
        // An acceleration is the last that leaves the range.
        let sum = bounds.iter().fold(Model::ZERO, |sum, motor| {
            let torque = motor.torque.map_or(Model::ZERO, |torque| torque.dynamic);
            sum + motor.acceleration + torque
        });
        if sum.is_finite() {
            Ok(bounds)
        } else {
            Err(Breach::out_of_range())
        }
    }

    fn position(
        &self,
        setpoint: &Setpoint<Model<N>>,
        rotation: &Rotation<Model<N>>,
    ) -> Result<Position<Model<N>>, Breach<Float<N>>> {
        let solve = |leg: usize| {
            self.tick.geometry().legs[leg]
                .position(leg, setpoint.pose.position, rotation)
                .map_err(|status| self.breach(status, setpoint, rotation))
        };
        let position = Position {
            legs: [solve(0)?, solve(1)?, solve(2)?],
        };
        let least = self.limits.serial_distance;
        for (leg, distance) in self.distances.serial(&position).into_iter().enumerate() {
            let value = distance.least_magnitude();
            if !(value >= least) {
                return Err(Breach::distance(
                    Bounded::SerialDistance,
                    Some(leg),
                    value,
                    least,
                ));
            }
        }
        let least = self.limits.parallel_distance;
        let value = self.distances.parallel(&position).least_magnitude();
        // Certainly not zero: a change of sign of det A is a crossing.
        if !(value >= least && value > <Float<N>>::ZERO) {
            return Err(Breach::distance(
                Bounded::ParallelDistance,
                None,
                value,
                least,
            ));
        }
        Ok(position)
    }

    #[inline(never)]
    fn accelerations(
        &self,
        position: &[LegPosition<Model<N>>; 3],
        rates: &[Rates<Model<N>>; 3],
        setpoint: &Setpoint<Model<N>>,
    ) -> [Accelerations<Model<N>>; 3] {
        let of = |leg: usize| {
            self.tick.geometry().legs[leg].accelerations(&position[leg], &rates[leg], setpoint)
        };
        [of(0), of(1), of(2)]
    }

    /// Three times the dynamics: at rest, at normal speed, and starting from rest with the ramp's
    /// rate, which is an acceleration of q' r without any rate.
    fn torques(
        &self,
        position: &Position<Model<N>>,
        rotation: &Rotation<Model<N>>,
        rates: &[Rates<Model<N>>; 3],
        steady: &[Accelerations<Model<N>>; 3],
        setpoint: &Setpoint<Model<N>>,
    ) -> Result<[TorqueBounds<N>; 3], Breach<Float<N>>> {
        let still = Rates {
            proximal: Model::ZERO,
            distal: Model::ZERO,
        };
        let unchanged = Accelerations {
            proximal: Model::ZERO,
            distal: Model::ZERO,
        };
        let zero = Vector3::from([Model::ZERO; 3]);
        let solve = |rates: &[Rates<Model<N>>; 3],
                     accelerations: &[Accelerations<Model<N>>; 3],
                     setpoint: &Setpoint<Model<N>>| {
            let motion = |leg: usize| LegMotion {
                position: position.legs[leg],
                rates: rates[leg],
                accelerations: accelerations[leg],
            };
            self.tick
                .torques(&[motion(0), motion(1), motion(2)], setpoint, rotation)
                .map_err(|status| self.breach(status, setpoint, rotation))
        };
        let at_normal_speed = solve(rates, steady, setpoint)?;
        let starting = Setpoint {
            velocity: zero,
            acceleration: setpoint.velocity.map(|component| component * self.ramp),
            ..*setpoint
        };
        let ramp = rates.each_ref().map(|rates| Accelerations {
            proximal: rates.proximal * self.ramp,
            distal: rates.distal * self.ramp,
        });
        let starting = solve(&[still; 3], &ramp, &starting)?;
        let at_rest = if self.loaded {
            let standing = Setpoint {
                velocity: zero,
                acceleration: zero,
                ..*setpoint
            };
            solve(&[still; 3], &[unchanged; 3], &standing)?
        } else {
            [Model::ZERO; 3]
        };
        let bounds = |motor: usize| TorqueBounds {
            at_rest: at_rest[motor],
            dynamic: at_normal_speed[motor] - at_rest[motor],
            ramp: starting[motor] - at_rest[motor],
        };
        Ok([bounds(0), bounds(1), bounds(2)])
    }

    /// What is broken where the pipeline ends without a value.
    fn breach(
        &self,
        status: Status,
        setpoint: &Setpoint<Model<N>>,
        rotation: &Rotation<Model<N>>,
    ) -> Breach<Float<N>> {
        match status {
            Status::Unreachable { leg } | Status::SerialSingular { leg } => {
                let dyad = &self.tick.geometry().legs[leg];
                let c = rotation.apply(dyad.joint);
                let d = (setpoint.pose.position - dyad.base) + c;
                let squared = dot(d, d);
                let (shortest, longest) = dyad.dyad.reach();
                let (shortest, longest) = (shortest.constant, longest.constant);
                // The span that is on the wrong side, or may be, of the nearer of the two bounds.
                let far = squared.constant + squared.radius();
                let near = squared.constant - squared.radius();
                let stretched = !(squared.constant
                    <= <Float<N>>::HALF * (shortest * shortest + longest * longest));
                let (value, limit) = if stretched {
                    (far.sqrt(), longest)
                } else if near > <Float<N>>::ZERO {
                    (near.sqrt(), shortest)
                } else {
                    (<Float<N>>::ZERO, shortest)
                };
                Breach {
                    what: Bounded::Reach,
                    index: Some(leg as u8),
                    value,
                    limit,
                    ramp: false,
                }
            }
            Status::ParallelSingular => Breach::distance(
                Bounded::ParallelDistance,
                None,
                <Float<N>>::ZERO,
                self.limits.parallel_distance,
            ),
            Status::OutOfRange => Breach::out_of_range(),
        }
    }
}
