//! Drawings: what SVG files give, in m and upward.

use trirrr_toolpath::drawing::{
    Drawing, DrawingSetup, Pen, PenKey, Rgb, Stroke, StrokeCurve, read_svg,
};
use trirrr_toolpath::{Act, ToolCurve, ToolPlace, ToolWork};

const RED: Rgb = [255, 0, 0];
const BLUE: Rgb = [0, 0, 255];

/// A page of 100 mm by 50 mm in units of mm, with `content`.
fn page(content: &str) -> String {
    format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm" viewBox="0 0 100 50">{content}</svg>"#
    )
}

fn drawing(content: &str) -> Drawing {
    read_svg(page(content)).expect("a drawing")
}

/// Asserts that two points are the same to the digits of binary32, m.
fn assert_near(found: [f64; 2], expected: [f64; 2]) {
    let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
    assert!(off < 1e-7, "{found:?} is not {expected:?}");
}

fn ends(stroke: &Stroke) -> [[f64; 2]; 2] {
    [stroke.start, stroke.end()]
}

#[test]
fn lengths_are_those_of_the_page_and_y_goes_up() {
    let found = drawing(r##"<path id="edge" d="M10 10 H30 V40" fill="none" stroke="#ff0000"/>"##);
    assert_eq!(found.strokes.len(), 1);
    let stroke = &found.strokes[0];
    assert_eq!(stroke.colour, Some(RED));
    assert_near(stroke.start, [0.01, 0.04]);
    assert_near(stroke.curves[0].end(), [0.03, 0.04]);
    assert_near(stroke.end(), [0.03, 0.01]);
    assert_eq!(found.place_of(1), "way to shape 1 (edge)");
    assert_eq!(found.place_of(2), "shape 1 (edge)");
    // Without units, 96 pixels are an inch.
    let bare = r#"<svg xmlns="http://www.w3.org/2000/svg" width="96" height="96"><path d="M0 0 L96 96" stroke="blue"/></svg>"#;
    let bare = read_svg(bare).expect("a drawing");
    assert_near(bare.strokes[0].start, [0.0, 0.0254]);
    assert_near(bare.strokes[0].end(), [0.0254, 0.0]);
    assert_eq!(bare.strokes[0].colour, Some(BLUE));
}

#[test]
fn transforms_styles_and_copies_are_resolved() {
    let found = drawing(
        r##"<style>.cut { stroke: #00f; fill: none }</style>
        <defs><line id="bar" x1="0" y1="0" x2="10" y2="0"/></defs>
        <g class="cut" transform="translate(20 30) rotate(90)"><use href="#bar"/><use href="#bar" x="5"/></g>
        <g class="cut" style="display:none"><rect width="9" height="9"/></g>"##,
    );
    assert_eq!(found.strokes.len(), 2);
    // Turned clockwise on the page, about (20, 30): down from there.
    assert_near(found.strokes[0].start, [0.02, 0.02]);
    assert_near(found.strokes[0].end(), [0.02, 0.01]);
    assert_near(found.strokes[1].start, [0.02, 0.015]);
    assert!(
        found
            .strokes
            .iter()
            .all(|stroke| stroke.colour == Some(BLUE))
    );
}

/// Every kind of shape against the points that its formula gives.
#[test]
fn curves_are_those_of_the_file() {
    let found = drawing(
        r#"<g fill="none" stroke="red"><circle cx="50" cy="25" r="20"/>
        <path d="M0 50 Q10 30 20 50"/><path d="M0 50 C0 40 20 40 20 50 Z"/></g>"#,
    );
    let [circle, parabola, closed] = &found.strokes[..] else {
        panic!("{} strokes", found.strokes.len());
    };
    for point in circle.points(1e-6) {
        let radius = (point[0] - 0.05).hypot(point[1] - 0.025);
        // Circles are drawn of four cubic curves, which are off by 2.8e-4 of the radius.
        assert!((radius - 0.02).abs() < 3e-4 * 0.02 + 1e-6, "{radius}");
    }
    // Quadratic: x = 20 p, y = 2 p (1 - p) 20 upward.
    for point in parabola.points(1e-6) {
        let p = point[0] / 0.02;
        assert_near(point, [0.02 * p, 2.0 * p * (1.0 - p) * 0.02]);
    }
    assert_near(closed.end(), closed.start);
    assert_eq!(closed.curves.len(), 2);
}

#[test]
fn what_cannot_be_drawn_is_refused_by_name() {
    for (content, line, word, reason) in [
        (
            "\n<text id='a'>Hi</text>",
            2,
            "text#a",
            "convert it to paths",
        ),
        ("<g>\n\n<image href='a.png'/></g>", 3, "image", "trace it"),
        (
            "<foreignObject><a/></foreignObject>",
            1,
            "foreignObject",
            "leave them out",
        ),
        ("", 0, "", "nothing in the file is drawn"),
        (
            "<path d='M0 0' stroke='red'/>",
            0,
            "",
            "nothing in the file is drawn",
        ),
        ("<path d='M0 0H9'", 1, "", "no SVG"),
    ] {
        let fault = read_svg(page(content)).expect_err(content);
        assert_eq!(
            (fault.line, fault.word.as_str()),
            (line, word),
            "{content}: {fault}"
        );
        assert!(fault.reason.contains(reason), "{content}: {fault}");
    }
    assert!(read_svg("G21 G90\n").is_err());
    // Names and notes of drawing programs are no text in the drawing.
    let quiet = "<metadata><text/></metadata><defs><text/></defs><path d='M0 0H9' stroke='red'/>";
    assert_eq!(drawing(quiet).strokes.len(), 1);
}

/// Length of the strokes, m.
fn length(strokes: &[Stroke]) -> f64 {
    strokes
        .iter()
        .flat_map(|stroke| {
            stroke
                .points(1e-5)
                .windows(2)
                .map(<[_]>::to_vec)
                .collect::<Vec<_>>()
        })
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
        .sum()
}

/// A fill covers its area: the length of its lines times their distance.
#[test]
fn a_fill_covers_what_is_inside() {
    let frame = |rule: &str, hole: &str| {
        format!(r#"<path fill="red" fill-rule="{rule}" d="M10 10 h30 v30 h-30 z {hole}"/>"#)
    };
    let (same, other) = ("M20 20 h10 v10 h-10 z", "M20 20 v10 h10 v-10 z");
    for (rule, hole, area) in [
        ("evenodd", same, 8e-4),
        ("evenodd", other, 8e-4),
        ("nonzero", same, 9e-4),
        ("nonzero", other, 8e-4),
    ] {
        let mut found = drawing(&frame(rule, hole));
        assert_eq!(
            found.strokes.len(),
            2,
            "the outlines, where nothing is filled"
        );
        found.fill(1e-4).expect("lines");
        let covered = 1e-4 * length(&found.strokes);
        assert!(
            (covered / area - 1.0).abs() < 0.01,
            "{rule} {hole}: {covered} of {area}"
        );
        for stroke in &found.strokes {
            let [from, to] = ends(stroke);
            assert!(from[1] == to[1] && stroke.colour == Some(RED));
            let middle = [0.5 * (from[0] + to[0]), from[1]];
            let in_hole = |at: f64| (0.0201..0.0299).contains(&at);
            let (x, y) = (middle[0], middle[1] - 0.0);
            assert!(area > 8.5e-4 || !(in_hole(x) && in_hole(y)), "{middle:?}");
        }
    }
    // A disc, and an outline with a colour of its own that stays.
    let mut disc = drawing(r#"<circle cx="50" cy="25" r="20" fill="red" stroke="blue"/>"#);
    disc.fill(1e-4).expect("lines");
    let (outline, lines): (Vec<Stroke>, Vec<Stroke>) = disc
        .strokes
        .into_iter()
        .partition(|stroke| stroke.colour == Some(BLUE));
    let area = std::f64::consts::PI * 0.02 * 0.02;
    assert!((1e-4 * length(&lines) / area - 1.0).abs() < 0.01);
    assert!((length(&outline) - std::f64::consts::TAU * 0.02).abs() < 1e-4);
    let fault = drawing(&frame("evenodd", ""))
        .fill(1e-9)
        .expect_err("too many lines");
    assert!(fault.reason.contains("larger distance"), "{fault}");
}

#[test]
fn the_nearest_stroke_is_drawn_next_and_turned_where_that_is_shorter() {
    let mut found = drawing(
        r#"<g stroke="red"><path d="M0 0 H10"/><path d="M50 0 H60"/><path d="M30 0 H11"/></g>"#,
    );
    found.order([0.0, 0.05]);
    let order: Vec<_> = found
        .strokes
        .iter()
        .map(|stroke| (stroke.shape, ends(stroke)))
        .collect();
    assert_eq!(
        order.iter().map(|(shape, _)| *shape).collect::<Vec<_>>(),
        [0, 2, 1]
    );
    assert_near(order[1].1[0], [0.011, 0.05]);
    assert_near(order[1].1[1], [0.03, 0.05]);
    found.order([0.06, 0.05]);
    assert_near(found.strokes[0].start, [0.06, 0.05]);
    assert_near(found.strokes[2].end(), [0.0, 0.05]);
}

/// Every stroke once, none before one inside it, and ways that are at most those to the nearest.
#[test]
fn holes_come_first_and_ways_get_shorter() {
    let mut content = String::from("<g fill='none' stroke='red'>");
    for k in 0..12 {
        let place = 5 * k % 12;
        let (x, y) = (8.0 * f64::from(place % 4), 14.0 * f64::from(place / 4));
        content += &format!(
            "<rect id='o{k}' x='{x}' y='{y}' width='7' height='12'/><circle id='i{k}' cx='{}' cy='{}' r='2'/><path d='M{} {}h1'/>",
            x + 3.0,
            y + 4.0,
            x + 2.5,
            y + 4.0,
        );
    }
    let mut found = drawing(&(content + "</g>"));
    let travel = found.order([0.0, 0.05]);
    assert!(travel.ordered_m < 0.7 * travel.in_file_m, "{travel:?}");
    let order: Vec<usize> = found.strokes.iter().map(|stroke| stroke.shape).collect();
    let mut all = order.clone();
    all.sort_unstable();
    assert_eq!(all, (0..36).collect::<Vec<_>>());
    let place = |shape: usize| order.iter().position(|other| *other == shape);
    for part in (0..36).step_by(3) {
        assert!(
            place(part + 2) < place(part + 1) && place(part + 1) < place(part),
            "{order:?}"
        );
    }
    // The nearest first is a trap here: turned round, the ways are shorter.
    let mut trap = drawing(
        "<g stroke='red'><path d='M21 50V49'/><path d='M18 50V49'/><path d='M30 50V49'/><path d='M5 50V49'/></g>",
    );
    let travel = trap.order([0.02, 0.0]);
    assert!(travel.ordered_m <= 0.0415 + 4e-3, "{travel:?}");
}

#[test]
fn the_tool_is_on_along_strokes_alone() {
    let mut found = drawing(
        r#"<g fill="none"><path d="M0 0 C1 1 2 1 3 0" stroke="red"/><path d="M9 0 H12" stroke="blue"/><path d="M20 0 H30" stroke="black"/></g>"#,
    );
    let pen = |power: f64| Pen {
        feed_m_s: 0.1,
        work: Some(ToolWork {
            power,
            follows_speed: true,
        }),
    };
    let off = Pen {
        feed_m_s: 0.1,
        work: None,
    };
    let setup = DrawingSetup {
        origin: ToolPlace {
            position_m: [0.2, 0.1],
            alpha_rad: 0.3,
        },
        scale: 2.0,
        pen: pen(0.5),
        pens: vec![
            (PenKey::Colour(BLUE), pen(1.0)),
            (PenKey::Colour([0; 3]), off),
        ],
    };
    found.leave_out(&setup);
    let elements = found.elements(&setup);
    assert_eq!(elements.len(), 4);
    let motion = |index: usize| match elements[index].act {
        Act::Motion(motion) => motion,
        _ => panic!("no motion"),
    };
    let powers: Vec<_> = elements
        .iter()
        .map(|each| each.tool.map(|tool| tool.power))
        .collect();
    assert_eq!(powers, [None, Some(0.5), None, Some(1.0)]);
    assert_near(motion(0).to.position_m, [0.2, 0.2]);
    assert_eq!(motion(0).feed_m_s, None);
    assert_eq!(
        (motion(1).feed_m_s, motion(1).to.alpha_rad),
        (Some(0.1), 0.3)
    );
    let ToolCurve::Bezier { controls_m } = motion(1).curve else {
        panic!("no curve");
    };
    assert_near(controls_m[0], [0.202, 0.198]);
    assert_near(motion(3).to.position_m, [0.224, 0.2]);
    assert!(matches!(found.strokes[1].curves[0], StrokeCurve::Line(_)));
}

/// Layers are those of Inkscape by their labels; in other files, the groups by their id.
#[test]
fn layers_have_pens_of_their_own() {
    let bar = r#"<path d="M0 0H9" stroke="red"/>"#;
    let inkscape = format!(
        r#"<g xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:groupmode="layer" inkscape:label="to cut" id="layer1">
        <g id="part">{bar}</g></g>{bar}"#
    );
    let plain = format!(r#"<g id="outer"><g id="inner">{bar}</g>{bar}</g>{bar}"#);
    for (content, layers) in [
        (&inkscape, &["to cut", ""][..]),
        (&plain, &["inner", "outer", ""]),
    ] {
        let found = drawing(content);
        let places: Vec<_> = (1..=layers.len())
            .map(|index| found.place_of(2 * index as u32))
            .collect();
        let expected = layers
            .iter()
            .enumerate()
            .map(|(index, layer)| match *layer {
                "" => format!("shape {}", index + 1),
                layer => format!("shape {} (layer {layer})", index + 1),
            });
        assert_eq!(places, expected.collect::<Vec<_>>());
    }
}
