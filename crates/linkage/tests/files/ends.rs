//! Where motions end: dead points, change points, linkages that cannot be assembled; and drives
//! other than cranks on the frame.

use crate::{joint, link, parse, pin, shipped_text, slide};
use std::f64::consts::PI;
use trirrr_linkage::assur::{GroupKind, Linkage, Reason, Track, track};
use trirrr_linkage::{FourBar, LinkageStatus};

/// The shipped four-bar with other lengths.
fn four_bar(ground: f64, crank: f64, coupler: f64, rocker: f64, start: f64) -> Linkage {
    let text = shipped_text("four-bar")
        .replace("C = [0.4, 0.0]", &format!("C = [{ground:?}, 0.0]"))
        // The rocker first: the crank may get the length that the rocker had.
        .replace(
            "length_m = 0.25\n",
            &format!("length_m = {rocker:?} # rocker\n"),
        )
        .replace("length_m = 0.1\n", &format!("length_m = {crank:?}\n"))
        .replace("B = [0.35, 0.0]", &format!("B = [{coupler:?}, 0.0]"))
        .replace("rate_rad_s", &format!("start_rad = {start:?}\nrate_rad_s"));
    parse(&text)
}

fn stop_angle(linkage: &Linkage, track: &Track) -> f64 {
    linkage.drives[0].at(track.stop.expect("an end").t)[0]
}

#[test]
fn a_dead_point_is_found_where_the_core_computes_it() {
    let lengths = FourBar {
        ground: 0.4,
        crank: 0.25,
        coupler: 0.35,
        rocker: 0.1,
    };
    let limits: Vec<f64> = lengths.singular_positions().into_iter().flatten().collect();
    let (low, high) = (limits[0].min(limits[1]), limits[0].max(limits[1]));
    let linkage = four_bar(0.4, 0.25, 0.35, 0.1, 0.5 * (low + high));
    let track = track(&linkage);
    let stop = track.stop.unwrap();
    assert_eq!(stop.unsolved.group, 1);
    assert_eq!(
        stop.unsolved.reason,
        Reason::Dyad(LinkageStatus::Unreachable)
    );
    let angle = stop_angle(&linkage, &track);
    assert!((angle - high).abs() < 1e-9, "{angle} for {high}");
    // Everything until there is there.
    let step = linkage.motion.duration / f64::from(linkage.motion.steps);
    let last = track.positions.last().unwrap().t;
    assert!(stop.t - last < step * 1.000001 && stop.t >= last);
}

#[test]
fn a_parallelogram_ends_at_its_change_point() {
    let linkage = four_bar(0.4, 0.1, 0.4, 0.1, 1.0);
    let track = track(&linkage);
    let stop = track.stop.unwrap();
    assert_eq!(
        (stop.unsolved.group, stop.unsolved.reason),
        (1, Reason::Singular)
    );
    let angle = stop_angle(&linkage, &track);
    assert!((angle - PI).abs() < 1e-6, "{angle}");
    // On its way there it is a parallelogram: the rocker turns like the crank, or the coupler's
    // angle would change.
    let (crank, rocker) = (link(&linkage, "crank"), link(&linkage, "rocker"));
    for position in track
        .positions
        .iter()
        .filter(|p| p.groups[1].distance > 0.05)
    {
        let [a, b] = [crank, rocker].map(|link| position.states[link].motion.rate);
        assert!((a - b).abs() < 1e-9 * a.abs(), "{a} {b}");
    }
}

#[test]
fn what_cannot_be_assembled_at_the_start_has_no_position() {
    let linkage = four_bar(0.4, 0.1, 0.1, 0.1, 0.0);
    let apart = track(&linkage);
    assert!(apart.positions.is_empty());
    let stop = apart.stop.unwrap();
    assert_eq!((stop.t, stop.unsolved.group), (0.0, 1));
    assert_eq!(
        stop.unsolved.reason,
        Reason::Dyad(LinkageStatus::Unreachable)
    );

    // The triad's rod is too short to reach.
    let text = shipped_text("stephenson").replace("length_m = 0.42", "length_m = 0.05");
    let short = track(&parse(&text));
    assert!(short.positions.is_empty());
    let stop = short.stop.unwrap();
    assert_eq!((stop.t, stop.unsolved.group), (0.0, 1));
    assert!(matches!(
        stop.unsolved.reason,
        Reason::Diverged | Reason::Singular
    ));
}

#[test]
fn a_triad_ends_at_its_dead_point_without_a_jump() {
    let text = shipped_text("stephenson")
        .replace("length_m = 0.05", "length_m = 0.15")
        .replace("rate_rad_s", "start_rad = 1.57\nrate_rad_s");
    let linkage = parse(&text);
    let track = track(&linkage);
    let stop = track.stop.unwrap();
    assert_eq!(stop.unsolved.group, 1);
    assert!(track.positions.len() > 1 && stop.t > 0.0);
    // The Jacobian loses its rank there.
    let distances: Vec<f64> = track
        .positions
        .iter()
        .map(|p| p.groups[1].distance)
        .collect();
    assert!(
        *distances.last().unwrap() < 0.5 * distances[0],
        "{distances:?}"
    );
    // No link moves farther in a step than its rates say.
    for pair in track.positions.windows(2) {
        let dt = pair[1].t - pair[0].t;
        for (a, b) in pair[0].states.iter().zip(&pair[1].states) {
            let fastest = a.motion.rate.abs().max(b.motion.rate.abs());
            assert!((b.angle - a.angle).abs() <= 1.01 * fastest * dt + 1e-9);
        }
    }
}

#[test]
fn guess_and_branch_choose_the_same_way_to_assemble() {
    let by_branch = |sign: i32| {
        let text = shipped_text("slider-crank-eccentric")
            .replace("branch = 1", &format!("branch = {sign}"));
        let linkage = parse(&text);
        let slider = link(&linkage, "slider");
        track(&linkage).positions[0].states[slider].pose()
    };
    let by_guess = |x: f64| {
        let text = shipped_text("slider-crank-eccentric").replace("branch = 1\n", "").replace(
            "points_m = { B = [0.0, 0.0] }",
            &format!("points_m = {{ B = [0.0, 0.0] }}\nguess = {{ at_m = [{x}, 0.0], angle_rad = 0 }}"),
        );
        let linkage = parse(&text);
        let slider = link(&linkage, "slider");
        track(&linkage).positions[0].states[slider].pose()
    };
    assert_eq!(by_branch(1), by_guess(0.3));
    assert_eq!(by_branch(-1), by_guess(-0.3));
    assert!(by_branch(1)[0] > 0.1 && by_branch(-1)[0] < -0.1);
}

const SLIDER_DRIVEN: &str = r#"
name = "press"
[motion]
duration_s = 1.0
steps = 50
[[link]]
name = "frame"
points_m = { O = [0, 0], G = [0.05, 0.02] }
[[link]]
name = "crank"
length_m = 0.1
ends = ["O", "A"]
[[link]]
name = "rod"
length_m = 0.3
ends = ["A", "B"]
[[link]]
name = "slider"
points_m = { B = [0, 0], S = [0.01, -0.02] }
"#;

/// A driven slide is one driven link whichever side is the guide, and the slide is as asked.
#[test]
fn a_driven_slider_moves_as_asked_from_either_side() {
    for (guide, slider, angle, start, rate) in [
        ("frame.G", "slider.S", 0.2, 0.25, 0.05),
        ("slider.S", "frame.G", -0.3, -0.25, -0.05),
    ] {
        let more = format!("direction_rad = 0.3\nangle_rad = {angle:?}\noffset_m = 0.01\n");
        let joints = [
            pin("O", ["frame.O", "crank.O"]),
            pin("A", ["crank.A", "rod.A"]),
            pin("B", ["rod.B", "slider.B"]),
            slide("guide", guide, slider, &more),
        ];
        let drive = format!(
            "[[drive]]\njoint = \"guide\"\nstart_m = {start:?}\nrate_m_s = {rate:?}\n\
             acceleration_m_s2 = 0.02\n"
        );
        let text = [SLIDER_DRIVEN, &joints.concat(), &drive].concat();
        let linkage = parse(&text);
        assert_eq!(linkage.groups[0].kind, GroupKind::Driven);
        assert_eq!(linkage.groups[1].title(), "dyad RRR");
        let track = track(&linkage);
        assert_eq!(track.stop, None, "{guide}");
        assert!(track.closure < 1e-15, "{:e}", track.closure);
        for position in &track.positions {
            let slide = position.slide(&linkage, joint(&linkage, "guide")).unwrap();
            let asked = linkage.drives[0].at(position.t);
            for i in 0..3 {
                assert!((slide[i] - asked[i]).abs() < 1e-14, "{slide:?} {asked:?}");
            }
        }
    }
}

const EXCAVATOR: &str = r#"
name = "boom"
[motion]
duration_s = 2.0
steps = 80
[[link]]
name = "frame"
points_m = { O = [0, 0], Q = [0.5, -0.2] }
[[link]]
name = "boom"
points_m = { O = [0, 0], A = [0.9, 0.1], T = [2.0, 0] }
guess = { angle_rad = 0.6 }
[[link]]
name = "cylinder"
points_m = { Q = [0, 0] }
guess = { at_m = [0.5, -0.2], angle_rad = 1.4 }
[[link]]
name = "piston"
points_m = { A = [0, 0] }
guess = { at_m = [0.7, 0.6], angle_rad = 1.4 }
"#;

/// A drive between two links that move is part of a group beyond dyads.
#[test]
fn a_cylinder_between_moving_links_is_solved_by_newton_raphson() {
    let joints = [
        pin("O", ["frame.O", "boom.O"]),
        pin("A", ["boom.A", "piston.A"]),
        pin("Q", ["frame.Q", "cylinder.Q"]),
        slide("stroke", "cylinder.Q", "piston.A", ""),
    ];
    let drive = "[[drive]]\njoint = \"stroke\"\nstart_m = 0.7\nrate_m_s = 0.1\n";
    let linkage = parse(&[EXCAVATOR, &joints.concat(), drive].concat());
    assert_eq!(linkage.groups.len(), 1);
    assert_eq!(linkage.groups[0].title(), "3 links, by Newton-Raphson");
    let track = track(&linkage);
    assert_eq!(track.stop, None);
    let a = crate::point(&linkage, "boom", "A");
    for position in &track.positions {
        let m = position.point(&linkage, a);
        let from_q = m.position - nalgebra::Vector2::new(0.5, -0.2);
        let length = from_q.x.hypot(from_q.y);
        let asked = linkage.drives[0].at(position.t);
        assert!((length - asked[0]).abs() < 2e-15, "{length} {}", asked[0]);
        // The length's rate is the velocity along it.
        let rate = (from_q.x * m.velocity.x + from_q.y * m.velocity.y) / length;
        assert!((rate - asked[1]).abs() < 1e-14);
    }
    assert!(track.positions.iter().all(|p| p.groups[0].iterations > 0));
}
