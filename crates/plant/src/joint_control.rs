//! Joint controllers as a drive runs them: the loop and the motor command of `trirrr-drives` at a
//! rate above that of the ticks.

use crate::control::{Commands, Measured};
use crate::drives::{SimulatedDrives, reference};
use crate::refusal::Refusal;
use trirrr_core::number::Number;
use trirrr_core::units::Units;
use trirrr_drives::bldc::{Bldc, BldcParameters};
use trirrr_drives::joint::{Loop, Reference};
use trirrr_scene::{DriveKind, Scene};
use trirrr_service::Output;

/// Drives of three motors that are driven by torque, in the number type `D`.
///
/// Duty is continuous: a scene describes no PWM timer.
pub(crate) struct JointDrives<D: Number> {
    units: Units,
    /// Time from one sample to the next, s.
    period: D,
    joints: [Joint<D>; 3],
}

struct Joint<D: Number> {
    reference: Reference<D>,
    inner: Loop<D>,
    stage: PowerStage<D>,
}

/// Power stage of a motor.
enum PowerStage<D> {
    /// Gives the torque as commanded.
    Torque,
    /// Gives a voltage, as a share of the supply in V.
    Voltage { drive: Bldc<D>, supply_v: f64 },
}

impl<D: Number> JointDrives<D> {
    /// Builds the drives of `scene` with `per_tick` samples in each tick, for ticks in `units`.
    ///
    /// # Errors
    /// [`Refusal::Scene`]: no controller.
    pub(crate) fn build(scene: &Scene, per_tick: u32, units: Units) -> Result<Self, Refusal> {
        let controller = scene.plant.as_ref().and_then(|plant| plant.controller);
        let controller = controller.ok_or_else(|| Refusal::Scene {
            key: "plant.controller".into(),
            reason: "missing: motors driven by torque need one".into(),
        })?;
        let rate_hz = scene.tick_rate_hz * f64::from(per_tick);
        let joint = |leg: usize| Joint {
            reference: Reference {
                angle: D::angle_from_f64(0.0),
                rate: D::ZERO,
                acceleration: D::ZERO,
                torque: D::ZERO,
            },
            inner: Loop::build(
                controller.kp_nm_rad[leg],
                controller.kd_nm_s_rad[leg],
                controller.feed_forward,
            ),
            stage: stage(scene, leg),
        };
        Ok(Self {
            units,
            period: D::from_f64(1.0 / rate_hz),
            joints: [joint(0), joint(1), joint(2)],
        })
    }
}

fn stage<D: Number>(scene: &Scene, leg: usize) -> PowerStage<D> {
    let Some(drives) = &scene.drives else {
        return PowerStage::Torque;
    };
    let DriveKind::Bldc(bldc) = drives[leg].kind else {
        return PowerStage::Torque;
    };
    PowerStage::Voltage {
        drive: Bldc::build(&BldcParameters {
            gear_ratio: drives[leg].gear_ratio,
            resistance_ohm: bldc.resistance_ohm,
            torque_constant_nm_a: bldc.torque_constant_nm_a,
            back_emf_constant_v_s_rad: bldc.back_emf_constant_v_s_rad,
            supply_v: bldc.supply_v,
            current_limit_a: bldc.current_limit_a,
        }),
        supply_v: bldc.supply_v,
    }
}

impl<N: Number, D: Number> SimulatedDrives<N> for JointDrives<D> {
    fn tick(&mut self, output: &Output<N>) -> Result<(), Refusal> {
        for (joint, motor) in self.joints.iter_mut().zip(&output.motors) {
            joint.reference = reference(motor, &self.units);
        }
        Ok(())
    }

    #[inline]
    fn sample(&mut self, slot: u32, measured: &[Measured; 3]) -> Commands {
        let mut commands = Commands::default();
        let elapsed = D::ratio(slot, 1) * self.period;
        for (leg, joint) in self.joints.iter().enumerate() {
            let reference = joint.reference.after(elapsed);
            commands.angle[leg] = D::angle_to_f64(reference.angle);
            let angle = D::angle_from_f64(measured[leg].angle);
            let rate = D::from_f64(measured[leg].rate);
            let torque = joint.inner.torque(&reference, angle, rate);
            commands.held[leg] = match &joint.stage {
                PowerStage::Torque => torque.to_f64(),
                PowerStage::Voltage { drive, supply_v } => {
                    let command = drive.command(torque, rate);
                    commands.limited[leg] = command.limited;
                    command.duty.to_f64() * supply_v
                }
            };
        }
        commands
    }
}
