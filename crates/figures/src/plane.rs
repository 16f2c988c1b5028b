//! Window on a plane, with the same scale in both directions and a grid.

use crate::canvas::{Canvas, Draw};
use crate::frame::Frame;
use crate::panel::{axis_title, range};
use crate::scale::{Axis, Margin};
use crate::sketch::Cells;

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
    pub fn at(&self, point: [f64; 2]) -> (f64, f64) {
        self.frame().at(point)
    }

    /// Returns the length in the plane of a logical pixel.
    pub fn pixel(&self) -> f64 {
        (self.x.high - self.x.low) / self.width
    }

    /// Returns the upper left corner.
    pub fn corner(&self) -> (f64, f64) {
        (self.left, self.top)
    }

    /// Fills the cells that have a colour. Cells beside each other in a row that have the same become one rectangle.
    pub(crate) fn cells(&self, canvas: &Canvas<'_>, cells: &Cells) -> Draw {
        let half = 0.5 * cells.side;
        let [x, y] = cells.first;
        for (row, colours) in (0_u32..).zip(cells.colours.chunks(cells.size[0].max(1))) {
            let y = y + f64::from(row) * cells.side;
            let mut column = 0;
            for run in colours.chunk_by(|one, other| one == other) {
                let ends = [column, column + run.len() - 1];
                column += run.len();
                let Some(colour) = run[0] else {
                    continue;
                };
                let [left, right] = ends.map(|column| x + column as f64 * cells.side);
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
        let frame = self.frame();
        frame.grid(canvas, false)?;
        let up = axis_title(titles[1], &self.y.unit);
        frame.outline(canvas, &up, self.left - 54.0)?;
        frame.below(canvas, &axis_title(titles[0], &self.x.unit))
    }

    fn frame(&self) -> Frame<'_> {
        Frame {
            left: self.left,
            top: self.top,
            right: self.left + self.width,
            bottom: self.top + self.height,
            x: &self.x,
            y: &self.y,
        }
    }
}
