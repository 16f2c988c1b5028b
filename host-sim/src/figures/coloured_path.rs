//! Path of D in the plane, in the colours of the speed along it and of the torque that it takes.

use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, LEFT_OF, RIGHT_OF, Size, page};
use trirrr_figures::panel::axis_title;
use trirrr_figures::plane::View;
use trirrr_figures::scale::{Axis, Margin};
use trirrr_figures::style::{FRAME, INK, tone};

const LEFT: f64 = 84.0;
const TOP: f64 = 84.0;
const BOTTOM: f64 = 126.0;
const SIDE: f64 = 430.0;
/// Colours that are told apart.
const LEVELS: usize = 24;

/// Values along the path.
struct PathQuantity {
    name: &'static str,
    unit: &'static str,
    /// Place of the value behind x and y.
    index: usize,
}

const SPEED: PathQuantity = PathQuantity {
    name: "speed of D",
    unit: "m/s",
    index: 2,
};
const TORQUE: PathQuantity = PathQuantity {
    name: "largest torque",
    unit: "N m",
    index: 3,
};

/// Draws the path of `points`: time; x and y of D (m), speed (m/s) and largest torque (N m). Torques that are all 0 are not drawn.
pub(super) fn draw(heading: &str, points: &[(f64, [f64; 4])]) -> Drawn {
    let has_torque = points.iter().any(|(_, values)| values[TORQUE.index] > 0.0);
    let quantities = match has_torque {
        true => &[SPEED, TORQUE][..],
        false => &[SPEED][..],
    };
    let places: Vec<[f64; 2]> = points.iter().map(|(_, [x, y, ..])| [*x, *y]).collect();
    let first = View::around(&places, "m", (LEFT, TOP), SIDE);
    let slot = LEFT + first.width + 30.0;
    let title = format!("{heading}: the path of D");
    let wide = slot * quantities.len() as f64 + 10.0;
    let width = wide.max(Size::Title.width(&title) + 40.0);
    page(width, TOP + first.height + BOTTOM, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for (index, quantity) in quantities.iter().enumerate() {
            let corner = (LEFT + slot * index as f64, TOP);
            let view = View::around(&places, "m", corner, SIDE);
            view.grid(canvas, ["x of D", "y of D"])?;
            coloured(canvas, &view, points, quantity)?;
        }
        Ok(())
    })
}

fn coloured(
    canvas: &Canvas<'_>,
    view: &View,
    points: &[(f64, [f64; 4])],
    quantity: &PathQuantity,
) -> Draw {
    let values = points.iter().map(|(_, values)| values[quantity.index]);
    let most = values.fold(0.0, f64::max);
    let level = |index: usize| {
        // A stretch has the value in its middle.
        let pair = [index, index + 1].map(|index| points[index].1[quantity.index]);
        let part = 0.5 * (pair[0] + pair[1]) / most.max(f64::MIN_POSITIVE);
        ((part * LEVELS as f64) as usize).min(LEVELS - 1)
    };
    let stretches: Vec<usize> = (0..points.len().saturating_sub(1)).collect();
    for stretch in stretches.chunk_by(|a, b| level(*a) == level(*b)) {
        let (first, last) = (stretch[0], stretch[stretch.len() - 1] + 1);
        let line: Vec<_> = points[first..=last]
            .iter()
            .map(|(_, [x, y, ..])| view.at([*x, *y]))
            .collect();
        canvas.line(&line, shade(level(first)), 3.4)?;
    }
    if let Some((_, [x, y, ..])) = points.first() {
        canvas.joint(view.at([*x, *y]), 5.0, INK)?;
    }
    let (left, top) = view.corner();
    let axis = Axis::new(0.0, most, quantity.unit, Margin::Exact, 5.0);
    let title = axis_title(quantity.name, &axis.unit);
    let middle = (left + view.width / 2.0, top - 18.0);
    canvas.text(&title, middle, Size::Label, CENTRED, INK)?;
    scale(canvas, view, &axis)
}

fn shade(level: usize) -> trirrr_figures::style::RGBColor {
    tone(level as f64 / (LEVELS - 1) as f64)
}

/// Bar of the colours with its values, below the drawing.
fn scale(canvas: &Canvas<'_>, view: &View, axis: &Axis) -> Draw {
    let (left, top) = view.corner();
    let (low, high) = (top + view.height + 72.0, top + view.height + 84.0);
    let x = |part: f64| left + part * view.width;
    for level in 0..LEVELS {
        let (from, to) = (
            x(level as f64 / LEVELS as f64),
            x((level + 1) as f64 / LEVELS as f64),
        );
        let corners = [(from, low), (to, low), (to, high), (from, high)];
        canvas.polygon(&corners, shade(level))?;
    }
    for (value, label) in &axis.ticks {
        let at = x(axis.fraction(*value));
        canvas.line(&[(at, high), (at, high + 5.0)], FRAME, 1.0)?;
        let anchor = match axis.fraction(*value) {
            part if part < 0.05 => RIGHT_OF,
            part if part > 0.95 => LEFT_OF,
            _ => CENTRED,
        };
        canvas.text(label, (at, high + 15.0), Size::Tick, anchor, INK)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_figures::style::hex;

    #[test]
    fn the_fastest_stretch_has_the_darkest_colour() {
        let points: Vec<_> = (0..100)
            .map(|index| {
                let part = f64::from(index) / 99.0;
                (part, [part, 0.5 * part, part, 0.0])
            })
            .collect();
        let drawn = draw("job", &points).unwrap();
        let lines = |colour| {
            let colour = format!("stroke=\"{}\"", hex(colour).to_uppercase());
            drawn.matches(&colour).count()
        };
        assert_eq!([lines(tone(1.0)), lines(tone(0.0))], [1, 1]);
        assert!(drawn.contains("speed of D (m/s)") && !drawn.contains("largest torque"));
        assert!(draw("job", &[]).unwrap().ends_with("</svg>\n"));
    }
}
