//! Commands and motions of the drives side by side: a row for each sample of the drives.
//!
//! A reading is put beside the command of its own tick: that of the tick before, or as much older as the reading is. Where a line
//! carries fewer samples, the command goes on at constant acceleration from the nearest sample.

use crate::describe::Units;
use nalgebra::Vector3;
use std::collections::VecDeque;
use trirrr_core::forward::Forward;
use trirrr_core::machine::{BuildError, Geometry};
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::{Pose, shorter_way};
use trirrr_core::tick::{Motor, Tick};
use trirrr_core::torque::links::{InPlane, Massive};
use trirrr_core::torque::payload::Offset;
use trirrr_protocol::message::{DriveReading, DriveSample, Telemetry, Transmit};
use trirrr_scene::{Contact, Scene};
use trirrr_service::coefficients::ContactCoefficients;
use trirrr_service::features::{ContactModel, ContactObserver};

/// Model with room for every scene.
type GeneralModel = Dynamic<f64, Offset<f64>, Massive<f64, InPlane<f64>>>;

/// Samples of the commands that are kept: readings are seldom older.
const KEPT: usize = 64;

/// Newton steps to a pose, from the commanded one: a few suffice.
const MOST_STEPS: u32 = 24;

/// Angle, rate and torque of a joint, SI.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointState {
    /// Angle, rad.
    pub angle: f64,
    /// Rate, rad/s.
    pub rate: f64,
    /// Torque of the motor, N m.
    pub torque: f64,
}

/// Sample of the drives beside their commands, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveRecord {
    /// Time since the start of the job, s.
    pub t: f64,
    /// Commands, each of the tick that its reading tells of.
    pub commanded: [JointState; 3],
    /// Readings.
    pub measured: [JointState; 3],
    /// Pose of the platform at the measured angles, by forward kinematics: x, y in m, alpha in rad; none where there is no
    /// such pose near the commanded one.
    pub pose: Option<[f64; 3]>,
    /// Distance of this pose from the commanded one, m, and in angle, rad.
    pub off: Option<[f64; 2]>,
    /// Torques by which the surroundings act on the joints, N m: commanded less measured, without what accelerates a joint off
    /// its command. Friction is among them.
    pub external: [f64; 3],
    /// Force at D along x and y, N, and moment about D, N m, by the observer of contacts.
    pub wrench: [f64; 3],
}

impl DriveRecord {
    /// Names of the columns of [`row`](Self::row).
    pub const COLUMNS: &str = "t,cmd_th1_1,cmd_th1_2,cmd_th1_3,cmd_dth1_1,cmd_dth1_2,cmd_dth1_3,cmd_tau1,cmd_tau2,cmd_tau3,\
        th1_1,th1_2,th1_3,dth1_1,dth1_2,dth1_3,tau1,tau2,tau3,x,y,alpha,off_m,off_rad,\
        ext_tau1,ext_tau2,ext_tau3,ext_fx,ext_fy,ext_moment";

    /// Row of a CSV table. A pose that is not known leaves its cells empty.
    pub fn row(&self) -> String {
        let states = [&self.commanded, &self.measured]
            .into_iter()
            .flat_map(|joints| {
                let angles = joints.iter().map(|joint| joint.angle);
                let rates = joints.iter().map(|joint| joint.rate);
                angles
                    .chain(rates)
                    .chain(joints.iter().map(|joint| joint.torque))
            });
        let known = |values: &[f64]| values.iter().map(|value| Some(*value)).collect::<Vec<_>>();
        let pose = self.pose.map_or(vec![None; 3], |pose| known(&pose));
        let off = self.off.map_or(vec![None; 2], |off| known(&off));
        let cells = std::iter::once(Some(self.t))
            .chain(states.map(Some))
            .chain(pose)
            .chain(off)
            .chain(self.external.iter().chain(&self.wrench).copied().map(Some));
        let cells = cells.map(|cell| cell.map_or(String::new(), |value| format!("{value:?}")));
        cells.collect::<Vec<_>>().join(",")
    }
}

/// Command of a tick, SI.
struct CommandedTick {
    tick: u32,
    motors: [Motor<f64>; 3],
    pose: Pose<f64>,
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
}

/// Turns samples of the drives of one job into records.
pub struct DriveSamples<N: Transmit> {
    units: Units,
    forward: Forward<f64>,
    tick: Tick<GeneralModel>,
    coefficients: Option<ContactCoefficients<f64>>,
    observer: ContactObserver<f64>,
    late_ticks: u32,
    /// Ticks from one sample to the next.
    every: u16,
    /// Tick of the machine at which the job started.
    start: Option<u32>,
    commands: VecDeque<CommandedTick>,
    waiting: VecDeque<DriveSample<N>>,
    last: Option<u32>,
}

impl<N: Transmit> DriveSamples<N> {
    /// Takes samples of the machine of `scene` in `units`, one every `every` ticks. `None` for drives that tell nothing.
    ///
    /// # Errors
    /// A machine that the scene's reader would have refused.
    pub fn new(scene: &Scene, units: Units, every: u16) -> Result<Option<Self>, BuildError> {
        let drives = scene.drives.as_ref();
        let Some(drive) = drives
            .map(|[drive, ..]| drive)
            .filter(|drive| drive.measures())
        else {
            return Ok(None);
        };
        let geometry = Geometry::<f64>::build(&scene.parameters)?;
        let contact = scene
            .contact
            .unwrap_or_else(|| Contact::estimating(scene.tick_rate_hz, drive));
        let mut parameters = contact.parameters(scene.tick_rate_hz);
        let every = every.max(1);
        // The observer takes a sample for a tick.
        parameters.told_after /= f64::from(every);
        let period_s = scene.period_s() * f64::from(every);
        Ok(Some(Self {
            units,
            forward: Forward::build(&scene.parameters, &geometry),
            tick: Tick::build(&scene.parameters)?,
            coefficients: ContactCoefficients::build(&parameters, period_s)
                .filter(|_| scene.torque),
            observer: ContactObserver::AT_REST,
            late_ticks: parameters.late_ticks.into(),
            every,
            start: None,
            commands: VecDeque::new(),
            waiting: VecDeque::new(),
            last: None,
        }))
    }

    /// Takes the telemetry sample of a tick of the job.
    pub fn command(&mut self, sample: &Telemetry<N>) {
        self.start
            .get_or_insert(sample.tick.wrapping_sub(sample.at));
        if self.commands.len() == KEPT {
            self.commands.pop_front();
        }
        let (length, rate) = (self.units.length_m, 1.0 / self.units.time_s);
        let torque = self.units.mass_kg * (length * rate) * (length * rate);
        let scaled = |values: Vector3<N>, by: f64| {
            let values: [N; 3] = values.into();
            in_si(values.map(N::to_f64), length, by)
        };
        let setpoint = &sample.setpoint;
        let position = setpoint.pose.position.map(|value| value.to_f64() * length);
        self.commands.push_back(CommandedTick {
            tick: sample.tick,
            motors: [0, 1, 2].map(|i| Motor {
                angle: N::angle_to_f64(sample.angles[i]),
                rate: sample.rates[i].to_f64() * rate,
                acceleration: sample.accelerations[i].to_f64() * rate * rate,
                torque: sample.torques[i].to_f64() * torque,
            }),
            pose: Pose {
                position,
                angle: N::angle_to_f64(setpoint.pose.angle),
            },
            velocity: scaled(setpoint.velocity, rate),
            acceleration: scaled(setpoint.acceleration, rate * rate),
        });
    }

    /// Takes a sample of the drives.
    pub fn drives(&mut self, sample: &DriveSample<N>) {
        self.waiting.push_back(*sample);
    }

    /// Returns the next record. A sample waits for the command of its own tick; one of before the job is dropped.
    pub fn next_record(&mut self) -> Option<DriveRecord> {
        loop {
            let newest = self.commands.back()?.tick;
            let start = self.start?;
            let sample = self.waiting.front()?;
            if sample.tick.wrapping_sub(newest) as i32 > 0 {
                return None;
            }
            let sample = self.waiting.pop_front()?;
            if sample.tick.wrapping_sub(start) as i32 > 0 {
                return Some(self.record(&sample, start));
            }
        }
    }

    fn record(&mut self, sample: &DriveSample<N>, start: u32) -> DriveRecord {
        // The readings of a tick tell of the command before it.
        let before = sample.tick.wrapping_sub(1 + self.late_ticks);
        let told = |reading: &DriveReading<N>| before.wrapping_sub(reading.age.into());
        let commands = [0, 1, 2].map(|i| self.motor(i, told(&sample.drives[i])));
        let measured = sample
            .drives
            .each_ref()
            .map(|reading| self.measured(reading));
        let oldest = sample.drives.iter().map(|reading| reading.age).max();
        let place = self.place(before.wrapping_sub(oldest.unwrap_or(0).into()));
        let angles = measured.map(|joint| joint.angle);
        let found = self.forward.solve(&angles, place, MOST_STEPS).ok();
        // Another assembly mode is no place of this platform.
        let side = |pose: &Pose<f64>| self.forward.side(&angles, pose);
        let found = found
            .map(|found| found.pose)
            .filter(|pose| side(pose) == side(&place));
        let off = found.map(|pose| {
            let way = pose.position - place.position;
            [
                way.x.hypot(way.y),
                shorter_way::<f64>(pose.angle - place.angle),
            ]
        });
        let follows = self
            .last
            .is_some_and(|last| sample.tick.wrapping_sub(last) == u32::from(self.every));
        self.last = Some(sample.tick);
        let mut wrench = [0.0; 3];
        let mut external = [0.0; 3];
        if let Some(coefficients) = &self.coefficients {
            external = [0, 1, 2].map(|i| commands[i].torque - measured[i].torque);
            if let Some(model) = ContactModel::at(&self.tick, place, coefficients) {
                let told = measured.map(|joint| [joint.rate, joint.torque]);
                let deviations = coefficients.deviations(&told, &commands);
                if !follows {
                    self.observer = ContactObserver::starting(&model, &deviations);
                }
                let torques = self.observer.observe(coefficients, &model, &deviations);
                wrench = model.at_tool(&torques);
            }
        }
        DriveRecord {
            t: f64::from(sample.tick.wrapping_sub(start)) / self.units.tick_rate_hz,
            commanded: commands.map(|motor| JointState {
                angle: motor.angle,
                rate: motor.rate,
                torque: motor.torque,
            }),
            measured,
            pose: found.map(|pose| [pose.position.x, pose.position.y, pose.angle]),
            off,
            external,
            wrench,
        }
    }

    /// Reading in SI units.
    fn measured(&self, reading: &DriveReading<N>) -> JointState {
        let (length, rate) = (self.units.length_m, 1.0 / self.units.time_s);
        JointState {
            angle: N::angle_to_f64(reading.angle),
            rate: reading.rate.to_f64() * rate,
            torque: reading.torque.to_f64()
                * self.units.mass_kg
                * (length * rate)
                * (length * rate),
        }
    }

    /// Sample of the commands nearest to `tick`, and the time from there, s.
    fn nearest(&self, tick: u32) -> Option<(&CommandedTick, f64)> {
        let ticks = |command: &CommandedTick| tick.wrapping_sub(command.tick) as i32;
        let nearest = self
            .commands
            .iter()
            .min_by_key(|each| ticks(each).unsigned_abs());
        nearest.map(|each| (each, f64::from(ticks(each)) / self.units.tick_rate_hz))
    }

    /// Command of motor `index` in `tick`.
    fn motor(&self, index: usize, tick: u32) -> Motor<f64> {
        let Some((command, dt)) = self.nearest(tick) else {
            return Motor {
                angle: 0.0,
                rate: 0.0,
                acceleration: 0.0,
                torque: 0.0,
            };
        };
        let motor = command.motors[index];
        Motor {
            angle: motor.angle + dt * (motor.rate + 0.5 * dt * motor.acceleration),
            rate: motor.rate + dt * motor.acceleration,
            ..motor
        }
    }

    /// Commanded pose in `tick`.
    fn place(&self, tick: u32) -> Pose<f64> {
        let Some((command, dt)) = self.nearest(tick) else {
            return Pose::from_f64(0.0, 0.0, 0.0);
        };
        command.pose_after(dt)
    }
}

impl CommandedTick {
    /// Pose `dt` s later, at constant acceleration.
    fn pose_after(&self, dt: f64) -> Pose<f64> {
        let way = (self.velocity + self.acceleration * (0.5 * dt)) * dt;
        Pose {
            position: self.pose.position + way.xy(),
            angle: self.pose.angle + way.z,
        }
    }
}

/// Velocity or acceleration of the platform: x and y in units of `length`, all in `per_time`. Angles have no unit of length.
fn in_si([x, y, turn]: [f64; 3], length: f64, per_time: f64) -> Vector3<f64> {
    Vector3::new(x * length, y * length, turn) * per_time
}
