//! Clips, masks and effects.

use super::{assert_length, assert_near, drawing, length, refusal};

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
