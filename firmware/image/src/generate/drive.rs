//! The drives of a scene as constants, in the units of its image.

mod can;

use super::FIXED;
use can::cans;
use std::fmt::{self, Write};
use trirrr_core::number::{Arithmetic, Fixed};
use trirrr_core::units::Units;
use trirrr_drives::bldc::{Bldc, BldcParameters};
use trirrr_drives::stepper::StepsPerTurn;
use trirrr_scene::{CanProtocol, Drive, DriveKind, EnableLevel, Scene, Stepper};

/// The kinds of drive, as `cfg(drive = "...")` has them in an image.
pub(super) const KINDS: &[&str] = &[NONE, "stepper", "bldc", "odrive", "mit", "moteus"];

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
        DriveKind::Stepper(_) => "stepper",
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
pub fn drive(scene: &Scene, scalar: &str, units: &Units) -> Result<String, DriveError> {
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
            line(format_args!("{}", bldcs(drives, scalar, units)?));
            line(format_args!("{}", enable(bldc.enable)));
            line(format_args!(
                "pub const REVERSED: [bool; 3] = {reversed:?};"
            ));
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
    // Two slots for each step, one for the direction.
    let slots = (2.0 * most + 1.0) * tick_rate_hz;
    if slots > SLOTS_MAX_HZ {
        return refuse(
            index,
            key,
            format!(
                "{limit} Hz takes {slots} slots per second, two for each step and one more in \
                 each tick; a board has at most {SLOTS_MAX_HZ}"
            ),
        );
    }
    Ok(most as u32)
}

fn bldcs(drives: &[Drive; 3], scalar: &str, units: &Units) -> Result<String, DriveError> {
    let mut motors = Vec::new();
    for (index, drive) in drives.iter().enumerate() {
        let DriveKind::Bldc(bldc) = drive.kind else {
            return refuse(index, "kind", "must be that of drive[1]");
        };
        // In the units of the image: torque per ampere, and volt per rate.
        let parameters = BldcParameters {
            gear_ratio: drive.gear_ratio,
            resistance_ohm: bldc.resistance_ohm,
            torque_constant_nm_a: bldc.torque_constant_nm_a / units.torque_nm(),
            back_emf_constant_v_s_rad: bldc.back_emf_constant_v_s_rad * units.rate_rad_s(),
            supply_v: bldc.supply_v,
            current_limit_a: bldc.current_limit_a,
        };
        if scalar == FIXED {
            for (what, value) in Bldc::<f64>::build(&parameters).coefficients() {
                if !Fixed::from_f64(value).is_finite() {
                    return refuse(
                        index,
                        "kind",
                        format!(
                            "{what} is {value:.3e} in the units of the image, more than fixed \
                             point holds: take number = \"f32\""
                        ),
                    );
                }
            }
        }
        motors.push(format!("trirrr_drives::bldc::{parameters:?}"));
    }
    Ok(format!(
        "pub const MOTORS: [trirrr_drives::bldc::BldcParameters; 3] = [{}];",
        motors.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The thesis scene with these drives, at 100 ticks per second.
    fn with(drives: &str) -> Scene {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/thesis.toml");
        let text = std::fs::read_to_string(&file).expect("a shipped scene");
        let text = text.replacen("[platform]", &format!("{drives}\n[platform]"), 1);
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
        assert_eq!(drive(&scene, "f32", &Units::SI), Ok(String::new()));
        assert_eq!(kind(&scene), "none");
    }

    #[test]
    fn steppers_are_counted_in_whole_steps_of_a_tick() {
        let scene = with(&format!(
            "{STEPPER}gear_ratio = 5.18\nstep_rate_limit_hz = 20050.0\nreversed = true"
        ));
        let text = drive(&scene, "f32", &Units::SI).expect("good");
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
                "takes 200100 slots per second",
            ),
            (
                format!("{STEPPER}step_rate_limit_hz = 20e3\ngear_ratio = 1e6"),
                "drive[1].gear_ratio",
                "more than 2147483647 microsteps",
            ),
        ] {
            let error = drive(&with(&drives), "f32", &Units::SI).expect_err("refused");
            assert_eq!(error.key, key);
            assert!(error.reason.contains(reason), "{error}");
        }
    }

    #[test]
    fn a_bus_that_is_too_slow_is_refused() {
        // 3 * 135 bits * 100 Hz are 40,500 bits per second, what the drives say 44,550 more: 68 % of the slowest.
        let scene = with(&cans("odrive", "bit_rate_hz = 125000"));
        let text = drive(&scene, "f32", &Units::SI).expect("good");
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
        let error = drive(&chatty, "f32", &Units::SI).expect_err("162 %");
        assert!(
            error.to_string().contains("take 162 % of 125000"),
            "{error}"
        );
        // Each command of the MIT mode is answered: 6 * 135 * 100 are 65 %.
        let more = "model = \"dm4310\"\nkp_nm_rad = 50.0\nkd_nm_s_rad = 1.0\nbit_rate_hz = 125000";
        let mut mit = with(&cans("mit", more));
        let text = drive(&mit, "f32", &Units::SI).expect("good");
        assert!(
            text.contains("kp: 50.0, kd: 1.0, answer: trirrr_drives::can::Answer::Damiao"),
            "{text}"
        );
        assert!(text.contains("FILTERS: [(u16, u16); 3] = [(0, 2047), (0, 2047), (0, 2047)];"));
        assert_eq!(kind(&mit), "mit");
        mit.tick_rate_hz = 200.0;
        assert!(drive(&mit, "f32", &Units::SI).is_err());
    }

    #[test]
    fn limits_beyond_a_frame_are_refused() {
        let refused = |text: &str| {
            let error = drive(&with(text), "f32", &Units::SI).expect_err("refused");
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

    #[test]
    fn torque_and_rate_are_in_the_units_of_the_image() {
        let scene = with(
            "[[drive]]\nkind = \"bldc\"\nresistance_ohm = 0.5\ninductance_h = 1e-4\n\
             torque_constant_nm_a = 0.06\nsupply_v = 24.0\ncurrent_limit_a = 8.0\n\
             gear_ratio = 4.0",
        );
        let units = Units {
            length: -2,
            time: -1,
            mass: 1,
        };
        // 2^(-2*2 + 1*2 + 1) = 1/2 N m and 2 rad/s.
        let text = drive(&scene, "f32", &units).expect("good");
        for part in [
            "torque_constant_nm_a: 0.12",
            "back_emf_constant_v_s_rad: 0.12",
            "ENABLE_HIGH: bool = true;",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        // In fixed point 1 / (4 * 0.06 * 8) = 0.52 per N m; per 16 N m it is 8.3.
        assert!(drive(&scene, FIXED, &units).is_ok());
        let large = Units {
            length: 2,
            time: 0,
            mass: 0,
        };
        let error = drive(&scene, FIXED, &large).expect_err("beyond the format");
        assert_eq!(error.key, "drive[1].kind");
    }
}
