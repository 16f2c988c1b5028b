//! Amplifiers, encoders and their loops as constants.

use super::{DriveError, refuse};
use std::f64::consts::TAU;
use trirrr_core::units::Units;
use trirrr_scene::{Bldc, Drive, FaultInput, Scene, Timing};

/// Fastest loops of a board, Hz: three of them take some 900 cycles of the core.
const LOOP_MAX_HZ: f64 = 20e3;

/// Most counts of an encoder per second. A level at an input lasts for two of them, and the filter of a board takes levels from 0.43 us on: 4.6 million,
/// of two inputs that change exactly in turn.
const COUNTS_MAX_HZ: f64 = 3e6;

/// Constants of the scene's loops, `first` for what all amplifiers share.
pub(super) fn bldcs(
    scene: &Scene,
    drives: &[Drive; 3],
    first: &Bldc,
    units: &Units,
) -> Result<String, DriveError> {
    if let Some(without) = drives
        .iter()
        .position(|drive| drive.encoder_counts_per_rev.is_none())
    {
        let reason =
            "missing: the board closes the loops around the motors, and has to know where they are";
        return refuse(without, "encoder_counts_per_rev", reason);
    }
    check_encoders(scene, drives)?;
    let of_controller = |key: &str, reason: String| {
        Err(DriveError {
            key: key.into(),
            reason,
        })
    };
    let per_tick = match scene.controller.map(|controller| controller.timing) {
        Some(Timing::Sampled { per_tick }) => per_tick,
        Some(Timing::Continuous) => {
            return of_controller("controller.timing", "a board computes in samples".into());
        }
        None => {
            return of_controller(
                "controller",
                "missing: the board closes the loops around the motors with its gains".into(),
            );
        }
    };
    let rate_hz = scene.tick_rate_hz * f64::from(per_tick);
    if rate_hz > LOOP_MAX_HZ {
        return of_controller(
            "controller.rate_hz",
            format!("is {rate_hz}, a board runs its loops at most {LOOP_MAX_HZ} times per second"),
        );
    }
    let Some(motors) = scene.loop_motors() else {
        return refuse(0, "kind", "must be \"bldc\" for all three");
    };
    let failed_high = match first.fault {
        FaultInput::High => Some(true),
        FaultInput::Low => Some(false),
        FaultInput::None => None,
    };
    Ok(format!(
        "use trirrr_drives::bldc::{{AmplifierParameters, EncoderScale, LoopMotor, LoopUnits}};\n\
         use trirrr_drives::joint::LoopParameters;\n\
         pub const MOTORS: [LoopMotor; 3] = {motors:?};\n\
         pub const UNITS: LoopUnits = LoopUnits {{ rate_rad_s: {:?}, acceleration_rad_s2: {:?}, \
         torque_nm: {:?}, tick_rate_hz: {:?} }};\n\
         /// Samples of the loops in a tick, and per second.\n\
         pub const PER_TICK: u32 = {per_tick};\n\
         pub const LOOP_HZ: u32 = {};\n\
         /// PWM frequency of the set values, Hz.\n\
         pub const COMMAND_HZ: u32 = {};\n\
         /// Level of an amplifier's output that tells a failure, if it has one.\n\
         pub const FAILED_HIGH: Option<bool> = {failed_high:?};",
        units.rate_rad_s(),
        units.acceleration_rad_s2(),
        units.torque_nm(),
        scene.tick_rate_hz,
        rate_hz.round(),
        first.command_hz.round(),
    ))
}

/// Refuses limits at which an encoder counts faster than its inputs are read.
fn check_encoders(scene: &Scene, drives: &[Drive; 3]) -> Result<(), DriveError> {
    let rates = scene.limits.rate_rad_s.into_iter().flatten();
    for (index, (drive, rate)) in drives.iter().zip(rates).enumerate() {
        let counts = f64::from(drive.encoder_counts_per_rev.unwrap_or(0)) * drive.gear_ratio;
        let per_second = counts * rate / TAU;
        if per_second > COUNTS_MAX_HZ {
            let reason = format!(
                "{per_second:.0} counts per second at [limits] rate_rad_s = {rate:?}; the inputs of a board take \
                 {COUNTS_MAX_HZ:.0}, which are {:.3} rad/s",
                COUNTS_MAX_HZ * TAU / counts
            );
            return refuse(index, "encoder_counts_per_rev", reason);
        }
    }
    Ok(())
}
