//! DXF files: what they give, against points that their formulas give.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use trirrr_toolpath::PathFault;
use trirrr_toolpath::drawing::{Drawing, DrawingSetup, Pen, PenKey, Stroke, StrokeCurve, read_dxf};
use trirrr_toolpath::{ToolPlace, ToolWork};

/// Lines of a file from pairs in one text: codes and values, separated by blanks.
fn pairs(text: &str) -> String {
    text.split_whitespace()
        .map(|part| part.to_owned() + "\n")
        .collect()
}

/// A file in millimetres with `entities`, and in `blocks` those of blocks.
fn file(blocks: &str, entities: &str) -> String {
    let layers = "0 SECTION 2 TABLES 0 TABLE 2 LAYER 70 3
        0 LAYER 2 cut 70 0 62 1 6 CONTINUOUS 0 LAYER 2 notes 70 0 62 -5 6 CONTINUOUS 0 ENDTAB 0 ENDSEC";
    pairs(&format!(
        "0 SECTION 2 HEADER 9 $ACADVER 1 AC1015 9 $INSUNITS 70 4 0 ENDSEC {layers}
        0 SECTION 2 BLOCKS {blocks} 0 ENDSEC 0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
    ))
}

fn read(text: &str) -> Result<Drawing, PathFault> {
    read_dxf(text.as_bytes(), |layer| layer == "left_out")
}

fn drawing(entities: &str) -> Drawing {
    read(&file("", entities)).expect(entities)
}

fn assert_near(found: [f64; 2], expected: [f64; 2], within: f64) {
    let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
    assert!(off <= within, "{found:?} is not {expected:?}");
}

fn only(drawing: &Drawing) -> &Stroke {
    let [stroke] = &drawing.strokes[..] else {
        panic!("{} strokes", drawing.strokes.len());
    };
    stroke
}

#[test]
fn lines_have_layer_colour_and_unit() {
    let found = drawing("0 LINE 8 cut 10 1 20 2 11 3 21 4");
    let stroke = only(&found);
    assert_near(stroke.start, [1e-3, 2e-3], 1e-15);
    assert_near(stroke.end(), [3e-3, 4e-3], 1e-15);
    assert_eq!(stroke.colour, Some([255, 0, 0]));
    assert_eq!(found.place_of(2), "shape 1 (LINE in line 60, layer cut)");
    let inches = file("", "0 LINE 8 0 10 0 20 0 11 1 21 0").replace("70\n4\n", "70\n1\n");
    assert_near(
        only(&read(&inches).expect("inches")).end(),
        [0.0254, 0.0],
        1e-15,
    );
    let own = drawing("0 LINE 8 cut 62 5 10 1 20 2 11 3 21 4");
    assert_eq!(only(&own).colour, Some([0, 0, 255]));
    let rgb = drawing("0 LINE 8 cut 420 66051 10 1 20 2 11 3 21 4");
    assert_eq!(only(&rgb).colour, Some([1, 2, 3]));
}

/// Circles stay circles: exact centre, radius and sense, from above and from below.
#[test]
fn arcs_are_exact() {
    for (normal, mirror) in [("", 1.0), ("210 0 220 0 230 -1", -1.0)] {
        let found = drawing(&format!("0 ARC 8 0 10 10 20 20 40 5 50 350 51 80 {normal}"));
        let stroke = only(&found);
        let at = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [mirror * (1e-2 + 5e-3 * cos), 2e-2 + 5e-3 * sin]
        };
        assert_near(stroke.start, at(350.0), 1e-15);
        let [StrokeCurve::Arc { centre, turn, to }] = stroke.curves[..] else {
            panic!("{:?}", stroke.curves);
        };
        assert_near(centre, [mirror * 1e-2, 2e-2], 1e-15);
        assert_near(to, at(80.0), 1e-15);
        assert!((turn - mirror * FRAC_PI_2).abs() < 1e-12, "{turn}");
        let back = stroke.clone().reversed();
        assert_near(
            back.points(1e-6)[1],
            stroke.points(1e-6).iter().rev().nth(1).copied().unwrap(),
            1e-12,
        );
    }
    let circle = drawing("0 CIRCLE 8 0 10 1 20 1 40 1");
    let points = only(&circle).points(1e-6);
    for pair in points.windows(2) {
        let middle = [0, 1].map(|i| 0.5 * (pair[0][i] + pair[1][i]) - 1e-3);
        let off = 1e-3 - middle[0].hypot(middle[1]);
        assert!((0.0..=1e-6).contains(&off), "{off}");
    }
    assert_near(points[0], points[points.len() - 1], 1e-15);
}

#[test]
fn a_bulge_is_the_arc_of_its_angle() {
    // A slot: two lines, and half circles of 10 mm about (30, 5) and (0, 5).
    let found =
        drawing("0 LWPOLYLINE 8 0 90 4 70 1 10 0 20 0 10 30 20 0 42 1 10 30 20 10 10 0 20 10 42 1");
    let stroke = only(&found);
    assert_eq!(stroke.curves.len(), 4);
    for (index, middle) in [(1, [0.03, 5e-3]), (3, [0.0, 5e-3])] {
        let StrokeCurve::Arc { centre, turn, .. } = stroke.curves[index] else {
            panic!("{:?}", stroke.curves[index]);
        };
        assert_near(centre, middle, 1e-12);
        assert!((turn - PI).abs() < 1e-12);
    }
    assert_near(stroke.end(), stroke.start, 1e-15);
    // Clockwise, a quarter: the centre lies to the right of the way.
    let bulge = -(PI / 8.0).tan();
    let quarter = drawing(&format!(
        "0 POLYLINE 8 0 66 1 70 0 0 VERTEX 8 0 10 0 20 0 42 {bulge} 0 VERTEX 8 0 10 10 20 10 0 SEQEND 8 0"
    ));
    let StrokeCurve::Arc { centre, turn, .. } = only(&quarter).curves[0] else {
        panic!("{quarter:?}");
    };
    assert_near(centre, [1e-2, 0.0], 1e-12);
    assert!((turn + FRAC_PI_2).abs() < 1e-12);
}

/// Largest distance from 0 of `value` over the points of a stroke.
fn worst(stroke: &Stroke, value: impl Fn(f64, f64) -> f64) -> f64 {
    let points = stroke.points(1e-8);
    points
        .iter()
        .map(|[x, y]| value(1e3 * x, 1e3 * y).abs())
        .fold(0.0, f64::max)
}

#[test]
fn ellipses_and_splines_lie_on_their_curves() {
    // Half axes 20 and 5, turned by 90 degrees.
    let found =
        drawing("0 ELLIPSE 8 0 10 0 20 0 30 0 11 0 21 20 31 0 40 0.25 41 0 42 6.283185307179586");
    let equation = |x: f64, y: f64| (x / 5.0).hypot(y / 20.0) - 1.0;
    assert!(worst(only(&found), equation) < 1e-5);
    // A cubic B-spline with one span is its Bezier curve, exactly.
    let cubic = drawing(
        "0 SPLINE 8 0 70 8 71 3 72 8 73 4 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1
        10 0 20 0 30 0 10 0 20 9 30 0 10 9 20 9 30 0 10 9 20 0 30 0",
    );
    let [StrokeCurve::Bezier(points)] = only(&cubic).curves[..] else {
        panic!("{:?}", only(&cubic).curves);
    };
    for (found, expected) in points
        .into_iter()
        .zip([[0.0, 9e-3], [9e-3, 9e-3], [9e-3, 0.0]])
    {
        assert_near(found, expected, 1e-12);
    }
    // A quarter of a circle as a rational spline of degree 2: weights 1, cos 45 degrees, 1.
    let circle = drawing(
        "0 SPLINE 8 0 70 12 71 2 72 6 73 3 40 0 40 0 40 0 40 1 40 1 40 1
        41 1 41 0.7071067811865476 41 1 10 10 20 0 30 0 10 10 20 10 30 0 10 0 20 10 30 0",
    );
    assert!(worst(only(&circle), |x, y| x.hypot(y) - 10.0) < 2e-5);
    // Two spans of degree 2 with a knot at 1: x = 10 u and y = 10 u^2, their control points by blossoming.
    let parabola = drawing(
        "0 SPLINE 8 0 70 8 71 2 72 7 73 4 40 0 40 0 40 0 40 1 40 2 40 2 40 2
        10 0 20 0 30 0 10 5 20 0 30 0 10 15 20 20 30 0 10 20 20 40 30 0",
    );
    assert!(worst(only(&parabola), |x, y| y - x * x / 10.0) < 1e-4);
}

const BLOCK: &str = "0 BLOCK 8 0 2 part 70 0 10 1 20 0 30 0
    0 LINE 8 0 62 0 10 1 20 0 11 2 21 0 0 CIRCLE 8 0 10 1 20 0 40 1 0 MTEXT 8 notes 1 hidden 0 ENDBLK 8 0";

#[test]
fn blocks_are_placed_turned_scaled_and_repeated() {
    let found = read(&file(
        BLOCK,
        "0 INSERT 8 cut 62 3 2 part 10 10 20 5 41 2 42 2 50 90 70 2 71 2 44 100 45 50",
    ))
    .expect("copies");
    assert_eq!(found.strokes.len(), 8);
    for (copy, base) in [[10.0, 5.0], [10.0, 105.0], [-40.0, 5.0], [-40.0, 105.0]]
        .iter()
        .enumerate()
    {
        let line = &found.strokes[2 * copy];
        assert_near(line.start, [1e-3 * base[0], 1e-3 * base[1]], 1e-12);
        assert_near(line.end(), [1e-3 * base[0], 1e-3 * (base[1] + 2.0)], 1e-12);
        assert_eq!(line.colour, Some([0, 255, 0]), "the colour of the copy");
        assert!(
            matches!(found.strokes[2 * copy + 1].curves[0], StrokeCurve::Arc { turn, .. } if (turn - TAU).abs() < 1e-12)
        );
    }
    assert!(
        found.place_of(1).ends_with("layer cut)"),
        "{}",
        found.place_of(1)
    );
    // Stretched, a circle becomes an ellipse.
    let found = read(&file(BLOCK, "0 INSERT 8 cut 2 part 10 0 20 0 41 3 42 1")).expect("stretched");
    let equation = |x: f64, y: f64| (x / 3.0).hypot(y) - 1.0;
    assert!(worst(&found.strokes[1], equation) < 1e-5);
    // Seen from below.
    let found = read(&file(
        BLOCK,
        "0 INSERT 8 cut 2 part 10 10 20 0 210 0 220 0 230 -1",
    ))
    .expect("mirrored");
    assert_near(found.strokes[0].end(), [-11e-3, 0.0], 1e-12);
}

#[test]
fn lines_that_meet_are_one_stroke_and_an_area() {
    let mut found = drawing(
        "0 LINE 8 0 10 0 20 0 11 10 21 0 0 LINE 8 0 10 0 20 10 11 0 21 0 0 LINE 8 0 10 10 20 0 11 10 21 10
        0 LINE 8 0 10 10 20 10 11 0 21 10 0 LINE 8 cut 10 10 20 10 11 20 21 10 0 CIRCLE 8 0 10 5 20 5 40 2",
    );
    assert_eq!(
        found.strokes.len(),
        3,
        "a square, a line on a layer of its own, a disc"
    );
    assert_eq!(found.strokes[0].curves.len(), 4);
    found.fill(1e-4).expect("lines");
    let lines: f64 = found.strokes[3..]
        .iter()
        .map(|line| (line.end()[0] - line.start[0]).abs())
        .sum();
    let area = 1e-4 - PI * 4e-6;
    assert!((1e-4 * lines / area - 1.0).abs() < 0.01, "{lines}");
}

#[test]
fn pens_are_chosen_by_layer_and_then_by_colour() {
    let pen = |power: Option<f64>| Pen {
        feed_m_s: 0.1,
        work: power.map(|power| ToolWork {
            power,
            follows_speed: true,
        }),
    };
    let setup = DrawingSetup {
        origin: ToolPlace::default(),
        scale: 1.0,
        pen: pen(Some(1.0)),
        pens: vec![
            (PenKey::Colour([255, 0, 0]), pen(None)),
            (PenKey::Layer("cut".into()), pen(Some(0.5))),
        ],
    };
    let mut found = drawing(
        "0 LINE 8 cut 10 0 20 0 11 1 21 0 0 LINE 8 0 62 1 10 0 20 5 11 1 21 5 0 LINE 8 0 10 0 20 9 11 1 21 9",
    );
    found.leave_out(&setup);
    let powers: Vec<_> = found
        .elements(&setup)
        .iter()
        .filter_map(|each| each.tool)
        .map(|tool| tool.power)
        .collect();
    assert_eq!(powers, [0.5, 1.0]);
}

#[test]
fn what_is_hidden_is_left_out_and_what_cannot_be_drawn_is_refused() {
    let line = "0 LINE 8 0 10 0 20 0 11 1 21 0";
    for quiet in [
        "0 TEXT 8 left_out 1 a",
        "0 TEXT 8 notes 1 a",
        "0 HATCH 8 0 60 1",
        "0 LINE 8 notes 10 0 20 0 11 1 21 0",
        "0 LINE 8 0 67 1 10 0 20 0 11 1 21 0",
    ] {
        assert_eq!(
            drawing(&format!("{quiet} {line}")).strokes.len(),
            1,
            "{quiet}"
        );
    }
    for (entities, word, reason) in [
        ("0 TEXT 8 0 1 a", "TEXT", "explode"),
        ("0 HATCH 8 0", "HATCH", "--hatch"),
        ("0 POINT 8 0 10 0 20 0", "POINT", "no length"),
        ("0 3DFACE 8 0", "3DFACE", "cannot be drawn"),
        ("0 WONDER 8 0", "WONDER", "cannot be drawn"),
        (
            "0 CIRCLE 8 0 10 0 20 0 40 1 210 1 220 0 230 0",
            "CIRCLE",
            "tilted",
        ),
        ("0 INSERT 8 0 2 none", "INSERT", "no block \"none\""),
        ("0 LINE 8 0 10 0 20 0 11 1e9 21 0", "LINE", "beyond"),
        ("0 LINE 8 0 10 nan 20 0 11 1 21 0", "LINE", "no number"),
        (
            "0 SPLINE 8 0 71 3 11 0 21 0 31 0 11 1 21 0 31 0",
            "SPLINE",
            "fit points",
        ),
        ("0 SPLINE 8 0 71 3 10 0 20 0 30 0", "SPLINE", "no spline"),
        ("", "", "nothing in the file is drawn"),
        (
            "0 LINE 8 0 10 1 20 1 11 1 21 1",
            "",
            "nothing in the file is drawn",
        ),
    ] {
        let fault = read(&file("", entities)).expect_err(entities);
        assert_eq!(fault.word, word, "{fault}");
        assert!(fault.reason.contains(reason), "{entities}: {fault}");
        assert_eq!(fault.line > 0, !word.is_empty(), "{fault}");
    }
    let own = "0 BLOCK 8 0 2 part 70 0 10 0 20 0 0 INSERT 8 0 2 part 0 ENDBLK 8 0";
    let fault = read(&file(own, "0 INSERT 8 0 2 part")).expect_err("a block in itself");
    assert!(fault.reason.contains("nested"), "{fault}");
    for (text, reason) in [
        ("AutoCAD Binary DXF\r\n", "binary"),
        ("AC1032", "binary"),
        ("G21\nG90\n", "no DXF"),
        ("0\n", "ends behind a code"),
        ("", "nothing"),
    ] {
        let fault = read(text).expect_err(text);
        assert!(fault.reason.contains(reason), "{text}: {fault}");
    }
}

/// A damaged file gives a drawing or a fault: nothing panics, and no stroke is lost without a word.
#[test]
fn damaged_files_give_a_drawing_or_a_fault() {
    let whole = file(
        BLOCK,
        "0 INSERT 8 cut 2 part 10 10 20 5 41 2 42 3 0 LINE 8 0 10 0 20 0 11 1 21 0
        0 LWPOLYLINE 8 0 90 2 70 1 10 0 20 0 10 30 20 0 42 1 0 ELLIPSE 8 0 10 0 20 0 11 0 21 20 40 0.25 41 0 42 6
        0 SPLINE 8 0 70 8 71 2 72 7 73 4 40 0 40 0 40 0 40 1 40 2 40 2 40 2 10 0 20 0 30 0 10 5 20 0 30 0 10 15 20 20 30 0 10 20 20 40 30 0",
    );
    let lines: Vec<&str> = whole.lines().collect();
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    let values = [
        "0",
        "-1",
        "1e308",
        "nan",
        "",
        "x",
        "SECTION",
        "ENDSEC",
        "99999999999",
        "VERTEX",
        "INSERT",
        "70",
        "10",
        "2",
    ];
    read(&whole).expect("the whole file");
    let mut drawn = 0;
    for _ in 0..4_000 {
        let mut damaged: Vec<&str> = lines.clone();
        for _ in 0..=random(3) {
            let place = random(damaged.len());
            match random(3) {
                0 => drop(damaged.remove(place)),
                1 => damaged[place] = values[random(values.len())],
                _ => damaged.insert(place, lines[random(lines.len())]),
            }
        }
        let text = damaged.join("\n");
        match read(&text) {
            Ok(drawing) => {
                drawn += 1;
                let points = drawing
                    .strokes
                    .iter()
                    .flat_map(|stroke| stroke.points(1e-5));
                assert!(points.flatten().all(f64::is_finite));
            }
            Err(fault) => assert!(!fault.reason.is_empty()),
        }
    }
    assert!(drawn > 100, "{drawn}");
}
