//! Jobs along a path: `[[job.path]]`.

use trirrr_core::number::Arithmetic;
use trirrr_plan::course::Effort;
use trirrr_plan::piece::PlaneCurve;
use trirrr_scene::{Scene, SceneError, in_number_type, plan_job};

const ENGRAVING: &str = include_str!("../../../../scenes/engraving.toml");

/// The machine of the engraving with another job.
fn with_job(job: &str) -> Result<Scene, SceneError> {
    let (machine, _) = ENGRAVING.split_once("[job]").expect("a job");
    let start = "start = { x_m = 0.25, y_m = 0.245, alpha_rad = 0.4 }\n";
    Scene::parse(&format!("{machine}[job]\n{start}{job}"), "path.toml")
}

fn refusal(job: &str) -> String {
    with_job(job).expect_err("refused").to_string()
}

/// A client that takes the rows as they stand offers what the machine plays.
#[test]
fn the_table_of_moves_holds_the_numbers_that_are_played() {
    for number in ["f32", "fixed"] {
        let text = ENGRAVING.replace("number = \"f32\"", &format!("number = \"{number}\""));
        let scene = Scene::parse(&text, "engraving.toml").unwrap_or_else(|error| panic!("{error}"));
        let path = scene.job.path.as_ref().expect("a path");
        let planned = plan_job(&scene, path, Effort::default()).expect("a plan");
        let rows = planned.rows(&scene);
        in_number_type!(scene.number, N => {
            let units = trirrr_scene::units::<N>(&scene).unwrap();
            let [length, time] = [units.of(1, 0, 0), units.of(0, 1, 0)];
            let held = |value: f64, unit: f64| N::from_f64(value / unit).to_f64() * unit;
            for [_, _, x, y, alpha, vx, vy, valpha, ax, ay, aalpha, ..] in &rows {
                for (value, unit) in [
                    (x, length),
                    (y, length),
                    (vx, length / time),
                    (vy, length / time),
                    (valpha, 1.0 / time),
                    (ax, length / (time * time)),
                    (ay, length / (time * time)),
                    (aalpha, 1.0 / (time * time)),
                ] {
                    assert_eq!(*value, held(*value, unit), "{number}");
                }
                assert_eq!(*alpha, N::angle_to_f64(N::angle_from_f64(*alpha)), "{number}");
            }
        });
        assert_eq!(rows.len(), scene.job.moves.len() + 1, "{number}");
    }
}

/// A drawing's straight stroke, whose controls often lie on its ends: the tangents of the cubic vanish there.
#[test]
fn a_straight_bezier_is_planned_as_its_line() {
    let planned = |piece: &str| {
        let job = format!("timing = \"shortest\"\n[[job.path]]\n{piece}\n");
        let scene = with_job(&job).unwrap_or_else(|error| panic!("{error}"));
        let path = scene.job.path.as_ref().expect("a path");
        (scene.ticks(), path.pieces[0].piece.curve)
    };
    let bezier = |controls: &str, more: &str| {
        planned(&format!(
            "bezier = {{ controls_m = {controls}, x_m = 0.28, y_m = 0.28{more} }}"
        ))
    };
    let line = planned("line = { x_m = 0.28, y_m = 0.28 }");
    for controls in [
        "[[0.25, 0.245], [0.28, 0.28]]",
        "[[0.25, 0.245], [0.265, 0.2625]]",
        "[[0.26, 0.2566666666666667], [0.27, 0.2683333333333333]]",
    ] {
        let (ticks, curve) = bezier(controls, "");
        assert!(matches!(curve, PlaneCurve::Line { .. }), "{controls}");
        assert_eq!(ticks, line.0, "{controls}");
    }
    // Bent, past its end and back, and turned by another law than its way.
    for (controls, more) in [
        ("[[0.26, 0.245], [0.27, 0.28]]", ""),
        ("[[0.25, 0.245], [0.30, 0.3033333333333333]]", ""),
        ("[[0.25, 0.245], [0.28, 0.28]]", ", alpha_rad = 0.5"),
    ] {
        let (_, curve) = bezier(controls, more);
        assert!(
            matches!(curve, PlaneCurve::Cubic { .. }),
            "{controls}{more}"
        );
    }
}

#[test]
fn the_shipped_path_is_planned_in_every_number_type() {
    for number in ["f64", "f32", "fixed", "micromath"] {
        let text = ENGRAVING.replace("number = \"f32\"", &format!("number = \"{number}\""));
        let scene = Scene::parse(&text, "engraving.toml").unwrap_or_else(|error| panic!("{error}"));
        let path = scene.job.path.as_ref().expect("a path");
        assert_eq!(path.tools.len(), 12, "{number}");
        // Eleven times the least of its length over its feed, and less than half as much again.
        let straight_s = (2.0 * (0.1 + 0.05) + 0.02 * core::f64::consts::TAU) / 0.25;
        let seconds = f64::from(scene.ticks()) * scene.period_s();
        assert!(
            seconds > straight_s && seconds < 2.0 * straight_s,
            "{number}: {seconds}"
        );
        let last = scene.job.moves.last().expect("a move");
        assert!(
            (last.to.position - scene.job.start.position).amax() < 1e-9,
            "{number}"
        );
        // The tool is on along the outline and the circle, off on the way between.
        assert!(
            scene.job.moves.iter().any(|each| each.tool.is_none()),
            "{number}"
        );
        assert!(
            scene.job.moves.iter().any(|each| each.tool.is_some()),
            "{number}"
        );
        for pair in scene.job.moves.windows(2) {
            assert_eq!(pair[0].end_velocity, pair[1].start_velocity, "{number}");
        }
    }
}

#[test]
fn curves_and_rounded_corners_are_planned() {
    let scene = with_job(
        r#"
        timing = "shortest"
        corner_tolerance_m = 5e-4
        [[job.path]]
        bezier = { controls_m = [[0.26, 0.245], [0.28, 0.26]], x_m = 0.28, y_m = 0.28, alpha_rad = 0.5 }
        [[job.path]]
        line = { x_m = 0.22, y_m = 0.28 }
        [[job.path]]
        spline = { through = [{ x_m = 0.23, y_m = 0.26 }, { x_m = 0.22, y_m = 0.25, alpha_rad = 0.3 }] }
        "#,
    );
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    let stops = |each: &&trirrr_scene::JobMove| each.end_velocity.amax() == 0.0;
    assert_eq!(
        scene.job.moves.iter().filter(stops).count(),
        1,
        "it ends, and stops nowhere else"
    );
    let path = scene.job.path.as_ref().expect("a path");
    // Two corners, and a spline of two cubics.
    assert_eq!(path.pieces.len(), 3 + 2 + 1);
}

#[test]
fn keys_that_do_not_go_together_are_refused() {
    let line = "[[job.path]]\nline = { x_m = 0.3, y_m = 0.245 }\n";
    let moved =
        "[[job.move]]\nto = { x_m = 0.3, y_m = 0.245, alpha_rad = 0.4 }\nduration_s = 1.0\n";
    assert!(refusal(line).contains("it goes with timing = \"shortest\""));
    assert!(
        refusal(&format!("timing = \"shortest\"\n{moved}")).contains("a move gives its duration")
    );
    assert!(refusal("timing = \"shortest\"\n").contains("at least one [[job.path]]"));
    let both = "timing = \"shortest\"\n[[job.path]]\nline = { x_m = 0.3, y_m = 0.245 }\narc = {}\n";
    assert!(refusal(both).contains("expected one of line, arc, bezier, spline and dwell_s"));
    let nowhere = "timing = \"shortest\"\n[[job.path]]\nline = { x_m = 0.25, y_m = 0.245 }\n";
    assert!(refusal(nowhere).contains("has no length"));
    let controls = "timing = \"shortest\"\n[[job.path]]\nbezier = { controls_m = [[0.2, 0.3]], x_m = 0.3, y_m = 0.3 }\n";
    assert!(refusal(controls).contains("expected 2 vectors"));
}

#[test]
fn an_obstacle_is_named_with_its_piece_and_place() {
    let far = "timing = \"shortest\"\n[[job.path]]\nline = { x_m = 0.3, y_m = 0.245 }\n\
               [[job.path]]\nline = { x_m = 0.9, y_m = 0.245 }\n";
    let refusal = refusal(far);
    assert!(refusal.contains("job.path[2]: at p = "), "{refusal}");
    assert!(refusal.contains("leg"), "{refusal}");
}

/// A quintic given by hand: its keys, and what is refused.
#[test]
fn a_quintic_move_is_read() {
    let to = "to = { x_m = 0.26, y_m = 0.25, alpha_rad = 0.4 }\n";
    let back = "to = { x_m = 0.25, y_m = 0.245, alpha_rad = 0.4 }\n";
    let first = "end_velocity = { vx_m_s = 0.02 }\ncurve = \"quintic\"\nend_acceleration = { ay_m_s2 = 0.1 }\n";
    let job = |second: &str| {
        with_job(&format!(
            "[[job.move]]\n{to}duration_s = 0.5\n{first}[[job.move]]\n{back}{second}"
        ))
    };
    let scene =
        job("duration_s = 0.5\ncurve = \"quintic\"\n").unwrap_or_else(|error| panic!("{error}"));
    assert!(scene.job.has_quintics());
    let accelerations = scene
        .job
        .moves
        .iter()
        .map(|each| each.accelerations.map(|both| both.map(|one| one.y)));
    assert_eq!(
        accelerations.collect::<Vec<_>>(),
        [Some([0.0, 0.1]), Some([0.1, 0.0])]
    );
    let refused = |second: &str| job(second).expect_err("refused").to_string();
    let ends = "duration_s = 0.5\ncurve = \"quintic\"\nend_acceleration = { ay_m_s2 = 0.1 }\n";
    assert!(refused(ends).contains("must end without an acceleration"));
    assert!(refused("curve = \"quintic\"\n").contains("a quintic needs its duration"));
    let cubic = "duration_s = 0.5\nend_acceleration = { ay_m_s2 = 0.1 }\n";
    assert!(refused(cubic).contains("goes with curve = \"quintic\""));
    assert!(refused("duration_s = 0.5\ncurve = \"septic\"\n").contains("curve"));
}

/// The machine stands where it is told to, for as long as it is told, also on a path that goes on straight.
#[test]
fn a_dwell_stands_between_the_pieces() {
    let job = r#"
        timing = "shortest"
        corner_tolerance_m = 5e-4
        [[job.path]]
        dwell_s = 0.02
        [[job.path]]
        line = { x_m = 0.27, y_m = 0.245 }
        [[job.path]]
        dwell_s = 0.05
        tool = { power = 0.75 }
        [[job.path]]
        line = { x_m = 0.3, y_m = 0.245 }
        [[job.path]]
        line = { x_m = 0.3, y_m = 0.28 }
        [[job.path]]
        dwell_s = 0.01
        [[job.path]]
        dwell_s = 0.03
        "#;
    let scene = with_job(job).unwrap_or_else(|error| panic!("{error}"));
    let moves = &scene.job.moves;
    let stands: Vec<_> = moves
        .iter()
        .filter(|each| each.from == each.to)
        .map(|each| {
            let at = each.from.position;
            assert_eq!(each.start_velocity.amax() + each.end_velocity.amax(), 0.0);
            (each.duration_ticks, [at.x, at.y].map(|x| (x * 1e6).round()))
        })
        .collect();
    let expected = [
        (20, [250_000.0, 245_000.0]),
        (50, [270_000.0, 245_000.0]),
        (10, [300_000.0, 280_000.0]),
        (30, [300_000.0, 280_000.0]),
    ];
    assert_eq!(stands, expected);
    assert_eq!(moves[0].duration_ticks, 20);
    let tools: Vec<_> = moves.iter().filter_map(|each| each.tool).collect();
    assert_eq!(tools.len(), 1);
    assert_eq!((tools[0].power, tools[0].speed_m_s), (0.75, 0.0));
    for pair in moves.windows(2) {
        assert_eq!(pair[0].to, pair[1].from);
        assert_eq!(pair[0].end_velocity, pair[1].start_velocity);
    }
    // The corner behind the dwell is rounded, the place of the dwell is not.
    let rests = moves
        .iter()
        .filter(|each| each.end_velocity.amax() == 0.0)
        .count();
    assert_eq!(rests, 4 + 2, "four dwells, two runs");
    // Without the dwells it is faster by more than they last, for it does not stop there.
    let through = job.replace(
        "dwell_s = 0.05\n        tool = { power = 0.75 }",
        "line = { x_m = 0.271, y_m = 0.245 }",
    );
    let through = with_job(&through).unwrap_or_else(|error| panic!("{error}"));
    assert!(through.ticks() + 50 < scene.ticks());
}

#[test]
fn bad_dwells_are_refused() {
    let job = |table: &str| {
        let line = "[[job.path]]\nline = { x_m = 0.3, y_m = 0.245 }\n";
        refusal(&format!(
            "timing = \"shortest\"\n{line}[[job.path]]\n{table}\n"
        ))
    };
    assert!(
        job("dwell_s = 0.0105")
            .contains("job.path[2].dwell_s = 0.0105: must be a whole number of ticks")
    );
    assert!(job("dwell_s = -1.0").contains("must be greater than 0"));
    assert!(job("dwell_s = 0.1\nfeed_m_s = 0.1").contains("the machine stands during a dwell"));
    assert!(job("dwell_s = 0.1\nline = { x_m = 0.25, y_m = 0.245 }").contains("expected one of"));
    let long = job("dwell_s = 16648.0");
    assert!(long.contains("a dwell lasts 8355966 at most"), "{long}");
    let only = refusal("timing = \"shortest\"\n[[job.path]]\ndwell_s = 0.1\n");
    assert!(only.contains("the machine only stands"), "{only}");
}

/// A machine that plans a path itself is not told to stand on it.
#[test]
fn a_path_with_a_dwell_is_sent_as_moves() {
    let job = "timing = \"shortest\"\n[[job.path]]\nline = { x_m = 0.3, y_m = 0.245 }\n[[job.path]]\ndwell_s = 0.1\n";
    let scene = with_job(job).unwrap_or_else(|error| panic!("{error}"));
    let units = trirrr_scene::units::<f32>(&scene).expect("units");
    let refused = trirrr_scene::offer::pieces::<f32>(&scene, &units).expect_err("a dwell");
    assert!(refused.contains("job.path[2]"), "{refused}");
}

/// The shipped job of a gripper: faster than with durations by hand, the gripper closed from the dwell on.
#[test]
fn the_pick_is_faster_than_by_hand_and_holds_its_part() {
    let path = include_str!("../../../../scenes/paths/pick.toml");
    let scene = Scene::parse(path, "pick.toml").unwrap_or_else(|error| panic!("{error}"));
    let by_hand = include_str!("../../../../scenes/pick-stepper.toml");
    let by_hand = Scene::parse(by_hand, "pick-stepper.toml").expect("shipped");
    assert_eq!(scene.tick_rate_hz, by_hand.tick_rate_hz);
    assert!(2 * scene.ticks() < by_hand.ticks(), "{}", scene.ticks());
    let moves = &scene.job.moves;
    let grip = moves.iter().position(|each| each.from == each.to);
    let (open, closed) = moves.split_at(grip.expect("a dwell"));
    assert_eq!(closed[0].duration_ticks, 50);
    assert!(open.iter().all(|each| each.tool.is_none()));
    let holds = |each: &trirrr_scene::JobMove| {
        each.tool
            .is_some_and(|tool| tool.power == 1.0 && tool.speed_m_s == 0.0)
    };
    assert!(closed.iter().all(holds));
    let at = closed[0].from.position;
    assert!((at.x - 0.29).abs() < 1e-12 && (at.y - 0.26).abs() < 1e-12);
}

const HOURGLASS: &str = include_str!("../../../../scenes/paths/hourglass.toml");

#[test]
fn a_free_alpha_is_chosen_and_faster() {
    let scene = Scene::parse(HOURGLASS, "hourglass.toml").unwrap_or_else(|error| panic!("{error}"));
    let held = HOURGLASS.replace("alpha = \"free\"\n", "");
    let held = Scene::parse(&held, "held.toml").unwrap_or_else(|error| panic!("{error}"));
    assert!(f64::from(scene.ticks()) < 0.95 * f64::from(held.ticks()));
    let path = scene.job.path.as_ref().expect("a path");
    let turns = |each: &&trirrr_plan::course::PathPiece| each.piece.turning != [0.0; 3];
    assert!(path.pieces.iter().any(|each| turns(&each)));
    let first = scene.job.moves.first().expect("a move");
    assert_eq!(first.from, scene.job.start);
    // alpha is that of the file where the file says so.
    let ended = HOURGLASS.replace(
        "line = { x_m = 0.16, y_m = 0.22 }",
        "line = { x_m = 0.16, y_m = 0.22, alpha_rad = 0.3 }",
    );
    let ended = Scene::parse(&ended, "ended.toml").unwrap_or_else(|error| panic!("{error}"));
    let last = ended.job.moves.last().expect("a move");
    assert!((last.to.angle - 0.3).abs() < 1e-9);
}

#[test]
fn a_bad_alpha_is_refused() {
    let line = "[[job.path]]\nline = { x_m = 0.3, y_m = 0.245 }\n";
    let bad = refusal(&format!("timing = \"shortest\"\nalpha = \"any\"\n{line}"));
    assert!(bad.contains("job.alpha") && bad.contains("free"), "{bad}");
    let given = refusal(
        "alpha = \"free\"\n[[job.move]]\nto = { x_m = 0.3, y_m = 0.245, alpha_rad = 0.4 }\nduration_s = 1.0\n",
    );
    assert!(given.contains("job.alpha"), "{given}");
    let controls = "[[job.path]]\nbezier = { controls_m = [[0.26, 0.245], [0.28, 0.26]], \
                    x_m = 0.28, y_m = 0.28, controls_alpha_rad = [0.4, 0.4] }\n";
    let controls = refusal(&format!(
        "timing = \"shortest\"\nalpha = \"free\"\n{controls}"
    ));
    assert!(controls.contains("leaves it to the planner"), "{controls}");
    let far = "[[job.path]]\nline = { x_m = 0.9, y_m = 0.245 }\n";
    let far = refusal(&format!("timing = \"shortest\"\nalpha = \"free\"\n{far}"));
    assert!(
        far.contains("job.path[1]: at p = ")
            && far.contains("no other alpha leads past this place"),
        "{far}"
    );
    let nowhere = "[[job.path]]\nline = { x_m = 0.25, y_m = 0.245 }\n";
    let nowhere = refusal(&format!(
        "timing = \"shortest\"\nalpha = \"free\"\n{nowhere}"
    ));
    assert!(nowhere.contains("has no length"), "{nowhere}");
}

/// Where the tool changes and the motion goes on, a move ends, to half a tick.
#[test]
fn the_tool_changes_where_the_pieces_meet() {
    let on = "tool = { power = 0.8, speed_m_s = 0.25 }";
    for ends in [[0.27, 0.28, 0.305, 0.31], [0.27, 0.275, 0.282, 0.31]] {
        let mut job = String::from("timing = \"shortest\"\nfeed_m_s = 0.25\n");
        for (index, x) in ends.iter().enumerate() {
            let tool = if index % 2 == 1 { on } else { "" };
            job += &format!("[[job.path]]\nline = {{ x_m = {x}, y_m = 0.245 }}\n{tool}\n");
        }
        let scene = with_job(&job).unwrap_or_else(|error| panic!("{error}"));
        let pairs = scene.job.moves.windows(2);
        let changes: Vec<f64> = pairs
            .filter(|pair| pair[0].tool != pair[1].tool)
            .map(|pair| pair[0].to.position.x)
            .collect();
        assert_eq!(changes.len(), ends.len() - 1, "{changes:?}");
        for (change, end) in changes.iter().zip(ends) {
            let off = (change - end).abs();
            assert!(off <= 0.5 * 0.25e-3 + 1e-5, "{changes:?} of {ends:?}");
        }
        // The motion goes on there.
        let stops = scene
            .job
            .moves
            .iter()
            .filter(|each| each.end_velocity[0] == 0.0);
        assert_eq!(stops.count(), 1);
    }
}
