//! Outlines moved by the radius of the tool, against the lengths and areas that geometry gives.

use std::f64::consts::{PI, TAU};
use trirrr_toolpath::drawing::{Drawing, Kerf, Stroke, read_svg};

/// Strokes of a drawing in mm, moved.
fn moved(content: &str, offset_mm: f64, lead_mm: f64) -> Drawing {
    let page = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100"><g fill="none" stroke="red">{content}</g></svg>"#
    );
    let mut drawing = read_svg(page).expect("a drawing");
    let kerf = Kerf {
        offset_m: 1e-3 * offset_mm,
        lead_m: 1e-3 * lead_mm,
    };
    drawing.offset(&kerf).expect("outlines");
    drawing
}

/// Length, mm, and area, mm^2, of a closed stroke.
fn size(stroke: &Stroke) -> [f64; 2] {
    let points = stroke.points(1e-7);
    let pairs = || points.windows(2);
    let length: f64 = pairs()
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
        .sum();
    let area: f64 = pairs()
        .map(|pair| 0.5 * (pair[0][0] * pair[1][1] - pair[1][0] * pair[0][1]))
        .sum();
    [1e3 * length, 1e6 * area.abs()]
}

const SQUARE: &str = r#"<rect x="20" y="20" width="40" height="40"/>"#;

#[test]
fn outlines_grow_and_holes_shrink() {
    let hole = r#"<circle cx="40" cy="40" r="10"/>"#;
    let island = r#"<path d="M37 37h6v6h-6z"/>"#;
    let ring = |radius: f64| [TAU * radius, PI * radius * radius];
    let grown = |side: f64, by: f64| {
        [
            4.0 * side + TAU * by,
            side * side + 4.0 * side * by + PI * by * by,
        ]
    };
    let square = |side: f64| [4.0 * side, side * side];
    for (content, offset, expected) in [
        (SQUARE.to_owned(), 1.0, vec![grown(40.0, 1.0)]),
        (SQUARE.to_owned(), -1.0, vec![square(38.0)]),
        (
            format!("{SQUARE}{hole}"),
            1.0,
            vec![grown(40.0, 1.0), ring(9.0)],
        ),
        (
            format!("{SQUARE}{hole}"),
            -1.0,
            vec![square(38.0), ring(11.0)],
        ),
        (
            format!("{hole}{SQUARE}{island}"),
            0.5,
            vec![ring(9.5), grown(40.0, 0.5), grown(6.0, 0.5)],
        ),
        // Whatever its sense in the file.
        (
            r#"<path d="M20 20v40h40v-40z"/>"#.to_owned(),
            1.0,
            vec![grown(40.0, 1.0)],
        ),
        // Curves: an ellipse grows by its length times the offset, and a disc of the offset.
        (
            r#"<path d="M20 40A20 20 0 0 1 60 40A20 20 0 0 1 20 40z"/>"#.to_owned(),
            2.0,
            vec![ring(22.0)],
        ),
        // A hole that is too narrow is gone.
        (
            format!(r#"{SQUARE}<circle cx="40" cy="40" r="0.5"/>"#),
            1.0,
            vec![grown(40.0, 1.0)],
        ),
    ] {
        let found = moved(&content, offset, 0.0);
        let sizes: Vec<[f64; 2]> = found.strokes.iter().map(size).collect();
        let near = |a: &[f64; 2], b: &[f64; 2]| (0..2).all(|i| (a[i] / b[i] - 1.0).abs() < 2e-4);
        assert!(
            sizes.len() == expected.len() && sizes.iter().zip(&expected).all(|(a, b)| near(a, b)),
            "{content} by {offset}: {sizes:?}, not {expected:?}"
        );
        assert_eq!(
            found.remarks.len(),
            usize::from(content.contains("0.5\"")),
            "{content}"
        );
    }
    // An ellipse and a free curve: area + length x offset + pi x offset^2.
    for curve in [
        r#"<ellipse cx="40" cy="40" rx="20" ry="8"/>"#,
        r#"<path d="M20 20C40 10 70 20 60 40S30 60 20 20z"/>"#,
    ] {
        let [length, area] = size(&moved(curve, 0.0, 0.0).strokes[0]);
        let [_, larger] = size(&moved(curve, 0.5, 0.0).strokes[0]);
        let expected = area + 0.5 * length + PI * 0.25;
        // The free curve has a corner, which is round outside.
        assert!(
            (larger / expected - 1.0).abs() < 1e-4,
            "{curve}: {larger}, not {expected}"
        );
    }
    // Open strokes stay as they are.
    let open = r#"<path d="M5 5H10"/>"#;
    assert_eq!(moved(open, 1.0, 2.0).strokes, moved(open, 0.0, 0.0).strokes);
}

#[test]
fn leads_lie_in_the_waste() {
    let found = moved(
        &format!(r#"{SQUARE}<circle cx="40" cy="40" r="10"/>"#),
        0.0,
        3.0,
    );
    let [square, hole] = &found.strokes[..] else {
        panic!("{}", found.strokes.len());
    };
    for point in [square.start, square.end()] {
        let [x, y] = [1e3 * point[0], 1e3 * (0.1 - point[1])];
        assert!(
            !(20.0..=60.0).contains(&x) || !(20.0..=60.0).contains(&y),
            "{x}, {y}"
        );
    }
    for point in [hole.start, hole.end()] {
        let off = (1e3 * point[0] - 40.0).hypot(1e3 * (0.1 - point[1]) - 40.0);
        assert!(off < 9.0, "{off}");
    }
    assert!(
        (size(square)[0] - 166.0).abs() < 1e-6 && (size(hole)[0] - TAU * 10.0 - 6.0).abs() < 1e-3
    );
    // Holes come first, with leads, too.
    let mut ordered = found.clone();
    ordered.order([0.0, 0.0]);
    assert_eq!(ordered.strokes[0].shape, 1);
    // Without room there is a shorter one, or none, and a word.
    let narrow = moved(
        r#"<circle cx="40" cy="40" r="0.1"/><rect x="30" y="30" width="20" height="20"/>"#,
        0.0,
        3.0,
    );
    assert_eq!(narrow.remarks.len(), 1, "{:?}", narrow.remarks);
}
