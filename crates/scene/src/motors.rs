//! Motors of a scene: their loops, and the steps of their angles.

use crate::drive::DriveKind;
use crate::scene::Scene;
use std::f64::consts::PI;
use trirrr_drives::bldc::{AmplifierParameters, EncoderScale, LoopMotor};

impl Scene {
    /// Loops of the motors, as a board and the plant run them; none unless all three have an amplifier and an encoder, under
    /// a sampled `[controller]`.
    pub fn loop_motors(&self) -> Option<[LoopMotor; 3]> {
        let (drives, controller) = (self.drives?, self.controller?);
        let rate_hz = controller.sample_rate_hz(self.tick_rate_hz)?;
        let motor = |leg: usize| {
            let drive = drives[leg];
            let DriveKind::Bldc(bldc) = drive.kind else {
                return None;
            };
            let per_ampere = drive.gear_ratio * bldc.torque_constant_nm_a;
            let counts = drive.encoder_counts_per_rev?;
            Some(LoopMotor {
                amplifier: AmplifierParameters {
                    duty: bldc.command_duty.map(|duty| duty as f32),
                    full_scale_nm: (per_ampere * bldc.full_scale_a) as f32,
                    reversed: drive.reversed,
                },
                encoder: EncoderScale::new(counts, drive.gear_ratio, drive.reversed),
                compliance_rad_nm: bldc
                    .stiffness_nm_rad
                    .map_or(0.0, |stiffness| 1.0 / stiffness)
                    as f32,
                encoder_bandwidth_rad_s: controller.encoder_bandwidth_rad_s as f32,
                controller: controller.of_joint(leg, per_ampere * bldc.current_limit_a, rate_hz),
            })
        };
        Some([motor(0)?, motor(1)?, motor(2)?])
    }

    /// Half a step of the angle of each motor, rad: half a microstep of a stepper, half a count of an
    /// encoder, both behind the gear. 0 where the scene gives neither.
    pub fn motor_resolution_rad(&self) -> [f64; 3] {
        [0, 1, 2].map(|motor| {
            let drive = self.drives.map(|drives| drives[motor]);
            let gear = drive.map_or(1.0, |drive| drive.gear_ratio);
            let steps = match (
                drive.map(|drive| drive.kind),
                drive.and_then(|drive| drive.encoder_counts_per_rev),
            ) {
                (Some(DriveKind::Stepper(stepper)), _) => {
                    f64::from(stepper.steps_per_rev) * f64::from(stepper.microsteps)
                }
                (_, Some(counts)) => f64::from(counts),
                (_, None) => return 0.0,
            };
            PI / (steps * gear)
        })
    }
}
