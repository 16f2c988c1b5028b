//! Arcs: by centre, by radius, whole turns, tolerances, consistency.
use crate::common::{arc, last, motion, near, place, refused, run, same};
use trirrr_toolpath::{Act, Element, ToolCurve, ToolPlace};

/// Asserts centre, mm, and turn, degrees.
#[track_caller]
fn is(text: &str, centre: [f64; 2], turn: f64) {
    let (found, found_turn) = arc(last(text));
    let off = (found[0] - centre[0]).hypot(found[1] - centre[1]);
    assert!(off < 1e-9, "{text}: centre {found:?} is not {centre:?}");
    assert!(
        (found_turn - turn).abs() < 1e-9,
        "{text}: turn {found_turn} is not {turn}"
    );
}

/// Asserts that each arc, turned from its start, ends at its end. Returns the length of all, mm.
#[track_caller]
fn consistent(start: ToolPlace, elements: &[Element]) -> f64 {
    let mut at = start;
    let mut way = 0.0;
    for element in elements {
        let Act::Motion(motion) = element.act else {
            panic!("{element:?}")
        };
        let ToolCurve::Arc {
            centre_m: [cx, cy],
            turn_rad,
        } = motion.curve
        else {
            panic!("{element:?}")
        };
        let [x, y] = [at.position_m[0] - cx, at.position_m[1] - cy];
        let (sin, cos) = turn_rad.sin_cos();
        let end = [cx + x * cos - y * sin, cy + x * sin + y * cos];
        same(
            ToolPlace {
                position_m: end,
                ..motion.to
            },
            motion.to,
        );
        way += x.hypot(y) * turn_rad.abs() * 1000.0;
        at = motion.to;
    }
    way
}

#[test]
fn quarters_by_centre() {
    is("G0 X10\nG3 X0 Y10 I-10 F60", [0.0, 0.0], 90.0);
    is("G0 X10\nG2 X0 Y10 I-10 F60", [0.0, 0.0], -270.0);
    is("G0 Y10\nG3 X-10 Y0 J-10 F60", [0.0, 0.0], 90.0);
    is("G0 X-10\nG3 X0 Y-10 I10 F60", [0.0, 0.0], 90.0);
    is("G0 Y-10\nG2 X-10 Y0 J10 F60", [0.0, 0.0], -90.0);
    is("G0 X30 Y20\nG2 X40 Y10 J-10 F60", [30.0, 10.0], -90.0);
}

#[test]
fn a_centre_in_work_coordinates() {
    is(
        "G10 L2 P1 X100 Y50\nG0 X10 Y0\nG3 X0 Y10 I-10 J0 F60",
        [100.0, 50.0],
        90.0,
    );
    is(
        "G10 L2 P1 X100 Y50\nG92 X5\nG0 X10 Y0\nG90.1 G3 X0 Y10 I0 J0 F60",
        [-5.0, 50.0],
        90.0,
    );
    is("G90.1 G0 X10 Y0\nG2 X20 Y10 I20 J0 F60", [20.0, 0.0], -90.0);
    is(
        "G90.1\nG91.1 G0 X10 Y0\nG2 X20 Y10 I10 F60",
        [20.0, 0.0],
        -90.0,
    );
    is("G91 G0 X10\nG3 X-10 Y10 I-10 F60", [0.0, 0.0], 90.0);
    is("G20 G0 X1\nG3 X0 Y1 I-1 F60", [0.0, 0.0], 90.0);
    assert_eq!(refused("G90.1 G2 X10 I5 F60").word, "I5");
}

#[test]
fn quarters_by_radius_in_all_quadrants() {
    // Counter-clockwise about zero, the short way and the long way.
    for (from, to, other) in [
        ("X10 Y0", "X0 Y10", [10.0, 10.0]),
        ("X0 Y10", "X-10 Y0", [-10.0, 10.0]),
        ("X-10 Y0", "X0 Y-10", [-10.0, -10.0]),
        ("X0 Y-10", "X10 Y0", [10.0, -10.0]),
    ] {
        is(&format!("G0 {from}\nG3 {to} R10 F60"), [0.0, 0.0], 90.0);
        is(&format!("G0 {from}\nG3 {to} R-10 F60"), other, 270.0);
        is(&format!("G0 {from}\nG2 {to} R10 F60"), other, -90.0);
        is(&format!("G0 {from}\nG2 {to} R-10 F60"), [0.0, 0.0], -270.0);
    }
}

#[test]
fn a_radius_of_half_the_distance_is_half_a_circle() {
    is("G2 X20 R10 F60", [10.0, 0.0], -180.0);
    is("G3 X20 R10 F60", [10.0, 0.0], 180.0);
    // 0.004 mm short of a diameter, as rounding does.
    is("G3 X20.008 R10 F60", [10.004, 0.0], 180.0);
    assert_eq!(refused("G3 X20.03 R10 F60").word, "R10");
    assert_eq!(refused("G3 R10 F60").word, "R10");
    refused("G3 X0 Y0 R10 F60");
    refused("G3 X1 R0 F60");
}

#[test]
fn a_small_arc_by_radius() {
    // 3-4-5: chord 6, radius 5, height 4; the angle is 2 asin(3/5).
    is("G3 X6 R5 F60", [3.0, 4.0], 73.739_795_291_688_04);
    is("G2 X6 R-5 F60", [3.0, 4.0], -286.260_204_708_311_96);
}

#[test]
fn whole_circles() {
    is("G2 I10 F60", [10.0, 0.0], -360.0);
    is("G3 X0 Y0 J-5 F60", [0.0, -5.0], 360.0);
    is("G3 X0 I5 P3 F60", [5.0, 0.0], 1080.0);
    // Alpha goes round with the circle.
    let motion = last("G3 I10 A180 F60");
    assert_eq!(arc(motion).1, 360.0);
    same(motion.to, place(0.0, 0.0, 180.0));
}

#[test]
fn p_adds_whole_turns() {
    is("G0 X10\nG3 X0 Y10 I-10 P1 F60", [0.0, 0.0], 90.0);
    is("G0 X10\nG3 X0 Y10 I-10 P2 F60", [0.0, 0.0], 450.0);
    is("G0 X10\nG2 X0 Y10 R10 P2 F60", [10.0, 10.0], -450.0);
    for p in ["P0", "P1.5", "P-1", "P1001", "P1000000"] {
        assert_eq!(refused(&format!("G2 I10 {p} F60")).word, p);
    }
    assert_eq!(refused("G2 I10 G4 P1 F60").word, "P1");
}

#[test]
fn the_arc_mode_holds_for_lines_with_axis_words() {
    is("G0 X10\nG3 X0 Y10 I-10 F60\nX-10 Y0 J-10", [0.0, 0.0], 90.0);
    refused("G0 X10\nG3 X0 Y10 I-10 F60\nJ-10");
    refused("G0 X10\nG3 X0 Y10 I-10 F60\nX5");
}

#[test]
fn radii_may_differ_as_in_grbl() {
    let start = place(10.0, 0.0, 0.0);
    // Start 10 mm, end 9.991 mm: 0.09 %.
    for end in ["X0 Y9.991", "X0 Y10.0095", "X-9.995 Y0", "X0 Y-9.991"] {
        for code in ["G2", "G3"] {
            let (interpreter, elements) = run(&format!("G0 X10\n{code} {end} I-10 F60"));
            consistent(start, &elements[1..]);
            // The end is the one of the program, to the bit.
            let value = |at: usize| end.split(' ').nth(at).unwrap()[1..].parse::<f64>().unwrap();
            assert_eq!(interpreter.place(), place(value(0), value(1), 0.0));
        }
    }
    let fault = refused("G0 X10\nG3 X0 Y9.98 I-10 F60");
    assert!(
        fault.reason.contains("10.0000 mm") && fault.reason.contains("9.9800 mm"),
        "{fault}"
    );
    // Small arcs have 0.005 mm.
    run("G0 X1\nG3 X0 Y1.004 I-1 F60");
    refused("G0 X1\nG3 X0 Y1.006 I-1 F60");
    // Great ones have half a millimetre.
    run("G0 X1000\nG3 X0 Y1000.4 I-1000 F60");
    refused("G0 X1000\nG3 X0 Y1000.6 I-1000 F60");
}

#[test]
fn a_nearly_closed_arc_keeps_its_circle() {
    let start = place(10.0, 0.0, 0.0);
    // Ends some micrometres before and behind the start, inside and outside.
    for end in [
        "X10.004 Y-0.01",
        "X9.996 Y-0.001",
        "X10.0003 Y-0.0002",
        "X9.999 Y0.000001",
    ] {
        let (_, elements) = run(&format!("G0 X10\nG3 {end} I-10 F60"));
        let way = consistent(start, &elements[1..]);
        assert!(
            (way - 20.0 * std::f64::consts::PI).abs() < 0.05,
            "{end}: {way} mm"
        );
        for element in &elements[1..] {
            let ([x, y], _) = arc(motion(element));
            assert!(x.hypot(y) < 0.01, "{end}: the centre is at {x}, {y} mm");
        }
    }
}

#[test]
fn whole_turns_before_an_arc_with_two_radii_stay_on_the_circle() {
    let (_, elements) = run("G0 X10 A0\nG2 X0 Y9.995 I-10 P3 A90 F60\nG61 X10 Y0 J-9.995");
    let way = consistent(place(10.0, 0.0, 0.0), &elements[1..]);
    // Two turns, three quarters, and a quarter back to the start.
    assert!((way - 60.0 * std::f64::consts::PI).abs() < 0.05, "{way} mm");
    let (centre, turn) = arc(motion(&elements[1]));
    assert_eq!(centre, [0.0, 0.0]);
    near(turn, -720.0);
    // Alpha goes evenly: two turns of two and three quarters.
    near(
        motion(&elements[1]).to.alpha_rad.to_degrees(),
        90.0 * 2.0 / 2.75,
    );
    near(motion(&elements[2]).to.alpha_rad.to_degrees(), 90.0);
}

#[test]
fn an_arc_of_many_turns_is_as_many_motions() {
    for (line, turns) in [
        ("G2 X10 I-10 P1000 A90 F60", 1000.0),
        ("G3 X0 Y10 I-10 P500 A90 F60", 499.25),
        ("G3 X0 Y10 R10 P9 A90 F60", 8.25),
        // With ends at two radii.
        ("G3 X0 Y9.995 I-10 P100 A90 F60", 99.25),
    ] {
        let (_, elements) = run(&format!("G0 X10 A0\n{line}"));
        let way = consistent(place(10.0, 0.0, 0.0), &elements[1..]);
        let wanted = 20.0 * std::f64::consts::PI * turns;
        assert!((way - wanted).abs() < 0.05, "{line}: {way} mm");
        let parts = elements.len() as f64 - 1.0;
        assert!(
            (turns - 2.0..turns + 3.0).contains(&parts),
            "{line}: {parts}"
        );
        // Alpha goes evenly.
        let mut before = 0.0;
        for element in &elements[1..] {
            let alpha = motion(element).to.alpha_rad.to_degrees();
            let even = 90.0 * arc(motion(element)).1.abs() / 360.0 / turns;
            assert!((alpha - before - even).abs() < 1e-6, "{line}: {alpha}");
            before = alpha;
        }
    }
}

#[test]
fn exact_stop_holds_at_the_end_of_a_divided_arc_alone() {
    let (_, elements) = run("G0 X10\nG61.1 G3 X10.004 Y-0.01 I-10 F60");
    let stops: Vec<_> = elements[1..]
        .iter()
        .map(|element| motion(element).stops)
        .collect();
    assert_eq!(stops, [false, true]);
}

#[test]
fn an_arc_of_no_angle_is_a_whole_turn() {
    // A nanometre on a circle of 10 mm is 1e-7 rad.
    let (_, elements) = run("G0 X10\nG3 X10 Y0.000001 I-10 F60");
    let way = consistent(place(10.0, 0.0, 0.0), &elements[1..]);
    near(way, 20.0 * std::f64::consts::PI + 1e-6);
    // Ten times that is an arc.
    let (_, elements) = run("G0 X10\nG3 X10 Y0.00001 I-10 F60");
    assert!(consistent(place(10.0, 0.0, 0.0), &elements[1..]) < 2e-5);
}

#[test]
fn arcs_that_make_no_sense_are_refused() {
    for text in [
        "G2 X10 F60",
        "G2 F60",
        "G2 X10 I0 J0 F60",
        "G2 X10 I10 F60",
        "G2 X10 I5 R5 F60",
        "G1 X10 K1 F60",
        "G1 X10 I5 F60",
        "G1 X10 R5 F60",
        "I5",
    ] {
        refused(text);
    }
}

/// Programs rounded to a thousandth of a millimetre hold such arcs.
#[test]
fn an_arc_without_a_radius_is_a_line() {
    for text in ["G2 X0.001 Y0 I0.0005 F60", "G3 X0.0004 R0.0002 F60"] {
        assert_eq!(last(text).curve, trirrr_toolpath::ToolCurve::Line, "{text}");
    }
    assert!(run("G2 X0 Y0 I0.0001 F60").1.is_empty());
    assert_eq!(refused("G2 X10 I0 J0 F60").word, "I0");
}
