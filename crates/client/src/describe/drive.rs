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

/// Drives that have restarted, and the angles that a person has to compare.
fn restarted<N: Transmit>(angles: &[Option<N::Angle>; 3]) -> [String; 2] {
    let angles = (1..).zip(angles);
    let known = angles.filter_map(|(number, angle)| Some((number, N::angle_to_f64((*angle)?))));
    let known: Vec<(u32, f64)> = known.collect();
    let joined = |of: &dyn Fn(&(u32, f64)) -> String| {
        let texts: Vec<String> = known.iter().map(of).collect();
        texts.join(", ")
    };
    let drives = joined(&|(number, _)| format!("drive {number}"));
    let joints = joined(&|(number, angle)| {
        let degrees = short(angle.to_degrees());
        format!(
            "joint {number} is taken to be at {} rad ({degrees} degrees)",
            short(*angle)
        )
    });
    [drives, joints]
}

/// Describes why a machine was not enabled.
pub fn not_enabled<N: Transmit>(why: &NotEnabled<N>) -> String {
    let counted = |motor: &u8| u32::from(*motor) + 1;
    match why {
        NotEnabled::Drive {
            motor,
            state,
            error: 0,
        } => {
            let (motor, state) = (counted(motor), drive_state(*state));
            format!("drive {motor} is {state}: look at its power, its node number and its wiring")
        }
        NotEnabled::Drive {
            motor,
            state,
            error,
        } => {
            let (motor, state) = (counted(motor), drive_state(*state));
            format!(
                "drive {motor} is {state} and reports its code {error}: clear it by trirrr enable --clear, --recover, or ClearFault"
            )
        }
        NotEnabled::Moves {
            motor,
            value,
            limit,
        } => {
            let motor = counted(motor);
            let [value, limit] = [value, limit].map(|angle| short(angle.to_f64()));
            format!(
                "joint {motor} moved by {value} rad while the machine was enabled, the most allowed is {limit} rad"
            )
        }
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
        } => {
            let what = subject(*what, *leg);
            let [value, limit] = [value, limit].map(|distance| short(distance.to_f64()));
            format!("the {what} is {value}, the least allowed is {limit}: move the platform by hand")
        }
        NotEnabled::Restarted { angles } => {
            let [drives, joints] = restarted::<N>(angles);
            format!(
                "restarted or silent while the machine stayed on: {drives}; {joints}, or whole turns of the rotor elsewhere. \
                 Compare with the machine. Where the angles are true, acknowledge them by trirrr enable --clear, --recover, or \
                 ClearFault; else turn the joints there by hand with the drives off, and restart the board at the start of the job"
            )
        }
    }
}
