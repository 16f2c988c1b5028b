//! The drives of a scene as constants, in the units of its image.

mod bldc;
mod can;

use bldc::bldcs;
use can::cans;
use std::fmt::{self, Write};
use trirrr_core::units::Units;
use trirrr_drives::stepper::{StepsPerTurn, slot_rate_hz};
use trirrr_scene::{CanProtocol, Drive, DriveKind, EnableLevel, Scene, Stepper};

/// The kinds of drive, as `cfg(drive = "...")` has them in an image.
pub(super) const KINDS: &[&str] = &[NONE, STEPPER, "bldc", "odrive", "mit", "moteus"];

/// Steppers.
pub(super) const STEPPER: &str = "stepper";

/// No drive.
const NONE: &str = "none";

/// The slots of the fastest steppers, Hz: beyond, an interrupt in each leaves no time for a tick.
const SLOTS_MAX_HZ: f64 = 200e3;

/// A drive that cannot be built into an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DriveError {
    key: String,
    reason: String,
}

impl fmt::Display for DriveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.reason)
    }
}

impl std::error::Error for DriveError {}

fn refuse<T>(index: usize, key: &str, reason: impl Into<String>) -> Result<T, DriveError> {
    Err(DriveError {
        key: format!("drive[{}].{key}", index + 1),
        reason: reason.into(),
    })
}

/// The kind of the scene's drives: `"none"`, `"stepper"`, `"bldc"`, `"odrive"`, `"mit"` or `"moteus"`.
pub fn kind(scene: &Scene) -> &'static str {
    let Some([drive, ..]) = &scene.drives else {
        return NONE;
    };
    match drive.kind {
        DriveKind::Stepper(_) => STEPPER,
        DriveKind::Bldc(_) => "bldc",
        DriveKind::Can(can) => match can.protocol {
            CanProtocol::Odrive => "odrive",
            CanProtocol::Mit(_) => "mit",
            CanProtocol::Moteus => "moteus",
        },
    }
}

/// A module `drive` with the constants of the scene's drives; nothing if it has none.
///
/// # Errors
/// What an image for a board needs and the scene does not say, or what no board does.
pub fn drive(scene: &Scene, units: &Units) -> Result<String, DriveError> {
    let Some(drives) = &scene.drives else {
        return Ok(String::new());
    };
    let reversed = drives.map(|drive| drive.reversed);
    let mut text = String::from("#[allow(dead_code)]\npub mod drive {\n");
    let mut line = |arguments: fmt::Arguments<'_>| {
        text.write_fmt(arguments)
            .expect("writing to a String cannot fail");
        text.push('\n');
    };
    let [first, ..] = drives;
    match first.kind {
        DriveKind::Stepper(stepper) => {
            line(format_args!("{}", steppers(scene, drives)?));
            line(format_args!("{}", enable(stepper.enable)));
            line(format_args!(
                "pub const REVERSED: [bool; 3] = {reversed:?};"
            ));
        }
        DriveKind::Bldc(bldc) => {
            line(format_args!("{}", bldcs(scene, drives, &bldc, units)?));
            line(format_args!("{}", enable(bldc.enable)));
        }
        DriveKind::Can(can) => {
            line(format_args!("{}", cans(scene, drives, &can, units)?));
        }
    }
    text.push_str("}\n");
    Ok(text)
}

fn enable(level: EnableLevel) -> String {
    let high = level == EnableLevel::High;
    format!("pub const ENABLE_HIGH: bool = {high};")
}

fn steppers(scene: &Scene, drives: &[Drive; 3]) -> Result<String, DriveError> {
    let mut per_turn = Vec::new();
    let mut most = Vec::new();
    for (index, drive) in drives.iter().enumerate() {
        let DriveKind::Stepper(stepper) = drive.kind else {
            return refuse(index, "kind", "must be that of drive[1]");
        };
        let microsteps = stepper.steps_per_rev * stepper.microsteps;
        if f64::from(microsteps) * drive.gear_ratio > StepsPerTurn::MAX {
            return refuse(
                index,
                "gear_ratio",
                format!(
                    "a turn of the joint is more than {} microsteps",
                    StepsPerTurn::MAX
                ),
            );
        }
        per_turn.push(format!(
            "trirrr_drives::stepper::StepsPerTurn::new({microsteps}, {:?})",
            drive.gear_ratio
        ));
        most.push(most_per_tick(index, &stepper, scene.tick_rate_hz)?);
    }
    Ok(format!(
        "pub const PER_TURN: [trirrr_drives::stepper::StepsPerTurn; 3] = [{}];\n\
         pub const MOST_PER_TICK: [u32; 3] = {most:?};",
        per_turn.join(", ")
    ))
}

/// Rate of the slots that step the scene's steppers, Hz, as an image computes it; none without steppers.
///
/// # Errors
/// Steppers that no board drives.
pub fn slots_hz(scene: &Scene) -> Result<Option<u32>, DriveError> {
    let mut most = None;
    for (index, drive) in scene.drives.iter().flatten().enumerate() {
        if let DriveKind::Stepper(stepper) = drive.kind {
            most = most.max(Some(most_per_tick(index, &stepper, scene.tick_rate_hz)?));
        }
    }
    Ok(most.map(|most| slot_rate_hz(most, scene.tick_rate_hz) as u32 + 1))
}

fn most_per_tick(index: usize, stepper: &Stepper, tick_rate_hz: f64) -> Result<u32, DriveError> {
    let key = "step_rate_limit_hz";
    let Some(limit) = stepper.step_rate_limit_hz else {
        return refuse(
            index,
            key,
            "missing: the timer that puts the steps out is set by it",
        );
    };
    let most = (limit / tick_rate_hz).floor();
    if most < 1.0 {
        return refuse(
            index,
            key,
            format!("{limit} Hz is less than a step in each of {tick_rate_hz} ticks per second"),
        );
    }
    // Two slots for each step, one for the direction, and one to spare.
    let slots = slot_rate_hz(most as u32, tick_rate_hz);
    if slots > SLOTS_MAX_HZ {
        return refuse(
            index,
            key,
            format!(
                "{limit} Hz takes {slots} slots per second, two for each step and two more in \
                 each tick; a board has at most {SLOTS_MAX_HZ}"
            ),
        );
    }
    Ok(most as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The thesis scene with these drives in place of its limits, at 100 ticks per second.
    fn with(drives: &str) -> Scene {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/thesis.toml");
        let text = std::fs::read_to_string(&file).expect("a shipped scene");
        let limits = "[limits]\nrate_rad_s = 2.0\ntorque_nm = 0.1\n";
        assert!(text.contains(limits), "the limits come with the drives");
        let drives = format!("{drives}\n[platform]");
        let text = text.replace(limits, "").replacen("[platform]", &drives, 1);
        Scene::parse(&text, "test.toml").expect("a good scene")
    }

    const STEPPER: &str = "[[drive]]\nkind = \"stepper\"\nsteps_per_rev = 200\nmicrosteps = 16\n";

    /// Drives with limits that fit their frames.
    fn cans(protocol: &str, more: &str) -> String {
        let drives: String = (1..=3)
            .map(|id| {
                format!(
                    "[[drive]]\nkind = \"can\"\nprotocol = \"{protocol}\"\nnode_id = {id}\n{more}\n"
                )
            })
            .collect();
        format!("[limits]\nrate_rad_s = 8.0\ntorque_nm = 4.0\n{drives}")
    }

    #[test]
    fn no_drive_no_code() {
        let scene = with("");
        assert_eq!(drive(&scene, &Units::SI), Ok(String::new()));
        assert_eq!(kind(&scene), "none");
    }

    #[test]
    fn steppers_are_counted_in_whole_steps_of_a_tick() {
        let scene = with(&format!(
            "{STEPPER}gear_ratio = 5.18\nstep_rate_limit_hz = 20050.0\nreversed = true"
        ));
        let text = drive(&scene, &Units::SI).expect("good");
        for part in [
            "StepsPerTurn::new(3200, 5.18)",
            "MOST_PER_TICK: [u32; 3] = [200, 200, 200];",
            "REVERSED: [bool; 3] = [true, true, true];",
            "ENABLE_HIGH: bool = false;",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert_eq!(kind(&scene), "stepper");
    }

    #[test]
    fn what_no_board_does_is_refused_with_its_key() {
        for (drives, key, reason) in [
            (STEPPER.to_owned(), "drive[1].step_rate_limit_hz", "missing"),
            (
                format!("{STEPPER}step_rate_limit_hz = 50.0"),
                "drive[1].step_rate_limit_hz",
                "less than a step in each",
            ),
            (
                format!("{STEPPER}step_rate_limit_hz = 100e3"),
                "drive[1].step_rate_limit_hz",
                "takes 200200 slots per second",
            ),
            (
                format!("{STEPPER}step_rate_limit_hz = 20e3\ngear_ratio = 1e6"),
                "drive[1].gear_ratio",
                "more than 2147483647 microsteps",
            ),
        ] {
            let error = drive(&with(&drives), &Units::SI).expect_err("refused");
            assert_eq!(error.key, key);
            assert!(error.reason.contains(reason), "{error}");
        }
    }

    #[test]
    fn a_bus_that_is_too_slow_is_refused() {
        // 3 * 135 bits * 100 Hz are 40,500 bits per second, what the drives say 44,550 more: 68 % of the slowest.
        let scene = with(&cans("odrive", "bit_rate_hz = 125000"));
        let text = drive(&scene, &Units::SI).expect("good");
        for part in [
            "NODES: [u8; 3] = [1, 2, 3];",
            "PROTOCOL: Protocol = trirrr_drives::can::Odrive;",
            "FILTERS: [(u16, u16); 3] = [(32, 2016), (64, 2016), (96, 2016)];",
            "Absolute::Rotor",
            // 125,000 / 100 / 111 are 11 and a part.
            "HEARD: u16 = 13;",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert_eq!(kind(&scene), "odrive");
        let chatty = with(&cans("odrive", "bit_rate_hz = 125000\nmessages_hz = 400"));
        let error = drive(&chatty, &Units::SI).expect_err("162 %");
        assert!(
            error.to_string().contains("take 162 % of 125000"),
            "{error}"
        );
        // Each command of the MIT mode is answered: 6 * 135 * 100 are 65 %.
        let more = "model = \"dm4310\"\nkp_nm_rad = 50.0\nkd_nm_s_rad = 1.0\nbit_rate_hz = 125000";
        let mut mit = with(&cans("mit", more));
        let text = drive(&mit, &Units::SI).expect("good");
        assert!(
            text.contains("kp: 50.0, kd: 1.0, answer: trirrr_drives::can::Answer::Damiao"),
            "{text}"
        );
        assert!(text.contains("FILTERS: [(u16, u16); 3] = [(0, 2047), (0, 2047), (0, 2047)];"));
        assert_eq!(kind(&mit), "mit");
        mit.tick_rate_hz = 200.0;
        assert!(drive(&mit, &Units::SI).is_err());
    }

    #[test]
    fn limits_beyond_a_frame_are_refused() {
        let refused = |text: &str| {
            let error = drive(&with(text), &Units::SI).expect_err("refused");
            error.to_string()
        };
        // 32.767 turns per second behind a gear of 30 are 6.863 rad/s.
        let error = refused(&cans("odrive", "gear_ratio = 30.0"));
        assert!(
            error.contains("rate_rad_s is 8.0 at the joint, and a frame holds 6.863"),
            "{error}"
        );
        let bare = cans("odrive", "").replace("rate_rad_s = 8.0\n", "");
        assert!(refused(&bare).contains("drive[1].protocol: needs rate_rad_s in [limits]"));
        let gains = "model = \"ak80-64\"\nkp_nm_rad = 50.0\nkd_nm_s_rad = 1.0\n";
        let error = refused(&cans("mit", &format!("{gains}gear_ratio = 2.0")));
        assert!(error.contains("a frame holds 4.000"), "{error}");
        let error = refused(&cans("mit", &format!("{gains}gear_ratio = 5.0")));
        assert!(
            error.contains("gear_ratio") && error.contains("15.7 rad"),
            "{error}"
        );
    }

    const BLDC: &str = "[[drive]]\nkind = \"bldc\"\nresistance_ohm = 0.5\ninductance_h = 1e-4\n\
                        torque_constant_nm_a = 0.06\nsupply_v = 24.0\ncurrent_limit_a = 8.0\n\
                        gear_ratio = 4.0\n";
    const CONTROLLER: &str = "[controller]\nrate_hz = 5000\nkp_nm_rad = 200.0\nkd_nm_s_rad = 3.0\n";

    #[test]
    fn loops_are_in_si_units_and_the_tick_in_its_own() {
        let scene = with(&format!(
            "{BLDC}encoder_counts_per_rev = 4096\nreversed = true\n{CONTROLLER}"
        ));
        let units = Units {
            length: -2,
            mass: 0,
            time: -3,
        };
        let text = drive(&scene, &units).expect("good");
        // 4 * 0.06 * 8 N m at the limit, and at full scale; 2^3 rad/s in a unit of the rate.
        for part in [
            "full_scale_nm: 1.92",
            "torque_max_nm: 1.92",
            "duty: [0.1, 0.9]",
            "kp_nm_rad: 200.0",
            "period_s: 0.0002",
            "rate_rad_s: 8.0",
            "PER_TICK: u32 = 50;",
            "LOOP_HZ: u32 = 5000;",
            "COMMAND_HZ: u32 = 5000;",
            "FAILED_HIGH: Option<bool> = Some(false);",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        // 2^64 / (4096 * 4) a count, backward.
        let per_count = (1u64 << 50).wrapping_neg();
        assert!(text.contains(&format!("per_count: {per_count}")), "{text}");
        assert_eq!(kind(&scene), "bldc");
    }

    #[test]
    fn loops_that_no_board_runs_are_refused_with_their_key() {
        let counted = format!("{BLDC}encoder_counts_per_rev = 4096\n");
        for (drives, key, reason) in [
            (
                format!("{BLDC}{CONTROLLER}"),
                "drive[1].encoder_counts_per_rev",
                "missing",
            ),
            (counted.clone(), "controller", "missing"),
            (
                format!(
                    "{counted}[controller]\ntiming = \"continuous\"\nkp_nm_rad = 1\nkd_nm_s_rad = 1\n"
                ),
                "controller.timing",
                "samples",
            ),
            (
                counted.clone() + &CONTROLLER.replace("5000", "30000"),
                "controller.rate_hz",
                "at most 20000",
            ),
            // 4 * 600,000 counts in a turn of the joint, at 8 rad/s.
            (
                format!(
                    "[limits]\nrate_rad_s = 8.0\n{BLDC}encoder_counts_per_rev = 600000\n{CONTROLLER}"
                ),
                "drive[1].encoder_counts_per_rev",
                "3055775 counts per second at [limits] rate_rad_s = 8.0; the inputs of a board take 3000000",
            ),
        ] {
            let error = drive(&with(&drives), &Units::SI).expect_err("refused");
            assert_eq!(error.key, key);
            assert!(error.reason.contains(reason), "{error}");
        }
    }
}
