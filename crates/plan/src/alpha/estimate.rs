//! Estimate of the pace at a place of the path, for any change of alpha along it.

use crate::cell::{Limited, Obstacle};
use crate::piece::PathPoint;
use nalgebra::Vector3;
use trirrr_core::limits::Limits;
use trirrr_core::machine::BuildError;
use trirrr_core::model::{Model, OfKind};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::singularity::Distances;
use trirrr_core::tick::{Motion, Tick};

/// Part of the time that a unit of inverse distance from a singularity counts.
const SINGULAR: f64 = 1e-3;

/// The machine at single poses.
pub struct Sampler<M: Model<N = f64>> {
    tick: Tick<M>,
    distances: Distances<f64>,
    limits: Limits<f64>,
    ramp: f64,
    lever_m: f64,
}

/// A quadratic in the change of alpha along the path.
type Quadratic = [f64; 3];

fn value([c0, c1, c2]: Quadratic, slope: f64) -> f64 {
    c0 + (c1 + c2 * slope) * slope
}

/// The quadratic through its values at -1, 0 and 1.
fn quadratic([minus, zero, plus]: [f64; 3]) -> Quadratic {
    [zero, 0.5 * (plus - minus), 0.5 * (plus + minus) - zero]
}

/// Coefficients of one motor.
#[derive(Clone, Copy, Debug)]
struct MotorTerms {
    rate: Quadratic,
    acceleration: Quadratic,
    /// Torques for an acceleration along the path, for the square of the pace, and at rest.
    starting: Quadratic,
    moving: Quadratic,
    resting: f64,
}

/// A pose of the path with all that a choice of the direction needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    motors: [MotorTerms; 3],
    /// Speed of D for a pace of 1.
    speed: f64,
    feed: f64,
    /// Factor of the time, 1 far from singularities.
    weight: f64,
}

impl<M: Model<N = f64>> Sampler<M> {
    /// Builds the coefficients. `ramp`: rate at which a hold may change the pace.
    ///
    /// # Errors
    /// The first quantity of the machine that is refused.
    pub fn build<'a>(
        machine: impl Into<OfKind<'a>>,
        limits: Limits<f64>,
        ramp: f64,
    ) -> Result<Self, BuildError> {
        let machine = machine.into();
        let parameters = machine.parameters;
        let radii = parameters.legs.iter().map(|leg| leg.joint_radius_m);
        Ok(Self {
            tick: Tick::build(machine)?,
            distances: Distances::build(parameters),
            limits,
            ramp,
            lever_m: radii.fold(0.0, f64::max),
        })
    }

    /// Sign of det A at `pose`; positive where there is none.
    pub(crate) fn side(&self, pose: Pose<f64>) -> bool {
        let motion = self.motion(pose, [Vector3::zeros(); 2]);
        motion.is_ok_and(|motion| self.signed_parallel(&motion) > 0.0)
    }

    fn signed_parallel(&self, motion: &Motion<f64>) -> f64 {
        let legs = motion.legs.each_ref();
        self.distances
            .signed_parallel_of(legs.map(|leg| &leg.position))
    }

    fn motion(
        &self,
        pose: Pose<f64>,
        [velocity, acceleration]: [Vector3<f64>; 2],
    ) -> Result<Motion<f64>, Obstacle> {
        let setpoint = Setpoint {
            pose,
            velocity,
            acceleration,
        };
        self.tick.evaluate(&setpoint).map_err(Obstacle::of)
    }

    /// Samples `point` of a path without its change of alpha; distances are to be `margin` of themselves greater than
    /// their least. `feed`: greatest speed of D; `side`: sign of det A on the path.
    ///
    /// # Errors
    /// The obstacle.
    pub(crate) fn sample(
        &self,
        point: &PathPoint<f64>,
        feed: Option<f64>,
        side: bool,
        margin: f64,
    ) -> Result<Sample, Obstacle> {
        let zero = Vector3::zeros();
        let standing = self.motion(point.pose, [zero, zero])?;
        let serial = self.distances.serial(&standing.position());
        let parallel = self.signed_parallel(&standing);
        for (leg, distance) in serial.iter().enumerate() {
            if !(*distance >= self.limits.serial_distance * (1.0 + margin)) {
                return Err(Obstacle::SerialDistance(leg));
            }
        }
        if !(parallel.abs() >= self.limits.parallel_distance * (1.0 + margin))
            || side != (parallel > 0.0)
        {
            return Err(Obstacle::ParallelDistance);
        }
        let resting = standing.motors.map(|motor| motor.torque);
        if let Some(limits) = self.limits.torque {
            for motor in 0..3 {
                if !(resting[motor].abs() < limits[motor]) {
                    return Err(Obstacle::Standing(Limited::Torque(motor)));
                }
            }
        }
        let along = |slope| Vector3::new(point.first.x, point.first.y, slope);
        let bend = Vector3::new(point.second.x, point.second.y, 0.0);
        let slopes = [-1.0, 0.0, 1.0];
        let mut moving = [standing; 3];
        let mut starting = [standing; 3];
        for (index, slope) in slopes.into_iter().enumerate() {
            moving[index] = self.motion(point.pose, [along(slope), bend])?;
            starting[index] = self.motion(point.pose, [zero, along(slope)])?;
        }
        let terms = |motor: usize| MotorTerms {
            rate: quadratic(moving.map(|motion| motion.motors[motor].rate)),
            acceleration: quadratic(moving.map(|motion| motion.motors[motor].acceleration)),
            starting: quadratic(
                starting.map(|motion| motion.motors[motor].torque - resting[motor]),
            ),
            moving: quadratic(moving.map(|motion| motion.motors[motor].torque - resting[motor])),
            resting: resting[motor],
        };
        let inverse: f64 = serial.iter().map(|distance| distance.recip()).sum();
        Ok(Sample {
            motors: [0, 1, 2].map(terms),
            speed: libm::hypot(point.first.x, point.first.y),
            feed: feed.unwrap_or(f64::INFINITY),
            weight: 1.0 + SINGULAR * (inverse + parallel.abs().recip()),
        })
    }

    /// Time for a unit of p at `sample` while alpha changes by `slope` for a unit of p, `to_stop` units of p from the
    /// nearest stop. A turn of the platform's joints as long as D's way adds the part `turning` to it.
    pub(crate) fn time(&self, sample: &Sample, slope: f64, to_stop: f64, turning: f64) -> f64 {
        let mut pace = sample.feed / sample.speed;
        // Greatest acceleration from rest.
        let mut start = f64::INFINITY;
        // bend u^2 + ramp along u <= room.
        let mut keep = |room: f64, along: f64, bend: f64| {
            let (hold, bend) = (self.ramp * along.abs(), bend.abs());
            let root = (hold * hold + 4.0 * bend * room).sqrt();
            start = start.min(room / along.abs());
            2.0 * room / (hold + root)
        };
        for (index, motor) in sample.motors.iter().enumerate() {
            let rate = value(motor.rate, slope);
            if let Some(limits) = self.limits.rate {
                pace = pace.min(limits[index] / rate.abs());
            }
            if let Some(limits) = self.limits.acceleration {
                pace = pace.min(keep(limits[index], rate, value(motor.acceleration, slope)));
            }
            let (starting, moving) = (value(motor.starting, slope), value(motor.moving, slope));
            let resting = motor.resting.abs();
            if let Some(limits) = self.limits.torque {
                pace = pace.min(keep(limits[index] - resting, starting, moving));
            }
            if let Some(limits) = self.limits.power {
                let (still, fast) = (limits[index] / (resting * rate).abs(), moving * rate);
                pace = pace.min(still).min(libm::cbrt(limits[index] / fast.abs()));
            }
        }
        let pace = pace.min((2.0 * start * to_stop).sqrt());
        let turned = self.lever_m * slope / sample.speed;
        sample.weight * (1.0 + turning * turned * turned) / pace
    }
}
