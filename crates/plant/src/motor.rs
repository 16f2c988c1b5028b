//! The motors: what a command makes of a rotor.
//!
//! Angles, rates and torques are those at the joint: a gear of ratio N divides the rotor's angle
//! by N and multiplies its torque by N. Sources: the winding as a direct-current equivalent, L di/dt
//! = u - R i - N Ke w; the hybrid stepper in micro-stepping, whose torque is a sine of the angle
//! between rotor and field with a period of four full steps, and whose detent torque has a period
//! of one.

use crate::refusal::Refusal;
use crate::scalar::Differentiable;
use std::f64::consts::{PI, TAU};
use trirrr_scene::{Drive, DriveKind};

/// A motor's model.
#[derive(Clone, Copy, Debug)]
pub enum MotorModel {
    /// Gives the torque it is told, in N m: without a drive, or inside a drive on the CAN bus.
    Ideal,
    /// Is told a voltage in V.
    Bldc(Winding),
    /// Is told the angle of its field at the joint, in rad from where it started.
    Stepper(Field),
}

/// A brushless motor's winding, seen from the joint.
#[derive(Clone, Copy, Debug)]
pub struct Winding {
    /// R, ohm.
    pub resistance: f64,
    /// L, H.
    pub inductance: f64,
    /// N Kt, N m/A.
    pub torque_constant: f64,
    /// N Ke, V s/rad.
    pub back_emf: f64,
    /// Supply, V.
    pub supply: f64,
    /// Largest current commanded, A.
    pub current_limit: f64,
}

/// A stepper's field, seen from the joint.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// N times the holding torque, N m.
    pub holding: f64,
    /// N times the detent torque, N m.
    pub detent: f64,
    /// Angle of the field (electrical) per angle of the joint: N times full steps per turn / 4.
    pub poles: f64,
    /// 1 / (joint rate at which the inductance halves the field's power)^2, s^2/rad^2.
    pub inverse_corner_sq: f64,
    /// Joint angle of one microstep, rad.
    pub microstep: f64,
}

impl MotorModel {
    /// The model of `drive`; without one, an ideal source of torque.
    ///
    /// # Errors
    /// [`Refusal::Scene`] for a drive that has no model.
    pub fn build(drive: Option<&Drive>) -> Result<Self, Refusal> {
        let Some(drive) = drive else {
            return Ok(MotorModel::Ideal);
        };
        let gear = drive.gear_ratio;
        let refuse = |key: &str, reason: &str| Refusal::Scene {
            key: format!("drive.{key}"),
            reason: reason.into(),
        };
        match drive.kind {
            DriveKind::Bldc(bldc) => Ok(MotorModel::Bldc(Winding {
                resistance: bldc.resistance_ohm,
                inductance: bldc.inductance_h,
                torque_constant: gear * bldc.torque_constant_nm_a,
                back_emf: gear * bldc.back_emf_constant_v_s_rad,
                supply: bldc.supply_v,
                current_limit: bldc.current_limit_a,
            })),
            DriveKind::Stepper(stepper) => {
                let holding = stepper
                    .holding_torque_nm
                    .ok_or_else(|| refuse("holding_torque_nm", "missing"))?;
                let steps = f64::from(stepper.steps_per_rev);
                // T(w) = holding / sqrt(1 + (w / corner)^2) through the point of the curve.
                let inverse_corner_sq = stepper.pull_out.map_or(0.0, |point| {
                    let ratio = holding / point.torque_nm;
                    let rate = point.rate_rad_s / gear;
                    (ratio * ratio - 1.0) / (rate * rate)
                });
                Ok(MotorModel::Stepper(Field {
                    holding: gear * holding,
                    detent: gear * stepper.detent_torque_nm,
                    poles: gear * steps / 4.0,
                    inverse_corner_sq,
                    microstep: TAU / (steps * f64::from(stepper.microsteps) * gear),
                }))
            }
            // It closes a current loop of its own, much faster than the loops around it.
            DriveKind::Can(_) => Ok(MotorModel::Ideal),
        }
    }
}

impl Winding {
    /// di/dt for a voltage of `u`.
    #[inline(always)]
    pub fn current_rate<T: Differentiable>(&self, u: T, current: T, rate: T) -> T {
        (u - current * self.resistance - rate * self.back_emf) * (1.0 / self.inductance)
    }

    /// Losses in W: the resistance's, and what a Ke that is not Kt takes.
    #[inline(always)]
    pub fn loss<T: Differentiable>(&self, current: T, rate: T) -> T {
        current * (current * self.resistance + rate * (self.back_emf - self.torque_constant))
    }
}

impl Field {
    /// Torque at the joint for a rotor at `angle` with `rate` and a field at `field`.
    #[inline(always)]
    pub fn torque<T: Differentiable>(&self, field: T, angle: T, rate: T) -> T {
        let fall = rate * rate * self.inverse_corner_sq + T::from(1.0);
        let root = fall.value().sqrt();
        let root = T::function(root, [(0.5 / root, fall)]);
        let sine = |angle: T| {
            let (sin, cos) = angle.value().sin_cos();
            T::function(sin, [(cos, angle)])
        };
        let mut torque = sine((field - angle) * self.poles) * self.holding / root;
        if self.detent > 0.0 {
            torque = torque - sine(angle * (4.0 * self.poles)) * self.detent;
        }
        torque
    }

    /// Number of the stable position of the field that holds the rotor: 0 where it follows, n when it has
    /// fallen n times four full steps behind (ahead, where negative).
    pub fn slips(&self, field: f64, angle: f64) -> i64 {
        (self.poles * (field - angle) / TAU).round() as i64
    }

    /// 0 where the rotor is midway between two stable positions of the field; changes its sign
    /// there.
    pub fn slip_edge(&self, field: f64, angle: f64) -> f64 {
        (0.5 * self.poles * (field - angle)).cos()
    }
}

/// `angle` within half a turn of 0.
#[inline(always)]
pub fn wrapped<T: Differentiable>(angle: T) -> T {
    if angle.value().abs() <= PI {
        angle
    } else {
        angle - T::from(TAU * (angle.value() / TAU).round())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> Field {
        let drive = Drive {
            gear_ratio: 5.0,
            rotor_inertia_kgm2: 1e-5,
            reversed: false,
            encoder_counts_per_rev: None,
            kind: DriveKind::Stepper(trirrr_scene::Stepper {
                steps_per_rev: 200,
                microsteps: 16,
                step_rate_limit_hz: None,
                holding_torque_nm: Some(0.5),
                detent_torque_nm: 0.02,
                pull_out: Some(trirrr_scene::PullOut {
                    torque_nm: 0.25,
                    rate_rad_s: 60.0,
                }),
                enable: trirrr_scene::EnableLevel::Low,
            }),
        };
        match MotorModel::build(Some(&drive)) {
            Ok(MotorModel::Stepper(field)) => field,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_stepper_pulls_most_one_full_step_off_its_field() {
        let field = field();
        // 1.8 degrees at the rotor, a fifth at the joint; the detent torque is 0 there.
        let step = 1.8f64.to_radians() / 5.0;
        assert!((field.torque(0.0, -step, 0.0) - 5.0 * 0.5).abs() < 1e-12);
        assert!((field.torque(0.0, step, 0.0) + 5.0 * 0.5).abs() < 1e-12);
        assert!(field.torque(0.0, 0.0, 0.0).abs() < 1e-15);
        assert!((field.microstep * 16.0 - step).abs() < 1e-15);
        // The point of the pull-out curve: half the torque at 60 rad/s of the rotor.
        assert!((field.torque(0.0, -step, 12.0) - 5.0 * 0.25).abs() < 1e-12);
    }

    #[test]
    fn a_stepper_that_falls_two_full_steps_behind_slips_by_four() {
        let field = field();
        let step = 1.8f64.to_radians() / 5.0;
        for (behind, slips) in [
            (0.0, 0),
            (1.99, 0),
            (2.01, 1),
            (5.99, 1),
            (6.01, 2),
            (-2.01, -1),
        ] {
            assert_eq!(field.slips(behind * step, 0.0), slips, "{behind}");
        }
        let edge = |behind: f64| field.slip_edge(behind * step, 0.0);
        assert!(edge(1.99) > 0.0 && edge(2.01) < 0.0 && edge(6.01) > 0.0);
    }

    #[test]
    fn angles_are_wrapped_the_short_way() {
        assert_eq!(wrapped(3.0), 3.0);
        assert!((wrapped(6.0) - (6.0 - TAU)).abs() < 1e-15);
        assert!((wrapped(-100.0) - (-100.0 + 16.0 * TAU)).abs() < 1e-13);
    }
}
