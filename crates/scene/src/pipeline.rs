//! The pipeline of a machine behind one object. A scene or a batch row names the kind of model at run
//! time, the types of the core name it at compile time; [`ModelKind::visit`] leads from one to the other.

use crate::record::{LegRecord, Record};
use crate::{JobPlayer, Scene};
use nalgebra::{Vector2, Vector3};
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::model::{Model, ModelKind, ModelVisitor, OfKind};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::tick::{Motion, Motor, Tick};
use trirrr_core::units::Units;

/// Pipeline of one machine in the number type `N`.
pub trait Pipeline<N: Number>: Send + Sync {
    /// Evaluates one setpoint in the units of the machine. The record carries the time `t`, s, and a tool
    /// that is off.
    ///
    /// # Errors
    /// [`Status`] of a setpoint without a motion; [`Status::OutOfRange`] if a value of the record is
    /// not finite.
    fn evaluate(&self, t: f64, setpoint: &Setpoint<N>) -> Result<Record, Status>;

    /// Returns the record of a `motion` that the model of this pipeline computed for `setpoint`.
    ///
    /// # Errors
    /// [`Status::OutOfRange`] if a value of the record is not finite.
    fn record(&self, t: f64, setpoint: &Setpoint<N>, motion: &Motion<N>) -> Result<Record, Status>;

    /// Returns the twelve results that the motors need and computes nothing else: the tick as it runs
    /// on a board.
    ///
    /// # Errors
    /// [`Status`] of a setpoint without a motion.
    fn motors(&self, setpoint: &Setpoint<N>) -> Result<[Motor<N>; 3], Status>;
}

/// Builds the leanest pipeline that computes the torques of `parameters`. Setpoints are in SI units.
///
/// # Errors
/// First quantity of the parameters that is refused.
pub fn build<N: Number>(parameters: &Parameters) -> Result<Box<dyn Pipeline<N>>, BuildError> {
    build_in(parameters, Units::SI)
}

/// Builds as [`build`], for setpoints in `units`. Parameters and results are in SI units.
///
/// # Errors
/// First quantity of the parameters, in `units`, that is refused.
pub fn build_in<N: Number>(
    parameters: &Parameters,
    units: Units,
) -> Result<Box<dyn Pipeline<N>>, BuildError> {
    build_kind(ModelKind::of(parameters, true), parameters, units)
}

/// Builds the pipeline of the machine of `scene` with the model of the scene, for setpoints in `units`.
///
/// # Errors
/// First quantity of the machine, in `units`, that is refused.
pub fn of_scene<N: Number>(
    scene: &Scene,
    units: Units,
) -> Result<Box<dyn Pipeline<N>>, BuildError> {
    build_kind(scene.model(), &scene.parameters, units)
}

/// A scene ready to be evaluated in the number type `N`.
pub struct Job<N: Number> {
    /// Pipeline of the machine.
    pub machine: Box<dyn Pipeline<N>>,
    /// Setpoints of the job, in `units`.
    pub player: JobPlayer<N>,
    /// Units of the machine.
    pub units: Units,
}

/// Builds the machine and the job of `scene` in the number type `N`.
///
/// # Errors
/// First quantity that does not fit the number type.
pub fn scene<N: Number>(scene: &Scene) -> Result<Job<N>, String> {
    let units = crate::units::<N>(scene).map_err(|error| error.to_string())?;
    Ok(Job {
        machine: of_scene(scene, units).map_err(|error| error.to_string())?,
        player: JobPlayer::new(&scene.job.in_units(&units), units.time(scene.period_s())),
        units,
    })
}

fn build_kind<N: Number>(
    kind: ModelKind,
    parameters: &Parameters,
    units: Units,
) -> Result<Box<dyn Pipeline<N>>, BuildError> {
    let parameters = &units.parameters(parameters);
    kind.visit(Build {
        machine: kind.with(parameters),
        units,
    })
}

struct Build<'a> {
    machine: OfKind<'a>,
    units: Units,
}

impl<N: Number> ModelVisitor<N> for Build<'_> {
    type Output = Result<Box<dyn Pipeline<N>>, BuildError>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        let tick = Tick::<M>::build(self.machine)?;
        let length = self.units.length_m();
        let bases = tick.geometry().legs().each_ref();
        let recorder = Recorder {
            distances: Distances::build(self.machine.parameters),
            units: self.units,
            bases: bases.map(|leg| pair(leg.base(), length)),
        };
        Ok(Box::new(ModelPipeline { tick, recorder }))
    }
}

struct ModelPipeline<M: Model> {
    tick: Tick<M>,
    recorder: Recorder<M::N>,
}

/// Turns motions into records. Its code is compiled for each number type, not for each model.
struct Recorder<N: Number> {
    distances: Distances<N>,
    units: Units,
    /// Base joints, m.
    bases: [[f64; 2]; 3],
}

impl<N: Number, M: Model<N = N>> Pipeline<N> for ModelPipeline<M> {
    fn evaluate(&self, t: f64, setpoint: &Setpoint<N>) -> Result<Record, Status> {
        self.record(t, setpoint, &self.motion(setpoint)?)
    }

    fn record(&self, t: f64, setpoint: &Setpoint<N>, motion: &Motion<N>) -> Result<Record, Status> {
        self.recorder.record(t, setpoint, motion)
    }

    fn motors(&self, setpoint: &Setpoint<N>) -> Result<[Motor<N>; 3], Status> {
        self.motion(setpoint).map(|motion| motion.motors)
    }
}

impl<M: Model> ModelPipeline<M> {
    // In WebAssembly size counts, and there are as many copies as models: one is not part of both callers.
    #[cfg_attr(target_arch = "wasm32", inline(never))]
    fn motion(&self, setpoint: &Setpoint<M::N>) -> Result<Motion<M::N>, Status> {
        self.tick.evaluate(setpoint)
    }
}

impl<N: Number> Recorder<N> {
    fn record(&self, t: f64, setpoint: &Setpoint<N>, motion: &Motion<N>) -> Result<Record, Status> {
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
                base: self.bases[i],
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
}

fn pair<N: Number>(vector: Vector2<N>, unit: f64) -> [f64; 2] {
    vector.map(|part| part.to_f64() * unit).into()
}

fn triple<N: Number>(vector: Vector3<N>, linear: f64, angular: f64) -> [f64; 3] {
    let [x, y, alpha] = vector.map(N::to_f64).into();
    [x * linear, y * linear, alpha * angular]
}
