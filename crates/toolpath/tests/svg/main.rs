//! SVG of the programs that people have: all that is seen is drawn, or refused by its line and name.

mod clips;
mod encodings;
mod lines;
mod seen;
mod styles;

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
