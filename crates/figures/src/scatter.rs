//! Points and curves over two quantities, such as error against run time, over linear or logarithmic axes.

use super::canvas::{CENTRED, Canvas, Draw, Drawn, RIGHT_OF, Size, page};
use super::frame::Frame;
use super::panel::{axis_title, range};
use super::scale::{Axis, Margin, power_of_ten};
use super::style::{CURVES, FRAME, INK, RGBColor, faded};

/// One curve or cloud of points in one colour.
#[derive(Default)]
pub struct Series {
    /// Legend entry.
    pub label: String,
    /// Colour; without one that of its place among the [`CURVES`].
    pub colour: Option<RGBColor>,
    /// Width of the line that joins the points, in their order; 0 for none.
    pub line: f64,
    /// Radius of the points, in logical pixels; 0 for none.
    pub radius: f64,
    /// The points. Those with a coordinate that is not finite, or has no logarithm where the axis needs one, are left out.
    pub points: Vec<Point>,
}

impl Series {
    /// Points with a radius in logical pixels.
    pub fn dots(label: impl Into<String>, radius: f64, points: Vec<[f64; 2]>) -> Self {
        Self {
            label: label.into(),
            radius,
            points: points.into_iter().map(Point::from).collect(),
            ..Self::default()
        }
    }

    /// Lines from point to point.
    pub fn line(label: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self {
            line: 2.0,
            ..Self::dots(label, 0.0, points)
        }
    }

    /// Draws in `colour`.
    #[must_use]
    pub fn coloured(mut self, colour: RGBColor) -> Self {
        self.colour = Some(colour);
        self
    }
}

/// One point.
pub struct Point {
    /// Value on the horizontal axis.
    pub x: f64,
    /// Value on the vertical axis.
    pub y: f64,
    /// Shape: index among the marks of the figure.
    pub mark: usize,
}

impl From<[f64; 2]> for Point {
    fn from([x, y]: [f64; 2]) -> Self {
        Self { x, y, mark: 0 }
    }
}

/// A staircase between points that none beats in both coordinates.
pub struct Front {
    /// Legend entry; none if empty.
    pub label: String,
    /// `true` draws the front thick, over a tint of all that it beats; `false` draws it thin and grey.
    pub strong: bool,
    /// Its corners, from left to right.
    pub points: Vec<(f64, f64)>,
}

/// Axis of a figure.
#[derive(Clone, Copy)]
pub enum Over<'a> {
    /// Whole decades, under this title with its unit: `instructions per tick`.
    Decades(&'a str),
    /// Linear, padded.
    Linear {
        /// Quantity of the title.
        quantity: &'a str,
        /// SI unit of the points; empty if they have none.
        unit: &'a str,
        /// Value that the axis has to show.
        from: Option<f64>,
    },
}

/// A figure.
pub struct Scatter<'a> {
    /// Title of the figure.
    pub title: &'a str,
    /// Horizontal axis.
    pub x: Over<'a>,
    /// Vertical axis.
    pub y: Over<'a>,
    /// Clouds and curves, each in one colour, the first one below the others.
    pub series: &'a [Series],
    /// Meanings of the shapes of the points, in order; empty if there is one shape.
    pub marks: &'a [&'a str],
    /// Pareto fronts, drawn behind the points.
    pub fronts: &'a [Front],
}

const WIDTH: f64 = 900.0;
const TOP: f64 = 52.0;
const BOTTOM: f64 = 64.0;
const LEFT: f64 = 92.0;

/// Radius of points that have shapes, in logical pixels.
pub const RADIUS: f64 = 5.0;

/// Strength of the tint of what a front beats.
const TINT: f64 = 0.07;

/// The points of `points` that no other one beats in both coordinates, from left to right. Those without a logarithm are left out.
pub fn pareto_front(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    let mut points: Vec<_> = points
        .filter(|&(x, y)| is_positive(x) && is_positive(y))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if front.last().is_none_or(|last| point.1 < last.1) {
            front.push(point);
        }
    }
    front
}

/// Draws the figure.
pub fn draw(figure: &Scatter<'_>) -> Drawn {
    let [x, y] = figure.axes();
    let labels = figure.series.iter().map(|series| series.label.as_str());
    let widest = labels
        .chain(figure.marks.iter().copied())
        .chain(figure.fronts.iter().map(|front| front.label.as_str()))
        .map(|label| Size::Label.width(label))
        .fold(0.0, f64::max);
    let frame = Frame {
        left: LEFT,
        top: TOP,
        right: WIDTH - widest - 56.0,
        bottom: TOP + figure.y.height(),
        x: &x,
        y: &y,
    };
    page(WIDTH, frame.bottom + BOTTOM, |canvas| {
        let middle = (WIDTH / 2.0, 26.0);
        canvas.text(figure.title, middle, Size::Title, CENTRED, INK)?;
        for front in figure.fronts.iter().filter(|front| front.strong) {
            let mut area = figure.staircase(&frame, front);
            if !area.is_empty() {
                area.push((frame.right, TOP));
                canvas.polygon(&area, faded(INK, TINT))?;
            }
        }
        frame.grid(canvas, false)?;
        for front in figure.fronts {
            let (colour, width) = front.stroke();
            canvas.line(&figure.staircase(&frame, front), colour, width)?;
        }
        for (colour, series) in coloured(figure) {
            let points = series.points.iter();
            let drawn: Vec<_> = points
                .filter_map(|point| Some((frame.at(figure.place(point.x, point.y)?), point.mark)))
                .collect();
            if series.line > 0.0 {
                let line: Vec<_> = drawn.iter().map(|(at, _)| *at).collect();
                canvas.line(&line, colour, series.line)?;
            }
            for (at, shape) in drawn.into_iter().filter(|_| series.radius > 0.0) {
                mark(canvas, at, shape, series.radius, colour)?;
            }
        }
        frame.outline(canvas, &figure.y.title(&y), 22.0)?;
        frame.below(canvas, &figure.x.title(&x))?;
        figure.legend(canvas, frame.right + 16.0)
    })
}

/// Series with their colours.
fn coloured<'a>(figure: &'a Scatter<'_>) -> impl Iterator<Item = (RGBColor, &'a Series)> {
    let series = figure.series.iter().zip(CURVES.iter().cycle());
    series.map(|(series, colour)| (series.colour.unwrap_or(*colour), series))
}

impl Over<'_> {
    /// Place of a value on the axis; a decade is 1.
    fn place(&self, value: f64) -> Option<f64> {
        let place = match self {
            Self::Decades(_) if value > 0.0 => value.log10(),
            Self::Decades(_) => return None,
            Self::Linear { .. } => value,
        };
        place.is_finite().then_some(place)
    }

    fn axis(&self, places: impl Iterator<Item = f64>, intervals: f64) -> Axis {
        match self {
            Self::Decades(_) => decades(range(places)),
            Self::Linear { unit, from, .. } => {
                let (low, high) = range(places.chain(*from));
                Axis::new(low, high, unit, Margin::Padded, intervals)
            }
        }
    }

    /// Height of a figure with this vertical axis, in logical pixels.
    fn height(&self) -> f64 {
        match self {
            Self::Decades(_) => 520.0,
            Self::Linear { .. } => 380.0,
        }
    }

    fn title(&self, axis: &Axis) -> String {
        match self {
            Self::Decades(title) => (*title).into(),
            Self::Linear { quantity, .. } => axis_title(quantity, &axis.unit),
        }
    }
}

/// Axis over whole decades. Of many every second or fifth has a tick.
fn decades((low, high): (f64, f64)) -> Axis {
    let (low, high) = (low.floor() as i32, high.ceil() as i32);
    let high = high.max(low + 1);
    let step = match high - low {
        0..=12 => 1,
        13..=24 => 2,
        _ => 5,
    };
    let exponents = (low..=high).step_by(step);
    Axis {
        low: f64::from(low),
        high: f64::from(high),
        ticks: exponents
            .map(|exponent| (f64::from(exponent), power_of_ten(exponent)))
            .collect(),
        unit: String::new(),
    }
}

impl Scatter<'_> {
    fn place(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        Some([self.x.place(x)?, self.y.place(y)?])
    }

    fn axes(&self) -> [Axis; 2] {
        let of_series = self.series.iter().flat_map(|series| &series.points);
        let of_series = of_series.map(|point| (point.x, point.y));
        let of_fronts = self.fronts.iter().flat_map(|front| front.points.iter());
        let points = of_series.chain(of_fronts.copied());
        let places: Vec<_> = points.filter_map(|(x, y)| self.place(x, y)).collect();
        let of = |axis: usize| places.iter().map(move |place| place[axis]);
        [
            self.x.axis(of(0), 8.0),
            self.y.axis(of(1), self.y.height() / 40.0),
        ]
    }

    /// The staircase from the frame's top to its right end. The front beats each point above and to the right.
    fn staircase(&self, frame: &Frame<'_>, front: &Front) -> Vec<(f64, f64)> {
        let points = front.points.iter();
        let places: Vec<_> = points
            .filter_map(|&(x, y)| Some(frame.at(self.place(x, y)?)))
            .collect();
        let mut path: Vec<_> = places.first().map(|(x, _)| (*x, TOP)).into_iter().collect();
        for (nth, place) in places.iter().enumerate() {
            path.push(*place);
            let next = places.get(nth + 1).map_or(frame.right, |(x, _)| *x);
            path.push((next, place.1));
        }
        path
    }

    /// Beside the frame, where it covers nothing: colours, then shapes, then fronts.
    fn legend(&self, canvas: &Canvas<'_>, x: f64) -> Draw {
        let mut y = TOP + 14.0;
        let text =
            |y: f64, label: &str| canvas.text(label, (x + 28.0, y), Size::Label, RIGHT_OF, INK);
        for (colour, series) in coloured(self) {
            match series.line > 0.0 || !self.marks.is_empty() {
                true => canvas.line(&[(x, y), (x + 20.0, y)], colour, series.line.max(2.5))?,
                false => canvas.dot((x + 10.0, y), series.radius, colour)?,
            }
            text(y, &series.label)?;
            y += 22.0;
        }
        y += 12.0;
        for (shape, name) in self.marks.iter().enumerate() {
            mark(canvas, (x + 10.0, y), shape, RADIUS, FRAME)?;
            text(y, name)?;
            y += 22.0;
        }
        y += 12.0;
        for front in self.fronts.iter().filter(|front| !front.label.is_empty()) {
            let (colour, width) = front.stroke();
            canvas.line(&[(x, y), (x + 20.0, y)], colour, width)?;
            text(y, &front.label)?;
            y += 22.0;
        }
        Ok(())
    }
}

impl Front {
    fn stroke(&self) -> (RGBColor, f64) {
        match self.strong {
            true => (INK, 2.4),
            false => (FRAME, 1.2),
        }
    }
}

/// A disc, square, triangle or diamond, then these again.
fn mark(
    canvas: &Canvas<'_>,
    (x, y): (f64, f64),
    shape: usize,
    size: f64,
    colour: RGBColor,
) -> Draw {
    match shape % 4 {
        0 => canvas.dot((x, y), size, colour),
        1 => {
            let r = 0.88 * size;
            let corners = [
                (x - r, y - r),
                (x + r, y - r),
                (x + r, y + r),
                (x - r, y + r),
            ];
            canvas.polygon(&corners, colour)
        }
        2 => {
            let corners = [
                (x, y - 1.2 * size),
                (x + 1.1 * size, y + 0.8 * size),
                (x - 1.1 * size, y + 0.8 * size),
            ];
            canvas.polygon(&corners, colour)
        }
        _ => {
            let r = 1.25 * size;
            canvas.polygon(&[(x, y - r), (x + r, y), (x, y + r), (x - r, y)], colour)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [
            (1.0, 9.0),
            (2.0, 5.0),
            (2.0, 4.0),
            (3.0, 4.0),
            (4.0, 1.0),
            (5.0, 2.0),
            (0.5, f64::NAN),
            (0.5, 0.0),
        ];
        let front = pareto_front(points.into_iter());
        assert_eq!(front, [(1.0, 9.0), (2.0, 4.0), (4.0, 1.0)]);
    }

    #[test]
    fn decades_frame_the_points_and_what_has_no_logarithm_is_left_out() {
        let point = |x: f64, y: f64| Point { x, y, mark: 1 };
        let series = [Series {
            label: "a series".into(),
            colour: None,
            line: 1.8,
            radius: RADIUS,
            points: vec![point(30.0, 2e-7), point(0.0, 1.0), point(4000.0, 3e-16)],
        }];
        let figure = Scatter {
            title: "title",
            x: Over::Decades("time"),
            y: Over::Decades("error"),
            series: &series,
            marks: &["a shape", "another"],
            fronts: &[Front {
                label: "front".into(),
                strong: true,
                points: vec![(30.0, 2e-7), (4000.0, 3e-16)],
            }],
        };
        let [x, y] = figure.axes();
        let ends = [x.low, x.high, y.low, y.high];
        assert_eq!(ends, [1.0, 4.0, -16.0, -6.0]);
        let frame = Frame {
            left: LEFT,
            top: TOP,
            right: 700.0,
            bottom: TOP + 520.0,
            x: &x,
            y: &y,
        };
        let at = |x: f64, y: f64| frame.at(figure.place(x, y).unwrap());
        assert_eq!(at(10.0, 1e-16), (LEFT, TOP + 520.0));
        assert_eq!(at(1e4, 1e-6), (700.0, TOP));
        let svg = draw(&figure).unwrap();
        // Two points are squares; the shapes of the legend are a disc and a square.
        // The polygon before them tints what the front beats.
        assert_eq!(svg.matches("<polygon").count(), 1 + 2 + 1);
        // From the frame's top by both corners to its right end.
        let [first, last] = [(30.0, 2e-7), (4000.0, 3e-16)].map(|(x, y)| at(x, y));
        let expected = [
            (first.0, TOP),
            first,
            (last.0, first.1),
            last,
            (700.0, last.1),
        ];
        assert_eq!(figure.staircase(&frame, &figure.fronts[0]), expected);
        for text in [
            "10\u{207b}\u{b9}\u{2076}",
            "10\u{2074}",
            "a series",
            "another",
            "front",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        let empty = Scatter {
            series: &[],
            fronts: &[],
            ..figure
        };
        assert!(draw(&empty).unwrap().ends_with("</svg>\n"));
    }
}
