//! Drives, and why they were not switched on.

use trirrr_protocol::message::{DriveState, NotEnabled, Transmit};
use trirrr_scene::words::{short, subject};

/// Describes the state of a drive.
pub fn drive_state(state: DriveState) -> &'static str {
    match state {
        DriveState::Silent => "silent",
        DriveState::Off => "off",
        DriveState::Preparing => "preparing",
        DriveState::On => "on",
        DriveState::Uncalibrated => "not calibrated",
        DriveState::Fault => "in error",
    }
}

/// Describes why a machine was not enabled.
pub fn not_enabled<N: Transmit>(why: &NotEnabled<N>) -> String {
    match why {
        NotEnabled::Drive {
            motor,
            state,
            error,
        } => {
            let (drive, state) = (motor + 1, drive_state(*state));
            match error {
                0 => format!("drive {drive} is {state}: look at its power, its node number and its wiring"),
                _ => format!(
                    "drive {drive} is {state} and reports its code {error}: clear it by --recover, or ClearFault"
                ),
            }
        }
        NotEnabled::Moves {
            motor,
            value,
            limit,
        } => format!(
            "joint {} moved by {} rad while the machine was enabled, the most allowed is {} rad",
            motor + 1,
            short(value.to_f64()),
            short(limit.to_f64())
        ),
        NotEnabled::NoPose => {
            "the joints stand at no pose with the elbows of the scene and on its side of the parallel singularity: \
             move the platform by hand, or look at zero_rad of the drives"
                .into()
        }
        NotEnabled::ManyPoses => {
            "the joints stand at more than one pose with the elbows of the scene: move the platform by hand towards its \
             start"
                .into()
        }
        NotEnabled::Singular {
            what,
            leg,
            value,
            limit,
        } => format!(
            "the {} is {}, the least allowed is {}: move the platform by hand",
            subject(*what, *leg),
            short(value.to_f64()),
            short(limit.to_f64())
        ),
    }
}
