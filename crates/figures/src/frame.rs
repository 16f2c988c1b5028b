//! Area between two axes: grid, ticks, frame and titles, of every figure that has axes.

use crate::canvas::{BELOW, Canvas, Draw, LEFT_OF, Size};
use crate::scale::Axis;
use crate::style::{FRAME, GRID, INK};

/// Area of a figure between its axes, in logical pixels.
pub(crate) struct Frame<'a> {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
    pub(crate) x: &'a Axis,
    pub(crate) y: &'a Axis,
}

impl Frame<'_> {
    /// Place on the page of a value on the horizontal axis.
    pub(crate) fn across(&self, value: f64) -> f64 {
        self.left + self.x.fraction(value) * (self.right - self.left)
    }

    /// Place on the page of a value on the vertical axis.
    pub(crate) fn up(&self, value: f64) -> f64 {
        self.bottom - self.y.fraction(value) * (self.bottom - self.top)
    }

    /// Place on the page of a point.
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        (self.across(x), self.up(y))
    }

    /// Draws the lines at the ticks, and the labels of the vertical axis. Where zero has a line of its own, it `stands_out`.
    pub(crate) fn grid(&self, canvas: &Canvas<'_>, stands_out: bool) -> Draw {
        for (value, _) in &self.x.ticks {
            let x = self.across(*value);
            canvas.line(&[(x, self.top), (x, self.bottom)], GRID, 1.0)?;
        }
        for (value, label) in &self.y.ticks {
            let y = self.up(*value);
            let is_zero = stands_out && *value == 0.0;
            let colour = if is_zero { FRAME } else { GRID };
            canvas.line(&[(self.left, y), (self.right, y)], colour, 1.0)?;
            canvas.text(label, (self.left - 8.0, y), Size::Tick, LEFT_OF, INK)?;
        }
        Ok(())
    }

    /// Draws the frame, and the title of the vertical axis at `middle` across.
    pub(crate) fn outline(&self, canvas: &Canvas<'_>, title: &str, middle: f64) -> Draw {
        let corners = [
            (self.left, self.top),
            (self.right, self.top),
            (self.right, self.bottom),
            (self.left, self.bottom),
            (self.left, self.top),
        ];
        canvas.line(&corners, FRAME, 1.0)?;
        let at = (middle, (self.top + self.bottom) / 2.0);
        canvas.upright(title, at, Size::Label, INK)
    }

    /// Draws the labels of the horizontal axis and its title.
    pub(crate) fn below(&self, canvas: &Canvas<'_>, title: &str) -> Draw {
        for (value, label) in &self.x.ticks {
            let at = (self.across(*value), self.bottom + 8.0);
            canvas.text(label, at, Size::Tick, BELOW, INK)?;
        }
        let middle = ((self.left + self.right) / 2.0, self.bottom + 32.0);
        canvas.text(title, middle, Size::Label, BELOW, INK)
    }
}
