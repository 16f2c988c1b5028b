//! Points and curves over two logarithmic axes, such as error against run time.

use super::canvas::{BELOW, CENTRED, Canvas, Draw, Drawn, LEFT_OF, RIGHT_OF, Size, page};
use super::panel::range;
use super::scale::power_of_ten;
use super::style::{CURVES, FRAME, GRID, INK, RGBColor, faded};

/// One curve or cloud of points in one colour.
pub struct Series {
    /// Legend entry.
    pub label: String,
    /// Colour; without one that of its place among the [`CURVES`].
    pub colour: Option<RGBColor>,
    /// `true` joins the points by lines, in their order.
    pub joined: bool,
    /// The points. Those with a coordinate that is not positive and finite are left out.
    pub points: Vec<Point>,
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

/// A staircase between points that none beats in both coordinates.
pub struct Front {
    /// Legend entry; none if empty.
    pub label: String,
    /// `true` draws the front thick, over a tint of all that it beats; `false` draws it thin and grey.
    pub strong: bool,
    /// Its corners, from left to right.
    pub points: Vec<(f64, f64)>,
}

/// A figure.
pub struct LogLog<'a> {
    /// Title of the figure.
    pub title: &'a str,
    /// Title of the horizontal axis, with the unit: `instructions per tick`.
    pub x: &'a str,
    /// Title of the vertical axis, with the unit: `error (m)`.
    pub y: &'a str,
    /// Clouds and curves, each in one colour.
    pub series: &'a [Series],
    /// Meanings of the shapes of the points, in order; empty if there is one shape.
    pub marks: &'a [&'a str],
    /// Pareto fronts, drawn behind the points.
    pub fronts: &'a [Front],
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 520.0;
const TOP: f64 = 52.0;
const BOTTOM: f64 = 64.0;
const LEFT: f64 = 84.0;

/// Strength of the tint of what a front beats.
const TINT: f64 = 0.07;

/// The points of `points` that no other one beats in both coordinates, from left to right.
pub fn pareto_front(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut points: Vec<_> = points.filter(|&(x, y)| is_drawn(x, y)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if front.last().is_none_or(|last| point.1 < last.1) {
            front.push(point);
        }
    }
    front
}

fn is_drawn(x: f64, y: f64) -> bool {
    x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite()
}

/// Draws the figure.
pub fn draw(figure: &LogLog<'_>) -> Drawn {
    let labels = figure.series.iter().map(|series| series.label.as_str());
    let widest = labels
        .chain(figure.marks.iter().copied())
        .chain(figure.fronts.iter().map(|front| front.label.as_str()))
        .map(|label| Size::Label.width(label))
        .fold(0.0, f64::max);
    let frame = DecadeFrame::around(figure, WIDTH - widest - 56.0);
    page(WIDTH, TOP + HEIGHT + BOTTOM, |canvas| {
        let middle = (WIDTH / 2.0, 26.0);
        canvas.text(figure.title, middle, Size::Title, CENTRED, INK)?;
        for front in figure.fronts.iter().filter(|front| front.strong) {
            frame.tint(canvas, front)?;
        }
        frame.draw(canvas, figure)?;
        for front in figure.fronts {
            frame.front(canvas, front)?;
        }
        for (colour, series) in coloured(figure) {
            let drawn: Vec<_> = series
                .points
                .iter()
                .filter(|point| is_drawn(point.x, point.y))
                .map(|point| (frame.at((point.x, point.y)), point.mark))
                .collect();
            if series.joined {
                let line: Vec<_> = drawn.iter().map(|(at, _)| *at).collect();
                canvas.line(&line, colour, 1.8)?;
            }
            for (at, shape) in drawn {
                mark(canvas, at, shape, colour)?;
            }
        }
        frame.legend(canvas, figure)
    })
}

/// Series with their colours.
fn coloured<'a>(figure: &'a LogLog<'_>) -> impl Iterator<Item = (RGBColor, &'a Series)> {
    let series = figure.series.iter().zip(CURVES.iter().cycle());
    series.map(|(series, colour)| (series.colour.unwrap_or(*colour), series))
}

/// The area of the axes, which run over whole decades.
struct DecadeFrame {
    right: f64,
    /// Decimal exponents at the ends.
    x: (i32, i32),
    y: (i32, i32),
}

impl DecadeFrame {
    fn around(figure: &LogLog<'_>, right: f64) -> Self {
        let points = || {
            let of_series = figure.series.iter().flat_map(|series| &series.points);
            let of_fronts = figure.fronts.iter().flat_map(|front| front.points.iter());
            of_series
                .map(|point| (point.x, point.y))
                .chain(of_fronts.copied())
                .filter(|&(x, y)| is_drawn(x, y))
        };
        let decades = |(low, high): (f64, f64)| {
            let (low, high) = (low.floor() as i32, high.ceil() as i32);
            (low, high.max(low + 1))
        };
        Self {
            right,
            x: decades(range(points().map(|(x, _)| x.log10()))),
            y: decades(range(points().map(|(_, y)| y.log10()))),
        }
    }

    fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let part = |value: f64, (low, high): (i32, i32)| {
            (value.log10() - f64::from(low)) / f64::from(high - low)
        };
        (
            LEFT + part(x, self.x) * (self.right - LEFT),
            TOP + (1.0 - part(y, self.y)) * HEIGHT,
        )
    }

    fn draw(&self, canvas: &Canvas<'_>, figure: &LogLog<'_>) -> Draw {
        let (bottom, right) = (TOP + HEIGHT, self.right);
        // Of many decades every second or fifth has a line.
        let step = |(low, high): (i32, i32)| match high - low {
            0..=12 => 1,
            13..=24 => 2,
            _ => 5,
        };
        let exponents = |ends: (i32, i32)| (ends.0..=ends.1).step_by(step(ends));
        for exponent in exponents(self.x) {
            let (x, _) = self.at((10f64.powi(exponent), 1.0));
            canvas.line(&[(x, TOP), (x, bottom)], GRID, 1.0)?;
            let label = power_of_ten(exponent);
            canvas.text(&label, (x, bottom + 8.0), Size::Tick, BELOW, INK)?;
        }
        for exponent in exponents(self.y) {
            let (_, y) = self.at((1.0, 10f64.powi(exponent)));
            canvas.line(&[(LEFT, y), (right, y)], GRID, 1.0)?;
            let label = power_of_ten(exponent);
            canvas.text(&label, (LEFT - 8.0, y), Size::Tick, LEFT_OF, INK)?;
        }
        let corners = [
            (LEFT, TOP),
            (right, TOP),
            (right, bottom),
            (LEFT, bottom),
            (LEFT, TOP),
        ];
        canvas.line(&corners, FRAME, 1.0)?;
        let middle = ((LEFT + right) / 2.0, bottom + 34.0);
        canvas.text(figure.x, middle, Size::Label, BELOW, INK)?;
        canvas.upright(figure.y, (18.0, TOP + HEIGHT / 2.0), Size::Label, INK)
    }

    /// The staircase from the frame's top to its right end. The front beats each point above and to the right.
    fn staircase(&self, front: &Front) -> Vec<(f64, f64)> {
        let places: Vec<_> = front.points.iter().map(|&point| self.at(point)).collect();
        let mut path: Vec<_> = places.first().map(|(x, _)| (*x, TOP)).into_iter().collect();
        for (nth, place) in places.iter().enumerate() {
            path.push(*place);
            let next = places.get(nth + 1).map_or(self.right, |(x, _)| *x);
            path.push((next, place.1));
        }
        path
    }

    fn tint(&self, canvas: &Canvas<'_>, front: &Front) -> Draw {
        let mut area = self.staircase(front);
        if area.is_empty() {
            return Ok(());
        }
        area.push((self.right, TOP));
        canvas.polygon(&area, faded(INK, TINT))
    }

    fn front(&self, canvas: &Canvas<'_>, front: &Front) -> Draw {
        let (colour, width) = front.stroke();
        canvas.line(&self.staircase(front), colour, width)
    }

    /// Beside the frame, where it covers nothing: colours, then shapes, then fronts.
    fn legend(&self, canvas: &Canvas<'_>, figure: &LogLog<'_>) -> Draw {
        let x = self.right + 16.0;
        let mut y = TOP + 14.0;
        let text =
            |y: f64, label: &str| canvas.text(label, (x + 22.0, y), Size::Label, RIGHT_OF, INK);
        for (colour, series) in coloured(figure) {
            canvas.line(&[(x, y), (x + 14.0, y)], colour, 5.0)?;
            text(y, &series.label)?;
            y += 22.0;
        }
        y += 12.0;
        for (shape, name) in figure.marks.iter().enumerate() {
            mark(canvas, (x + 7.0, y), shape, FRAME)?;
            text(y, name)?;
            y += 22.0;
        }
        y += 12.0;
        for front in figure.fronts.iter().filter(|front| !front.label.is_empty()) {
            let (colour, width) = front.stroke();
            canvas.line(&[(x - 4.0, y), (x + 18.0, y)], colour, width)?;
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
fn mark(canvas: &Canvas<'_>, (x, y): (f64, f64), shape: usize, colour: RGBColor) -> Draw {
    const R: f64 = 5.0;
    match shape % 4 {
        0 => canvas.dot((x, y), R, colour),
        1 => {
            let r = 0.88 * R;
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
                (x, y - 1.2 * R),
                (x + 1.1 * R, y + 0.8 * R),
                (x - 1.1 * R, y + 0.8 * R),
            ];
            canvas.polygon(&corners, colour)
        }
        _ => {
            let r = 1.25 * R;
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
            joined: true,
            points: vec![point(30.0, 2e-7), point(0.0, 1.0), point(4000.0, 3e-16)],
        }];
        let figure = LogLog {
            title: "title",
            x: "time",
            y: "error",
            series: &series,
            marks: &["a shape", "another"],
            fronts: &[Front {
                label: "front".into(),
                strong: true,
                points: vec![(30.0, 2e-7), (4000.0, 3e-16)],
            }],
        };
        let frame = DecadeFrame::around(&figure, 700.0);
        assert_eq!((frame.x, frame.y), ((1, 4), (-16, -6)));
        assert_eq!(frame.at((10.0, 1e-16)), (LEFT, TOP + HEIGHT));
        assert_eq!(frame.at((1e4, 1e-6)), (700.0, TOP));
        let svg = draw(&figure).unwrap();
        // Two points are squares; the shapes of the legend are a disc and a square.
        // The polygon before them tints what the front beats.
        assert_eq!(svg.matches("<polygon").count(), 1 + 2 + 1);
        // From the frame's top by both corners to its right end.
        let [first, last] = [(30.0, 2e-7), (4000.0, 3e-16)].map(|point| frame.at(point));
        let expected = [
            (first.0, TOP),
            first,
            (last.0, first.1),
            last,
            (700.0, last.1),
        ];
        assert_eq!(frame.staircase(&figure.fronts[0]), expected);
        for text in [
            "10\u{207b}\u{b9}\u{2076}",
            "10\u{2074}",
            "a series",
            "another",
            "front",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        let empty = LogLog {
            series: &[],
            fronts: &[],
            ..figure
        };
        assert!(draw(&empty).unwrap().ends_with("</svg>\n"));
    }
}
