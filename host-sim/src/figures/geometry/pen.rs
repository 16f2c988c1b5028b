//! Arcs, names and signs of the geometry figure.

use std::f64::consts::TAU;
use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Size};
use trirrr_figures::style::{INK, RGBColor, WHITE};

/// Angle that is drawn as an arc with an arrow head.
pub(super) struct AngleArc {
    centre: (f64, f64),
    radius: f64,
    from: f64,
    /// Signed, less than a turn.
    by: f64,
}

impl AngleArc {
    pub(super) fn new(centre: (f64, f64), radius: f64, from: f64, to: f64) -> Self {
        Self {
            centre,
            radius,
            from,
            by: (to - from) % TAU,
        }
    }

    fn at(&self, part: f64, radius: f64) -> (f64, f64) {
        let angle = self.from + part * self.by;
        let (x, y) = self.centre;
        (x + radius * angle.cos(), y - radius * angle.sin())
    }

    pub(super) fn draw(&self, canvas: &Canvas<'_>, name: &str, colour: RGBColor) -> Draw {
        let points: Vec<_> = (0..=40)
            .map(|step| self.at(f64::from(step) / 40.0, self.radius))
            .collect();
        // An arrow head is longer than the arc of a small angle.
        match (self.by * self.radius).abs() > 12.0 {
            true => canvas.arrow(&points, colour, 1.5)?,
            false => canvas.line(&points, colour, 1.5)?,
        }
        // The name of a small angle would lie on its sides: it stands before the first one.
        let part = match self.by.abs() < 0.6 {
            true => -0.3 / self.by.abs().max(1e-3),
            false => 0.5,
        };
        let middle = self.from + part * self.by;
        let room = 10.0 + 0.5 * Size::Tick.width(name) * middle.cos().abs();
        haloed(canvas, name, self.at(part, self.radius + room), colour)
    }
}

pub(super) fn midpoint(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0)
}

/// Place at `distance` from `at`, on the side away from `from`.
pub(super) fn away(at: (f64, f64), from: (f64, f64), distance: f64) -> (f64, f64) {
    let (dx, dy) = (at.0 - from.0, at.1 - from.1);
    let size = dx.hypot(dy).max(1e-9);
    (at.0 + distance * dx / size, at.1 + distance * dy / size)
}

/// Writes a name on a ground of its own.
fn haloed(canvas: &Canvas<'_>, text: &str, at: (f64, f64), colour: RGBColor) -> Draw {
    if text.is_empty() {
        return Ok(());
    }
    for (dx, dy) in [(-1.3, 0.0), (1.3, 0.0), (0.0, -1.3), (0.0, 1.3)] {
        let around = (at.0 + dx, at.1 + dy);
        canvas.text(text, around, Size::Tick, CENTRED, WHITE)?;
    }
    canvas.text(text, at, Size::Tick, CENTRED, colour)
}

pub(super) fn named(canvas: &Canvas<'_>, text: &str, at: (f64, f64)) -> Draw {
    haloed(canvas, text, at, INK)
}

/// Writes a name at a place, on the side away from `from`, farther where the text is wide.
pub(super) fn outside(canvas: &Canvas<'_>, text: &str, at: (f64, f64), from: (f64, f64)) -> Draw {
    let along = away(at, from, 1.0).0 - at.0;
    let room = 15.0 + 0.5 * Size::Tick.width(text) * along.abs();
    named(canvas, text, away(at, from, room))
}

/// Writes a name beside the middle of a line.
pub(super) fn beside(canvas: &Canvas<'_>, text: &str, a: (f64, f64), b: (f64, f64)) -> Draw {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let size = dx.hypot(dy).max(1e-9);
    // Across the line, farther where the text is wide.
    let (x, y) = (-dy / size, dx / size);
    let room = 11.0 + 0.5 * Size::Tick.width(text) * x.abs();
    let middle = midpoint(a, b);
    named(canvas, text, (middle.0 + room * x, middle.1 + room * y))
}

/// A disc in quarters, black and white.
pub(super) fn centre_of_mass(canvas: &Canvas<'_>, at: (f64, f64)) -> Draw {
    const R: f64 = 6.0;
    canvas.joint(at, R, INK)?;
    for start in [0.0, TAU / 2.0] {
        let arc = (0..=8).map(|step| {
            let angle = start + f64::from(step) / 8.0 * TAU / 4.0;
            (at.0 + R * angle.cos(), at.1 + R * angle.sin())
        });
        let corners: Vec<_> = std::iter::once(at).chain(arc).collect();
        canvas.polygon(&corners, INK)?;
    }
    Ok(())
}
