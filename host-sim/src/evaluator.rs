//! The pipeline behind one object: the core's types say what a machine holds, a scene or a batch
//! row says it at run time, and here the one is chosen by the other.

use crate::record::{LegRecord, Record};
use nalgebra::{Vector2, Vector3};
use trirrr_core::machine::{BuildError, LinksKind, Parameters, PayloadKind};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::{Motor, Tick};
use trirrr_core::torque::links::{Horizontal, InPlane, Links, Massive, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset, Payload};

/// The pipeline of one machine in the number type `N`.
pub trait Evaluator<N: Number>: Send + Sync {
    /// Evaluates one setpoint. The record's time is `t`, which nothing is computed from; its tool is
    /// off.
    ///
    /// # Errors
    /// The [`Status`] that leaves the setpoint without a motion, [`Status::OutOfRange`] where any
    /// value of the record would not be finite.
    fn evaluate(&self, t: f64, setpoint: &Setpoint<N>) -> Result<Record, Status>;

    /// The twelve results that the motors need, and nothing else is computed: the tick as it runs
    /// on a target.
    ///
    /// # Errors
    /// The [`Status`] that leaves the setpoint without a motion.
    fn motors(&self, setpoint: &Setpoint<N>) -> Result<[Motor<N>; 3], Status>;
}

/// Builds the pipeline that has room for what `parameters` hold, and for nothing else.
///
/// # Errors
/// The first quantity of the parameters that is refused.
pub fn build<N: Number>(parameters: &Parameters) -> Result<Box<dyn Evaluator<N>>, BuildError> {
    match PayloadKind::of(parameters) {
        PayloadKind::Centred => with_payload::<N, Centred<N>>(parameters),
        PayloadKind::Offset => with_payload::<N, Offset<N>>(parameters),
    }
}

fn with_payload<N, P>(parameters: &Parameters) -> Result<Box<dyn Evaluator<N>>, BuildError>
where
    N: Number,
    P: Payload<N> + Send + Sync + 'static,
{
    match LinksKind::of(parameters) {
        LinksKind::Massless => Machine::<N, P, Massless>::boxed(parameters),
        LinksKind::Rotors => Machine::<N, P, Rotors<N>>::boxed(parameters),
        LinksKind::MassiveHorizontal => Machine::<N, P, Massive<N, Horizontal>>::boxed(parameters),
        LinksKind::MassiveInPlane => Machine::<N, P, Massive<N, InPlane<N>>>::boxed(parameters),
    }
}

struct Machine<N: Number, P, L> {
    tick: Tick<N, P, L>,
    distances: Distances<N>,
}

impl<N, P, L> Machine<N, P, L>
where
    N: Number,
    P: Payload<N> + Send + Sync + 'static,
    L: Links<N> + Send + Sync + 'static,
{
    fn boxed(parameters: &Parameters) -> Result<Box<dyn Evaluator<N>>, BuildError> {
        Ok(Box::new(Self {
            tick: Tick::build(parameters)?,
            distances: Distances::build(parameters),
        }))
    }
}

impl<N, P, L> Evaluator<N> for Machine<N, P, L>
where
    N: Number,
    P: Payload<N> + Send + Sync,
    L: Links<N> + Send + Sync,
{
    fn evaluate(&self, t: f64, setpoint: &Setpoint<N>) -> Result<Record, Status> {
        let motion = self.tick.evaluate(setpoint)?;
        let powers = motion.powers()?;
        let position = motion.position();
        let serial = self.distances.serial(&position);
        let leg = |i: usize| {
            let (motor, leg) = (&motion.motors[i], &motion.legs[i]);
            let links = &leg.position.links;
            LegRecord {
                th1: N::angle_to_f64(motor.angle),
                th2: N::angle_to_f64(leg.position.distal_angle()),
                dth1: motor.rate.to_f64(),
                dth2: leg.rates.distal.to_f64(),
                ddth1: motor.acceleration.to_f64(),
                ddth2: leg.accelerations.distal.to_f64(),
                torque: motor.torque.to_f64(),
                power: powers[i].to_f64(),
                cross: links.r1_cross_r2.to_f64(),
                serial: serial[i].to_f64(),
                base: pair(self.tick.geometry().legs[i].base),
                r1: pair(links.r1),
                r2: pair(links.r2),
            }
        };
        let [x, y] = pair(setpoint.pose.position);
        let record = Record {
            t,
            pose: [x, y, N::angle_to_f64(setpoint.pose.angle)],
            velocity: triple(setpoint.velocity),
            acceleration: triple(setpoint.acceleration),
            legs: [leg(0), leg(1), leg(2)],
            det_a: motion.forces.det_a.to_f64(),
            parallel: self.distances.parallel(&position).to_f64(),
            tool: 0.0,
        };
        if record.is_finite() {
            Ok(record)
        } else {
            Err(Status::OutOfRange)
        }
    }

    fn motors(&self, setpoint: &Setpoint<N>) -> Result<[Motor<N>; 3], Status> {
        self.tick.evaluate(setpoint).map(|motion| motion.motors)
    }
}

fn pair<N: Number>(vector: Vector2<N>) -> [f64; 2] {
    vector.map(N::to_f64).into()
}

fn triple<N: Number>(vector: Vector3<N>) -> [f64; 3] {
    vector.map(N::to_f64).into()
}
