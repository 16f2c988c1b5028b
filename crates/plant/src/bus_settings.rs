//! Settings of drives on a bus, from those of a scene.

use trirrr_drives::can::{Absolute, Answer, Mit, MitRanges};
use trirrr_scene::{self as scene, Feedback, Knows, MitAnswer, Scene};

/// Meaning of a drive's position.
pub(crate) fn absolute(knows: Knows) -> Absolute {
    match knows {
        Knows::Joint => Absolute::Joint,
        Knows::Rotor => Absolute::Rotor,
        Knows::Nothing => Absolute::Nothing,
    }
}

/// Watch over the drives.
pub(crate) fn watch(scene: &Scene) -> Feedback {
    scene.feedback.unwrap_or_default()
}

/// Settings of the frames, from those of the scene.
pub(crate) fn mit_of(mit: &scene::Mit) -> Mit {
    Mit {
        ranges: MitRanges {
            position: mit.position_max_rad as f32,
            velocity: mit.velocity_max_rad_s as f32,
            torque: mit.torque_max_nm as f32,
            kp: mit.kp_max as f32,
            kd: mit.kd_max as f32,
        },
        kp: mit.kp_nm_rad as f32,
        kd: mit.kd_nm_s_rad as f32,
        answer: match mit.answer {
            MitAnswer::Damiao => Answer::Damiao,
            MitAnswer::RobStride => Answer::RobStride,
            MitAnswer::TMotor => Answer::TMotor,
        },
        host_id: mit.host_id as u16,
    }
}
