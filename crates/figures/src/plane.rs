//! Window on a plane, with the same scale in both directions and a grid.

use crate::canvas::{BELOW, Canvas, Draw, LEFT_OF, Size};
use crate::panel::{axis_title, range};
use crate::scale::{Axis, Margin};
use crate::style::{FRAME, GRID, INK, RGBColor};

/// Distance of the grid's lines, about, in logical pixels.
const INTERVAL: f64 = 80.0;

/// Overlap of cells, in logical pixels.
const SEAM: f64 = 0.4;

/// Maps points of a plane to logical pixels.
pub struct View {
    x: Axis,
    y: Axis,
    left: f64,
    top: f64,
    /// Width in logical pixels.
    pub width: f64,
    /// Height in logical pixels.
    pub height: f64,
}

impl View {
    /// Returns a window that shows all `points`, given in `unit`.
    ///
    /// `(left, top)` is the upper left corner in logical pixels. The window fits into a square of
    /// `side` pixels, and is at least a third of `side` wide and high.
    pub fn around(points: &[[f64; 2]], unit: &str, (left, top): (f64, f64), side: f64) -> Self {
        let (x_low, x_high) = range(points.iter().map(|p| p[0]));
        let (y_low, y_high) = range(points.iter().map(|p| p[1]));
        let span = f64::max(x_high - x_low, y_high - y_low);
        // A single point still has a scale.
        let span = if span > 0.0 { span } else { 1.0 };
        let margin = 0.09 * span;
        let extent = |low: f64, high: f64| {
            let missing = f64::max(0.0, span / 3.0 - (high - low)) / 2.0;
            (low - margin - missing, high + margin + missing)
        };
        let ((x_low, x_high), (y_low, y_high)) = (extent(x_low, x_high), extent(y_low, y_high));
        let pixels = side / f64::max(x_high - x_low, y_high - y_low);
        let (width, height) = ((x_high - x_low) * pixels, (y_high - y_low) * pixels);
        Self {
            x: Axis::new(x_low, x_high, unit, Margin::Exact, width / INTERVAL),
            y: Axis::new(y_low, y_high, unit, Margin::Exact, height / INTERVAL),
            left,
            top,
            width,
            height,
        }
    }

    /// Returns the place of a point on the page.
    pub fn at(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        (
            self.left + self.x.fraction(x) * self.width,
            self.top + (1.0 - self.y.fraction(y)) * self.height,
        )
    }

    /// Returns the upper left corner.
    pub fn corner(&self) -> (f64, f64) {
        (self.left, self.top)
    }

    /// Fills the square cells of a grid with sides of `side`, whose centres and colours are given by column and row. Cells beside each other in a
    /// row that have the same colour become one rectangle.
    ///
    /// # Errors
    /// Failures of plotters.
    pub fn cells(
        &self,
        canvas: &Canvas<'_>,
        ([columns, rows], side): ([usize; 2], f64),
        centre: impl Fn(usize, usize) -> [f64; 2],
        colour: impl Fn(usize, usize) -> Option<RGBColor>,
    ) -> Draw {
        let half = 0.5 * side;
        for row in 0..rows {
            let colours: Vec<_> = (0..columns).map(|column| colour(column, row)).collect();
            let mut column = 0;
            for run in colours.chunk_by(|one, other| one == other) {
                let (first, last) = (column, column + run.len() - 1);
                column += run.len();
                let Some(colour) = run[0] else {
                    continue;
                };
                let ([left, y], [right, _]) = (centre(first, row), centre(last, row));
                // A hair over the next cell: no seam shows between them.
                let [low, high] = [
                    self.at([left - half, y - half]),
                    self.at([right + half, y + half]),
                ];
                let (low, high) = ((low.0, low.1 + SEAM), (high.0, high.1 - SEAM));
                let corners = [low, (high.0, low.1), high, (low.0, high.1)];
                canvas.polygon(&corners, colour)?;
            }
        }
        Ok(())
    }

    /// Draws grid, frame, ticks and the titles of the axes.
    ///
    /// # Errors
    /// Failures of plotters.
    pub fn grid(&self, canvas: &Canvas<'_>, titles: [&str; 2]) -> Draw {
        let (left, top) = (self.left, self.top);
        let (right, bottom) = (left + self.width, top + self.height);
        for (value, label) in &self.x.ticks {
            let x = left + self.x.fraction(*value) * self.width;
            canvas.line(&[(x, top), (x, bottom)], GRID, 1.0)?;
            canvas.text(label, (x, bottom + 8.0), Size::Tick, BELOW, INK)?;
        }
        for (value, label) in &self.y.ticks {
            let y = bottom - self.y.fraction(*value) * self.height;
            canvas.line(&[(left, y), (right, y)], GRID, 1.0)?;
            canvas.text(label, (left - 8.0, y), Size::Tick, LEFT_OF, INK)?;
        }
        let corners = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        canvas.line(&corners, FRAME, 1.0)?;
        let middle = (left + self.width / 2.0, bottom + 34.0);
        let title = axis_title(titles[0], &self.x.unit);
        canvas.text(&title, middle, Size::Label, BELOW, INK)?;
        let middle = (left - 54.0, top + self.height / 2.0);
        canvas.upright(
            &axis_title(titles[1], &self.y.unit),
            middle,
            Size::Label,
            INK,
        )
    }
}
