//! Points and curves over two quantities, each with an axis of its own.

use trirrr_figures::canvas::{BELOW, CENTRED, Canvas, Draw, Drawn, LEFT_OF, RIGHT_OF, Size, page};
use trirrr_figures::panel::{axis_title, range};
use trirrr_figures::scale::{Axis, Margin};
use trirrr_figures::style::{FRAME, GRID, INK, RGBColor};

const WIDTH: f64 = 900.0;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 250.0;
const TOP: f64 = 52.0;
const BOTTOM: f64 = 58.0;
const HEIGHT: f64 = 380.0;

/// Marks of a scatter figure.
pub(super) enum ScatterMarks {
    /// Points with a radius in logical pixels.
    Dots(f64),
    /// Lines from point to point.
    Line,
}

/// Points that share marks, a colour and an entry of the legend.
pub(super) struct ScatterSet {
    pub(super) label: String,
    pub(super) colour: RGBColor,
    pub(super) marks: ScatterMarks,
    pub(super) points: Vec<[f64; 2]>,
}

/// Title of an axis with its unit, and the least value that it has to show.
pub(super) struct ScatterAxis<'a> {
    pub(super) quantity: &'a str,
    pub(super) unit: &'a str,
    pub(super) from: Option<f64>,
}

/// Draws all sets, the first one below the others.
pub(super) fn scatter(title: &str, axes: [ScatterAxis<'_>; 2], sets: &[ScatterSet]) -> Drawn {
    let points = || sets.iter().flat_map(|set| &set.points);
    let axis = |index: usize, intervals: f64| {
        let ScatterAxis { unit, from, .. } = &axes[index];
        let (low, high) = range(points().map(|point| point[index]).chain(*from));
        Axis::new(low, high, unit, Margin::Padded, intervals)
    };
    let (x, y) = (axis(0, 8.0), axis(1, HEIGHT / 40.0));
    let right = WIDTH - RIGHT;
    let bottom = TOP + HEIGHT;
    let at = |point: &[f64; 2]| {
        (
            LEFT + x.fraction(point[0]) * (right - LEFT),
            bottom - y.fraction(point[1]) * HEIGHT,
        )
    };
    page(WIDTH, bottom + BOTTOM, |canvas| {
        canvas.text(title, (WIDTH / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for (value, label) in &x.ticks {
            let (place, _) = at(&[*value, y.low]);
            canvas.line(&[(place, TOP), (place, bottom)], GRID, 1.0)?;
            canvas.text(label, (place, bottom + 8.0), Size::Tick, BELOW, INK)?;
        }
        for (value, label) in &y.ticks {
            let (_, place) = at(&[x.low, *value]);
            canvas.line(&[(LEFT, place), (right, place)], GRID, 1.0)?;
            canvas.text(label, (LEFT - 8.0, place), Size::Tick, LEFT_OF, INK)?;
        }
        for set in sets {
            let places: Vec<_> = set.points.iter().map(at).collect();
            marks(canvas, &set.marks, &places, set.colour)?;
        }
        let corners = [
            (LEFT, TOP),
            (right, TOP),
            (right, bottom),
            (LEFT, bottom),
            (LEFT, TOP),
        ];
        canvas.line(&corners, FRAME, 1.0)?;
        let [across, up] = &axes;
        let middle = (0.5 * (LEFT + right), bottom + 32.0);
        let title = axis_title(across.quantity, &x.unit);
        canvas.text(&title, middle, Size::Label, BELOW, INK)?;
        let middle = (22.0, TOP + 0.5 * HEIGHT);
        canvas.upright(&axis_title(up.quantity, &y.unit), middle, Size::Label, INK)?;
        for (row, set) in sets.iter().enumerate() {
            let (left, top) = (right + 14.0, TOP + 14.0 + 22.0 * row as f64);
            let sample = match set.marks {
                ScatterMarks::Dots(_) => vec![(left + 10.0, top)],
                ScatterMarks::Line => vec![(left, top), (left + 20.0, top)],
            };
            marks(canvas, &set.marks, &sample, set.colour)?;
            canvas.text(&set.label, (left + 28.0, top), Size::Label, RIGHT_OF, INK)?;
        }
        Ok(())
    })
}

fn marks(
    canvas: &Canvas<'_>,
    marks: &ScatterMarks,
    places: &[(f64, f64)],
    colour: RGBColor,
) -> Draw {
    match marks {
        ScatterMarks::Line => canvas.line(places, colour, 2.0),
        ScatterMarks::Dots(radius) => places
            .iter()
            .try_for_each(|place| canvas.dot(*place, *radius, colour)),
    }
}
