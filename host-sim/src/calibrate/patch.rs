//! Calibrated values in the files of the scene.

use super::CalibrateArgs;
use crate::failure::CliError;
use crate::patched_scene::PatchedScene;
use nalgebra::Vector2;
use trirrr_calibration::{Calibration, ParameterGroup};
use trirrr_scene::{DriveKind, Scene};

/// Puts what was fitted into copies of the scene's files. Returns the key that has the encoder offsets, too; none where the
/// scene has no place for them.
///
/// # Errors
/// Refused: a file of the scene cannot be read again.
pub(super) fn patch(
    scene: &Scene,
    args: &CalibrateArgs,
    calibration: &Calibration,
) -> Result<(PatchedScene, Option<&'static str>), CliError> {
    let mut patched = PatchedScene::of(scene, &args.scene)?;
    let is_fitted = |group: ParameterGroup| {
        let mut indices = calibration.free.iter();
        indices.any(|index| ParameterGroup::of(*index) == group)
    };
    // The file has platform joints in the frame of the bare platform.
    let machine = calibration.values.put_into(&scene.parameters);
    let machine = machine.at_tool_point(Vector2::zeros());
    let files = patched.at("machine");
    for (number, leg) in (1..).zip(&machine.legs) {
        let key = |name: &str| format!("machine.leg[{number}].{name}");
        if is_fitted(ParameterGroup::Base) {
            files.put_numbers(&key("base_m"), &[leg.base_m.x, leg.base_m.y]);
        }
        if is_fitted(ParameterGroup::Proximal) {
            files.put_number(&key("proximal_m"), leg.proximal_m);
        }
        if is_fitted(ParameterGroup::Distal) {
            files.put_number(&key("distal_m"), leg.distal_m);
        }
        if is_fitted(ParameterGroup::Joint) {
            files.put_number(&key("joint_radius_m"), leg.joint_radius_m);
            files.put_number(&key("joint_angle_rad"), leg.joint_angle_rad);
        }
    }
    if !is_fitted(ParameterGroup::Offset) {
        return Ok((patched, None));
    }
    let offsets = calibration.values.offsets_rad();
    // A homing says where the motors are, whatever the drives told before.
    if let Some(homing) = &scene.homing {
        let angles = [0, 1, 2].map(|motor| homing.motors[motor].angle_rad + offsets[motor]);
        let key = "homing.angle_rad";
        let is_put = patched.at(key).put_numbers(key, &angles);
        return Ok((patched, is_put.then_some(key)));
    }
    let Some(drives) = &scene.drives else {
        return Ok((patched, None));
    };
    let mut is_put = false;
    for (number, (drive, offset)) in (1..).zip(drives.iter().zip(offsets)) {
        if let DriveKind::Can(can) = &drive.kind {
            let key = format!("drive[{number}].zero_rad");
            is_put = patched.at(&key).put_number(&key, can.zero_rad + offset);
        }
    }
    Ok((patched, is_put.then_some("drive.zero_rad")))
}
