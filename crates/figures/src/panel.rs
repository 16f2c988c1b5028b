//! Curves against time, or another quantity: panels stacked over one axis.

use super::canvas::{CENTRED, Canvas, Draw, Drawn, LEFT_OF, RIGHT_OF, Size, page};
use super::frame::Frame;
use super::scale::{Axis, Margin};
use super::style::{CURVES, FRAME, INK, LIMIT, RGBColor, faded};
use std::borrow::Cow;

/// One curve of a panel.
#[derive(Default)]
pub struct Curve {
    /// Legend entry.
    pub label: Cow<'static, str>,
    /// Points: the quantity of the horizontal axis (time in s, unless the figure has another)
    /// and the value in the panel's unit. A value that is not finite is a gap.
    pub points: Vec<(f64, f64)>,
    /// Colour; without one that of its place among the [`CURVES`].
    pub colour: Option<RGBColor>,
    /// `true` draws dashes: what is asked for, beside what there is.
    pub dashed: bool,
}

/// Lines at the values of a limit.
pub struct LimitLine {
    /// Legend entry.
    pub label: String,
    /// Values in the panel's unit.
    pub values: Vec<f64>,
    /// Colour.
    pub colour: RGBColor,
}

/// One panel: curves of one unit.
#[derive(Default)]
pub struct Panel {
    /// Quantity of the vertical axis, such as `motor torque`.
    pub quantity: &'static str,
    /// SI unit of the points; empty if they have none.
    pub unit: &'static str,
    /// `true` includes zero in the vertical axis, regardless of the values.
    pub from_zero: bool,
    /// The curves. Those that have no colours of their own take the [`CURVES`] in turn.
    pub curves: Vec<Curve>,
    /// Limits of the curves. One that is far beyond them stands in the legend alone.
    pub limits: Vec<LimitLine>,
    /// Parts of the horizontal axis in which a limit is broken, from and to.
    pub breaches: Vec<(f64, f64)>,
    /// Ends of the stretches of the horizontal axis that are numbered from 1, such as moves; from the axis's start on.
    pub marks: Vec<f64>,
}

/// Limits more than so many times the values would press them flat.
const FAR: f64 = 3.0;

/// Most marks that can be told apart.
const MARKS: usize = 64;

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
            let labels = panel.curves.iter().map(|curve| curve.label.as_ref());
            labels
                .chain(panel.limits.iter().map(|limit| limit.label.as_str()))
                .map(|label| Size::Label.width(label))
        }));

    let total = TOP + BOTTOM + height * panels.len() as f64 + GAP * (panels.len() as f64 - 1.0);
    page(WIDTH, total, |canvas| {
        canvas.text(title, (WIDTH / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for (row, (panel, axis)) in panels.iter().zip(&axes).enumerate() {
            let top = TOP + row as f64 * (height + GAP);
            let frame = Frame {
                left,
                right: WIDTH - right,
                top,
                bottom: top + height,
                x: over,
                y: axis,
            };
            frame.draw(canvas, panel)?;
            if row == 0 {
                frame.numbers(canvas, panel)?;
            }
            if row + 1 == panels.len() {
                frame.below(canvas, &axis_title(quantity, &over.unit))?;
            }
        }
        Ok(())
    })
}

fn vertical_axis(panel: &Panel, height: f64) -> Axis {
    let values = panel
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(|p| p.1))
        .filter(|value| value.is_finite());
    let zero = panel.from_zero.then_some(0.0);
    let (low, high) = range(values.chain(zero));
    let limits = panel.limits.iter().flat_map(|limit| &limit.values);
    let near = limits.copied().filter(|value| is_near(*value, (low, high)));
    let (low, high) = range(near.chain([low, high]));
    Axis::new(low, high, panel.unit, Margin::Padded, height / 40.0)
}

/// Returns `true` if a limit can be shown beside values from `low` to `high`.
fn is_near(limit: f64, (low, high): (f64, f64)) -> bool {
    limit.abs() <= FAR * low.abs().max(high.abs())
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

/// Curves with their colours.
fn coloured(panel: &Panel) -> impl Iterator<Item = (RGBColor, &Curve)> {
    let curves = panel.curves.iter().zip(CURVES.iter().cycle());
    curves.map(|(curve, colour)| (curve.colour.unwrap_or(*colour), curve))
}

/// Contents of a panel.
impl Frame<'_> {
    fn draw(&self, canvas: &Canvas<'_>, panel: &Panel) -> Draw {
        for (from, to) in &panel.breaches {
            // An instant is seen, too.
            let (from, to) = (self.across(*from) - 1.0, self.across(*to) + 1.0);
            let corners = [
                (from, self.top),
                (to, self.top),
                (to, self.bottom),
                (from, self.bottom),
            ];
            canvas.polygon(&corners, faded(LIMIT, 0.16))?;
        }
        self.grid(canvas, true)?;
        for (colour, curve) in coloured(panel) {
            let stretches = curve.points.split(|(_, value)| !value.is_finite());
            for stretch in stretches {
                let points: Vec<_> = stretch
                    .iter()
                    .map(|&(t, value)| (self.across(t), self.up(value)))
                    .collect();
                match curve.dashed {
                    true => canvas.dashes(&points, colour, 1.5)?,
                    false => canvas.line(&points, colour, 2.0)?,
                }
            }
        }
        for limit in &panel.limits {
            let shown = self.y.low..=self.y.high;
            for value in limit.values.iter().filter(|value| shown.contains(value)) {
                let y = self.up(*value);
                canvas.dashed((self.left, y), (self.right, y), limit.colour)?;
            }
        }
        if panel.marks.len() <= MARKS {
            for mark in &panel.marks {
                let x = self.across(*mark);
                canvas.line(&[(x, self.top), (x, self.bottom)], faded(FRAME, 0.6), 1.0)?;
            }
        }
        let title = axis_title(panel.quantity, &self.y.unit);
        self.outline(canvas, &title, 18.0)?;
        self.legend(canvas, panel)
    }

    /// Numbers of the marked stretches above the frame, where there is room.
    fn numbers(&self, canvas: &Canvas<'_>, panel: &Panel) -> Draw {
        if panel.marks.len() < 2 || panel.marks.len() > MARKS {
            return Ok(());
        }
        let y = self.top - 8.0;
        canvas.text("move", (self.left - 8.0, y), Size::Tick, LEFT_OF, FRAME)?;
        let mut from = self.left;
        for (index, mark) in panel.marks.iter().enumerate() {
            let (to, text) = (self.across(*mark), (index + 1).to_string());
            if to - from > Size::Tick.width(&text) + 3.0 {
                canvas.text(&text, ((from + to) / 2.0, y), Size::Tick, CENTRED, FRAME)?;
            }
            from = to;
        }
        Ok(())
    }

    /// Beside the frame, where it covers no curve.
    fn legend(&self, canvas: &Canvas<'_>, panel: &Panel) -> Draw {
        let x = self.right + 12.0;
        let at = |row: usize| self.top + 14.0 + 22.0 * row as f64;
        let text = |row: usize, label: &str| {
            canvas.text(label, (x + 29.0, at(row)), Size::Label, RIGHT_OF, INK)
        };
        for (row, (colour, curve)) in coloured(panel).enumerate() {
            let line = [(x, at(row)), (x + 22.0, at(row))];
            match curve.dashed {
                true => canvas.dashes(&line, colour, 1.5)?,
                false => canvas.line(&line, colour, 2.5)?,
            }
            text(row, &curve.label)?;
        }
        for (row, limit) in panel.limits.iter().enumerate() {
            let row = panel.curves.len() + row;
            canvas.dashed((x, at(row)), (x + 22.0, at(row)), limit.colour)?;
            text(row, &limit.label)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(limit: f64) -> Panel {
        Panel {
            quantity: "torque",
            unit: "N m",
            curves: vec![Curve {
                label: "motor 1".into(),
                points: vec![(0.0, -1.0), (1.0, 2.0)],
                ..Curve::default()
            }],
            limits: vec![LimitLine {
                label: "limit".into(),
                values: vec![limit, -limit],
                colour: LIMIT,
            }],
            ..Panel::default()
        }
    }

    #[test]
    fn a_limit_is_on_the_axis_unless_it_would_press_the_curves_flat() {
        let axis = |limit| vertical_axis(&panel(limit), 200.0);
        assert!(axis(5.0).high > 5.0 && axis(5.0).low < -5.0);
        assert!(axis(500.0).high < 3.0);
        let dashes = |limit| {
            let drawn = draw("title", &[panel(limit)]).unwrap();
            assert!(drawn.contains(">\nlimit\n<"));
            drawn
                .matches(&crate::style::hex(LIMIT).to_uppercase())
                .count()
        };
        assert!(
            dashes(5.0) > 20 * dashes(500.0),
            "{} {}",
            dashes(5.0),
            dashes(500.0)
        );
    }

    #[test]
    fn stretches_are_numbered_where_there_is_room() {
        let mut panel = panel(5e3);
        panel.marks = vec![0.5, 0.501, 1.0];
        let drawn = draw("title", &[panel]).unwrap();
        let has = |text: &str| drawn.contains(&format!(">\n{text}\n<"));
        assert!(has("1") && !has("2") && has("3") && has("move"));
    }
}
