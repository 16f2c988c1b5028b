//! Slices of states of one machine, evaluated several at a time over all cores.
//!
//! Rows of three numbers lie one behind the other, as in a C-contiguous array of shape (n, 3): an array of numpy is
//! such a slice without a copy.

use crate::lanes::{Float, LANES, Lanes};
use multiversion::multiversion;
use nalgebra::{Vector2, Vector3};
use rayon::prelude::*;
use trirrr_core::machine::{BuildError, Geometry, Parameters};
use trirrr_core::model::{Model, ModelKind, ModelVisitor, OfKind};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::{Motor, Tick};

/// Rows that a thread takes at once.
const CHUNK: usize = 1 << 12;

/// States of the platform, one a row, SI units.
#[derive(Clone, Copy, Debug)]
pub struct StateRows<'a, F> {
    /// x and y of the reference point in m, alpha in rad.
    pub poses: &'a [[F; 3]],
    /// m/s, m/s, rad/s.
    pub velocities: &'a [[F; 3]],
    /// m/s^2, m/s^2, rad/s^2.
    pub accelerations: &'a [[F; 3]],
}

/// Room for the results of the three motors, one state a row, SI units.
#[derive(Debug)]
pub struct MotorRows<'a, F> {
    /// Directions of the proximal links in (-pi, pi], rad.
    pub angles: &'a mut [[F; 3]],
    /// rad/s.
    pub rates: &'a mut [[F; 3]],
    /// rad/s^2.
    pub accelerations: &'a mut [[F; 3]],
    /// N m, counter-clockwise positive; zero from a machine without torques.
    pub torques: &'a mut [[F; 3]],
}

/// A row without results. What stood in its place stands there still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FailedRow {
    /// Number of the row, from 0.
    pub row: usize,
    /// Reason.
    pub status: Status,
}

/// Refusal of slices of different lengths.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{slice} has {found} rows where poses has {expected}")]
pub struct LengthError {
    /// Name of the slice.
    pub slice: &'static str,
    /// Its rows.
    pub found: usize,
    /// Rows of the poses.
    pub expected: usize,
}

/// Distances of one state from the singularities, from 0 to 1: serial of the three legs, then parallel.
pub type DistanceRow<F> = [F; 4];

/// A machine that evaluates slices of states.
pub struct BatchMachine<F: Float> {
    ticks: Box<dyn BatchTick<F>>,
    geometry: Geometry<F>,
    distances: Distances<F>,
}

/// Tick of one model, for many states.
trait BatchTick<F>: Send + Sync {
    /// Evaluates the rows of slices of equal lengths; the first of them is row `first`.
    fn evaluate(
        &self,
        first: usize,
        states: StateRows<'_, F>,
        results: MotorRows<'_, F>,
        failed: &mut Vec<FailedRow>,
    );
}

impl<F: Float> BatchMachine<F> {
    /// Builds the leanest model of the machine; `torque`: torques are asked for.
    ///
    /// # Errors
    /// First quantity of the parameters that is refused.
    pub fn build(parameters: &Parameters, torque: bool) -> Result<Self, BuildError> {
        let kind = ModelKind::of(parameters, torque);
        Ok(Self {
            ticks: kind.visit(Build {
                machine: kind.with(parameters),
            })?,
            geometry: Geometry::build(parameters)?,
            distances: Distances::build(parameters),
        })
    }

    /// Finds the distances of every pose from the singularities, on all threads of rayon's current pool. Returns the rows without
    /// results, in their order.
    ///
    /// # Errors
    /// [`LengthError`]: nothing is evaluated.
    pub fn distances(
        &self,
        poses: &[[F; 3]],
        results: &mut [DistanceRow<F>],
    ) -> Result<Vec<FailedRow>, LengthError> {
        check_length("distances of the results", results.len(), poses.len())?;
        Ok(each_row(results, |row| {
            let position = self.geometry.position(&pose_of(poses[row]))?;
            let [one, two, three] = self.distances.serial(&position);
            Ok([one, two, three, self.distances.parallel(&position)])
        }))
    }

    /// Evaluates every state on all threads of rayon's current pool. Each row has the bits that
    /// [`Tick::evaluate`] gives. Returns the rows without results, in their order.
    ///
    /// # Errors
    /// [`LengthError`]: nothing is evaluated.
    pub fn evaluate(
        &self,
        states: StateRows<'_, F>,
        results: MotorRows<'_, F>,
    ) -> Result<Vec<FailedRow>, LengthError> {
        let expected = states.rows()?;
        for (slice, found) in [
            ("angles of the results", results.angles.len()),
            ("rates of the results", results.rates.len()),
            ("accelerations of the results", results.accelerations.len()),
            ("torques of the results", results.torques.len()),
        ] {
            check_length(slice, found, expected)?;
        }
        let states = states
            .poses
            .par_chunks(CHUNK)
            .zip(states.velocities.par_chunks(CHUNK))
            .zip(states.accelerations.par_chunks(CHUNK));
        let results = results
            .angles
            .par_chunks_mut(CHUNK)
            .zip(results.rates.par_chunks_mut(CHUNK))
            .zip(results.accelerations.par_chunks_mut(CHUNK))
            .zip(results.torques.par_chunks_mut(CHUNK));
        let failed = states
            .zip(results)
            .enumerate()
            .map(|(chunk, (states, results))| {
                let ((poses, velocities), accelerations) = states;
                let states = StateRows {
                    poses,
                    velocities,
                    accelerations,
                };
                let (((angles, rates), accelerations), torques) = results;
                let results = MotorRows {
                    angles,
                    rates,
                    accelerations,
                    torques,
                };
                let mut failed = Vec::new();
                self.ticks
                    .evaluate(chunk * CHUNK, states, results, &mut failed);
                failed
            });
        Ok(failed.collect::<Vec<_>>().concat())
    }
}

/// Compares the `found` rows of a slice with the `expected` ones.
pub(crate) fn check_length(
    slice: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), LengthError> {
    match found == expected {
        true => Ok(()),
        false => Err(LengthError {
            slice,
            found,
            expected,
        }),
    }
}

/// Evaluates each row by its number into `results`, on all threads. Returns the rows without results, in their order.
pub(crate) fn each_row<R: Send>(
    results: &mut [R],
    evaluate: impl Fn(usize) -> Result<R, Status> + Sync,
) -> Vec<FailedRow> {
    let chunks = results.par_chunks_mut(CHUNK).enumerate();
    let failed = chunks.map(|(chunk, results)| {
        let mut failed = Vec::new();
        for (row, result) in (chunk * CHUNK..).zip(results) {
            match evaluate(row) {
                Ok(value) => *result = value,
                Err(status) => failed.push(FailedRow { row, status }),
            }
        }
        failed
    });
    failed.collect::<Vec<_>>().concat()
}

fn pose_of<F: Float>([x, y, alpha]: [F; 3]) -> Pose<F> {
    Pose {
        position: Vector2::new(x, y),
        angle: alpha,
    }
}

struct Build<'a> {
    machine: OfKind<'a>,
}

impl<F: Float> ModelVisitor<F> for Build<'_> {
    type Output = Result<Box<dyn BatchTick<F>>, BuildError>;

    fn visit<M: Model<N = F>>(self) -> Self::Output {
        Ok(Box::new(ModelTicks::<F, M> {
            one: Tick::build(self.machine)?,
            lanes: Tick::build(self.machine)?,
        }))
    }
}

/// The same tick for one state and for several.
struct ModelTicks<F: Float, M: Model<N = F>> {
    one: Tick<M>,
    lanes: Tick<M::Over<Lanes<F>>>,
}

impl<F: Float, M: Model<N = F>> BatchTick<F> for ModelTicks<F, M> {
    fn evaluate(
        &self,
        first: usize,
        states: StateRows<'_, F>,
        mut results: MotorRows<'_, F>,
        failed: &mut Vec<FailedRow>,
    ) {
        let rows = states.poses.len();
        let mut begin = 0;
        while begin < rows {
            // As many groups of lanes as have results.
            begin = evaluate_lanes(&self.lanes, begin, &states, &mut results);
            let end = rows.min(begin + LANES);
            for row in begin..end {
                match self.one.evaluate(&states.one(row)) {
                    Ok(motion) => results.put(row, &motion.motors),
                    Err(status) => failed.push(FailedRow {
                        row: first + row,
                        status,
                    }),
                }
            }
            begin = end;
        }
    }
}

/// Evaluates groups of rows from `begin` on, up to the first one that has a row without a result. Returns its first row.
#[multiversion(targets("x86_64+avx+avx2"))]
fn evaluate_lanes<F: Float, M: Model<N = Lanes<F>>>(
    tick: &Tick<M>,
    begin: usize,
    states: &StateRows<'_, F>,
    results: &mut MotorRows<'_, F>,
) -> usize {
    let mut begin = begin;
    while begin + LANES <= states.poses.len() {
        let Ok(motion) = tick.evaluate(&states.lanes(begin)) else {
            break;
        };
        results.put_lanes(begin, &motion.motors);
        begin += LANES;
    }
    begin
}

impl<F> StateRows<'_, F> {
    /// Number of the rows.
    ///
    /// # Errors
    /// [`LengthError`].
    pub(crate) fn rows(&self) -> Result<usize, LengthError> {
        let expected = self.poses.len();
        check_length("velocities", self.velocities.len(), expected)?;
        check_length("accelerations", self.accelerations.len(), expected)?;
        Ok(expected)
    }
}

impl<F: Float> StateRows<'_, F> {
    pub(crate) fn one(&self, row: usize) -> Setpoint<F> {
        Setpoint {
            pose: pose_of(self.poses[row]),
            velocity: self.velocities[row].into(),
            acceleration: self.accelerations[row].into(),
        }
    }

    /// The states from row `first` on, one in each lane.
    #[inline(always)]
    fn lanes(&self, first: usize) -> Setpoint<Lanes<F>> {
        let column = |rows: &[[F; 3]], part: usize| Lanes::new(|lane| rows[first + lane][part]);
        let vector = |rows| Vector3::new(column(rows, 0), column(rows, 1), column(rows, 2));
        let pose = vector(self.poses);
        Setpoint {
            pose: Pose {
                position: pose.xy(),
                angle: pose.z,
            },
            velocity: vector(self.velocities),
            acceleration: vector(self.accelerations),
        }
    }
}

impl<F: Float> MotorRows<'_, F> {
    fn put(&mut self, row: usize, motors: &[Motor<F>; 3]) {
        self.angles[row] = motors.map(|motor| motor.angle);
        self.rates[row] = motors.map(|motor| motor.rate);
        self.accelerations[row] = motors.map(|motor| motor.acceleration);
        self.torques[row] = motors.map(|motor| motor.torque);
    }

    #[inline(always)]
    fn put_lanes(&mut self, first: usize, motors: &[Motor<Lanes<F>>; 3]) {
        for lane in 0..LANES {
            for (index, motor) in motors.iter().enumerate() {
                self.angles[first + lane][index] = motor.angle.value(lane);
                self.rates[first + lane][index] = motor.rate.value(lane);
                self.accelerations[first + lane][index] = motor.acceleration.value(lane);
                self.torques[first + lane][index] = motor.torque.value(lane);
            }
        }
    }
}
