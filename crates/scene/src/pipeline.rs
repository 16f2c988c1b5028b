//! The pipeline behind one object: the core's types say what a machine holds, a scene or a batch
//! row says it at run time, and here the one is chosen by the other.

use crate::record::{LegRecord, Record};
use crate::{JobPlayer, Scene};
use nalgebra::{Vector2, Vector3};
use trirrr_core::machine::{BuildError, LinksKind, Parameters, PayloadKind};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::{Motor, Tick};
use trirrr_core::torque::links::{Horizontal, InPlane, Links, Massive, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset, Payload, PositionOnly};
use trirrr_core::units::Units;

/// The pipeline of one machine in the number type `N`.
pub trait Pipeline<N: Number>: Send + Sync {
    /// Evaluates one setpoint, given in the machine's units. The record's time is `t`, which nothing is computed from; its tool is
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

/// Builds the pipeline that has room for what `parameters` hold, and for nothing else. Setpoints
/// are in SI units.
///
/// # Errors
/// The first quantity of the parameters that is refused.
pub fn build<N: Number>(parameters: &Parameters) -> Result<Box<dyn Pipeline<N>>, BuildError> {
    build_in(parameters, Units::SI)
}

/// As [`build`], for setpoints in `units`; `parameters` and what comes out are in SI units.
///
/// # Errors
/// The first quantity of the parameters, in `units`, that is refused.
pub fn build_in<N: Number>(
    parameters: &Parameters,
    units: Units,
) -> Result<Box<dyn Pipeline<N>>, BuildError> {
    let parameters = &units.parameters(parameters);
    match PayloadKind::of(parameters) {
        PayloadKind::Centred => with_payload::<N, Centred<N>>(parameters, units),
        PayloadKind::Offset => with_payload::<N, Offset<N>>(parameters, units),
    }
}

/// A scene ready to be played in the number type `N`: its machine, and its job in the units that
/// the number type needs.
pub struct Played<N: Number> {
    /// The machine.
    pub machine: Box<dyn Pipeline<N>>,
    /// The setpoints, in `units`.
    pub player: JobPlayer<N>,
    /// What 1 stands for.
    pub units: Units,
}

/// Builds the machine and the job of `scene` in the number type `N`.
///
/// # Errors
/// The first quantity that does not fit the number type.
pub fn scene<N: Number>(scene: &Scene) -> Result<Played<N>, String> {
    let units = crate::units::<N>(scene).map_err(|error| error.to_string())?;
    let machine = match scene.torque {
        true => build_in(&scene.parameters, units),
        false => {
            let parameters = units.parameters(&scene.parameters);
            Machine::<N, PositionOnly, Massless>::boxed(&parameters, units)
        }
    };
    Ok(Played {
        machine: machine.map_err(|error| error.to_string())?,
        player: JobPlayer::new(&scene.job.in_units(&units), units.time(scene.period_s())),
        units,
    })
}

fn with_payload<N, P>(
    parameters: &Parameters,
    units: Units,
) -> Result<Box<dyn Pipeline<N>>, BuildError>
where
    N: Number,
    P: Payload<N> + Send + Sync + 'static,
{
    match LinksKind::of(parameters) {
        LinksKind::Massless => Machine::<N, P, Massless>::boxed(parameters, units),
        LinksKind::Rotors => Machine::<N, P, Rotors<N>>::boxed(parameters, units),
        LinksKind::MassiveHorizontal => {
            Machine::<N, P, Massive<N, Horizontal>>::boxed(parameters, units)
        }
        LinksKind::MassiveInPlane => {
            Machine::<N, P, Massive<N, InPlane<N>>>::boxed(parameters, units)
        }
    }
}

struct Machine<N: Number, P: Payload<N>, L> {
    tick: Tick<N, P, L>,
    distances: Distances<N>,
    units: Units,
}

impl<N, P, L> Machine<N, P, L>
where
    N: Number,
    P: Payload<N> + Send + Sync + 'static,
    L: Links<N> + Send + Sync + 'static,
{
    fn boxed(parameters: &Parameters, units: Units) -> Result<Box<dyn Pipeline<N>>, BuildError> {
        Ok(Box::new(Self {
            tick: Tick::build(parameters)?,
            distances: Distances::build(parameters),
            units,
        }))
    }
}

impl<N, P, L> Pipeline<N> for Machine<N, P, L>
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
        // Powers of two: what is multiplied by them keeps its digits.
        let units = &self.units;
        let (length, rate) = (units.length_m(), units.rate_rad_s());
        let acceleration = units.acceleration_rad_s2();
        let leg = |i: usize| {
            let (motor, leg) = (&motion.motors[i], &motion.legs[i]);
            let links = &leg.position.links;
            LegRecord {
                th1: N::angle_to_f64(motor.angle),
                th2: N::angle_to_f64(leg.position.distal_angle()),
                dth1: motor.rate.to_f64() * rate,
                dth2: leg.rates.distal.to_f64() * rate,
                ddth1: motor.acceleration.to_f64() * acceleration,
                ddth2: leg.accelerations.distal.to_f64() * acceleration,
                torque: motor.torque.to_f64() * units.torque_nm(),
                power: powers[i].to_f64() * units.power_w(),
                cross: links.r1_cross_r2.to_f64() * (length * length),
                serial: serial[i].to_f64(),
                base: pair(self.tick.geometry().legs[i].base, length),
                r1: pair(links.r1, length),
                r2: pair(links.r2, length),
            }
        };
        let [x, y] = pair(setpoint.pose.position, length);
        let record = Record {
            t,
            pose: [x, y, N::angle_to_f64(setpoint.pose.angle)],
            velocity: triple(setpoint.velocity, units.of(1, -1, 0), rate),
            acceleration: triple(setpoint.acceleration, units.of(1, -2, 0), acceleration),
            legs: [leg(0), leg(1), leg(2)],
            det_a: motion.forces.det_a.to_f64() * units.of(4, 0, 0),
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

fn pair<N: Number>(vector: Vector2<N>, unit: f64) -> [f64; 2] {
    vector.map(|part| part.to_f64() * unit).into()
}

fn triple<N: Number>(vector: Vector3<N>, linear: f64, angular: f64) -> [f64; 3] {
    let [x, y, alpha] = vector.map(N::to_f64).into();
    [x * linear, y * linear, alpha * angular]
}
