//! DXF files: what they give, against points that their formulas give.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use trirrr_toolpath::PathFault;
use trirrr_toolpath::drawing::{
    Drawing, DrawingSetup, DxfChoices, Pen, PenKey, Stroke, StrokeCurve, read_dxf,
};
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
    read_dxf(text.as_bytes(), &left_out())
}

fn left_out() -> DxfChoices {
    DxfChoices {
        layers: vec!["left_out".into()],
        ..DxfChoices::default()
    }
}

/// Texts of the remarks, with their lines.
fn remarks(drawing: &Drawing) -> String {
    let texts = drawing.remarks.iter().map(ToString::to_string);
    texts.collect::<Vec<_>>().join("; ")
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
        ("0 LINE 8 0 10 0 20 0 11 1e99 21 0", "LINE", "beyond"),
        ("0 LINE 8 0 10 nan 20 0 11 1 21 0", "LINE", "no number"),
        ("0 LINE 8 0 10 1,5 20 0 11 1 21 0", "1,5", "comma: 1.5"),
        (
            "0 ARC 8 0 10 0 20 0 40 -,25 50 0 51 9",
            "-,25",
            "comma: -.25",
        ),
        (
            "0 ARC 8 0 10 1.234,5 20 0 40 2 50 0 51 9",
            "1.234,5",
            "one decimal sign",
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

/// Layers that are frozen are not drawn; their names have letters of any case.
#[test]
fn frozen_layers_are_left_out() {
    for (flags, drawn) in [
        (0, 2),
        (1, 1),
        (2, 2),
        (3, 1),
        (4, 2),
        (5, 1),
        (64, 2),
        (65, 1),
    ] {
        let lines = "0 LINE 8 cut 10 0 20 0 11 1 21 0 0 LINE 8 Notes 10 0 20 5 11 1 21 5";
        let text = file("", lines).replace(
            "notes\n70\n0\n62\n-5",
            &format!("notes\n70\n{flags}\n62\n5"),
        );
        assert_eq!(
            read(&text).expect("a drawing").strokes.len(),
            drawn,
            "{flags}"
        );
    }
    // In blocks, too.
    let block = "0 BLOCK 8 0 2 part 70 0 10 0 20 0 0 LINE 8 CUT 10 0 20 0 11 9 21 0 0 ENDBLK 8 0";
    let text = file(block, "0 INSERT 8 0 2 PART 0 LINE 8 0 10 0 20 5 11 1 21 5");
    assert_eq!(read(&text).expect("both").strokes.len(), 2);
    let frozen = text.replace("cut\n70\n0", "cut\n70\n1");
    assert_eq!(read(&frozen).expect("one").strokes.len(), 1);
}

/// Entities that do not lie at one height are refused with their line; a height as a whole has no effect.
#[test]
fn entities_out_of_the_plane_are_refused() {
    for entity in [
        "LINE 8 0 10 0 20 0 30 0 11 30 21 0 31 40",
        "LINE 8 0 10 0 20 0 30 0 11 0 21 0 31 40",
        "LINE 8 0 10 0 20 0 30 5 11 30 21 0",
        "POLYLINE 8 0 66 1 70 8 0 VERTEX 8 0 10 0 20 0 30 0 70 32 0 VERTEX 8 0 10 9 20 0 30 2 70 32 0 SEQEND 8 0",
        "ELLIPSE 8 0 10 0 20 0 11 9 21 0 31 1 40 0.5 41 0 42 6",
        "SOLID 8 0 10 0 20 0 30 0 11 9 21 0 31 0 12 0 22 9 32 4 13 9 23 9 33 4",
        "SPLINE 8 0 70 8 71 1 72 4 73 2 40 0 40 0 40 1 40 1 10 0 20 0 30 0 10 9 20 0 30 9",
        "SPLINE 8 0 70 8 71 3 74 3 11 0 21 0 31 0 11 9 21 0 31 9 11 9 21 9 31 0",
        "LWPOLYLINE 8 0 90 2 70 0 210 1 220 0 230 1 10 0 20 0 10 9 20 0",
    ] {
        let fault = read(&file("", &format!("0 {entity}"))).expect_err(entity);
        assert!(
            fault.reason.contains("tilted") && fault.line > 50,
            "{entity}: {fault}"
        );
        assert!(entity.starts_with(&fault.word), "{fault}");
    }
    for flat in [
        "LINE 8 0 10 0 20 0 30 7 11 30 21 0 31 7",
        "LINE 8 0 10 0 20 0 30 0 11 30 21 0 31 1e-6",
        "POLYLINE 8 0 66 1 70 8 0 VERTEX 8 0 10 0 20 0 30 2 70 32 0 VERTEX 8 0 10 9 20 0 30 2 70 32 0 SEQEND 8 0",
    ] {
        assert_eq!(drawing(&format!("0 {flat}")).strokes.len(), 1);
    }
}

/// The curve goes through its points with a curvature without steps: exact for parabolas of the chord, near a circle's points.
#[test]
fn splines_of_fit_points_go_through_them() {
    for text in [
        "0 SPLINE 8 0 70 8 71 3 74 3 11 0 21 0 31 0 11 25 21 20 31 0 11 50 21 0 31 0",
        "0 SPLINE 8 0 70 8 71 3 72 0 73 0 74 3 11 0 21 0 11 25 21 20 11 50 21 0",
    ] {
        let found = drawing(text);
        let stroke = only(&found);
        assert_near(stroke.start, [0.0, 0.0], 1e-12);
        assert_near(stroke.curves[0].end(), [0.025, 0.020], 1e-12);
        assert_near(stroke.end(), [0.050, 0.0], 1e-12);
        // Free ends and symmetry: the tangent is level in the middle.
        let StrokeCurve::Bezier([_, inner, at]) = stroke.curves[0] else {
            panic!("no curve")
        };
        assert!((inner[1] - at[1]).abs() < 1e-12);
    }
    // A closed curve through points of a circle stays near it, with and without its first point once more.
    let points: Vec<String> = (0..16)
        .map(|index| {
            let (sin, cos) = (f64::from(index) * TAU / 16.0).sin_cos();
            format!("11 {:.12} 21 {:.12} 31 0", 10.0 * cos, 10.0 * sin)
        })
        .collect();
    for again in ["", points[0].as_str()] {
        let found = drawing(&format!(
            "0 SPLINE 8 0 70 11 71 3 74 16 {} {again}",
            points.join(" ")
        ));
        let off = worst(only(&found), |x, y| x.hypot(y) - 10.0);
        assert!(off < 3e-3, "{off}");
        assert_near(only(&found).end(), [0.01, 0.0], 1e-12);
    }
    // Two points are a line; directions at the ends are kept.
    let line = drawing("0 SPLINE 8 0 70 8 71 3 74 2 11 0 21 0 31 0 11 30 21 40 31 0");
    assert!(worst(only(&line), |x, y| 0.8 * x - 0.6 * y) < 1e-15);
    let bent = drawing(
        "0 SPLINE 8 0 70 8 71 3 74 2 12 0 22 5 32 0 13 0 23 -2 33 0 11 0 21 0 31 0 11 30 21 0 31 0",
    );
    let StrokeCurve::Bezier([first, second, _]) = only(&bent).curves[0] else {
        panic!("no curve")
    };
    assert_near(first, [0.0, 0.010], 1e-12);
    assert_near(second, [0.030, 0.010], 1e-12);
}

#[test]
fn splines_need_no_heights() {
    let with = "0 SPLINE 8 0 70 8 71 2 72 6 73 3 40 0 40 0 40 0 40 1 40 1 40 1 10 0 20 0 30 0 10 5 20 9 30 0 10 9 20 0 30 0 0 LINE 8 0 10 0 20 20 11 9 21 20";
    let without = with.replace(" 30 0", "");
    assert_eq!(drawing(with).strokes, drawing(&without).strokes);
    // Lines of refusals are those of the file.
    let fault = read(&file("", &format!("{without} 0 WONDER 8 0"))).expect_err("a wonder");
    let place = file("", &format!("{without} 0 WONDER 8 0"));
    let line = place
        .lines()
        .position(|line| line == "WONDER")
        .expect("there") as u32
        + 1;
    assert_eq!(fault.line, line);
}

/// Text, dimensions and the like beside lines are left out with a word, or without one on request.
#[test]
fn what_is_no_line_is_left_out_beside_lines() {
    let line = "0 LINE 8 0 10 0 20 0 11 9 21 0";
    for kind in [
        "TEXT",
        "MTEXT",
        "POINT",
        "DIMENSION",
        "HATCH",
        "3DFACE",
        "REGION",
        "XLINE",
        "LEADER",
    ] {
        let text = file("", &format!("0 {kind} 8 0 {line} 0 {kind} 8 0"));
        let found = read(&text).expect(kind);
        assert_eq!(found.strokes.len(), 1);
        let told = remarks(&found);
        assert!(
            told.starts_with("line 6") && told.contains(&format!("2 entities {kind} are left out")),
            "{told}"
        );
        assert!(
            told.contains(&format!("--leave-out {}", kind.to_lowercase())),
            "{told}"
        );
        let choices = DxfChoices {
            kinds: vec![kind.to_lowercase()],
            ..left_out()
        };
        assert_eq!(read_dxf(text.as_bytes(), &choices).expect(kind).remarks, []);
        // Alone they are refused.
        assert_eq!(
            read(&file("", &format!("0 {kind} 8 0")))
                .expect_err(kind)
                .word,
            kind
        );
    }
    // A mesh is a polyline in the file.
    let mesh = format!(
        "{line} 0 POLYLINE 8 0 66 1 70 16 71 2 72 2 0 VERTEX 8 0 10 0 20 0 30 0 70 64 0 SEQEND 8 0"
    );
    let found = drawing(&mesh);
    assert!(found.strokes.len() == 1 && remarks(&found).contains("--leave-out mesh"));
    // What may be a line is refused, and left out on request; kinds that are drawn, too.
    let text = file(
        "",
        &format!("{line} 0 WONDER 8 0 0 CIRCLE 8 0 10 0 20 0 40 1"),
    );
    assert_eq!(read(&text).expect_err("a wonder").word, "WONDER");
    let choices = DxfChoices {
        kinds: vec!["Wonder".into(), "circle".into()],
        ..left_out()
    };
    assert_eq!(
        read_dxf(text.as_bytes(), &choices)
            .expect("a line")
            .strokes
            .len(),
        1
    );
}

#[test]
fn line_types_and_lines_of_no_length_are_told() {
    let entities = "0 LINE 8 0 6 DASHED 10 0 20 0 11 9 21 0 0 LINE 8 0 6 Continuous 10 0 20 1 11 9 21 1
        0 LINE 8 cut 6 ByLayer 10 0 20 2 11 9 21 2 0 LINE 8 0 10 1 20 1 11 1 21 1 0 CIRCLE 8 0 10 0 20 0 40 0";
    let told = remarks(&drawing(entities));
    assert!(
        told.contains("line type DASHED") && told.contains("1 stroke is"),
        "{told}"
    );
    assert!(told.contains("2 lines of no length are left out"), "{told}");
    let dashed = file("", entities).replace(
        "cut\n70\n0\n62\n1\n6\nCONTINUOUS",
        "cut\n70\n0\n62\n1\n6\nCENTER",
    );
    assert!(remarks(&read(&dashed).expect("a drawing")).contains("line type CENTER"));
}

/// Lines that lie on others are counted, and left out on request.
#[test]
fn doubles_are_counted_and_left_out() {
    let line = "0 LINE 8 0 10 0 20 0 11 9 21 0";
    let back = "0 LINE 8 0 10 9 20 0 11 0 21 0";
    let box_of = |x: i32| {
        let far = x + 10;
        format!("0 LWPOLYLINE 8 0 90 4 70 1 10 {x} 20 0 10 {far} 20 0 10 {far} 20 10 10 {x} 20 10")
    };
    let sides = "0 LINE 8 0 10 0 20 0 11 9 21 0 0 LINE 8 0 10 9 20 0 11 9 21 9 0 LINE 8 0 10 9 20 9 11 0 21 0";
    for (entities, count, way_mm) in [
        (format!("{line} {line} {back}"), 2, 9.0),
        (format!("{line} 0 LINE 8 cut 10 0 20 0 11 9 21 0"), 0, 18.0),
        (format!("{sides} {sides}"), 3, 18.0 + 9.0 * 2f64.sqrt()),
        // Two boxes with one edge in common.
        (format!("{} {}", box_of(0), box_of(10)), 1, 70.0),
        (
            "0 CIRCLE 8 0 10 0 20 0 40 5 0 CIRCLE 8 0 10 0 20 0 40 5 0 CIRCLE 8 0 10 0 20 0 40 6"
                .into(),
            1,
            22.0 * PI,
        ),
        (
            "0 LINE 8 0 10 0 20 0 11 9 21 0 0 LINE 8 0 10 0 20 0.0005 11 9 21 0".into(),
            1,
            9.0,
        ),
        (
            "0 LINE 8 0 10 0 20 0 11 9 21 0 0 LINE 8 0 10 0 20 0.002 11 9 21 0".into(),
            0,
            18.0,
        ),
    ] {
        let length = |drawing: &Drawing| -> f64 {
            let points = drawing.strokes.iter().map(|stroke| stroke.points(1e-9));
            points
                .map(|points| {
                    points
                        .windows(2)
                        .map(|pair| (pair[0][0] - pair[1][0]).hypot(pair[0][1] - pair[1][1]))
                        .sum::<f64>()
                })
                .sum()
        };
        let mut found = drawing(&entities);
        let all = length(&found);
        assert_eq!(
            found.doubles(false).map_or(0, |(count, _)| count),
            count,
            "{entities}"
        );
        assert_eq!(length(&found), all);
        found.doubles(true);
        assert!(
            (length(&found) - 1e-3 * way_mm).abs() < 1e-6,
            "{entities}: {}",
            length(&found)
        );
        assert_eq!(found.doubles(true), None);
    }
    // A doubled outline is an outline: its lines are joined, and it is filled.
    let outline = format!("{sides} 0 LINE 8 0 10 0 20 0 11 0 21 9");
    let mut found = drawing(&format!("{} {}", box_of(0), box_of(0)));
    found.doubles(true);
    found.fill(1e-3).expect("a fill");
    assert!(found.strokes.len() > 9, "{outline}");
}

#[test]
fn units_are_chosen_and_sizes_are_told() {
    let line = file("", "0 LINE 8 0 10 0 20 0 11 3400 21 2100");
    let in_unit = |number: &str| line.replace("70\n4\n", &format!("70\n{number}\n"));
    let metres = read(&in_unit("6")).expect_err("kilometres of lines");
    let words = "3400 by 2100 m large, with 1 m a unit by $INSUNITS of the file; if its numbers are millimetres, --unit mm makes it 3400 by 2100 mm";
    assert!(metres.reason.contains(words), "{metres}");
    let kilometres = read(&in_unit("7")).expect_err("as a country");
    assert!(
        kilometres.reason.contains("3.4e") || kilometres.reason.contains("3400000 by 2100000 m"),
        "{kilometres}"
    );
    let choices = |unit_m| DxfChoices {
        unit_m: Some(unit_m),
        ..left_out()
    };
    for number in ["0", "1", "6", "7", "20"] {
        let found = read_dxf(in_unit(number).as_bytes(), &choices(1e-3)).expect(number);
        assert_near(only(&found).end(), [3.4, 2.1], 1e-12);
    }
    assert!(
        read(&in_unit("18"))
            .expect_err("astronomy")
            .reason
            .contains("--unit mm")
    );
    let far = file("", "0 LINE 8 0 10 4500000 20 0 11 4500100 21 0");
    let fault = read(&far).expect_err("on a map");
    assert!(
        fault
            .reason
            .contains("100 by 0 mm large and lies 4500.1 m from"),
        "{fault}"
    );
}

/// Text of every system; what is no DXF is told in short.
#[test]
fn lines_end_in_any_way_and_letters_are_of_any_form() {
    let text = file("", "0 LINE 8 caf\u{e9} 10 0 20 0 11 9 21 0");
    let expected = read(&text).expect("a drawing").strokes;
    for end in ["\r\n", "\r", "\r\r\n"] {
        let found = read_dxf(text.replace('\n', end).as_bytes(), &left_out());
        assert_eq!(found.expect(end).strokes, expected);
    }
    let utf_16 = format!("\u{feff}{text}");
    let little: Vec<u8> = utf_16.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin: Vec<u8> = text.chars().map(|letter| letter as u32 as u8).collect();
    for bytes in [
        little,
        latin,
        utf_16.into_bytes(),
        format!("{text}\x1a").into_bytes(),
    ] {
        let found = read_dxf(&bytes, &left_out()).expect("a drawing");
        assert_eq!(
            found.place_of(2),
            "shape 1 (LINE in line 60, layer caf\u{e9})"
        );
    }
    let long = "what ever ".repeat(10_000);
    let fault = read(&long).expect_err("no drawing");
    assert!(fault.to_string().len() < 200, "{fault}");
}
