//! `[homing]`: what is read, what is driven on paper, and what is refused.

use crate::common::{edit, problems};
use trirrr_core::units::Units;
use trirrr_scene::{Knows, Scene};
use trirrr_service::features::Contact;

const STEPPER: &str = include_str!("../../../../scenes/pick-stepper.toml");

/// The same with homing: references 0.3 rad from the start pose.
const HOMED: &str = include_str!("../../../../scenes/pick-home.toml");

#[test]
fn homing_is_read() {
    let plain = Scene::parse(STEPPER, "pick-stepper.toml").expect("shipped");
    let scene = Scene::parse(HOMED, "pick-home.toml").expect("it can be homed");
    assert_eq!((plain.homing, &plain.job), (None, &scene.job));
    let homing = scene.homing.expect("the table is there");
    assert_eq!(homing.contact, Contact::Switch);
    assert!(homing.active_high);
    // 5 ms at 500 Hz, rounded.
    assert_eq!(homing.debounce_ticks, 3);
    assert_eq!(
        homing.motors.map(|motor| motor.positive),
        [true, false, false]
    );
    assert_eq!(homing.motors.map(|motor| motor.stage), [0; 3]);
    assert_eq!(homing.motors[1].angle_rad, -2.196);

    let parameters = homing.parameters(&scene, &Units::SI).expect("it stands");
    let times = parameters.times;
    // 0.8 rad at 0.4 rad/s, half a ramp of 0.1 s and the debounce time, in ticks of 2 ms.
    for ticks in times.search {
        assert!((1025 + 4..=1025 + 8).contains(&ticks), "{ticks}");
    }
    // The same path in other units of time takes as many ticks.
    let units = Units {
        time: -3,
        ..Units::SI
    };
    let other = homing.parameters(&scene, &units).expect("it stands");
    assert_eq!(other.times, times);
    assert_eq!(other.motors[0].search_rate_rad_s, 0.05);
}

/// A drive on the bus that does not know its joint is homed like a stepper; one that knows it is not.
#[test]
fn drives_on_the_bus_are_homed_where_they_do_not_know_their_joints() {
    let (start, end) = (HOMED.find("[[drive]]"), HOMED.find("[limits]"));
    let (start, end) = (start.expect("steppers"), end.expect("limits"));
    let with = |more: &str| {
        let drives: String = (1..=3)
            .map(|id| {
                format!("[[drive]]\nkind = \"can\"\nprotocol = \"odrive\"\nnode_id = {id}\n{more}")
            })
            .collect();
        format!("{}{drives}{}", &HOMED[..start], &HOMED[end..])
    };
    for (more, knows) in [
        ("", Knows::Nothing),
        ("absolute = \"rotor\"\n", Knows::Rotor),
    ] {
        let scene = Scene::parse(&with(more), "bus.toml").expect("it can be homed");
        let [drive, ..] = scene.drives.expect("on the bus");
        assert_eq!(drive.can().map(|can| can.knows), Some(knows));
        assert!(scene.homing.is_some() && scene.feedback.is_some());
    }
    let found = problems(&with("absolute = \"joint\"\n"));
    assert_eq!(found[0].key, "drive[1].absolute", "{found:#?}");
    assert!(
        found[0].reason.contains("for which [homing] searches"),
        "{found:#?}"
    );
}

#[test]
fn hard_stops_are_read() {
    let unfelt = edit(
        HOMED,
        "\"switches\"",
        1,
        "\"hard-stops\"\nstall_detection = false",
    );
    let unfelt = edit(&unfelt, "latch_rate_rad_s = 0.05\n", 1, "");
    let scene = Scene::parse(&unfelt, "unfelt.toml").expect("it can be homed");
    assert_eq!(
        scene.homing.map(|homing| homing.contact),
        Some(Contact::Unfelt)
    );
    let felt = edit(
        HOMED,
        "\"switches\"",
        1,
        "\"hard-stops\"\nstall_detection = true\nactive = \"low\"",
    );
    let homing = Scene::parse(&felt, "felt.toml")
        .expect("it can be homed")
        .homing;
    let homing = homing.expect("the table is there");
    assert_eq!(
        (homing.contact, homing.active_high),
        (Contact::Stall, false)
    );
    assert!(!homing.stall_is_fault);
    let watched = edit(&felt, "active = \"low\"", 1, "stall_fault = true");
    let homing = Scene::parse(&watched, "watched.toml").expect("it can be homed");
    assert!(homing.homing.expect("the table").stall_is_fault);
}

/// A scene whose drives tell their torque, homed to hard stops that the torque tells.
fn pressed(stall: &str) -> String {
    let drive = "kind = \"stepper\"\ngear_ratio = 5.0\nsteps_per_rev = 200\nmicrosteps = 16\nstep_rate_limit_hz = 40000.0\n";
    let bldc = "kind = \"bldc\"\ngear_ratio = 5.0\nencoder_counts_per_rev = 4096\nresistance_ohm = 1\n\
                inductance_h = 0.001\ntorque_constant_nm_a = 0.1\nsupply_v = 24\ncurrent_limit_a = 2\n";
    let text = edit(&edit(HOMED, drive, 1, bldc), "torque = false\n", 1, "");
    edit(
        &text,
        "\"switches\"",
        1,
        &format!("\"hard-stops\"\n{stall}"),
    )
}

#[test]
fn hard_stops_that_the_torque_tells_are_read() {
    let scene = Scene::parse(
        &pressed("stall_torque_nm = [0.2, 0.3, 0.4]"),
        "pressed.toml",
    );
    let homing = scene.expect("it can be homed").homing.expect("the table");
    assert_eq!(homing.contact, Contact::Torque);
    let torques = homing.motors.map(|motor| motor.stall_torque_nm);
    assert_eq!(torques, [0.2, 0.3, 0.4]);
    for (text, key, reason) in [
        (
            pressed("stall_torque_nm = 0.2\nstall_detection = true"),
            "homing.stall_detection",
            "goes without stall_torque_nm",
        ),
        (
            pressed("stall_torque_nm = [0.2, 1.5, 0.2]"),
            "homing.stall_torque_nm",
            "motor 2 never gives that: its current limit makes 1.0 N m",
        ),
        (
            pressed("stall_torque_nm = 0"),
            "homing.stall_torque_nm",
            "must be greater than 0 (N m)",
        ),
        (
            pressed("stall_torque_nm = 0.2\nactive = \"low\""),
            "homing.active",
            "unknown key",
        ),
        (
            pressed("stall_detection = false"),
            "homing.to",
            "take switches, or stall_torque_nm",
        ),
        (
            edit(
                HOMED,
                "\"switches\"",
                1,
                "\"hard-stops\"\nstall_torque_nm = 0.2",
            ),
            "homing.stall_torque_nm",
            "needs drives that tell their torque",
        ),
        (
            edit(
                HOMED,
                "\"switches\"",
                1,
                "\"switches\"\nstall_torque_nm = 0.2",
            ),
            "homing.stall_torque_nm",
            "unknown key",
        ),
    ] {
        let found = problems(&text);
        let met = found
            .iter()
            .any(|problem| problem.key == key && problem.reason.contains(reason));
        assert!(met, "{key}: {reason} is not in {found:?}");
    }
}

#[test]
fn sequences_are_driven_in_their_order() {
    // One by one they may move less: the platform is small and turns fast.
    let near = edit(HOMED, "[0.376, -2.196, 2.38]", 1, "[0.136, -1.956, 2.62]");
    let near = edit(&near, "back_off_rad = 0.05", 1, "back_off_rad = 0.03");
    for order in ["[1, 2, 3]", "[3, 1, 2]", "[2, 2, 1]"] {
        let text = edit(
            &near,
            "back_off_rad",
            1,
            &format!("sequence = {order}\nback_off_rad"),
        );
        Scene::parse(&text, "order.toml").expect(order);
    }
}

#[test]
fn what_cannot_be_homed_is_refused() {
    for (from, to, key, reason) in [
        (
            "to = \"switches\"",
            "to = \"encoders\"",
            "homing.to",
            "must be one of",
        ),
        (
            "to = \"switches\"",
            "to = \"hard-stops\"",
            "homing.stall_detection",
            "missing",
        ),
        (
            "direction = [1, -1, -1]",
            "direction = 0",
            "homing.direction",
            "must be 1 or -1",
        ),
        ("direction = [1, -1, -1]", "", "homing.direction", "missing"),
        (
            "latch_rate_rad_s = 0.05",
            "latch_rate_rad_s = 0.5",
            "homing.latch_rate_rad_s",
            "beyond its search rate",
        ),
        (
            "back_off_rad = 0.05",
            "back_off_rad = 0.8",
            "homing.back_off_rad",
            "not less than its largest travel",
        ),
        (
            "search_rate_rad_s = 0.4",
            "search_rate_rad_s = 6.5",
            "homing.search_rate_rad_s",
            "beyond [limits] rate_rad_s",
        ),
        (
            "acceleration_rad_s2 = 4.0",
            "acceleration_rad_s2 = 81",
            "homing.acceleration_rad_s2",
            "beyond [limits] acceleration_rad_s2",
        ),
        (
            "acceleration_rad_s2 = 4.0",
            "acceleration_rad_s2 = 0",
            "homing.acceleration_rad_s2",
            "must be greater than 0",
        ),
        (
            "travel_max_rad = 0.8",
            "travel_max_rad = 0.2",
            "homing.travel_max_rad",
            "reference of motor 1 is 0.2999 rad from the start pose",
        ),
        (
            "travel_max_rad = 0.8",
            "travel_max_rad = 4",
            "homing.travel_max_rad",
            "must be from 0 to",
        ),
        (
            "back_off_rad = 0.05",
            "back_off_rad = 0.05\nsequence = 1.5",
            "homing.sequence",
            "must be whole numbers",
        ),
        (
            "back_off_rad = 0.05",
            "back_off_rad = 0.05\nstall_fault = true",
            "homing.stall_fault",
            "unknown key",
        ),
        (
            "back_off_rad = 0.05",
            "back_off_rad = 0.05\nspeed = 2",
            "homing.speed",
            "unknown key",
        ),
    ] {
        let found = problems(&edit(HOMED, from, 1, to));
        let met = found
            .iter()
            .any(|problem| problem.key == key && problem.reason.contains(reason));
        assert!(met, "{to}: {found:?}");
    }
}

/// A way that the closed chain cannot go, with the motors' angles where it ends.
#[test]
fn a_way_through_a_singularity_is_refused() {
    let far = edit(HOMED, "[0.376, -2.196, 2.38]", 1, "[1.6, -2.196, 2.38]");
    let far = edit(&far, "travel_max_rad = 0.8", 1, "travel_max_rad = 3");
    let found = problems(&far);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].key, "homing.angle_rad");
    let reason = &found[0].reason;
    assert!(
        reason.contains("on the way to the references (sequence 1), with the motors at"),
        "{reason}"
    );
    assert!(reason.contains("singular"), "{reason}");
}

/// Motors that follow no angle, or their own.
#[test]
fn drives_that_cannot_search_are_refused() {
    let drive = "kind = \"stepper\"\ngear_ratio = 5.0\nsteps_per_rev = 200\nmicrosteps = 16\nstep_rate_limit_hz = 40000.0\n";
    let bldc = "kind = \"bldc\"\nresistance_ohm = 1\ninductance_h = 0.001\ntorque_constant_nm_a = 0.1\nsupply_v = 24\ncurrent_limit_a = 2\n";
    let text = edit(&edit(HOMED, drive, 1, bldc), "torque = false\n", 1, "");
    let found = problems(&text);
    let met = found.iter().any(|problem| {
        problem.key == "homing.to" && problem.reason.contains("only with encoder_counts")
    });
    assert!(met, "{found:?}");
    // With an encoder it searches for a switch.
    let counted = edit(
        &text,
        "current_limit_a",
        1,
        "encoder_counts_per_rev = 4096\ncurrent_limit_a",
    );
    assert!(Scene::parse(&counted, "counted.toml").is_ok());
    let slow = edit(
        HOMED,
        "step_rate_limit_hz = 40000.0",
        1,
        "step_rate_limit_hz = 1000.0",
    );
    let found = problems(&slow);
    let met = found.iter().any(|problem| {
        problem.key == "homing.search_rate_rad_s"
            && problem.reason.contains("1019 microsteps per second")
    });
    assert!(met, "{found:?}");
}
