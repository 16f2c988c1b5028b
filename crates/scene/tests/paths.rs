//! Jobs along a path: `[[job.path]]`.

use trirrr_scene::{Scene, SceneError};

const OUTLINE: &str = include_str!("../../../scenes/paths/outline.toml");

/// The outline's machine with another job.
fn with_job(job: &str) -> Result<Scene, SceneError> {
    let (machine, _) = OUTLINE.split_once("[job]").expect("a job");
    let start = "start = { x_m = 0.25, y_m = 0.245, alpha_rad = 0.4 }\n";
    Scene::parse(&format!("{machine}[job]\n{start}{job}"), "path.toml")
}

fn refusal(job: &str) -> String {
    with_job(job).expect_err("refused").to_string()
}

#[test]
fn the_shipped_path_is_planned_in_every_number_type() {
    for number in ["f64", "f32", "fixed", "micromath"] {
        let text = OUTLINE.replace("number = \"f32\"", &format!("number = \"{number}\""));
        let scene = Scene::parse(&text, "outline.toml").unwrap_or_else(|error| panic!("{error}"));
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
    assert!(refusal(both).contains("expected one of line, arc, bezier and spline"));
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

const HOURGLASS: &str = include_str!("../../../scenes/paths/hourglass.toml");

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
