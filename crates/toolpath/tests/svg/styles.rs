//! Styles, path data and coordinates.

use super::{assert_length, drawing, ends, refusal};
use trirrr_toolpath::drawing::read_svg;

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
