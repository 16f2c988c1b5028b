//! Commands of the motors: held from sample to sample, or by a controller that acts at every instant.

use crate::mechanics::Mechanics;
use crate::motor::{MotorModel, Winding, wrapped};
use crate::path::JobPath;
use crate::power_stage::DriveLimit;
use crate::refusal::Refusal;
use crate::scalar::Differentiable;
use trirrr_scene::pipeline::{self, Pipeline};
use trirrr_scene::{Controller, Scene};

/// Measurement of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured<T = f64> {
    /// Angle at the joint, rad, in -pi to pi.
    pub angle: T,
    /// Rate at the joint, rad/s.
    pub rate: T,
}

/// Commands of the drives at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Commands {
    /// Command of each motor until the next sample: torque in N m, voltage in V, or the angle of
    /// the field in rad at the joint from where it started.
    pub held: [f64; 3],
    /// Reference angle of each joint at this instant, rad.
    pub angle: [f64; 3],
    /// The limit of each drive that acts.
    pub limited: [Option<DriveLimit>; 3],
}

/// Reference of a joint: angle, rate, and torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointReference {
    /// rad.
    pub angle: f64,
    /// rad/s.
    pub rate: f64,
    /// N m, rotors included.
    pub torque: f64,
}

/// A controller that acts at every instant, its setpoints at every instant of the job.
pub struct Continuous {
    path: JobPath,
    /// The move under way: a mode, switched by events. Past the last, the end of the job is held.
    under_way: usize,
    mechanics: Mechanics,
    /// Only where torques are fed forward.
    pipeline: Option<Box<dyn Pipeline<f64>>>,
    controller: Controller,
    /// Limits that act in each motor: a mode, switched by events.
    pub limited: [Limited; 3],
}

/// Limits that act in a motor, with the sign of what they limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limited {
    /// +1 or -1 where the current is limited.
    pub current: Option<f64>,
    /// +1 or -1 where the voltage is limited.
    pub voltage: Option<f64>,
}

/// Margins of a motor's command: zero where a limit begins or ends to act, positive beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// i^2 / limit^2 - 1.
    pub current: f64,
    /// u^2 / supply^2 - 1.
    pub voltage: f64,
}

impl Continuous {
    /// The controller of `scene`, which follows its job from t = 0.
    ///
    /// # Errors
    /// A machine that the core refuses.
    pub fn build(scene: &Scene, controller: Controller) -> Result<Self, Refusal> {
        let pipeline = match controller.feed_forward {
            true => Some(
                pipeline::build::<f64>(&scene.parameters)
                    .map_err(|error| Refusal::Machine(error.to_string()))?,
            ),
            false => None,
        };
        Ok(Self {
            path: JobPath::new(scene),
            under_way: 0,
            mechanics: Mechanics::build(&scene.parameters, true)?,
            pipeline,
            controller,
            limited: Default::default(),
        })
    }

    /// End of the move under way, s; `None` after the last.
    pub fn segment_end(&self) -> Option<f64> {
        self.path.end_of(self.under_way)
    }

    /// Goes on to the next move.
    pub fn next_segment(&mut self) {
        self.under_way += 1;
    }

    /// References of the joints at `t` seconds; the torque is 0 where it is not fed forward, for it takes
    /// longer than everything else.
    ///
    /// # Errors
    /// [`Refusal::Setpoint`].
    pub fn references(&self, t: f64) -> Result<[JointReference; 3], Refusal> {
        let setpoint = self.path.in_move(self.under_way, t);
        let Some(pipeline) = &self.pipeline else {
            let pose = &setpoint.pose;
            let q = [pose.position.x, pose.position.y, pose.angle];
            let legs = self
                .mechanics
                .configuration(None, q, setpoint.velocity.into())
                .map_err(Refusal::Setpoint)?
                .legs;
            return Ok([0, 1, 2].map(|leg| JointReference {
                angle: self.mechanics.motor_angle(leg, &legs[leg]),
                rate: legs[leg].rates[0],
                torque: 0.0,
            }));
        };
        let motors = pipeline.motors(&setpoint).map_err(Refusal::Setpoint)?;
        Ok(motors.map(|motor| JointReference {
            angle: motor.angle,
            rate: motor.rate,
            torque: motor.torque,
        }))
    }

    /// Torque wanted of motor `index`, before any limit.
    #[inline]
    fn torque<T: Differentiable>(
        &self,
        index: usize,
        reference: &JointReference,
        measured: &Measured<T>,
    ) -> T {
        let controller = &self.controller;
        wrapped(T::from(reference.angle) - measured.angle) * controller.kp_nm_rad[index]
            + (T::from(reference.rate) - measured.rate) * controller.kd_nm_s_rad[index]
            + T::from(reference.torque)
    }

    /// Command of motor `index`, by the formula of the limits that act.
    #[inline]
    pub fn command<T: Differentiable>(
        &self,
        index: usize,
        motor: &MotorModel,
        reference: &JointReference,
        measured: &Measured<T>,
    ) -> T {
        let torque = self.torque(index, reference, measured);
        let MotorModel::Bldc(winding) = motor else {
            return torque;
        };
        let limited = &self.limited[index];
        match limited.voltage {
            Some(sign) => T::from(sign * winding.supply),
            None => voltage(winding, limited, torque, measured.rate),
        }
    }

    /// Margins of motor `index` to its limits.
    pub fn margins(
        &self,
        index: usize,
        winding: &Winding,
        reference: &JointReference,
        measured: &Measured,
    ) -> Margins {
        let torque = self.torque(index, reference, measured);
        let current = torque / (winding.torque_constant * winding.current_limit);
        let voltage =
            voltage(winding, &self.limited[index], torque, measured.rate) / winding.supply;
        Margins {
            current: current * current - 1.0,
            voltage: voltage * voltage - 1.0,
        }
    }

    /// Switches the limit of the current of motor `index` on or off.
    pub fn toggle_current(
        &mut self,
        index: usize,
        reference: &JointReference,
        measured: &Measured,
    ) {
        let sign = self.torque(index, reference, measured).signum();
        let limited = &mut self.limited[index];
        limited.current = match limited.current {
            None => Some(sign),
            Some(_) => None,
        };
    }

    /// Switches the limit of the voltage of motor `index` on or off.
    pub fn toggle_voltage(
        &mut self,
        index: usize,
        winding: &Winding,
        reference: &JointReference,
        measured: &Measured,
    ) {
        let torque = self.torque(index, reference, measured);
        let sign = voltage(winding, &self.limited[index], torque, measured.rate).signum();
        let limited = &mut self.limited[index];
        limited.voltage = match limited.voltage {
            None => Some(sign),
            Some(_) => None,
        };
    }
}

/// u = R i + N Ke w with the current limited, the voltage not.
#[inline]
fn voltage<T: Differentiable>(winding: &Winding, limited: &Limited, torque: T, rate: T) -> T {
    let current = match limited.current {
        Some(sign) => T::from(sign * winding.current_limit),
        None => torque * (1.0 / winding.torque_constant),
    };
    current * winding.resistance + rate * winding.back_emf
}
