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
use crate::extreme::{greater, lesser};
use crate::piece::{PathPoint, Piece};
use heapless::Vec;
use nalgebra::Vector3;
use trirrr_core::dyad::{Accelerations, Rates};
use trirrr_core::inverse::{LegMotion, LegPosition, Rotation};
use trirrr_core::limits::Limits;
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::Tick;
use trirrr_service::admission::{Enclose, TaylorModel};

/// Most rows of a cell: rate, acceleration and torque of three motors, and the speed of D.
pub const ROWS: usize = 10;

/// Part of a limit that the value at rest may take.
const STANDING: f64 = 0.999_999;

/// A quantity that a limit bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limited {
    /// Joint rate of a motor, 0 to 2.
    Rate(usize),
    /// Joint acceleration of a motor.
    Acceleration(usize),
    /// Torque of a motor.
    Torque(usize),
    /// Mechanical power of a motor.
    Power(usize),
    /// Speed of the reference point D.
    Feed,
}

/// |acceleration a + square x + rest| <= limit over a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<N: Enclose> {
    pub(crate) what: Limited,
    /// Coefficient of a; none where the quantity depends on x alone and is not negative.
    pub(crate) acceleration: Option<TaylorModel<N>>,
    /// Coefficient of x.
    pub(crate) square: TaylorModel<N>,
    /// Value at rest.
    pub(crate) rest: TaylorModel<N>,
    pub(crate) limit: N::Bound,
}

/// Limit of the power of one motor: |torque| |theta'| u <= limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PowerLimit<N: Enclose> {
    /// Greatest |theta'| of the cell.
    pub(crate) rate: N::Bound,
    /// The torque, with an unused limit.
    pub(crate) torque: Row<N>,
    pub(crate) limit: N::Bound,
}

/// Limits over a stretch of a piece.
#[derive(Clone, Debug)]
pub struct Cell<N: Enclose> {
    /// Length of the stretch in p, positive.
    pub(crate) length: N::Bound,
    /// x at the start of this cell over x at the end of the cell before: not 1 where pieces join.
    pub(crate) joint: N::Bound,
    /// Part that the passes use of what the limits leave for motion, 0 to 1.
    pub(crate) share: N::Bound,
    /// What `share` is to be lowered to, as a part of itself.
    tightened: N::Bound,
    /// r: rate of change of the pace that a hold may add, in paces per unit of time.
    pub(crate) ramp: N::Bound,
    pub(crate) rows: Vec<Row<N>, ROWS>,
    pub(crate) powers: Vec<PowerLimit<N>, 3>,
    /// Bounds of any motion through the cell.
    pub(crate) possible: Possible<N::Bound>,
}

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

/// The machine with its limits, ready to measure cells.
#[derive(Clone, Debug)]
pub struct Planner<M: Model<N: Enclose>> {
    tick: Tick<M::Over<TaylorModel<M::N>>>,
    distances: Distances<TaylorModel<M::N>>,
    limits: Limits<<M::N as Enclose>::Bound>,
    ramp: <M::N as Enclose>::Bound,
    loaded: bool,
    lever_m: f64,
}

type Model3<N> = [TaylorModel<N>; 3];

impl<N: Enclose, M: Model<N = N>> Planner<M> {
    /// Builds the coefficients. `ramp`: rate at which a hold may change the pace anywhere on the path, in paces per
    /// unit of time; 0 leaves no room for holds.
    ///
    /// # Errors
    /// The first quantity of the machine that is refused.
    pub fn build(
        parameters: &Parameters,
        limits: Limits<N::Bound>,
        ramp: N::Bound,
    ) -> Result<Self, BuildError> {
        Ok(Self {
            tick: Tick::build(parameters)?,
            distances: Distances::build(parameters),
            limits,
            ramp,
            loaded: parameters.is_loaded_at_rest(),
            lever_m: parameters
                .legs
                .iter()
                .map(|leg| leg.joint_radius_m)
                .fold(0.0, f64::max),
        })
    }

    /// Largest distance of a platform joint from D.
    pub fn lever_m(&self) -> f64 {
        self.lever_m
    }

    /// Returns true if the power of the motors is limited.
    #[cfg(feature = "std")]
    pub(crate) fn limits_power(&self) -> bool {
        self.limits.power.is_some()
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
    ) -> Result<Cell<N>, Obstacle> {
        let half = N::Bound::HALF;
        let p = TaylorModel::span(half * (from + to), half * (to - from));
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
        let mut legs = self.solve(&setpoint, &rotation)?;
        self.keep_distances(&legs, side)?;

        let mut cell = Cell {
            length: to - from,
            joint: N::Bound::ONE,
            share: N::Bound::ONE,
            tightened: N::Bound::ONE,
            ramp: N::Bound::ZERO,
            rows: Vec::new(),
            powers: Vec::new(),
            possible: Possible::of::<N>(&[], to - from),
        };
        let rates = legs.map(|leg| leg.rates.proximal);
        if let Some(limits) = self.limits.rate {
            for (motor, limit) in limits.into_iter().enumerate() {
                cell.push(Row::of_square(
                    Limited::Rate(motor),
                    rates[motor] * rates[motor],
                    limit,
                ));
            }
        }
        if let Some(limits) = self.limits.acceleration {
            for (motor, limit) in limits.into_iter().enumerate() {
                cell.push(Row {
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
            cell.push(Row::of_square(Limited::Feed, speed_sq, feed));
        }
        if M::TORQUES && (self.limits.torque.is_some() || self.limits.power.is_some()) {
            let torques = self
                .torques(&mut legs, &mut setpoint, &rotation)
                .map_err(Obstacle::of)?;
            self.add_torques(&mut cell, &rates, torques);
        }
        for row in &cell.rows {
            if !row.is_finite() {
                return Err(Obstacle::Range);
            }
            // Rounding of the passes is far below this margin.
            if !(row.rest.magnitude() <= row.limit * N::Bound::from_f64(STANDING)) {
                return Err(Obstacle::Standing(row.what));
            }
        }
        cell.possible = Possible::of(&cell.rows, cell.length);
        Ok(cell)
    }

    fn add_torques(
        &self,
        cell: &mut Cell<N>,
        rates: &Model3<N>,
        [starting, moving, resting]: [Model3<N>; 3],
    ) {
        for motor in 0..3 {
            let rest = resting[motor];
            let torque = |limit| Row {
                what: Limited::Torque(motor),
                acceleration: Some(starting[motor] - rest),
                square: moving[motor] - rest,
                rest,
                limit,
            };
            if let Some(limits) = self.limits.torque {
                cell.push(torque(limits[motor]));
            }
            if let Some(limits) = self.limits.power {
                let power = PowerLimit {
                    rate: rates[motor].magnitude(),
                    torque: Row {
                        what: Limited::Power(motor),
                        ..torque(limits[motor])
                    },
                    limit: limits[motor],
                };
                // Room for each motor.
                let _ = cell.powers.push(power);
            }
        }
    }

    fn solve(
        &self,
        setpoint: &Setpoint<TaylorModel<N>>,
        rotation: &Rotation<TaylorModel<N>>,
    ) -> Result<[LegMotion<TaylorModel<N>>; 3], Obstacle> {
        let legs = self.tick.geometry().legs();
        let solve = |index: usize| {
            let leg = &legs[index];
            let position: LegPosition<_> = leg.position(index, setpoint.pose.position, rotation)?;
            let rates = leg.rates(&position, &setpoint.velocity);
            let accelerations = leg.accelerations(&position, &rates, setpoint);
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
        side: &mut Option<bool>,
    ) -> Result<(), Obstacle> {
        for (index, leg) in legs.iter().enumerate() {
            let distance = self.distances.serial_of(index, &leg.position);
            if !(distance.least_magnitude() >= self.limits.serial_distance) {
                return Err(Obstacle::SerialDistance(index));
            }
        }
        let positions = legs.each_ref().map(|leg| &leg.position);
        let distance = self.distances.signed_parallel_of(positions);
        let positive = distance > TaylorModel::ZERO;
        let apart = distance.least_magnitude() > N::Bound::ZERO
            && distance.least_magnitude() >= self.limits.parallel_distance;
        match apart && *side.get_or_insert(positive) == positive {
            true => Ok(()),
            false => Err(Obstacle::ParallelDistance),
        }
    }

    /// Torques A + C, B + C and C.
    fn torques(
        &self,
        legs: &mut [LegMotion<TaylorModel<N>>; 3],
        setpoint: &mut Setpoint<TaylorModel<N>>,
        rotation: &Rotation<TaylorModel<N>>,
    ) -> Result<[Model3<N>; 3], Status> {
        let moving = self.tick.torques(legs, setpoint, rotation)?;
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
        let starting = self.tick.torques(legs, setpoint, rotation)?;
        let mut resting = [zero; 3];
        if self.loaded {
            setpoint.acceleration = setpoint.velocity;
            for leg in legs.iter_mut() {
                leg.accelerations = Accelerations {
                    proximal: zero,
                    distal: zero,
                };
            }
            resting = self.tick.torques(legs, setpoint, rotation)?;
        }
        Ok([starting, moving, resting])
    }
}

impl<N: Enclose> Row<N> {
    /// square x <= limit^2.
    fn of_square(what: Limited, square: TaylorModel<N>, limit: N::Bound) -> Self {
        Self {
            what,
            acceleration: None,
            square,
            rest: TaylorModel::ZERO,
            limit: limit * limit,
        }
    }

    fn is_finite(&self) -> bool {
        let all = self.acceleration.unwrap_or(TaylorModel::ZERO) + self.square + self.rest;
        all.is_finite()
    }
}

impl<N: Enclose> Cell<N> {
    /// There is room: each kind of row occurs once for each motor.
    fn push(&mut self, row: Row<N>) {
        let _ = self.rows.push(row);
    }

    /// Sets the scale of the pace at the start of this cell: x here over x at the end of the cell before.
    pub fn join(&mut self, joint: N::Bound) {
        self.joint = joint;
    }

    /// Takes the coefficients in the middle of the cell for all of it: an estimate, no proof.
    #[cfg(feature = "std")]
    pub(crate) fn flatten(&mut self) {
        let flat = |model: TaylorModel<N>| TaylorModel::point(model.line().constant);
        for row in self
            .rows
            .iter_mut()
            .chain(self.powers.iter_mut().map(|power| &mut power.torque))
        {
            row.acceleration = row.acceleration.map(flat);
            row.square = flat(row.square);
            row.rest = flat(row.rest);
        }
    }

    /// Leaves room for a hold at the rate `ramp` in the passes from now on; a cell is measured without.
    pub fn reserve(&mut self, ramp: N::Bound) {
        self.ramp = ramp;
    }

    /// Notes that the passes are to use no more than `share` of what they use of the limits now. Of several shares
    /// the least counts, from the next [`apply_tightening`](Self::apply_tightening) on.
    pub fn tighten(&mut self, share: N::Bound) {
        self.tightened = lesser(self.tightened, share);
    }

    /// Lowers the part of the limits that the passes use, down to 1e-8 at most: the pace goes with its root.
    pub fn apply_tightening(&mut self) {
        self.share = greater(self.share * self.tightened, N::Bound::ratio(1, 100_000_000));
        self.tightened = N::Bound::ONE;
    }

    /// Length in p.
    pub fn length(&self) -> N::Bound {
        self.length
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
