//! Curves against time, or another quantity: panels stacked over one axis.

use super::canvas::{BELOW, CENTRED, Canvas, Draw, Drawn, LEFT_OF, RIGHT_OF, Size, page};
use super::scale::{Axis, Margin};
use super::style::{CURVES, FRAME, GRID, INK};
use std::borrow::Cow;

/// One curve of a panel.
pub struct Curve {
    /// Legend entry.
    pub label: Cow<'static, str>,
    /// Points: the quantity of the horizontal axis (time in s, unless the figure has another)
    /// and the value in the panel's unit.
    pub points: Vec<(f64, f64)>,
}

/// One panel: curves of one unit.
pub struct Panel {
    /// Quantity of the vertical axis, such as `motor torque`.
    pub quantity: &'static str,
    /// SI unit of the points; empty if they have none.
    pub unit: &'static str,
    /// `true` includes zero in the vertical axis, regardless of the values.
    pub from_zero: bool,
    /// At most as many as there are colours.
    pub curves: Vec<Curve>,
}

const WIDTH: f64 = 900.0;
const TOP: f64 = 52.0;
const BOTTOM: f64 = 58.0;
const GAP: f64 = 26.0;

/// Draws panels over time under one title. Panels without points are empty frames.
pub fn draw(title: &str, panels: &[Panel]) -> Drawn {
    draw_over(title, "time", &time_axis(panels), panels)
}

/// Draws panels under one title over the axis of `quantity`.
pub fn draw_over(title: &str, quantity: &str, over: &Axis, panels: &[Panel]) -> Drawn {
    let height = if panels.len() == 1 { 360.0 } else { 230.0 };
    let axes: Vec<Axis> = panels
        .iter()
        .map(|panel| vertical_axis(panel, height))
        .collect();

    let widest = |sizes: &mut dyn Iterator<Item = f64>| sizes.fold(0.0, f64::max);
    let left = 48.0
        + widest(
            &mut axes
                .iter()
                .flat_map(|axis| axis.ticks.iter().map(|(_, label)| Size::Tick.width(label))),
        );
    let right = 52.0
        + widest(&mut panels.iter().flat_map(|panel| {
            panel
                .curves
                .iter()
                .map(|curve| Size::Label.width(&curve.label))
        }));

    let total = TOP + BOTTOM + height * panels.len() as f64 + GAP * (panels.len() as f64 - 1.0);
    page(WIDTH, total, |canvas| {
        canvas.text(title, (WIDTH / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for (row, (panel, axis)) in panels.iter().zip(&axes).enumerate() {
            let top = TOP + row as f64 * (height + GAP);
            let frame = PanelFrame {
                left,
                right: WIDTH - right,
                top,
                bottom: top + height,
                over,
                quantity,
                axis,
            };
            frame.draw(canvas, panel)?;
            if row + 1 == panels.len() {
                frame.labels_below(canvas)?;
            }
        }
        Ok(())
    })
}

fn vertical_axis(panel: &Panel, height: f64) -> Axis {
    let values = panel
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(|p| p.1));
    let zero = panel.from_zero.then_some(0.0);
    let (low, high) = range(values.chain(zero));
    Axis::new(low, high, panel.unit, Margin::Padded, height / 40.0)
}

fn time_axis(panels: &[Panel]) -> Axis {
    let times = panels
        .iter()
        .flat_map(|panel| &panel.curves)
        .flat_map(|curve| curve.points.iter().map(|p| p.0));
    let (start, end) = range(times);
    Axis::time(start, end)
}

/// Least and greatest of `values`; (0, 0) if there are none.
pub fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values
        .fold(None, |range, value| match range {
            None => Some((value, value)),
            Some((low, high)) => Some((f64::min(low, value), f64::max(high, value))),
        })
        .unwrap_or((0.0, 0.0))
}

/// Formats an axis title, `quantity (unit)`.
pub fn axis_title(quantity: &str, unit: &str) -> String {
    if unit.is_empty() {
        quantity.into()
    } else {
        format!("{quantity} ({unit})")
    }
}

struct PanelFrame<'a> {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    over: &'a Axis,
    quantity: &'a str,
    axis: &'a Axis,
}

impl PanelFrame<'_> {
    fn x(&self, time: f64) -> f64 {
        self.left + self.over.fraction(time) * (self.right - self.left)
    }

    fn y(&self, value: f64) -> f64 {
        self.bottom - self.axis.fraction(value) * (self.bottom - self.top)
    }

    fn draw(&self, canvas: &Canvas<'_>, panel: &Panel) -> Draw {
        for (time, _) in &self.over.ticks {
            let x = self.x(*time);
            canvas.line(&[(x, self.top), (x, self.bottom)], GRID, 1.0)?;
        }
        for (value, label) in &self.axis.ticks {
            let y = self.y(*value);
            let is_zero = *value == 0.0;
            let colour = if is_zero { FRAME } else { GRID };
            canvas.line(&[(self.left, y), (self.right, y)], colour, 1.0)?;
            canvas.text(label, (self.left - 8.0, y), Size::Tick, LEFT_OF, INK)?;
        }
        for (curve, colour) in panel.curves.iter().zip(CURVES) {
            let points: Vec<_> = curve
                .points
                .iter()
                .map(|&(t, value)| (self.x(t), self.y(value)))
                .collect();
            canvas.line(&points, colour, 2.0)?;
        }
        let corners = [
            (self.left, self.top),
            (self.right, self.top),
            (self.right, self.bottom),
            (self.left, self.bottom),
            (self.left, self.top),
        ];
        canvas.line(&corners, FRAME, 1.0)?;
        canvas.upright(
            &axis_title(panel.quantity, &self.axis.unit),
            (18.0, (self.top + self.bottom) / 2.0),
            Size::Label,
            INK,
        )?;
        self.legend(canvas, panel)
    }

    /// Beside the frame, where it covers no curve.
    fn legend(&self, canvas: &Canvas<'_>, panel: &Panel) -> Draw {
        for (row, (curve, colour)) in panel.curves.iter().zip(CURVES).enumerate() {
            let y = self.top + 14.0 + 22.0 * row as f64;
            let x = self.right + 12.0;
            canvas.line(&[(x, y), (x + 22.0, y)], colour, 2.5)?;
            canvas.text(&curve.label, (x + 29.0, y), Size::Label, RIGHT_OF, INK)?;
        }
        Ok(())
    }

    fn labels_below(&self, canvas: &Canvas<'_>) -> Draw {
        for (time, label) in &self.over.ticks {
            canvas.text(
                label,
                (self.x(*time), self.bottom + 8.0),
                Size::Tick,
                BELOW,
                INK,
            )?;
        }
        let middle = (self.left + self.right) / 2.0;
        let title = axis_title(self.quantity, &self.over.unit);
        canvas.text(
            &title,
            (middle, self.bottom + 32.0),
            Size::Label,
            BELOW,
            INK,
        )
    }
}
