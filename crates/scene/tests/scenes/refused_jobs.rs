//! Jobs that cannot be done: each refused with the move, the time in it, the leg and the reason.

use crate::common::{MOTORS, THESIS, case, check, edit, problems, unlimited};
use trirrr_scene::Scene;

#[test]
#[rustfmt::skip] // two lines a case
fn tick_rates_and_durations() {
    check(THESIS, &[
        case(("tick_rate_hz = 100", 1, "tick_rate_hz = 0"),
            "tick_rate_hz", Some("0"), "must be from 1 to 100000 (Hz)"),
        case(("tick_rate_hz = 100", 1, "tick_rate_hz = -100"),
            "tick_rate_hz", Some("-100"), "must be from 1 to 100000 (Hz)"),
        case(("tick_rate_hz = 100", 1, "tick_rate_hz = 100001"),
            "tick_rate_hz", Some("100001"), "must be from 1 to 100000 (Hz)"),
        case(("tick_rate_hz = 100", 1, "tick_rate_hz = nan"),
            "tick_rate_hz", Some("nan"), "must be a finite number (Hz)"),
        case(("duration_s = 1.0", 1, "duration_s = 0.0"),
            "job.move[1].duration_s", Some("0.0"), "must be greater than 0 (s)"),
        case(("duration_s = 1.0", 1, "duration_s = -1"),
            "job.move[1].duration_s", Some("-1"), "must be greater than 0 (s)"),
        case(("duration_s = 1.0", 1, "duration_s = 1.005"),
            "job.move[1].duration_s", Some("1.005"), "the nearest durations are 1.0 and 1.01 (s)"),
        case(("duration_s = 1.0", 1, "duration_s = 0.001"),
            "job.move[1].duration_s", Some("0.001"), "the shortest duration is 0.01 (s)"),
        case(("duration_s = 1.0", 1, "duration_s = 5e7"),
            "job.move[1].duration_s", Some("5e7"), "more than the 4294967295"),
        case(("duration_s = 1.0", 1, "duration_s = inf"),
            "job.move[1].duration_s", Some("inf"), "must be a finite number (s)"),
        case(("duration_s = 1.0", 1, "duration_s = 1\nend_velocity = { vx_m_s = 0.1 }"),
            "job.move[1].end_velocity", Some("{ vx_m_s = 0.1 }"), "the last move must end at rest"),
    ]);
    let again = "[[job.move]]\nto = { x_m = 0.21, y_m = 0.22, alpha_rad = 0 }\nduration_s = 4e7\n";
    let long = edit(THESIS, "duration_s = 1.0", 1, "duration_s = 4e7\n") + again;
    let found = problems(&long);
    assert_eq!((found[0].key.as_str(), found.len()), ("job", 1), "{found:#?}");
    assert!(found[0].reason.contains("8000000000 ticks together"), "{found:#?}");

    // Without a duration, velocities that lead back.
    let back = edit(THESIS, "duration_s = 1.0", 1, "end_velocity = { vx_m_s = -0.1 }\n")
        + "[[job.move]]\nto = { x_m = 0.21, y_m = 0.22, alpha_rad = 0 }\nduration_s = 1\n";
    let found = problems(&back);
    assert_eq!((found[0].key.as_str(), found.len()), ("job.move[1].duration_s", 1), "{found:#?}");
    assert!(found[0].reason.contains("do not lead along the move, d . (v0 + v1) = -0.007"));
}

#[test]
#[rustfmt::skip] // two lines a case
fn poses_that_cannot_be_taken() {
    let start = "x_m = 0.21, y_m = 0.22, alpha_rad = 0.15707963267948966";
    let to = "x_m = 0.28, y_m = 0.28, alpha_rad = 0.20943951023931953";
    check(THESIS, &[
        case((start, 1, "x_m = 0.5, y_m = 0.1, alpha_rad = 0"),
            "job.start", Some("{ x_m = 0.5, y_m = 0.1, alpha_rad = 0 }"), "unreachable: leg 1 would span 0.5808 m, 0.1808 m beyond its reach of 0.4 m"),
        case((to, 1, "x_m = 9, y_m = 0.28, alpha_rad = 0"),
            "job.move[1].to", Some("{ x_m = 9, y_m = 0.28, alpha_rad = 0 }"), "unreachable: leg 1 would span"),
        case((to, 1, "x_m = 1e308, y_m = -1e308, alpha_rad = 1e308"),
            "job.move[1].to", Some("{ x_m = 1e308, y_m = -1e308, alpha_rad = 1e308 }"), "unreachable: leg 1"),
        // The parallel singularity at (0.245, 0.25).
        case((to, 1, "x_m = 0.245, y_m = 0.25, alpha_rad = -0.753418931929448511"),
            "job.move[1].to", Some("{ x_m = 0.245, y_m = 0.25, alpha_rad = -0.753418931929448511..."), "parallel singularity: distance"),
        // Leg 1 nearly stretched: C_1 is 0.4 cos(0.0025) m from A_1, so the angle between its
        // links is 0.005.
        case((to, 1, "x_m = 0.3650883079898806, y_m = 0.22584646564347702, alpha_rad = 0.15707963267948966"),
            "job.move[1].to", Some("{ x_m = 0.3650883079898806, y_m = 0.22584646564347702, alpha..."), "serial singularity: leg 1 is stretched, distance 0.005, the least allowed is 0.01"),
    ]);
    // With unequal links, a leg that would have to fold further than it can.
    let unequal = edit(THESIS, "distal_m = 0.2", 3, "distal_m = 0.1");
    let near = edit(&unequal, start, 1, "x_m = 0.25, y_m = 0.1, alpha_rad = 0");
    let found = problems(&near);
    assert_eq!(found[0].key, "job.start");
    assert_eq!(found[0].reason, "unreachable: leg 3 would span 0.08 m, 0.02 m short of the 0.1 m it folds to");

    let point = THESIS.replace("joint_radius_m = 0.02", "joint_radius_m = 0");
    let found = problems(&point);
    assert_eq!((found[0].key.as_str(), found.len()), ("machine", 1), "{found:#?}");
    assert!(found[0].reason.contains("platform joints fall together"));
}

#[test]
fn moves_that_meet_a_singularity_between_their_poses() {
    let to = "alpha_rad = 0.20943951023931953";
    // Half a turn: both poses are good, det A changes its sign on the way.
    let text = edit(&unlimited(), to, 1, "alpha_rad = 2.8");
    let found = problems(&text);
    let [only] = found.as_slice() else {
        panic!("{found:#?}")
    };
    assert_eq!(
        (only.key.as_str(), only.value.as_ref()),
        ("job.move[1]", None)
    );
    assert!(only.reason.starts_with("at t = 0."), "{only}");
    assert!(only.reason.contains("s of the move, x = 0.2"), "{only}");
    assert!(
        only.reason
            .contains("the parallel singularity would be 0.0"),
        "{only}"
    );

    // With no least distance, the change of sign alone gives it away, in a move of few ticks too.
    let free = "[limits]\nparallel_distance_min = 0\nserial_distance_min = 0";
    let text = edit(
        &edit(&text, "[limits]", 1, free),
        "duration_s = 1.0",
        1,
        "duration_s = 0.03",
    );
    let found = problems(&text);
    assert_eq!(
        (found[0].key.as_str(), found.len()),
        ("job.move[1]", 1),
        "{found:#?}"
    );
    assert!(
        found[0].reason.contains("det A changes its sign"),
        "{found:#?}"
    );

    // A turn in two moves: the second is the one that meets it.
    let quarter = edit(&unlimited(), to, 1, "alpha_rad = 1.0")
        + "[[job.move]]\nto = { x_m = 0.28, y_m = 0.28, alpha_rad = 2.9 }\nduration_s = 1\n";
    let found = problems(&quarter);
    assert_eq!(
        (found[0].key.as_str(), found.len()),
        ("job.move[2]", 1),
        "{found:#?}"
    );
}

#[test]
fn moves_that_leave_the_reach_between_their_poses() {
    // A velocity that throws the platform far out before it comes back.
    let text = edit(
        &unlimited(),
        "duration_s = 1.0",
        1,
        "duration_s = 1.0\nend_velocity = { vy_m_s = 4 }",
    ) + "[[job.move]]\nto = { x_m = 0.28, y_m = 0.29, alpha_rad = 0.2 }\nduration_s = 1\n";
    let found = problems(&text);
    assert!(!found.is_empty());
    for problem in &found {
        assert!(problem.key.starts_with("job.move["), "{problem}");
        assert!(problem.reason.starts_with("at t = 0."), "{problem}");
    }
    assert_eq!(found.len(), 2, "both moves swing out: {found:#?}");
}

#[test]
fn the_longest_move_is_checked_in_moderate_time() {
    let text = edit(THESIS, "duration_s = 1.0", 1, "duration_s = 83559.67");
    let found = problems(&text);
    assert_eq!(
        found[0].reason,
        "8355967 ticks; a move lasts 8355966 at most"
    );
    let text = edit(THESIS, "duration_s = 1.0", 1, "duration_s = 83559.66");
    let scene = Scene::parse(&text, "slow.toml").unwrap();
    assert_eq!(scene.ticks(), 8_355_966);
    let text = edit(
        &text,
        "alpha_rad = 0.20943951023931953",
        1,
        "alpha_rad = 2.8",
    );
    assert!(problems(&text)[0].reason.contains("parallel singularity"));
}

/// The first instant says where; the worst one by how much. Values: `tests/reference/true_massless.csv`.
#[test]
fn a_refusal_says_how_far_the_move_is_beyond_at_worst() {
    let refused = |limits: &str| problems(&edit(THESIS, MOTORS, 1, limits))[0].reason.clone();
    let reason = refused("rate_rad_s = [10, 10, 0.3]");
    assert!(reason.contains("rate of motor 3 would be 0.3"), "{reason}");
    let worst = "; at worst 0.7411 rad/s at t = 0.47 s, 2.47 times as much as allowed";
    assert!(reason.ends_with(worst), "{reason}");
    let reason = refused("torque_nm = [1, 1, 0.03]");
    let worst = "; at worst 0.03963 N m at t = 1 s, 1.321 times as much as allowed";
    assert!(reason.ends_with(worst), "{reason}");
    assert!(!reason.contains("no duration helps"), "{reason}");
    // Gravity alone asks for more than the motors may give.
    let heavy = edit(
        THESIS,
        "tick_rate_hz",
        1,
        "gravity_m_s2 = [0, -9.81]\ntick_rate_hz",
    );
    let reason = problems(&heavy)[0].reason.clone();
    assert!(
        reason.contains("; no duration helps: to stand where the move is at t = "),
        "{reason}"
    );
}

/// What the service would refuse when the move is offered is refused when the scene is read.
#[test]
fn moves_beyond_a_motors_limit() {
    let limited = |limits: &str| {
        let text = edit(THESIS, MOTORS, 1, limits);
        let found = problems(&text);
        let [only] = found.as_slice() else {
            panic!("{found:#?}")
        };
        assert_eq!(only.key, "job.move[1]");
        only.reason.clone()
    };
    // 0.0125 N m at the start of the move, by the reference data; the hold's ramp adds nothing there.
    let reason = limited("torque_nm = [0.01, 1, 1]");
    let start = "at t = 0 s of the move, x = 0.21 m, y = 0.22 m, alpha = 0.1571 rad: \
                 torque of motor 1 would be 0.01253 N m, the most allowed is 0.01 N m; ";
    assert!(reason.starts_with(start), "{reason}");
    assert!(reason.contains("s) would be long enough"), "{reason}");
    let reason = limited("rate_rad_s = 0.3");
    assert!(reason.contains("rate of motor "), "{reason}");
    assert!(
        reason.contains(" rad/s, the most allowed is 0.3 rad/s; "),
        "{reason}"
    );
    // In the middle of the move there is hardly any acceleration but that of a hold.
    let reason = limited("acceleration_rad_s2 = [1000, 3, 1000]\n[service]\nstop_time_max_s = 0.1");
    assert!(reason.contains("in a hold or a resume there"), "{reason}");
}
