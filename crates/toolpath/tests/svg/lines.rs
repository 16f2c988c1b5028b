//! Copies, dashes and markers.

use super::{SEEN, assert_length, drawing, ends, length, refusal};

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
