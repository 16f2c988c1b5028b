//! Limits along a short stretch of a path, as bounds in the pace.
//!
//! With u = dp/dt the pace along a piece, x = u^2 and a = du/dt = (dx/dp) / 2, every limited quantity of
//! a motor is affine in a and x:
//!
//! ```text
//! acceleration   theta' a + theta'' x
//! torque         A a + B x + C
//! rate^2         theta'^2 x
//! speed of D^2   |D'|^2 x
//! ```
//!
//! theta' and theta'' are the derivatives of the joint angle by p. C is the torque at rest; A + C and
//! B + C are the torques of the accelerations X' and X'' with the velocities 0 and X'. A [`Cell`] holds
//! the coefficients as Taylor models over its stretch, so they bound the quantity at every point.

use crate::bound::Possible;
use crate::piece::{PathPoint, Piece};
pub use crate::rows::{Cell, Limited};
use crate::rows::{ModelRow, PowerLimit, Row, Rows};
use core::borrow::Borrow;
use nalgebra::Vector3;
use trirrr_core::dyad::{Accelerations, Rates};
use trirrr_core::inverse::{LegMotion, LegPosition, Rotation};
use trirrr_core::limits::Limits;
#[cfg(feature = "std")]
use trirrr_core::machine::BuildError;
use trirrr_core::model::Model;
#[cfg(feature = "std")]
use trirrr_core::model::OfKind;
use trirrr_core::number::Arithmetic;
#[cfg(feature = "std")]
use trirrr_core::setpoint::Pose;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_core::torque::lines::DistalLines;
#[cfg(feature = "std")]
use trirrr_service::admission::AngleModel;
use trirrr_service::admission::{Enclose, Path, TaylorModel};
#[cfg(feature = "std")]
use trirrr_service::paces::Ramp;

/// Part of a limit that the value at rest may take.
const STANDING: f64 = 0.999_999;

/// Obstacle to a motion along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// A leg, 0 to 2, does not reach the pose for certain.
    Reach(usize),
    /// A leg comes nearer to its serial singularity than the limit, or may.
    SerialDistance(usize),
    /// The machine comes nearer to its parallel singularity than the limit, or may.
    ParallelDistance,
    /// The quantity is beyond its limit at rest, or may be: the machine cannot stand there.
    Standing(Limited),
    /// A value leaves the range of the number type.
    Range,
    /// The moves of the plan are refused by whoever plays them, at any pace.
    Refused,
}

/// The machine with its limits, ready to measure cells. `C` holds the coefficients, which are those of the admission.
#[derive(Clone, Copy, Debug)]
pub struct Planner<M: Model<N: Enclose>, C = Path<M>> {
    coefficients: C,
    ramp: BoundOf<M>,
    #[cfg(feature = "std")]
    lever_m: f64,
    #[cfg(feature = "std")]
    is_paced: bool,
    /// Most of x |X''| across the path, in the plane and for alpha.
    bend: Option<[BoundOf<M>; 2]>,
}

type BoundOf<M> = <<M as Model>::N as Enclose>::Bound;

/// Limits over a stretch of a piece as they are measured: Taylor models.
#[derive(Clone, Debug)]
pub struct Measured<N: Enclose> {
    length: N::Bound,
    limits: Rows<TaylorModel<N>, N::Bound>,
}

/// Motion of the legs that the limits ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LegNeeds {
    /// Rates of the motors.
    Rates,
    /// Rates and accelerations of the motors.
    Accelerations,
    /// Rates and accelerations of all links, which have masses.
    Links,
}

type Model3<N> = [TaylorModel<N>; 3];

#[cfg(feature = "std")]
impl<N: Enclose, M: Model<N = N>> Planner<M> {
    /// Builds the coefficients. `ramp`: rate at which a hold may change the pace anywhere on the path, in paces per
    /// unit of time; 0 leaves no room for holds.
    ///
    /// # Errors
    /// The first quantity of the machine that is refused.
    pub fn build<'a>(
        machine: impl Into<OfKind<'a>>,
        limits: Limits<N::Bound>,
        ramp: N::Bound,
    ) -> Result<Self, BuildError> {
        let machine = machine.into();
        // Holds and ticks are the admission's own.
        let coefficients = Path::build(machine, limits, Ramp::within(1, None), 1.0)?;
        let radii = machine.parameters.legs.iter().map(|leg| leg.joint_radius_m);
        Ok(Self {
            lever_m: radii.fold(0.0, f64::max),
            ..Self::over(coefficients, ramp)
        })
    }
}

#[cfg(feature = "std")]
impl<M: Model<N = f64>> Planner<M> {
    /// Largest part of a limit of the motors that `setpoint` takes, and which; none where there is no motion.
    pub(crate) fn part_of_limits(&self, setpoint: &Setpoint<f64>) -> Option<(f64, Limited)> {
        let model = |value: f64| TaylorModel::<f64>::point(value);
        let setpoint = Setpoint {
            pose: Pose {
                position: setpoint.pose.position.map(model),
                angle: AngleModel::of(setpoint.pose.angle),
            },
            velocity: setpoint.velocity.map(model),
            acceleration: setpoint.acceleration.map(model),
        };
        let rotation = Rotation::new(setpoint.pose.angle);
        let legs = self.solve(&setpoint, &rotation, LegNeeds::Links).ok()?;
        let mut most = (0.0_f64, Limited::Rate(0));
        let mut take =
            |values: Model3<f64>, limits: Option<[f64; 3]>, what: fn(usize) -> Limited| {
                let limits = limits.into_iter().flatten();
                for (motor, (value, limit)) in values.into_iter().zip(limits).enumerate() {
                    let part = value.magnitude() / limit;
                    if part > most.0 {
                        most = (part, what(motor));
                    }
                }
            };
        let limits = self.limits();
        let rates = legs.map(|leg| leg.rates.proximal);
        take(rates, limits.rate, Limited::Rate);
        take(
            legs.map(|leg| leg.accelerations.proximal),
            limits.acceleration,
            Limited::Acceleration,
        );
        if self.needs_torques() {
            let lines = DistalLines::of(legs.each_ref().map(|leg| &leg.position));
            let torques = self.torques_of(&lines, &legs, &setpoint, &rotation).ok()?;
            take(torques, limits.torque, Limited::Torque);
            let powers = [0, 1, 2].map(|motor| torques[motor] * rates[motor]);
            take(powers, limits.power, Limited::Power);
        }
        Some(most)
    }
}

impl<N: Enclose, M: Model<N = N>, C: Borrow<Path<M>>> Planner<M, C> {
    /// With the coefficients of an admission. `ramp` as in [`build`](Planner::build).
    pub fn over(coefficients: C, ramp: N::Bound) -> Self {
        Self {
            coefficients,
            ramp,
            #[cfg(feature = "std")]
            lever_m: 0.0,
            #[cfg(feature = "std")]
            is_paced: false,
            bend: None,
        }
    }

    fn path(&self) -> &Path<M> {
        self.coefficients.borrow()
    }

    fn limits(&self) -> &Limits<N::Bound> {
        self.path().limits()
    }

    /// Limits the acceleration across the path to `most`, of D and of alpha: moves that average over time leave the
    /// path by as much.
    pub(crate) fn with_bend(mut self, most: [N::Bound; 2]) -> Self {
        self.bend = Some(most);
        self
    }

    /// Largest distance of a platform joint from D.
    #[cfg(feature = "std")]
    pub(crate) fn lever_m(&self) -> f64 {
        self.lever_m
    }

    /// Limits powers at each pace from rest to that of the motion: a torque at rest that is beyond what the power allows at that pace is none
    /// where the motion takes it back.
    #[cfg(feature = "std")]
    pub(crate) fn paced(self) -> Self {
        Self {
            is_paced: true,
            ..self
        }
    }

    /// Returns true if powers are limited at each pace.
    #[cfg(feature = "std")]
    pub(crate) fn is_paced(&self) -> bool {
        self.is_paced
    }

    /// Returns true if the power of the motors is limited.
    #[cfg(feature = "std")]
    pub(crate) fn limits_power(&self) -> bool {
        self.limits().power.is_some()
    }

    /// Limits of jerk, rad/s^3.
    #[cfg(feature = "std")]
    pub(crate) fn jerk(&self) -> Option<[N::Bound; 3]> {
        self.limits().jerk
    }

    /// Accelerations of the motors at p of `piece`, as coefficients of a and x; none where a leg does not reach.
    #[cfg(feature = "std")]
    pub(crate) fn turning(
        &self,
        piece: &Piece<TaylorModel<N>>,
        p: N::Bound,
    ) -> Option<[[N::Bound; 2]; 3]> {
        let PathPoint {
            pose,
            first,
            second,
        } = piece.at(TaylorModel::point(p));
        let setpoint = Setpoint {
            pose,
            velocity: first,
            acceleration: second,
        };
        let rotation = Rotation::new(pose.angle);
        let legs = self
            .solve(&setpoint, &rotation, LegNeeds::Accelerations)
            .ok()?;
        let middle = |model: TaylorModel<N>| model.line().constant;
        Some(legs.map(|leg| {
            let LegMotion {
                rates,
                accelerations,
                ..
            } = leg;
            [middle(rates.proximal), middle(accelerations.proximal)]
        }))
    }

    /// Torques of a motion.
    fn torques_of(
        &self,
        lines: &DistalLines<TaylorModel<N>>,
        legs: &[LegMotion<TaylorModel<N>>; 3],
        setpoint: &Setpoint<TaylorModel<N>>,
        rotation: &Rotation<TaylorModel<N>>,
    ) -> Result<Model3<N>, Status> {
        let model = self.path().tick().model();
        let load = |leg: usize| model.load(leg, &legs[leg]);
        let loads = [load(0), load(1), load(2)];
        let forces = model.forces(Some(lines), legs, &loads, setpoint, rotation)?;
        Ok(forces.torques(legs, &loads))
    }

    /// Rate at which a hold may change the pace.
    pub fn ramp(&self) -> N::Bound {
        self.ramp
    }

    /// Measures the stretch of `piece` from p = `from` to `to`. `feed` is the greatest speed of D, if any;
    /// `side` the sign of det A on the path, none where it is not known yet.
    ///
    /// # Errors
    /// The obstacle. The stretch may be too long to exclude it: a shorter one may pass.
    pub fn measure(
        &self,
        piece: &Piece<TaylorModel<N>>,
        [from, to]: [N::Bound; 2],
        feed: Option<N::Bound>,
        side: &mut Option<bool>,
    ) -> Result<Measured<N>, Obstacle> {
        let half = N::Bound::HALF;
        // Rounding is far below what a cell loses by its length.
        let p = TaylorModel::span(half * (from + to), half * (to - from)).made_rough();
        let PathPoint {
            pose,
            first,
            second,
        } = piece.at(p);
        let mut setpoint = Setpoint {
            pose,
            velocity: first,
            acceleration: second,
        };
        let rotation = Rotation::new(pose.angle);
        let needed = match self.limits().acceleration {
            _ if self.needs_torques() && self.path().tick().model().has_leg_loads() => {
                LegNeeds::Links
            }
            Some(_) => LegNeeds::Accelerations,
            None => LegNeeds::Rates,
        };
        let mut legs = self.solve(&setpoint, &rotation, needed)?;
        let lines = DistalLines::of(legs.each_ref().map(|leg| &leg.position));
        self.keep_distances(&legs, lines.det_a, side)?;

        let mut rows = Rows::new();
        let rates = legs.map(|leg| leg.rates.proximal);
        if let Some(limits) = self.limits().rate {
            for (motor, limit) in limits.into_iter().enumerate() {
                rows.push(ModelRow::of_square(
                    Limited::Rate(motor),
                    rates[motor] * rates[motor],
                    limit,
                ));
            }
        }
        if let Some(limits) = self.limits().acceleration {
            for (motor, limit) in limits.into_iter().enumerate() {
                rows.push(Row {
                    what: Limited::Acceleration(motor),
                    acceleration: Some(rates[motor]),
                    square: legs[motor].accelerations.proximal,
                    rest: TaylorModel::ZERO,
                    limit,
                });
            }
        }
        if let Some(feed) = feed {
            let speed_sq = TaylorModel::ab_plus_cd(first.x, first.x, first.y, first.y);
            rows.push(ModelRow::of_square(Limited::Feed, speed_sq, feed));
        }
        // A straight line does not bend.
        let bends = || second.iter().any(|each| each.magnitude() > N::Bound::ZERO);
        if let Some(most) = self.bend.filter(|_| bends()) {
            let most = most.map(|each| TaylorModel::point(N::Bound::ONE.div(each)));
            rows.push(bend(&first, &second, most).ok_or(Obstacle::Range)?);
        }
        if self.needs_torques() {
            let torques = self
                .torques(&lines, &mut legs, &mut setpoint, &rotation)
                .map_err(Obstacle::of)?;
            self.add_torques(&mut rows, &rates, torques);
        }
        for row in &rows.rows {
            if !row.is_finite() {
                return Err(Obstacle::Range);
            }
            // Rounding of the passes is far below this margin.
            if !(row.rest.magnitude() <= row.limit * N::Bound::from_f64(STANDING)) {
                return Err(Obstacle::Standing(row.what));
            }
        }
        Ok(Measured {
            length: to - from,
            limits: rows,
        })
    }

    /// Returns true if a limit asks for the dynamics.
    fn needs_torques(&self) -> bool {
        M::TORQUES && (self.limits().torque.is_some() || self.limits().power.is_some())
    }

    fn add_torques(
        &self,
        rows: &mut Rows<TaylorModel<N>, N::Bound>,
        rates: &Model3<N>,
        [starting, moving, resting]: [Model3<N>; 3],
    ) {
        for motor in 0..3 {
            let rest = resting[motor];
            // Without a load there is nothing to subtract.
            let [acceleration, square] = match self.path().is_loaded() {
                true => [starting[motor] - rest, moving[motor] - rest],
                false => [starting[motor], moving[motor]],
            };
            let torque = |limit| Row {
                what: Limited::Torque(motor),
                acceleration: Some(acceleration),
                square,
                rest,
                limit,
            };
            if let Some(limits) = self.limits().torque {
                rows.push(torque(limits[motor]));
            }
            if let Some(limits) = self.limits().power {
                let power = PowerLimit {
                    rate: rates[motor].magnitude(),
                    least_rate: rates[motor].least_magnitude(),
                    torque: Row {
                        what: Limited::Power(motor),
                        ..torque(limits[motor])
                    },
                    limit: limits[motor],
                };
                // Room for each motor.
                let _ = rows.powers.push(power);
            }
        }
    }

    /// Solves the legs; what is not `needed` stays 0.
    fn solve(
        &self,
        setpoint: &Setpoint<TaylorModel<N>>,
        rotation: &Rotation<TaylorModel<N>>,
        needed: LegNeeds,
    ) -> Result<[LegMotion<TaylorModel<N>>; 3], Obstacle> {
        let legs = self.path().tick().geometry().legs();
        let solve = |index: usize| {
            let leg = &legs[index];
            let position: LegPosition<_> = leg.position(index, setpoint.pose.position, rotation)?;
            let rates = match needed {
                LegNeeds::Rates => Rates {
                    proximal: leg.motor_rate(&position, &setpoint.velocity),
                    distal: TaylorModel::ZERO,
                },
                _ => leg.rates(&position, &setpoint.velocity),
            };
            let accelerations = match needed {
                LegNeeds::Links => leg.accelerations(&position, &rates, setpoint),
                LegNeeds::Accelerations => Accelerations {
                    proximal: leg.motor_acceleration(&position, &rates, setpoint),
                    distal: TaylorModel::ZERO,
                },
                LegNeeds::Rates => Accelerations {
                    proximal: TaylorModel::ZERO,
                    distal: TaylorModel::ZERO,
                },
            };
            Ok(LegMotion {
                position,
                rates,
                accelerations,
            })
        };
        let all = || Ok([solve(0)?, solve(1)?, solve(2)?]);
        all().map_err(Obstacle::of)
    }

    fn keep_distances(
        &self,
        legs: &[LegMotion<TaylorModel<N>>; 3],
        det_a: TaylorModel<N>,
        side: &mut Option<bool>,
    ) -> Result<(), Obstacle> {
        for (index, leg) in legs.iter().enumerate() {
            let distance = self
                .path()
                .distances()
                .signed_serial_of(index, &leg.position);
            if !(distance.least_magnitude() >= self.limits().serial_distance) {
                return Err(Obstacle::SerialDistance(index));
            }
        }
        let distance = self.path().distances().signed_parallel(det_a);
        // All of it, where it is apart from 0.
        let positive = distance.line().constant > N::Bound::ZERO;
        let least = distance.least_magnitude();
        let apart = least > N::Bound::ZERO && least >= self.limits().parallel_distance;
        match apart && *side.get_or_insert(positive) == positive {
            true => Ok(()),
            false => Err(Obstacle::ParallelDistance),
        }
    }

    /// Torques A + C, B + C and C.
    fn torques(
        &self,
        lines: &DistalLines<TaylorModel<N>>,
        legs: &mut [LegMotion<TaylorModel<N>>; 3],
        setpoint: &mut Setpoint<TaylorModel<N>>,
        rotation: &Rotation<TaylorModel<N>>,
    ) -> Result<[Model3<N>; 3], Status> {
        let model = self.path().tick().model();
        if model.is_singular(lines.det_a) {
            return Err(Status::ParallelSingular);
        }
        let torques = |legs: &[LegMotion<_>; 3], setpoint: &Setpoint<_>| {
            self.torques_of(lines, legs, setpoint, rotation)
        };
        let moving = torques(legs, setpoint)?;
        let zero = TaylorModel::ZERO;
        setpoint.acceleration = setpoint.velocity;
        setpoint.velocity = Vector3::from([zero; 3]);
        for leg in legs.iter_mut() {
            leg.accelerations = Accelerations {
                proximal: leg.rates.proximal,
                distal: leg.rates.distal,
            };
            leg.rates = Rates {
                proximal: zero,
                distal: zero,
            };
        }
        let starting = torques(legs, setpoint)?;
        let mut resting = [zero; 3];
        if self.path().is_loaded() {
            setpoint.acceleration = setpoint.velocity;
            for leg in legs.iter_mut() {
                leg.accelerations = Accelerations {
                    proximal: zero,
                    distal: zero,
                };
            }
            resting = torques(legs, setpoint)?;
        }
        Ok([starting, moving, resting])
    }
}

/// The row |X' x X''| / |X'| x <= 1, with D and alpha in parts of what each may bend; none where X' may vanish.
fn bend<N: Enclose>(
    first: &Vector3<TaylorModel<N>>,
    second: &Vector3<TaylorModel<N>>,
    [plane, angle]: [TaylorModel<N>; 2],
) -> Option<ModelRow<N>> {
    let scaled = |v: &Vector3<TaylorModel<N>>| Vector3::new(v.x * plane, v.y * plane, v.z * angle);
    let (first, second) = (scaled(first), scaled(second));
    let across = [
        TaylorModel::ab_minus_cd(first.y, second.z, first.z, second.y),
        TaylorModel::ab_minus_cd(first.z, second.x, first.x, second.z),
        TaylorModel::ab_minus_cd(first.x, second.y, first.y, second.x),
    ];
    let mut sum = N::Bound::ZERO;
    for each in across {
        let size = each.magnitude();
        sum += size * size;
    }
    let length = TaylorModel::ab_plus_cd(first.x, first.x, first.y, first.y) + first.z * first.z;
    let least = length.least_magnitude();
    (least > N::Bound::ZERO).then(|| Row {
        what: Limited::Tolerance,
        acceleration: None,
        square: TaylorModel::point(sum.div(least).sqrt()),
        rest: TaylorModel::ZERO,
        limit: N::Bound::ONE,
    })
}

impl<N: Enclose> Measured<N> {
    /// The limits as the passes take them.
    pub fn cell(&self) -> Cell<N::Bound> {
        Cell::new(self.length, self.limits.convert(TaylorModel::line))
    }

    /// Bounds of any motion through the stretch.
    pub fn possible(&self) -> Possible<N::Bound> {
        Possible::of(&self.limits, self.length)
    }
}

impl Obstacle {
    pub(crate) fn of(status: Status) -> Self {
        match status {
            Status::Unreachable { leg } | Status::SerialSingular { leg } => Self::Reach(leg),
            Status::ParallelSingular => Self::ParallelDistance,
            Status::OutOfRange => Self::Range,
        }
    }
}
