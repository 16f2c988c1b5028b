//! Keys and values that a scene is refused for: each with its key, value and reason.

use crate::common::{THESIS, VERTICAL, case, check, edit, problems};
use trirrr_scene::Scene;

#[test]
#[rustfmt::skip] // two lines a case
fn numbers_of_the_machine() {
    check(THESIS, &[
        case(("distal_m = 0.2", 1, "distal_m = -0.2"),
            "machine.leg[1].distal_m", Some("-0.2"), "must be greater than 0 (m)"),
        case(("proximal_m = 0.2", 3, "proximal_m = 0"),
            "machine.leg[3].proximal_m", Some("0"), "must be greater than 0 (m)"),
        case(("proximal_m = 0.2", 2, "proximal_m = nan"),
            "machine.leg[2].proximal_m", Some("nan"), "must be a finite number (m)"),
        case(("distal_m = 0.2", 2, "distal_m = inf"),
            "machine.leg[2].distal_m", Some("inf"), "must be a finite number (m)"),
        case(("distal_m = 0.2", 2, "distal_m = 1e400"),
            "machine.leg[2].distal_m", Some("1e400"), "must be a finite number (m)"),
        case(("joint_radius_m = 0.02", 1, "joint_radius_m = -0.02"),
            "machine.leg[1].joint_radius_m", Some("-0.02"), "must not be negative (m)"),
        case(("elbow = 1", 2, "elbow = 2"), "machine.leg[2].elbow", Some("2"), "must be 1 or -1"),
        case(("elbow = 1", 1, "elbow = \"up\""),
            "machine.leg[1].elbow", Some("\"up\""), "expected 1 or -1, found a string"),
        case(("[0.5, 0.433]", 1, "[0.5]"),
            "machine.leg[2].base_m", Some("[0.5]"), "expected [x, y], a number in m each, found 1 values"),
        case(("[0.5, 0.433]", 1, "0.5"),
            "machine.leg[2].base_m", Some("0.5"), "expected [x, y], a number in m each, found a number"),
        case(("[0.5, 0.433]", 1, "[0.5, nan]"),
            "machine.leg[2].base_m[2]", Some("nan"), "must be a finite number (m)"),
        case(("mass_kg = 0.5", 1, "mass_kg = -0.5"),
            "platform.mass_kg", Some("-0.5"), "must not be negative (kg)"),
        case(("inertia_kgm2 = 0.0025000000000000005", 1, "inertia_kgm2 = -1"),
            "platform.inertia_kgm2", Some("-1"), "must not be negative (kg m^2)"),
        case(("[platform]", 1, "[platform]\ncom_m = [50, 0.0]"),
            "platform.com_m", Some("[50, 0.0]"), "more than 10 times the reach of the longest leg, 0.4 m"),
        case(("[platform]", 1, "[links]\nproximal = { mass_kg = -1 }\n[platform]"),
            "links.proximal.mass_kg", Some("-1"), "must not be negative (kg)"),
        case(("[platform]", 1, "[links]\ndistal = { mass_kg = 1, inertia_kgm2 = -1 }\n[platform]"),
            "links.distal.inertia_kgm2", Some("-1"), "must not be negative (kg m^2)"),
        case(("[platform]", 1, "[wrench]\nforce_n = [1, inf]\n[platform]"),
            "wrench.force_n[2]", Some("inf"), "must be a finite number (N)"),
        case(("[platform]", 1, "[machine.leg.links]\nproximal = { mass_kg = 1, com_m = 100 }\n[platform]"),
            "machine.leg[3].proximal_m", Some("0.2"), "com_m = 100.0, is more than 10 link lengths"),
    ]);
}

#[test]
#[rustfmt::skip] // two lines a case
fn missing_keys_and_wrong_types() {
    check(THESIS, &[
        case(("name = \"thesis\"\n", 1, ""), "name", None, "missing, expected a string"),
        case(("tick_rate_hz = 100\n", 1, ""),
            "tick_rate_hz", None, "missing, expected a number in Hz"),
        case(("distal_m = 0.2\n", 2, ""),
            "machine.leg[2].distal_m", None, "missing, expected a number in m"),
        case(("base_m = [0.5, 0.433]\n", 1, ""),
            "machine.leg[2].base_m", None, "missing, expected [x, y], a number in m each"),
        case(("elbow = 1\n", 3, ""), "machine.leg[3].elbow", None, "missing, expected 1 or -1"),
        case(("mass_kg = 0.5\n", 1, ""),
            "platform.mass_kg", None, "missing, expected a number in kg"),
        case(("x_m = 0.21, ", 1, ""), "job.start.x_m", None, "missing, expected a number in m"),
        case(("duration_s = 1.0\n", 1, ""),
            "job.move[1].duration_s", None, "from rest to rest needs its duration"),
        case(("distal_m = 0.2", 1, "distal_m = \"200 mm\""),
            "machine.leg[1].distal_m", Some("\"200 mm\""), "expected a number in m, found a string"),
        case(("mass_kg = 0.5", 1, "mass_kg = true"),
            "platform.mass_kg", Some("true"), "expected a number in kg, found a boolean"),
        case(("mass_kg = 0.5", 1, "mass_kg = 1979-05-27"),
            "platform.mass_kg", Some("1979-05-27"), "found a date or time"),
        case(("mass_kg = 0.5", 1, "mass_kg = {}"), "platform.mass_kg", Some("{}"), "found a table"),
        case(("name = \"thesis\"", 1, "name = \"thesis\"\nboard = \" \""),
            "board", Some("\" \""), "must be a shipped board, \"feather-f405\", "),
        case(("name = \"thesis\"", 1, "name = \"thesis\"\nboard = \"picoo\""),
            "board", Some("\"picoo\""), "ends in .toml; did you mean \"pico\"?"),
        case(("name = \"thesis\"", 1, "name = \"thesis\"\nname = \"other\""),
            "", None, "not TOML: duplicate key `name`"),
        case(("elbow = 1\n", 1, "elbow = \"left\"\n"),
            "machine.leg[1].elbow", Some("\"left\""), "expected 1 or -1, found a string"),
        case(("elbow = 1\n", 1, "elbow = 0.5\n"),
            "machine.leg[1].elbow", Some("0.5"), "must be 1 or -1"),
        case(("[job]", 1, "[service]\ntelemetry_ticks = \"all\"\n[job]"),
            "service.telemetry_ticks", Some("\"all\""), "expected a whole number from 1 to 65535, found a string"),
        case(("name = \"thesis\"", 1, "name = 7"),
            "name", Some("7"), "expected a string, found a number"),
        case(("description = \"", 1, "description = [] # \""),
            "description", Some("[]"), "expected a string, found an array"),
        case(("name = \"thesis\"", 1, "name = \"a/../b\""),
            "name", Some("\"a/../b\""), "letters, digits"),
        case(("name = \"thesis\"", 1, "name = \"\""), "name", Some("\"\""), "1 to 64 letters"),
        case(("number = \"f64\"", 1, "number = \"f16\""),
            "number", Some("\"f16\""), "must be one of \"f64\", \"f32\", \"fixed\", \"micromath\""),
        case(("number = \"f64\"", 1, "number = \"float32\""),
            "number", Some("\"float32\""), "\"micromath\""),
        case(("number = \"f64\"", 1, "number = \"fixd\""),
            "number", Some("\"fixd\""), "; did you mean \"fixed\"?"),
        case(("[platform]", 1, "[wrench]\nforce_n = 3\n[platform]"),
            "wrench.force_n", Some("3"), "expected [x, y], a number in N each"),
        case(("start = { x_m = 0.21, y_m = 0.22, alpha_rad = 0.15707963267948966 }", 1, "start = [0.21, 0.22]"),
            "job.start", Some("[0.21, 0.22]"), "expected a table, found an array"),
    ]);
}

#[test]
#[rustfmt::skip] // two lines a case
fn unknown_keys_suggest_the_right_one() {
    check(THESIS, &[
        case(("[platform]", 1, "[platform]\ncolour = 3"),
            "platform.colour", Some("3"), "unknown key; keys here are mass_kg, inertia_kgm2, com_m"),
        case(("[platform]", 1, "[platform]\ncom_cm = [1, 2]"),
            "platform.com_cm", Some("[1, 2]"), "did you mean `com_m`?"),
        case(("[platform]", 1, "[platform]\ngravity_m_s2 = [0, -9.81]"),
            "platform.gravity_m_s2", Some("[0, -9.81]"), "it belongs at the top of the file, before the first table"),
        case(("tick_rate_hz", 1, "nmber = \"f32\"\ntick_rate_hz"),
            "nmber", Some("\"f32\""), "did you mean `number`?"),
        case(("[job]", 1, "[job]\npause_s = 1"),
            "job.pause_s", Some("1"), "unknown key; keys here are start, move"),
        case(("[platform]", 1, "[limit]\nrate_rad_s = 1\n[platform]"),
            "limit", Some("[limit]"), "did you mean `limits`?"),
        case(("[limits]", 1, "[limits]\nrate_rps = 1"),
            "limits.rate_rps", Some("1"), "unknown key"),
        case(("duration_s", 1, "end_velocity = { vx_mm_s = 1 }\nduration_s"),
            "job.move[1].end_velocity.vx_mm_s", Some("1"), "did you mean `vx_m_s`?"),
    ]);
    // A renamed key is missing as well.
    for (from, to, key, meant) in [
        ("joint_radius_m = 0.02", "radius_mm = 20", "machine.leg[1].radius_mm", "joint_radius_m"),
        ("joint_angle_rad", "joint_angle_degrees", "machine.leg[1].joint_angle_degrees", "joint_angle_rad"),
        ("duration_s", "duration_ms", "job.move[1].duration_ms", "duration_s"),
        ("tick_rate_hz", "tick_rate", "tick_rate", "tick_rate_hz"),
        ("mass_kg", "mass_g", "platform.mass_g", "mass_kg"),
    ] {
        let found = problems(&edit(THESIS, from, 1, to));
        let [first, second] = found.as_slice() else {
            panic!("{found:#?}");
        };
        let (missing, unknown) = match first.value {
            None => (first, second),
            Some(_) => (second, first),
        };
        assert_eq!(unknown.key, key);
        assert_eq!(unknown.reason, format!("unknown key; did you mean `{meant}`?"));
        assert!(missing.key.ends_with(meant), "{found:#?}");
        assert!(missing.reason.starts_with("missing"), "{found:#?}");
    }
}

#[test]
#[rustfmt::skip] // two lines a case
fn values_in_other_units() {
    check(THESIS, &[
        case(("distal_m = 0.2", 1, "distal_mm = -200"),
            "machine.leg[1].distal_mm", Some("-200"), "must be greater than 0 (m); it is -0.2 m"),
        case(("distal_m = 0.2", 1, "distal_m = 0.2\ndistal_mm = 200"),
            "machine.leg[1].distal_mm", Some("200"), "`distal_m` is given, too; leave out one of both"),
        case(("distal_m = 0.2", 1, "distal_mm = \"200\""),
            "machine.leg[1].distal_mm", Some("\"200\""), "expected a number in mm, found a string"),
        case(("base_m = [0.5, 0.433]", 1, "base_mm = [500, nan]"),
            "machine.leg[2].base_mm[2]", Some("nan"), "must be a finite number (m)"),
        case(("rate_rad_s = 2.0", 1, "rate_rpm = -20"),
            "limits.rate_rpm", Some("-20"), "must be greater than 0 (rad/s); it is -2.094 rad/s"),
        case(("joint_angle_rad = 2.6179938779914944", 1, "joint_angle_rad = 150"),
            "machine.leg[1].joint_angle_rad", Some("150"),
            "must be within two turns, from -12.566 to 12.566 (rad); in degrees it is `joint_angle_deg`"),
        case(("joint_angle_rad = 2.6179938779914944", 1, "joint_angle_deg = 721"),
            "machine.leg[1].joint_angle_deg", Some("721"),
            "must be within two turns, from -12.566 to 12.566 (rad); it is 12.58 rad"),
        case(("alpha_rad = 0.15707963267948966", 1, "alpha_deg = nan"),
            "job.start.alpha_deg", Some("nan"), "must be a finite number (rad)"),
        case(("mass_kg = 0.5", 1, "mass_kg = 0,5"), "", None, "a number has a decimal point: 0.5, not 0,5"),
    ]);
}

#[test]
fn a_scene_in_other_units_is_the_same_scene() {
    let mut text = THESIS.to_owned();
    for (si, other) in [
        ("proximal_m = 0.2", "proximal_mm = 200"),
        ("distal_m = 0.2", "distal_mm = 200"),
        ("joint_radius_m = 0.02", "joint_radius_mm = 20"),
        ("base_m = [0.5, 0.433]", "base_mm = [500, 433]"),
        (
            "joint_angle_rad = 2.6179938779914944",
            "joint_angle_deg = 150",
        ),
        (
            "joint_angle_rad = 4.71238898038469",
            "joint_angle_deg = 270",
        ),
        (
            "x_m = 0.21, y_m = 0.22, alpha_rad = 0.15707963267948966",
            "x_mm = 210, y_mm = 220, alpha_deg = 9",
        ),
        ("rate_rad_s = 2.0", "rate_rpm = 19.098593171027442"),
    ] {
        assert!(text.contains(si), "{si}");
        text = text.replace(si, other);
    }
    let [expected, found] = [THESIS, &text].map(|text| Scene {
        key: 0,
        ..Scene::parse(text, "a.toml").unwrap_or_else(|error| panic!("{error}"))
    });
    assert_eq!(found, expected);
    // A setting replaces the value, whatever its unit in the file.
    for (text, setting) in [
        (&*text, "machine.leg[*].distal_m=0.21"),
        (THESIS, "machine.leg[*].distal_mm=210"),
    ] {
        let settings = [setting.parse().expect("a setting")];
        let scene = Scene::parse_set(text, "a.toml", &settings);
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            scene.parameters.legs.map(|leg| leg.distal_m),
            [0.21; 3],
            "{setting}"
        );
    }
}

#[test]
#[rustfmt::skip] // two lines a case
fn the_service_and_the_tool() {
    check(THESIS, &[
        case(("[platform]", 1, "[service]\nsilence_timeout_s = 0\n[platform]"),
            "service.silence_timeout_s", Some("0"), "must be greater than 0 (s)"),
        case(("[platform]", 1, "[service]\nhold_ramp_s = 4e3\n[platform]"),
            "service.hold_ramp_s", Some("4e3"), "must be at most 3600 (s)"),
        case(("[platform]", 1, "[service]\nstop_time_max_s = 0.05\n[platform]"),
            "service.stop_time_max_s", Some("0.05"), "must be at least hold_ramp_s, 0.1 (s)"),
        case(("[platform]", 1, "[service]\nhold_ramp_ms = 100\n[platform]"),
            "service.hold_ramp_ms", Some("100"), "did you mean `hold_ramp_s`?"),
        case(("[platform]", 1, "[service]\nplans_paths = 1\n[platform]"),
            "service.plans_paths", Some("1"), "expected true or false, found a number"),
        case(("[limits]", 1, "[service]\nplans_paths = true\n[limits]\njerk_rad_s3 = 1e5"),
            "service.plans_paths", Some("true"), "knows no limit of jerk: leave [limits] jerk_rad_s3 out, or plan on the host"),
        case(("[platform]", 1, "[service]\nupdate = true\nscene_over_line = true\n[platform]"),
            "service.scene_over_line", Some("true"), "needs adjustable = true beside it: such an image builds machines from values"),
        case(("[platform]", 1, "[service]\nadjustable = true\nscene_over_line = true\n[platform]"),
            "service.scene_over_line", Some("true"), "needs update = true beside it: such an image has the flash to keep a scene in"),
        case(("[platform]", 1, "[service]\ntelemetry_ticks = 0\n[platform]"),
            "service.telemetry_ticks", Some("0"), "must be a whole number from 1 to 65535"),
        case(("[platform]", 1, "[service]\ntelemetry_ticks = 2.5\n[platform]"),
            "service.telemetry_ticks", Some("2.5"), "must be a whole number"),
        case(("duration_s", 1, "tool = { power = 1.5, speed_m_s = 0.1 }\nduration_s"),
            "job.move[1].tool.power", Some("1.5"), "must be from 0 to 1"),
        case(("duration_s", 1, "tool = { power = 0.5, speed_m_s = 0 }\nduration_s"),
            "job.move[1].tool.speed_m_s", Some("0"), "must be greater than 0 (m/s)"),
        case(("duration_s", 1, "tool = { speed_m_s = 0.1 }\nduration_s"),
            "job.move[1].tool.power", None, "missing, expected a number"),
        case(("duration_s", 1, "tool = 0.5\nduration_s"),
            "job.move[1].tool", Some("0.5"), "expected a table, found a number"),
        case(("[platform]", 1, "service = 3\n[platform]"), "machine.leg[3].service", Some("3"), "unknown key"),
    ]);
}

#[test]
#[rustfmt::skip] // two lines a case
fn drives_and_limits() {
    check(VERTICAL, &[
        case(("kind = \"bldc\"", 1, "kind = \"servo\""),
            "drive[1].kind", Some("\"servo\""), "must be one of \"bldc\", \"stepper\", \"can\""),
        case(("gear_ratio = 9.0", 1, "gear_ratio = 0"),
            "drive[1].gear_ratio", Some("0"), "must be greater than 0"),
        case(("gear_ratio = 9.0", 1, "gear_ratio = 1e200"),
            "drive[1].gear_ratio", Some("1e200"), "N^2 J_r, is not a finite number"),
        case(("rotor_inertia_kgm2 = 2.2e-5", 1, "rotor_inertia_kgm2 = -1"),
            "drive[1].rotor_inertia_kgm2", Some("-1"), "must not be negative (kg m^2)"),
        case(("resistance_ohm = 0.35", 1, "resistance_ohm = 0"),
            "drive[1].resistance_ohm", Some("0"), "must be greater than 0 (ohm)"),
        case(("supply_v = 36.0\n", 1, ""),
            "drive[1].supply_v", None, "missing, expected a number in V"),
        case(("supply_v = 36.0", 1, "supply_v = 36.0\nmicrosteps = 3"),
            "drive[1].microsteps", Some("3"), "unknown key"),
        case(("current_limit_a = 20.0", 1, "current_limit_a = -2"),
            "drive[1].current_limit_a", Some("-2"), "must be greater than 0 (A)"),
        case(("rate_rad_s = 5.0", 1, "rate_rad_s = 0"),
            "limits.rate_rad_s", Some("0"), "must be greater than 0 (rad/s)"),
        case(("[15.0, 15.0, 10.0]", 1, "[15.0, 15.0]"),
            "limits.power_w", Some("[15.0, 15.0]"), "a number in W, or three of them, found 2 values"),
        case(("[15.0, 15.0, 10.0]", 1, "[15.0, -1, 10.0]"),
            "limits.power_w[2]", Some("-1"), "must be greater than 0 (W)"),
        case(("rate_rad_s = 5.0", 1, "jerk_rad_s3 = [1, 0, 1]"),
            "limits.jerk_rad_s3[2]", Some("0"), "must be greater than 0 (rad/s^3)"),
        case(("serial_distance_min = 0.1", 1, "serial_distance_min = 1"),
            "limits.serial_distance_min", Some("1"), "at least 0 and less than 1"),
        case(("gravity_m_s2 = [0.0, -9.81]", 1, "gravity_m_s2 = -9.81"),
            "gravity_m_s2", Some("-9.81"), "expected [x, y], a number in m/s^2 each"),
    ]);
    let drive = |kind: &str| edit(THESIS, "[platform]", 1, &format!("[[drive]]\n{kind}\n[platform]"));
    for (text, key, reason) in [
        ("kind = \"stepper\"\nsteps_per_rev = 200\nmicrosteps = 1.5", "drive[1].microsteps", "must be a whole number"),
        ("kind = \"stepper\"\nsteps_per_rev = 0\nmicrosteps = 16", "drive[1].steps_per_rev", "must be a whole number from 1 to 100000"),
        ("kind = \"can\"\nprotocol = \"odrive\"\nnode_id = 64", "drive[1].node_id", "must be a whole number from 0 to 63"),
        ("kind = \"can\"\nprotocol = \"moteus\"\nnode_id = 1", "drive[1].node_id", "give three [[drive]]"),
        ("kind = \"can\"\nprotocol = \"odrive\"\nnode_id = 1\nbit_rate_hz = 300000", "drive[1].bit_rate_hz", "must be 125000, 250000,"),
        ("kind = \"can\"\nprotocol = \"moteus\"\nnode_id = 1\nbit_rate_hz = 500000", "drive[1].bit_rate_hz", "unknown key"),
        ("kind = \"can\"\nprotocol = \"moteus\"\nnode_id = 1\nmessages_hz = 100", "drive[1].messages_hz", "unknown key"),
        ("kind = \"can\"\nprotocol = \"odrive\"\nnode_id = 1\nabsolute = \"nothing\"", "drive[1].absolute", "needs [homing]"),
        ("kind = \"can\"\nprotocol = \"odrive\"\nnode_id = 1\nabsolute = \"link\"", "drive[1].absolute", "must be one of"),
        ("kind = \"can\"\nprotocol = \"mit\"\nnode_id = 1\nmodel = \"dm9\"", "drive[1].model", "must be one of \"ak10-9\""),
        ("kind = \"can\"\nprotocol = \"mit\"\nnode_id = 1\nmodel = \"rs00\"\nkp_nm_rad = 501\nkd_nm_s_rad = 1", "drive[1].kp_nm_rad", "must be from 0 to 500"),
        ("kind = \"can\"\nprotocol = \"mit\"\nnode_id = 16\nmodel = \"dm4310\"\nkp_nm_rad = 1\nkd_nm_s_rad = 1", "drive[1].node_id", "from 1 to 15"),
        ("kind = \"stepper\"\nsteps_per_rev = 200\nmicrosteps = 16\nenable = \"on\"", "drive[1].enable", "must be one of \"low\", \"high\""),
        ("kind = \"stepper\"\nsteps_per_rev = 200\nmicrosteps = 16\nreversed = 1", "drive[1].reversed", "expected true or false"),
    ] {
        let mut found = problems(&drive(text));
        found.retain(|problem| problem.key == key || !problem.key.ends_with("node_id"));
        assert_eq!((found[0].key.as_str(), found.len()), (key, 1), "{found:#?}");
        assert!(found[0].reason.contains(reason), "{found:#?}");
    }
    let can = |id| format!("[[drive]]\nkind = \"can\"\nprotocol = \"moteus\"\nnode_id = {id}\n");
    let three = [can(1), can(2), can(1), "[platform]".into()].concat();
    let found = problems(&edit(THESIS, "[platform]", 1, &three));
    assert_eq!((found[0].key.as_str(), found.len()), ("drive[3].node_id", 1), "{found:#?}");
    assert_eq!(found[0].reason, "is already the address of drive[1]");
    let mit = |id: u8, kp: f64| {
        format!(
            "[[drive]]\nkind = \"can\"\nprotocol = \"mit\"\nnode_id = {id}\nmodel = \"dm4310\"\nkp_nm_rad = {kp}\nkd_nm_s_rad = 1\n"
        )
    };
    let odrive = |id| format!("[[drive]]\nkind = \"can\"\nprotocol = \"odrive\"\nnode_id = {id}\n");
    let stepper = |more| format!("[[drive]]\nkind = \"stepper\"\nsteps_per_rev = 200\nmicrosteps = 16\n{more}\n");
    for (three, key, reason) in [
        ([can(1), can(2), odrive(3)], "drive[3].protocol", "all three are on one bus"),
        ([odrive(1), stepper(""), odrive(3)], "drive[2].kind", "a board drives three of one kind"),
        ([odrive(1), odrive(2) + "bit_rate_hz = 500000\n", odrive(3)], "drive[2].bit_rate_hz", "one bus"),
        ([mit(1, 9.0), mit(2, 9.0), mit(3, 8.0)], "drive[3].kp_nm_rad", "one for all three"),
        ([stepper(""), stepper(""), stepper("enable = \"high\"")], "drive[3].enable", "one line switches"),
    ] {
        let text = three.concat() + "[platform]";
        let found = problems(&edit(THESIS, "[platform]", 1, &text));
        assert_eq!((found[0].key.as_str(), found.len()), (key, 1), "{found:#?}");
        assert!(found[0].reason.contains(reason), "{found:#?}");
    }
}

const PLANT: &str = include_str!("../../../../scenes/plant-reference.toml");

#[test]
#[rustfmt::skip] // two lines a case
fn plants() {
    check(PLANT, &[
        case(("inductance_h = 1e-4", 1, "inductance_h = -1e-4"),
            "drive[1].inductance_h", Some("-1e-4"), "must be greater than 0 (H)"),
        case(("settle_s = 0.2", 1, "settle_s = -1"),
            "plant.settle_s", Some("-1"), "must not be negative (s)"),
        case(("record_s = 0.001", 1, "record_s = 0"),
            "plant.record_s", Some("0"), "must be greater than 0 (s)"),
        case(("settle_s = 0.2", 1, "method = \"rk4\"\nstep_s = 1.3"),
            "plant.step_s", Some("1.3"), "a step longer than the run, which lasts 1 s"),
        case(("settle_s = 0.2", 1, "method = \"rk4\""),
            "plant.step_s", None, "missing, expected a number in s"),
        case(("settle_s = 0.2", 1, "method = \"rk4\"\nstep_s = 0"),
            "plant.step_s", Some("0"), "must be greater than 0 (s)"),
        case(("settle_s = 0.2", 1, "method = \"radau-iia\"\nstep_s = 1e-4"),
            "plant.step_s", Some("1e-4"), "belongs to method = \"semi-implicit-euler\" or \"rk4\""),
        case(("settle_s = 0.2", 1, "step_s = 1e-4"),
            "plant.step_s", Some("1e-4"), "belongs to method = \"semi-implicit-euler\" or \"rk4\""),
        case(("settle_s = 0.2", 1, "method = \"rk4\"\nstep_s = 1e-4\ntolerance = 1e-6"),
            "plant.tolerance", Some("1e-6"), "belongs to method = \"dormand-prince\""),
        case(("settle_s = 0.2", 1, "method = \"leapfrog\""),
            "plant.method", Some("\"leapfrog\""), "must be one of \"auto\", \"semi-implicit-euler\""),
        case(("settle_s = 0.2", 1, "tolerance = 1"),
            "plant.tolerance", Some("1"), "must be from 1e-14 to 0.1"),
        case(("settle_s = 0.2", 1, "mass_factor = 0"),
            "plant.mass_factor", Some("0"), "must be from 0.01 to 100"),
        case(("gear_ratio", 1, "encoder_counts_per_rev = 1.5\ngear_ratio"),
            "drive[1].encoder_counts_per_rev", Some("1.5"), "must be a whole number from 4 to"),
        case(("gear_ratio", 1, "command_duty = [0.5, 0.5]\ngear_ratio"),
            "drive[1].command_duty", Some("[0.5, 0.5]"), "both ends are the same"),
        case(("gear_ratio", 1, "full_scale_a = 1.0\ngear_ratio"),
            "drive[1].full_scale_a", Some("1.0"), "current_limit_a is 20"),
        case(("gear_ratio", 1, "command_hz = 10\ngear_ratio"),
            "drive[1].command_hz", Some("10"), "must be from 50 to 100000"),
        case(("timing = \"continuous\"", 1, "timing = \"continuous\"\nki_nm_rad_s = 3"),
            "controller.ki_nm_rad_s", Some("3"), "must be 0 with timing"),
        case(("settle_s = 0.2", 1, "following_error_rad = 0"),
            "plant.following_error_rad", Some("0"), "must be greater than 0 (rad)"),
        case(("kp_nm_rad = 2000.0", 1, "kp_nm_rad = -1"),
            "controller.kp_nm_rad", Some("-1"), "must not be negative (N m/rad)"),
        case(("kd_nm_s_rad = 5.0\n", 1, ""),
            "controller.kd_nm_s_rad", None, "missing, expected a number, or three"),
        case(("feed_forward = false", 1, "feed_forward = 0"),
            "controller.feed_forward", Some("0"), "expected true or false, found a number"),
        case(("timing = \"continuous\"", 1, "timing = \"sometimes\""),
            "controller.timing", Some("\"sometimes\""), "must be one of \"continuous\", \"sampled\""),
        case(("timing = \"continuous\"", 1, "rate_hz = 1500"),
            "controller.rate_hz", Some("1500"), "a whole multiple of tick_rate_hz = 1000"),
        case(("timing = \"continuous\"", 1, "timing = \"continuous\"\nrate_hz = 1000"),
            "controller.rate_hz", Some("1000"), "unknown key"),
        case(("[job]", 1, "[plant.friction]\nelbow = { coulomb_nm = 1, stick_rad_s = 0 }\n[job]"),
            "plant.friction.elbow.stick_rad_s", Some("0"), "must be greater than 0 (rad/s)"),
        case(("[job]", 1, "[plant.transmission]\nstiffness_nm_rad = 0\n[job]"),
            "plant.transmission.stiffness_nm_rad", Some("0"), "must be greater than 0 (N m/rad)"),
        case(("[job]", 1, "[plant.transmission]\ndamping_nm_s_rad = 1\n[job]"),
            "plant.transmission.stiffness_nm_rad", None, "missing, expected a number in N m/rad"),
    ]);
    let transmission = edit(PLANT, "[job]", 1, "[plant.transmission]\nstiffness_nm_rad = 1e4\n[job]");
    for (base, from, to, key, reason) in [
        (&transmission, "rotor_inertia_kgm2 = 1e-5", "", "plant.transmission", "needs a rotor to turn against"),
        (&edit(PLANT, "[controller]", 1, "[other]"), "", "", "controller", "driven by torque needs one"),
    ] {
        let text = if from.is_empty() { base.clone() } else { edit(base, from, 1, to) };
        let found = problems(&text);
        let named = found.iter().find(|problem| problem.key == key);
        assert!(named.is_some_and(|problem| problem.reason.contains(reason)), "{found:#?}");
    }
    let start = PLANT.find("[[drive]]").unwrap();
    let end = PLANT.find("[plant]").unwrap();
    for (drive, key, reason) in [
        ("kind = \"can\"\nprotocol = \"odrive\"\nnode_id = ", "controller", "computes in samples"),
        ("kind = \"stepper\"\nsteps_per_rev = 200\nmicrosteps = ", "drive", "needs the holding_torque_nm"),
        ("kind = \"stepper\"\nholding_torque_nm = 1\nsteps_per_rev = 200\nmicrosteps = ", "controller", "has to be sampled"),
        ("kind = \"stepper\"\nholding_torque_nm = 1\npull_out_rate_rad_s = 9\npull_out_torque_nm = 1\nsteps_per_rev = 200\nmicrosteps = ",
            "drive[1].pull_out_torque_nm", "must be less than holding_torque_nm"),
    ] {
        let drives: String = (1..=3).map(|id| format!("[[drive]]\n{drive}{id}\n")).collect();
        let text = format!("{}{drives}{}", &PLANT[..start], &PLANT[end..]);
        let found = problems(&text);
        assert_eq!(found[0].key, key, "{found:#?}");
        assert!(found[0].reason.contains(reason), "{found:#?}");
    }
}

#[test]
#[rustfmt::skip] // two lines a case
fn torques_that_are_left_out_and_asked_for() {
    check(THESIS, &[
        case(("tick_rate_hz", 1, "torque = 0\ntick_rate_hz"),
            "torque", Some("0"), "found a number"),
    ]);
    let none = "torque = false\ntick_rate_hz";
    let found = problems(&edit(VERTICAL, "tick_rate_hz", 1, none));
    let reasons: Vec<&str> = found.iter().map(|problem| problem.reason.as_str()).collect();
    assert_eq!(reasons, [
        "[limits] torque_nm needs the torques that this leaves out",
        "[limits] power_w needs the torques that this leaves out",
        "a [[drive]] of kind \"bldc\" needs the torques that this leaves out",
        "[controller] feed_forward, which is true unless it says false, needs the torques that this leaves out",
    ]);
    let plant = include_str!("../../../../scenes/plant-thesis.toml");
    let found = problems(&edit(plant, "tick_rate_hz", 1, none));
    assert_eq!(found.len(), 3, "{found:#?}");
    assert!(found[0].reason.starts_with("[limits] torque_nm"), "{found:#?}");
    assert!(found[1].reason.starts_with("a [[drive]] of kind \"bldc\""), "{found:#?}");
    assert!(found[2].reason.starts_with("[controller] feed_forward"), "{found:#?}");
}

/// A table of tolerances at the end of the thesis scene.
fn with_tolerances(table: &str) -> String {
    format!("{THESIS}\n[tolerances]\n{table}\n")
}

#[test]
fn tolerances_that_no_machine_can_have() {
    for (table, key, value, reason) in [
        (
            "distal_m = -1e-4",
            "distal_m",
            "-1e-4",
            "must not be negative (m)",
        ),
        (
            "distal_m = nan",
            "distal_m",
            "nan",
            "must be a finite number (m)",
        ),
        (
            "distal_m = 0.2",
            "distal_m",
            "0.2",
            "must be less than the length of the distal link of leg 1, 0.2 (m): give the half-width",
        ),
        (
            "proximal_m = [1e-4, 1e-4, 0.3]",
            "proximal_m",
            "[1e-4, 1e-4, 0.3]",
            "less than the length of the proximal link of leg 3, 0.2 (m)",
        ),
        (
            "base_m = 0.4",
            "base_m",
            "0.4",
            "less than the reach of leg 1, 0.4 (m)",
        ),
        (
            "joint_m = 1",
            "joint_m",
            "1",
            "less than the reach of leg 1, 0.4 (m)",
        ),
        (
            "motor_angle_rad = 4",
            "motor_angle_rad",
            "4",
            "must be from 0 to 3.14159",
        ),
        (
            "rotor_inertia_fraction = 1",
            "rotor_inertia_fraction",
            "1",
            "must be at least 0 and less than 1",
        ),
        (
            "platform = { mass_fraction = 1.5 }",
            "platform.mass_fraction",
            "1.5",
            "must be at least 0 and less than 1",
        ),
        (
            "links = { com_m = 0.5 }",
            "links",
            "{ com_m = 0.5 }",
            "com_m = 0.5 must be less than the reach of the longest leg, 0.4 (m)",
        ),
        (
            "wrench = { force_n = -1 }",
            "wrench.force_n",
            "-1",
            "must not be negative (N)",
        ),
        (
            "distal_cm = 0.1",
            "distal_cm",
            "0.1",
            "unknown key; did you mean `distal_m`?",
        ),
    ] {
        let found = problems(&with_tolerances(table));
        let [only] = found.as_slice() else {
            panic!("one problem expected of {table}: {found:#?}");
        };
        assert_eq!(only.key, format!("tolerances.{key}"), "{table}");
        assert_eq!(only.value.as_deref(), Some(value), "{table}");
        assert!(only.reason.contains(reason), "{:?} in {only:?}", reason);
    }
}
