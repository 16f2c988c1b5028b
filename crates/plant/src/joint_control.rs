//! Joint controllers with ideal sensors, at a rate above that of the ticks: of motors that are sources of torque, or that have an
//! amplifier and no encoder.

use crate::control::{Commands, Measured};
use crate::drives::{SimulatedDrives, reference};
use crate::power_stage::{DriveLimit, PowerStage};
use crate::refusal::Refusal;
use trirrr_core::number::Number;
use trirrr_core::units::Units;
use trirrr_drives::joint::{Loop, Reference};
use trirrr_scene::Scene;
use trirrr_service::Output;

/// Drives of three motors that are driven by torque, in the number type `D`.
pub(crate) struct JointDrives<D: Number> {
    units: Units,
    /// Time from one sample to the next, s.
    period: D,
    joints: [Joint<D>; 3],
}

struct Joint<D: Number> {
    reference: Reference<D>,
    inner: Loop<D>,
    /// None of a motor that gives the torque as commanded.
    stage: Option<PowerStage>,
}

impl<D: Number> JointDrives<D> {
    /// Builds the drives of `scene` with `per_tick` samples in each tick, for ticks in `units`.
    ///
    /// # Errors
    /// [`Refusal::Scene`]: no controller.
    pub(crate) fn build(scene: &Scene, per_tick: u32, units: Units) -> Result<Self, Refusal> {
        let controller = scene.controller.ok_or_else(|| Refusal::Scene {
            key: "controller".into(),
            reason: "missing: motors driven by torque need one".into(),
        })?;
        let rate_hz = scene.tick_rate_hz * f64::from(per_tick);
        let joint = |leg: usize| {
            let drive = scene.drives.map(|drives| drives[leg]);
            let stage = drive.and_then(|drive| PowerStage::of(&drive));
            // More than any torque, and a number in any type.
            let most = stage.map_or(1e30, |stage| stage.torque_max_nm());
            Joint {
                reference: Reference::standing(D::angle_from_f64(0.0)),
                inner: Loop::build(&controller.of_joint(leg, most, rate_hz)),
                stage,
            }
        };
        Ok(Self {
            units,
            period: D::from_f64(1.0 / rate_hz),
            joints: [joint(0), joint(1), joint(2)],
        })
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
        for (leg, joint) in self.joints.iter_mut().enumerate() {
            let reference = joint.reference.after(elapsed);
            commands.angle[leg] = D::angle_to_f64(reference.angle);
            let angle = D::angle_from_f64(measured[leg].angle);
            let rate = D::from_f64(measured[leg].rate);
            let asked = joint.inner.torque(&reference, angle, rate);
            let torque = asked.torque.to_f64();
            commands.limited[leg] = asked.limited.then_some(DriveLimit::Current);
            commands.held[leg] = match &joint.stage {
                None => torque,
                Some(stage) => {
                    let (voltage, limited) = stage.voltage(torque, measured[leg].rate);
                    if limited {
                        commands.limited[leg] = Some(DriveLimit::Voltage);
                    }
                    voltage
                }
            };
        }
        commands
    }
}
