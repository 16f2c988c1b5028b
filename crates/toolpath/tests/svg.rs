//! SVG of the programs that people have: all that is seen is drawn, or refused by its line and name.

use flate2::{Compression, write::GzEncoder};
use std::io::Write;
use trirrr_toolpath::PathFault;
use trirrr_toolpath::drawing::{Drawing, Stroke, read_svg};

/// A page of 100 mm by 100 mm in units of mm, with `content`.
fn page(content: &str) -> String {
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="100mm" height="100mm" viewBox="0 0 100 100">{content}</svg>"##
    )
}

fn drawing(content: &str) -> Drawing {
    read_svg(page(content)).unwrap_or_else(|fault| panic!("{content}: {fault}"))
}

fn refusal(content: &str) -> PathFault {
    read_svg(page(content)).expect_err(content)
}

/// Length of all strokes, mm.
fn length(strokes: &[Stroke]) -> f64 {
    let of = |stroke: &Stroke| {
        let points = stroke.points(1e-7);
        let pairs = points
            .windows(2)
            .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        1e3 * pairs.sum::<f64>()
    };
    strokes.iter().map(of).sum()
}

/// Ends of the strokes, mm from the upper left corner of the page, rounded to a hundredth of a micrometre.
fn ends(drawing: &Drawing) -> Vec<[f64; 4]> {
    let round = |value: f64| (1e5 * value).round() / 1e5 + 0.0;
    let of = |stroke: &Stroke| {
        let (from, to) = (stroke.start, stroke.end());
        [from[0], 0.1 - from[1], to[0], 0.1 - to[1]].map(|value| round(1e3 * value))
    };
    drawing.strokes.iter().map(of).collect()
}

/// Asserts the ends of the strokes, to a micrometre.
fn assert_near(content: &str, expected: &[[f64; 4]]) {
    let found = ends(&drawing(content));
    let near = |a: &[f64; 4], b: &[f64; 4]| (0..4).all(|i| (a[i] - b[i]).abs() <= 1e-3);
    let same = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| near(a, b));
    assert!(same, "{content}: {found:?} is not {expected:?}");
}

/// Asserts the length of what is drawn, mm.
fn assert_length(content: &str, expected: f64) {
    let found = length(&drawing(content).strokes);
    assert!(
        (found - expected).abs() < 1e-4 * expected.max(1.0),
        "{content}: {found} mm, not {expected}"
    );
}

/// A line of 80 mm that is seen.
const SEEN: &str = r##"<path d="M10 10H90" fill="none" stroke="#000"/>"##;

#[test]
fn what_nobody_sees_is_not_drawn() {
    let line = r##"<path d="M10 20H90" stroke="#f00"/>"##;
    for unseen in [
        format!(r##"<g opacity="0">{line}</g>"##),
        format!(r##"<g style="opacity:0%">{line}</g>"##),
        format!(r##"<g opacity=".05"><g opacity=".02">{line}</g></g>"##),
        r##"<path d="M10 20H90" stroke="#f00" opacity="0.0"/>"##.into(),
        r##"<path d="M10 30H90" stroke="#f00" stroke-opacity="0"/>"##.into(),
        r##"<rect x="5" y="5" width="90" height="90" fill-opacity="0"/>"##.into(),
        r##"<rect x="5" y="5" width="90" height="90" fill="red" style="fill-opacity:0%;stroke:blue;stroke-opacity:0"/>"##.into(),
        r##"<path d="M10 40H90" stroke="transparent"/>"##.into(),
        r##"<path d="M10 40H90" stroke="rgba(255,0,0,0)"/>"##.into(),
        r##"<path d="M10 40H90" stroke="rgb(255 0 0 / 0%)"/>"##.into(),
        r##"<path d="M10 40H90" stroke="#f000"/>"##.into(),
        r##"<path d="M10 40H90" stroke="#ff000000"/>"##.into(),
        r##"<path d="M10 40H90" stroke="hsla(120, 50%, 50%, 0)"/>"##.into(),
        r##"<path d="M10 40H90" stroke="currentColor" color="transparent"/>"##.into(),
        r##"<path d="M10 40H90" stroke="red" stroke-width="0"/>"##.into(),
        r##"<path d="M10 40H90 V50 H10z" fill="none"/>"##.into(),
        // A line without a stroke has no area.
        r##"<path d="M10 40H90"/><line x2="50" y2="50"/><polyline points="1 1 20 20"/>"##.into(),
        r##"<g style="visibility:hidden"><rect width="9" height="9"/></g>"##.into(),
        r##"<g display="none"><rect width="9" height="9"/></g>"##.into(),
        r##"<style>.off{display:none}</style><rect class="off" width="9" height="9"/>"##.into(),
        r##"<linearGradient id="g"><stop stop-opacity="0"/><stop offset="1" stop-opacity="0"/></linearGradient><rect width="50" height="50" fill="url(#g)"/>"##.into(),
        r##"<linearGradient id="g"/><rect width="50" height="50" fill="url(#g)"/>"##.into(),
        r##"<rect width="50" height="50" fill="url(#none)"/>"##.into(),
        r##"<rect width="0" height="50"/><circle r="0"/><ellipse rx="5"  ry="0"/>"##.into(),
        r##"<g transform="scale(0)"><rect width="5" height="5"/></g>"##.into(),
        r##"<clipPath id="c"/><g clip-path="url(#c)"><rect width="5" height="5"/></g>"##.into(),
        r##"<clipPath id="c"><rect x="50" y="50" width="5" height="5"/></clipPath><rect clip-path="url(#c)" width="5" height="5"/>"##.into(),
        r##"<switch><g systemLanguage="de"><rect width="9" height="9"/></g></switch>"##.into(),
        r##"<symbol id="s"><rect width="5" height="5"/></symbol>"##.into(),
        r##"<defs><rect width="5" height="5"/></defs><pattern id="p"><rect width="5" height="5"/></pattern>"##.into(),
    ] {
        assert_length(&format!("{SEEN}{unseen}"), 80.0);
    }
    // A child of what is hidden may be seen.
    assert_length(
        &format!(
            r##"{SEEN}<g visibility="hidden"><path visibility="visible" d="M0 0H9" stroke="red"/></g>"##
        ),
        89.0,
    );
    assert!(
        refusal(r##"<rect width="5" height="5" opacity="0"/>"##)
            .reason
            .contains("nothing in the file is drawn")
    );
}

#[test]
fn paints_of_every_kind_are_known_by_their_colour_or_refused() {
    for (paint, colour) in [
        ("rgb(255 0 0 / 100%)", Some([255, 0, 0])),
        ("rgb(255 0 0)", Some([255, 0, 0])),
        ("rgb(100%, 0%, 50%)", Some([255, 0, 128])),
        ("RGBA(0,128,0,.5)", Some([0, 128, 0])),
        ("#F00F", Some([255, 0, 0])),
        ("Red", Some([255, 0, 0])),
        ("hsl(120deg 100% 50%)", Some([0, 255, 0])),
        ("hwb(240 0% 0%)", Some([0, 0, 255])),
        ("oklch(62.8% 0.2577 29.23)", Some([255, 0, 0])),
        ("lab(54.29% 80.8 69.89)", Some([255, 0, 0])),
        ("color(srgb 0 0 1)", Some([0, 0, 255])),
        ("color(display-p3 0 0 0)", Some([0, 0, 0])),
        ("var(--c, #f00)", Some([255, 0, 0])),
        ("var(--blue)", Some([0, 0, 255])),
        ("var(--none, var(--blue))", Some([0, 0, 255])),
        (
            "#CD853F icc-color(acmecmyk, 0.11, 0.48, 0.83, 0.00)",
            Some([0xCD, 0x85, 0x3F]),
        ),
        ("url(#none) #00f", Some([0, 0, 255])),
        ("url(#some)", None),
        ("url('#some') red", None),
        ("currentColor", Some([1, 2, 3])),
    ] {
        let found = drawing(&format!(
            r##"<style>:root{{--blue:#00f}}</style><linearGradient id="some"><stop/></linearGradient><path d="M10 40L90 50" color="#010203" style="stroke:{paint}"/>"##
        ));
        assert_eq!(found.strokes[0].colour, colour, "{paint}");
    }
    for (content, line, word) in [
        (
            "<g>\n<path id='a' d='M0 0H9' stroke='color-mix(in srgb, red, blue)'/></g>",
            2,
            "path#a",
        ),
        ("<rect width='9' height='9' fill='reddish'/>", 1, "rect"),
        (
            "\n\n<g id='b' style='stroke:light-dark(red, blue)'><path d='M0 0H9'/></g>",
            3,
            "g#b",
        ),
        ("<path d='M0 0H9' stroke='url(other.svg#a)'/>", 1, "path"),
    ] {
        let fault = refusal(content);
        assert_eq!(
            (fault.line, fault.word.as_str()),
            (line, word),
            "{content}: {fault}"
        );
        assert!(fault.reason.contains("not known"), "{fault}");
    }
}

#[test]
fn styles_place_and_shape() {
    for (content, expected) in [
        (
            r##"<path style="transform:translate(10px,-20px)" d="M0 100H50" stroke="red"/>"##,
            [10.0, 80.0, 60.0, 80.0],
        ),
        (
            r##"<path style="transform:translateX(50%) rotate(0.25turn)" d="M0 0H50" stroke="red"/>"##,
            [50.0, 0.0, 50.0, 50.0],
        ),
        (
            r##"<path style="transform:rotate(90deg);transform-origin:10px 10px" d="M10 10H50" stroke="red"/>"##,
            [10.0, 10.0, 10.0, 50.0],
        ),
        (
            r##"<path style="transform:scaleX(-1);transform-box:fill-box;transform-origin:center" d="M10 10L50 20" stroke="red"/>"##,
            [50.0, 10.0, 10.0, 20.0],
        ),
        (
            r##"<path style="rotate:90deg;translate:5px 6px;scale:2" d="M0 0H10" stroke="red"/>"##,
            [5.0, 6.0, 5.0, 26.0],
        ),
        (
            r##"<style>path{transform:matrix(1,0,0,1,3,4)}</style><path transform="scale(9)" d="M0 0H10" stroke="red"/>"##,
            [3.0, 4.0, 13.0, 4.0],
        ),
        (
            r##"<path style="d:path('M1 2H3')" d="M9 9H10" stroke="red"/>"##,
            [1.0, 2.0, 3.0, 2.0],
        ),
        (
            r##"<path transform="rotate(90 10 10) skewX(0)" d="M10 10H50" stroke="red"/>"##,
            [10.0, 10.0, 10.0, 50.0],
        ),
        (
            r##"<line x1="10%" y1="1cm" x2="3in" y2="72pt" transform="scale(1)" stroke="red"/>"##,
            [10.0, 37.79528, 288.0, 96.0],
        ),
        (
            r##"<path d="M1 1H2" transform="translate(1e1-5)" stroke="red"/>"##,
            [11.0, -4.0, 12.0, -4.0],
        ),
    ] {
        assert_eq!(ends(&drawing(content)), [expected], "{content}");
    }
    for (content, expected) in [
        (
            r##"<rect style="x:10px;y:10px;width:20px;height:30px" stroke="red"/>"##,
            100.0,
        ),
        (
            r##"<style>rect{width:20px;rx:0}</style><rect width="1" height="30" stroke="red"/>"##,
            100.0,
        ),
        (
            r##"<circle style="cx:50px;cy:50px;r:10px" stroke="red"/>"##,
            std::f64::consts::TAU * 10.0,
        ),
        (
            r##"<circle cx="50" cy="50" r="10" stroke="red" transform="rotate(33)"/>"##,
            std::f64::consts::TAU * 10.0,
        ),
        (
            r##"<g font-size="5"><rect width="2em" height="10" stroke="red"/></g>"##,
            40.0,
        ),
        (
            r##"<style>g > .a:first-child, rect + rect { stroke: red }</style><g><rect class="b a" width="5" height="5"/><rect width="5" height="5"/></g>"##,
            40.0,
        ),
        (
            r##"<style>@media screen { rect { width: 10px !important } } @media print { rect {height:1px} } @font-face { font-family: a; src: url(a{b) }</style><rect width="5" style="width:7px" height="10"/>"##,
            40.0,
        ),
    ] {
        assert_length(content, expected);
    }
    for (content, line, word, reason) in [
        (
            "<path style='transform:translate3d(1px,2px,0)' d='M0 0H9' stroke='red'/>",
            1,
            "path",
            "transform",
        ),
        (
            "<path style='transform:rotate(45)' d='M0 0H9' stroke='red'/>",
            1,
            "path",
            "transform",
        ),
        (
            "<path transform='rotte(45)' d='M0 0H9' stroke='red'/>",
            1,
            "path",
            "transform",
        ),
        (
            "<path style='offset-path:path(\"M0 0H9\")' d='M0 0H9' stroke='red'/>",
            1,
            "path",
            "offset-path",
        ),
        (
            "\n<rect id='r' width='calc(1px + 2px)' height='3'/>",
            2,
            "rect#r",
            "width",
        ),
        ("<rect style='width:20' height='3'/>", 1, "rect", "width"),
        ("<circle r='5vw'/>", 1, "circle", "r: 5vw"),
        ("<path style='d:url(#a)' stroke='red'/>", 1, "path", "d: "),
        (
            "<style>\n\nrect:nth-child(2) { stroke: red }</style><rect width='3' height='3'/>",
            3,
            "rect:nth-child(2)",
            "selector",
        ),
        (
            "<style>a{}\n@import url(a.css);</style><rect width='3' height='3'/>",
            2,
            "@import url(a.css)",
            "rule",
        ),
        (
            "<style>@media (min-width: 100px) { rect { fill: red } }</style><rect width='3' height='3'/>",
            1,
            "@media (min-width: 100px)",
            "condition",
        ),
        (
            "<style>g { fill: red; rect { fill: blue } }</style><rect width='3' height='3'/>",
            1,
            "g",
            "nested",
        ),
    ] {
        let fault = refusal(content);
        assert_eq!(
            (fault.line, fault.word.as_str()),
            (line, word),
            "{content}: {fault}"
        );
        assert!(fault.reason.contains(reason), "{content}: {fault}");
    }
}

#[test]
fn paths_with_a_mistake_are_refused_by_its_place() {
    for (content, line, word, at) in [
        (
            "\n<path id='p' d='M10 10 H50 V' stroke='red'/>",
            2,
            "path#p",
            "",
        ),
        (
            "<path d='M10 10 H50 X 20' stroke='red'/>",
            1,
            "path",
            "letter 12",
        ),
        (
            "<path d='M10 10 L50 abc' stroke='red'/>",
            1,
            "path",
            "letter",
        ),
        (
            "<path d='M10 10 L50 1e999' stroke='red'/>",
            1,
            "path",
            "letter",
        ),
        ("<path d='L10 10' stroke='red'/>", 1, "path", "letter"),
        (
            "<path d='M0 0 A5 5 0 2 1 9 9' stroke='red'/>",
            1,
            "path",
            "letter",
        ),
        (
            "<polyline points='0 0 10 10 20' stroke='red'/>",
            1,
            "polyline",
            "pairs",
        ),
        (
            "<polygon points='0,0 10,x 20,20' stroke='red'/>",
            1,
            "polygon",
            "pairs",
        ),
    ] {
        let fault = refusal(content);
        assert_eq!(
            (fault.line, fault.word.as_str()),
            (line, word),
            "{content}: {fault}"
        );
        assert!(fault.reason.contains(at), "{content}: {fault}");
    }
}

#[test]
fn copies_symbols_and_viewports_are_drawn() {
    for (content, expected) in [
        // Clips that hold everything have no effect.
        (r##"<svg width="100" height="100"><path d="M10 10H90" stroke="red"/></svg>"##.to_owned(), 80.0),
        (r##"<svg x="10" y="10" width="40" height="40" viewBox="0 0 4 4"><path d="M0 0H4" stroke="red"/></svg>"##.into(), 40.0),
        (r##"<symbol id="s" viewBox="0 0 10 10"><path d="M0 5H10" stroke="red"/></symbol><use href="#s" width="50" height="50"/>"##.into(), 50.0),
        (r##"<symbol id="s"><path d="M0 5H10" stroke="red"/></symbol><use xlink:href="#s" x="20"/>"##.into(), 10.0),
        (r##"<g id="g"><path id="p" d="M0 5H10" stroke="red"/></g><use href="#g" x="20"/><use href="#p" y="9"/>"##.into(), 30.0),
        // Clips that cut.
        (r##"<svg x="10" y="10" width="40" height="40"><path d="M-20 5H90" stroke="red"/></svg>"##.into(), 40.0),
        (r##"<svg x="10" y="10" width="40" height="40" overflow="visible"><path d="M-20 5H90" stroke="red"/></svg>"##.into(), 110.0),
        (r##"<symbol id="s" viewBox="0 0 10 10"><path d="M-5 5H10" stroke="red"/></symbol><use href="#s" width="50" height="50"/>"##.into(), 50.0),
        // One that holds itself is drawn by nobody.
        (format!("{SEEN}<g id='a'><use href='#a'/></g><use id='b' href='#c'/><use id='c' href='#b'/>"), 80.0),
    ] {
        assert_length(&content, expected);
    }
    for (content, line, word, reason) in [
        (
            "\n<use id='u' href='other.svg#a'/>",
            2,
            "use#u",
            "another file, other.svg#a",
        ),
        ("<use xlink:href='#nothing'/>", 1, "use", "#nothing"),
        ("<lyne x2='9' stroke='red'/>", 1, "lyne", "not known"),
    ] {
        let fault = refusal(content);
        assert_eq!(
            (fault.line, fault.word.as_str()),
            (line, word),
            "{content}: {fault}"
        );
        assert!(fault.reason.contains(reason), "{content}: {fault}");
    }
    // Copies of copies that grow beyond all bounds.
    let mut bomb = String::from(r##"<g id="g0"><path d="M0 0H1" stroke="red"/></g>"##);
    for level in 1..30 {
        let one = format!(r##"<use href="#g{}"/>"##, level - 1);
        bomb += &format!(r##"<g id="g{level}">{}</g>"##, one.repeat(4));
    }
    assert!(refusal(&bomb).reason.contains("copies"));
    let deep = format!(
        "{}<path d='M0 0H9' stroke='red'/>{}",
        "<g>".repeat(300),
        "</g>".repeat(300)
    );
    assert!(refusal(&deep).reason.contains("within each other"));
}

#[test]
fn coordinates_keep_all_their_digits() {
    // A map in UTM: its view box is far from zero.
    let map = r##"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="500000.123 5400000.456 100 100"><path d="M500010.123 5400010.456H500090.123V5400090.456" fill="none" stroke="red"/></svg>"##;
    let found = read_svg(map).expect("a map");
    let points = found.strokes[0].points(1e-5);
    for (point, expected) in points
        .iter()
        .zip([[0.01, 0.09], [0.09, 0.09], [0.09, 0.01]])
    {
        assert!(
            (point[0] - expected[0]).hypot(point[1] - expected[1]) < 1e-8,
            "{point:?}"
        );
    }
    let moved = drawing(
        r##"<g transform="translate(-123456789 -987654321)"><path d="M123456799.0625 987654331.5H123456809.0625" stroke="red"/></g>"##,
    );
    assert_eq!(ends(&moved), [[10.0625, 10.5, 20.0625, 10.5]]);
}

#[test]
fn dashes_are_strokes_of_their_own() {
    let dashed = drawing(r##"<path d="M10 10H90" stroke="#000" stroke-dasharray="10 10"/>"##);
    let expected: Vec<_> = (0..4)
        .map(|k| 10.0 + 20.0 * f64::from(k))
        .map(|x| [x, 10.0, x + 10.0, 10.0])
        .collect();
    assert_eq!(ends(&dashed), expected);
    for (attributes, expected) in [
        (
            "stroke-dasharray='10'",
            vec![[0.0, 10.0], [20.0, 30.0], [40.0, 50.0]],
        ),
        (
            "stroke-dasharray='10,5,20'",
            vec![[0.0, 10.0], [15.0, 35.0], [45.0, 50.0]],
        ),
        (
            "stroke-dasharray='10' stroke-dashoffset='5'",
            vec![[0.0, 5.0], [15.0, 25.0], [35.0, 45.0]],
        ),
        (
            "stroke-dasharray='10' stroke-dashoffset='-5'",
            vec![[5.0, 15.0], [25.0, 35.0], [45.0, 50.0]],
        ),
        (
            "style='stroke-dasharray:10%'",
            vec![[0.0, 10.0], [20.0, 30.0], [40.0, 50.0]],
        ),
        (
            "stroke-dasharray='1' pathLength='5'",
            vec![[0.0, 10.0], [20.0, 30.0], [40.0, 50.0]],
        ),
        (
            "stroke-dasharray='5' transform='scale(2 7)' d='M0 0H25'",
            vec![[0.0, 10.0], [20.0, 30.0], [40.0, 50.0]],
        ),
        ("stroke-dasharray='none'", vec![[0.0, 50.0]]),
        ("stroke-dasharray='0 0'", vec![[0.0, 50.0]]),
        ("stroke-dasharray='60'", vec![[0.0, 50.0]]),
        // One that is drawn and none that is not: parts that meet.
        ("stroke-dasharray='25 0'", vec![[0.0, 25.0], [25.0, 50.0]]),
        (
            "stroke-dasharray='37.795276 37.795276' vector-effect='non-scaling-stroke'",
            vec![[0.0, 10.0], [20.0, 30.0], [40.0, 50.0]],
        ),
    ] {
        let path = match attributes.contains(" d=") {
            true => String::new(),
            false => "d='M0 0H50'".into(),
        };
        let found = drawing(&format!("<path {path} stroke='red' {attributes}/>"));
        let along: Vec<[f64; 2]> = ends(&found).iter().map(|ends| [ends[0], ends[2]]).collect();
        let near = |a: &[f64; 2], b: &[f64; 2]| (0..2).all(|i| (a[i] - b[i]).abs() < 1e-4);
        assert!(
            along.len() == expected.len() && along.iter().zip(&expected).all(|(a, b)| near(a, b)),
            "{attributes}: {along:?}"
        );
    }
    // Along a circle, by its length.
    let circle =
        drawing("<circle cx='50' cy='50' r='20' fill='none' stroke='red' stroke-dasharray='5 3'/>");
    let whole = std::f64::consts::TAU * 20.0;
    assert_eq!(circle.strokes.len(), (whole / 8.0).ceil() as usize);
    for stroke in &circle.strokes[..15] {
        assert!((length(std::slice::from_ref(stroke)) - 5.0).abs() < 1e-4);
    }
    for content in [
        "<path d='M0 0H50' stroke='red' stroke-linecap='round' stroke-dasharray='0 5'/>",
        "<path d='M0 0z' stroke-linecap='round' stroke='red'/>",
    ] {
        assert!(
            refusal(content).reason.contains("dots") || refusal(content).reason.contains("dot")
        );
    }
    let many = refusal("<path d='M0 0H50' stroke='red' stroke-dasharray='0.000001'/>");
    assert!(many.reason.contains("dashes"), "{many}");
}

#[test]
fn clips_and_masks_cut() {
    let rect = |x: f64, width: f64| {
        format!(
            r##"<clipPath id="c"><rect x="{x}" y="0" width="{width}" height="100"/></clipPath>"##
        )
    };
    let line = |clip: &str| {
        format!(r##"{clip}<g clip-path="url(#c)"><path d="M10 10H90" stroke="red"/></g>"##)
    };
    for (content, expected) in [
        (line(&rect(0.0, 100.0)), vec![[10.0, 10.0, 90.0, 10.0]]),
        (line(&rect(10.0, 80.0)), vec![[10.0, 10.0, 90.0, 10.0]]),
        (line(&rect(20.0, 30.0)), vec![[20.0, 10.0, 50.0, 10.0]]),
        (line(r##"<clipPath id="c" clipPathUnits="objectBoundingBox"><rect width=".5" height="1"/></clipPath>"##), vec![]),
        (
            line(r##"<clipPath id="c"><path clip-rule="evenodd" d="M20 0h60v60h-60z M30 0h40v60h-40z"/></clipPath>"##),
            vec![[20.0, 10.0, 30.0, 10.0], [70.0, 10.0, 80.0, 10.0]],
        ),
        (
            line(r##"<clipPath id="c"><rect x="20" width="10" height="20"/><rect x="25" width="10" height="20"/><rect x="50" width="10" height="20" display="none"/></clipPath>"##),
            vec![[20.0, 10.0, 35.0, 10.0]],
        ),
        (
            line(r##"<clipPath id="d"><rect x="20" width="10" height="20"/></clipPath><clipPath id="c" clip-path="url(#d)"><rect x="25" width="10" height="20"/></clipPath>"##),
            vec![[25.0, 10.0, 30.0, 10.0]],
        ),
        (
            line(r##"<clipPath id="c"><circle cx="50" cy="10" r="20"/></clipPath>"##),
            vec![[30.0, 10.0, 70.0, 10.0]],
        ),
        (
            line(r##"<rect id="r" x="5" width="10" height="20" visibility="hidden"/><clipPath id="c" transform="translate(10)"><use href="#r" x="5" visibility="visible"/></clipPath>"##).replace("visibility=\"hidden\"/>", "fill='none'/>"),
            vec![[20.0, 10.0, 30.0, 10.0]],
        ),
        (
            r##"<mask id="m"><rect x="20" width="10" height="100" fill="white"/></mask><path mask="url(#m)" d="M10 10H90" stroke="red"/>"##.into(),
            vec![[20.0, 10.0, 30.0, 10.0]],
        ),
        (
            r##"<mask id="m" maskUnits="userSpaceOnUse" x="0" y="0" width="60" height="100"><rect width="100" height="100" fill="#fff"/><rect x="20" width="10" height="100" fill="#000"/></mask><path mask="url(#m)" d="M10 10H90" stroke="red"/>"##.into(),
            vec![[10.0, 10.0, 20.0, 10.0], [30.0, 10.0, 60.0, 10.0]],
        ),
        (
            r##"<mask id="m" style="mask-type:alpha"><rect x="20" width="10" height="100" fill="#D9D9D9"/></mask><g mask="url(#m)"><path d="M10 10H90" stroke="red"/></g>"##.into(),
            vec![[20.0, 10.0, 30.0, 10.0]],
        ),
        // A line along an edge of its clip is seen, by half.
        (
            r##"<clipPath id="c"><rect x="10" y="10" width="20" height="20"/></clipPath><path clip-path="url(#c)" d="M10 5V50" stroke="red"/>"##.into(),
            vec![[10.0, 10.0, 10.0, 30.0]],
        ),
    ] {
        if expected.is_empty() {
            assert!(refusal(&content).reason.contains("nothing"), "{content}");
            continue;
        }
        assert_near(&content, &expected);
    }
    // A closed line is cut into one part where its start is within.
    let ring = drawing(
        r##"<clipPath id="c"><rect y="0" x="0" width="50" height="100"/></clipPath><circle clip-path="url(#c)" cx="50" cy="50" r="20" fill="none" stroke="red" transform="rotate(180 50 50)"/>"##,
    );
    assert_eq!(ring.strokes.len(), 1);
}

/// The outline of an area behind a clip is that of what is left of it; so are the lines of a fill.
#[test]
fn areas_behind_clips_have_the_outline_of_what_is_left() {
    let quarter = std::f64::consts::PI * 10.0;
    for (clip, shape, outline, area) in [
        // A rectangle by another.
        (
            r##"<rect x="20" y="20" width="20" height="20"/>"##,
            r##"<rect x="30" y="10" width="20" height="20"/>"##,
            40.0,
            100.0,
        ),
        // One within the other, both ways, and one that is the same.
        (
            r##"<rect x="20" y="20" width="20" height="20"/>"##,
            r##"<rect x="10" y="10" width="80" height="80"/>"##,
            80.0,
            400.0,
        ),
        (
            r##"<rect x="10" y="10" width="80" height="80"/>"##,
            r##"<rect x="20" y="20" width="20" height="20"/>"##,
            80.0,
            400.0,
        ),
        (
            r##"<rect x="20" y="20" width="20" height="20"/>"##,
            r##"<path d="M40 20V40H20V20z"/>"##,
            80.0,
            400.0,
        ),
        // Sides that lie on each other.
        (
            r##"<rect x="20" y="20" width="20" height="20"/>"##,
            r##"<rect x="20" y="30" width="20" height="30"/>"##,
            60.0,
            200.0,
        ),
        // A disc by a half plane, and by a disc that is the same.
        (
            r##"<rect width="50" height="100"/>"##,
            r##"<circle cx="50" cy="50" r="20"/>"##,
            2.0 * quarter + 40.0,
            2.0 * quarter * 10.0,
        ),
        (
            r##"<circle cx="50" cy="50" r="20"/>"##,
            r##"<circle cx="50" cy="50" r="20" transform="rotate(77 50 50)"/>"##,
            4.0 * quarter,
            4.0 * quarter * 10.0,
        ),
        // A clip with a hole in the area.
        (
            r##"<path clip-rule="evenodd" d="M0 0h100v100h-100z M30 30h10v10h-10z"/>"##,
            r##"<rect x="20" y="20" width="40" height="40"/>"##,
            200.0,
            1500.0,
        ),
        // Two shapes of a clip, over each other.
        (
            r##"<rect width="30" height="100"/><rect x="25" width="10" height="100"/>"##,
            r##"<rect x="20" y="20" width="40" height="40"/>"##,
            110.0,
            600.0,
        ),
    ] {
        let content = format!(
            r##"<clipPath id="c">{clip}</clipPath><g clip-path="url(#c)" fill="red">{shape}</g>"##
        );
        let mut found = drawing(&content);
        let drawn = length(&found.strokes);
        assert!(
            (drawn - outline).abs() < 1e-3 * outline,
            "{content}: {drawn} mm, not {outline}"
        );
        for stroke in &found.strokes {
            let (from, to) = (stroke.start, stroke.end());
            assert!(
                (from[0] - to[0]).hypot(from[1] - to[1]) < 3e-6,
                "{content}: an outline is open"
            );
        }
        found.fill(1e-4).expect("lines");
        let covered = 0.1 * length(&found.strokes);
        assert!(
            (covered - area).abs() < 0.01 * area,
            "{content}: {covered} mm^2, not {area}"
        );
    }
    // Outside of its clip nothing is left.
    let content = r##"<clipPath id="c"><rect width="20" height="20"/></clipPath><rect clip-path="url(#c)" x="20" width="20" height="20"/>"##;
    assert!(refusal(content).reason.contains("nothing"));
}

#[test]
fn effects_that_cannot_be_drawn_are_refused_by_element() {
    for (content, line, word, reason) in [
        (
            "<mask id='m'>\n<rect width='9' height='9' fill='gray'/></mask><rect mask='url(#m)' width='9' height='9'/>",
            2,
            "rect",
            "mask #m of rect",
        ),
        (
            "<linearGradient id='g'><stop/><stop stop-color='white'/></linearGradient><mask id='m'><rect width='9' height='9' fill='url(#g)'/></mask><rect mask='url(#m)' width='9' height='9'/>",
            1,
            "rect",
            "gradient",
        ),
        (
            "<mask id='m'><path d='M0 0H9' stroke='white' id='l'/></mask><rect mask='url(#m)' width='9' height='9'/>",
            1,
            "path#l",
            "a line",
        ),
        (
            "<mask id='m'><rect width='9' height='9' fill='white' opacity='.5'/></mask><rect mask='url(#m)' width='9' height='9'/>",
            1,
            "rect",
            "half seen",
        ),
        (
            "<g id='a' style='clip-path:circle(50%)'><rect width='9' height='9'/></g>",
            1,
            "g#a",
            "clip-path",
        ),
        (
            "<clipPath id='c'>\n<text>A</text></clipPath><g clip-path='url(#c)'><rect width='9' height='9'/></g>",
            2,
            "text",
            "convert",
        ),
        (
            "<clipPath id='c'><g><rect width='5' height='9'/></g></clipPath><rect clip-path='url(#c)' width='9' height='9'/>",
            1,
            "g",
            "ungroup",
        ),
        (
            "<filter id='f'><feOffset dx='9'/></filter><rect filter='url(#f)' width='9' height='9'/>",
            1,
            "rect",
            "filter",
        ),
        (
            "<marker id='m'>\n<text>A</text></marker><path d='M0 0H9' marker-end='url(#m)' stroke='red'/>",
            2,
            "text",
            "marker of path",
        ),
    ] {
        let fault = refusal(content);
        assert_eq!(
            (fault.line, fault.word.as_str()),
            (line, word),
            "{content}: {fault}"
        );
        assert!(fault.reason.contains(reason), "{content}: {fault}");
    }
    // A shadow, and blur: the shape is where it is.
    let shadow = "<filter id='f'><feOffset dx='9'/><feBlend in='SourceGraphic'/></filter><filter id='b'><feGaussianBlur stdDeviation='2'/></filter><rect filter='url(#f)' width='10' height='10'/><rect filter='url(#b)' width='10' height='10'/>";
    assert_length(shadow, 80.0);
}

#[test]
fn markers_are_drawn_at_their_vertices() {
    let arrow = r##"<marker id="m" markerWidth="4" markerHeight="4" refY="2"><path d="M0 0L4 2L0 4z"/></marker>"##;
    let side = 2.0 * 20.0_f64.sqrt() + 4.0;
    for (marker, path, expected) in [
        (arrow.to_owned(), r##"<path d="M10 10H90" fill="none" stroke="#000" marker-end="url(#m)"/>"##, 80.0 + side),
        (arrow.into(), r##"<path d="M10 10H90" fill="none" stroke="#000" stroke-width="2" style="marker:url(#m)"/>"##, 80.0 + 4.0 * side),
        (arrow.into(), r##"<path d="M10 10H40H90" fill="none" stroke="#000" marker-mid="url(#m)"/>"##, 80.0 + side),
        (arrow.into(), r##"<rect width="10" height="10" fill="none" stroke="#000" marker-end="url(#m)"/>"##, 40.0),
        (arrow.into(), r##"<path d="M10 10H90" stroke="#000" marker-end="url(#none)"/>"##, 80.0),
        // Cut by its own rectangle, unless it may be seen beyond.
        (r##"<marker id="m" markerWidth="4" markerHeight="4" refX="0"><path d="M-3 2H2" stroke="red"/></marker>"##.into(), r##"<path d="M10 10H90" stroke="#000" marker-end="url(#m)"/>"##, 82.0),
        (r##"<marker id="m" style="overflow:visible"><path d="M-3 2H2" stroke="red"/></marker>"##.into(), r##"<path d="M10 10H90" stroke="#000" marker-end="url(#m)"/>"##, 85.0),
        (r##"<marker id="m" viewBox="0 0 10 10" markerWidth="5" markerHeight="5" refX="10" refY="5"><path d="M0 5H10" stroke="context-stroke"/></marker>"##.into(), r##"<path d="M10 10H90" stroke="#00f" marker-end="url(#m)"/>"##, 85.0),
    ] {
        assert_length(&format!("{marker}{path}"), expected);
    }
    let turned = drawing(
        r##"<marker id="m" orient="auto" overflow="visible"><path d="M0 0H5" stroke="red"/></marker><path d="M10 10V50" stroke="red" marker-end="url(#m)"/>"##,
    );
    assert_eq!(ends(&turned)[1], [10.0, 50.0, 10.0, 55.0]);
    let start = drawing(
        r##"<marker id="m" orient="auto-start-reverse" overflow="visible"><path d="M0 0H5" stroke="red"/></marker><path d="M10 10V50" stroke="red" marker-start="url(#m)"/>"##,
    );
    assert_eq!(ends(&start)[1], [10.0, 10.0, 10.0, 5.0]);
}

#[test]
fn text_and_images_that_nobody_sees_are_no_text_and_no_images() {
    for unseen in [
        "<g style='display:none'><text x='1' y='1'>n</text></g>",
        "<text x='1' y='1'> \n </text>",
        "<text><tspan/></text>",
        "<text opacity='0'>A</text>",
        "<text fill='none'>A</text>",
        "<text visibility='hidden'>A</text>",
        "<text><tspan style='display:none'>A</tspan></text>",
        "<text font-size='0'>A</text>",
        "<g visibility='hidden'><image href='a.png' width='9' height='9'/></g>",
        "<image width='9' height='9'/>",
        "<image href='a.png' width='0' height='9'/>",
        "<foreignObject width='9' height='9'>  </foreignObject>",
        "<switch><foreignObject requiredExtensions='http://ns.adobe.com/AdobeIllustrator/10.0/' width='9' height='9'><a>x</a></foreignObject><g/></switch>",
        "<metadata><text>A</text></metadata><title>A</title><desc>B</desc>",
        "<x xmlns='http://other'><text xmlns='http://www.w3.org/2000/svg'>A</text></x>",
    ] {
        assert_length(&format!("{SEEN}{unseen}"), 80.0);
    }
    for (seen, word) in [
        ("<text id='t'>A</text>", "text#t"),
        ("<text> <tspan>A</tspan></text>", "text"),
        (
            "<text fill='none'><tspan fill='red'>A</tspan></text>",
            "text",
        ),
        ("<image href='a.png'/>", "image"),
        (
            "<image xlink:href='data:image/png;base64,AAAA' width='5' height='5'/>",
            "image",
        ),
    ] {
        assert_eq!(refusal(&format!("{SEEN}{seen}")).word, word, "{seen}");
    }
}

#[test]
fn a_white_page_is_remarked() {
    for (content, lines) in [
        (
            r##"<rect width="100%" height="100%" fill="white"/>"##,
            vec![1],
        ),
        ("\n<path id='p' d='M0 0h100v100H0z' fill='#fff'/>", vec![2]),
        (
            r##"<rect x="-9" y="-9" width="200" height="200" style="fill:rgb(255 255 255)"/>"##,
            vec![1],
        ),
        (
            r##"<rect width="100%" height="100%" fill="white" stroke="black"/>"##,
            vec![],
        ),
        (r##"<rect width="100%" height="100%" fill="red"/>"##, vec![]),
        (
            r##"<rect width="100%" height="50%" fill="white"/>"##,
            vec![],
        ),
    ] {
        let found = drawing(content);
        let told: Vec<u32> = found.remarks.iter().map(|remark| remark.line).collect();
        assert_eq!(told, lines, "{content}");
    }
}

#[test]
fn files_of_every_encoding_are_read() {
    let latin = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"100mm\" viewBox=\"0 0 100 100\"><title>gr\xFC\xDFe</title><path id=\"\xE4\" d=\"M10 10H90\" stroke=\"#000\"/></svg>";
    let text = page(SEEN);
    let utf16 = |mark: &[u8], unit: fn(u16) -> [u8; 2]| {
        let mut bytes = mark.to_vec();
        bytes.extend(text.encode_utf16().flat_map(unit));
        bytes
    };
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(text.as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    for bytes in [
        latin.to_vec(),
        [b"\xEF\xBB\xBF", text.as_bytes()].concat(),
        utf16(b"\xFF\xFE", u16::to_le_bytes),
        utf16(b"\xFE\xFF", u16::to_be_bytes),
        utf16(b"", u16::to_le_bytes),
        packed.clone(),
        text.replace('\n', "\r\n").into_bytes(),
        format!("<?xml version='1.0' encoding='windows-1250'?>{text}").into_bytes(),
    ] {
        let found = read_svg(&bytes).unwrap_or_else(|fault| panic!("{fault}: {bytes:?}"));
        assert!((length(&found.strokes) - 80.0).abs() < 1e-9);
    }
    assert_eq!(read_svg(latin).unwrap().place_of(2), "shape 1 (\u{e4})");
    for (bytes, line, word, reason) in [
        (
            b"<svg>\n<title>gr\xFC\xDFe</title></svg>".to_vec(),
            2,
            "byte 0xFC",
            "save it as UTF-8",
        ),
        (
            b"<?xml version='1.0' encoding='windows-1251'?><svg>\xE4</svg>".to_vec(),
            1,
            "windows-1251",
            "save it as UTF-8",
        ),
        (packed[..packed.len() / 2].to_vec(), 0, "", "damaged"),
        (b"\xFF\xFE<".to_vec(), 0, "", "UTF-16"),
        (b"PK\x03\x04".to_vec(), 1, "", "no SVG"),
        (Vec::new(), 1, "", "no SVG"),
    ] {
        let fault = read_svg(&bytes).expect_err(reason);
        assert_eq!((fault.line, fault.word.as_str()), (line, word), "{fault}");
        assert!(fault.reason.contains(reason), "{fault}");
    }
}
