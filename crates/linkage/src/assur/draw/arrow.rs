//! Arrows.

use trirrr_figures::canvas::{Canvas, Draw};
use trirrr_figures::style::RGBColor;

/// A line with a head, where it is long enough for one.
pub(super) fn arrow(
    canvas: &Canvas<'_>,
    from: (f64, f64),
    to: (f64, f64),
    colour: RGBColor,
    width: f64,
) -> Draw {
    const HEAD: f64 = 10.0;
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    if length < 1.0 {
        return Ok(());
    }
    canvas.line(&[from, to], colour, width)?;
    if length < HEAD {
        return Ok(());
    }
    let (ux, uy) = (dx / length, dy / length);
    let back = (to.0 - HEAD * ux, to.1 - HEAD * uy);
    let half = 0.36 * HEAD;
    let head = [
        to,
        (back.0 - half * uy, back.1 + half * ux),
        (back.0 + half * uy, back.1 - half * ux),
    ];
    canvas.polygon(&head, colour)
}
