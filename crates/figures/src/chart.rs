//! Figures against time, or another quantity, as data: which values of a row stand in which panel. The rows of a job are gathered in
//! bounded memory, whatever its length.

use crate::canvas::Drawn;
use crate::decimate::Decimator;
use crate::panel::{Curve, LimitLine, Panel, draw};
use crate::style::RGBColor;
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};

/// One quantity of the rows as a curve.
pub struct Series<R: ?Sized> {
    label: Cow<'static, str>,
    colour: Option<RGBColor>,
    is_dashed: bool,
    is_angle: bool,
    value: Box<dyn Fn(&R) -> f64 + Send>,
}

impl<R: ?Sized> Series<R> {
    /// Curve of `value`. A value that is not finite is a gap.
    pub fn new(
        label: impl Into<Cow<'static, str>>,
        value: impl Fn(&R) -> f64 + Send + 'static,
    ) -> Self {
        Self {
            label: label.into(),
            colour: None,
            is_dashed: false,
            is_angle: false,
            value: Box::new(value),
        }
    }

    /// A curve for each of `count` motors, legs or joints; `value` gets their numbers from 0. The first three have the colours of the
    /// motors.
    pub fn numbered(
        thing: &str,
        count: usize,
        value: impl Fn(&R, usize) -> f64 + Send + Copy + 'static,
    ) -> Vec<Self> {
        let each = |index: usize| {
            let label = format!("{thing} {}", index + 1);
            Self::new(label, move |row: &R| value(row, index))
        };
        (0..count).map(each).collect()
    }

    /// Draws the curve in `colour`, in place of that of its place.
    #[must_use]
    pub fn coloured(mut self, colour: RGBColor) -> Self {
        self.colour = Some(colour);
        self
    }

    /// Draws dashes: what is asked for, beside what there is.
    #[must_use]
    pub fn dashed(mut self) -> Self {
        self.is_dashed = true;
        self
    }

    /// The value is an angle that jumps by a turn where atan2 does: the curve has no such jump.
    #[must_use]
    pub fn unwrapped(mut self) -> Self {
        self.is_angle = true;
        self
    }

    /// Value in a row.
    pub fn value(&self, row: &R) -> f64 {
        (self.value)(row)
    }
}

/// One panel of a figure: curves of one unit.
pub struct Chart<R: ?Sized> {
    /// Quantity of the vertical axis.
    pub quantity: &'static str,
    /// SI unit of the values; empty if they have none.
    pub unit: &'static str,
    /// The axis includes zero, because the distance from zero matters.
    pub from_zero: bool,
    /// The curves.
    pub series: Vec<Series<R>>,
    /// Limits of the curves.
    pub limits: Vec<LimitLine>,
}

impl<R: ?Sized> Chart<R> {
    /// Panel of `series`, whose axis fits the values.
    pub fn new(
        quantity: &'static str,
        unit: &'static str,
        series: impl IntoIterator<Item = Series<R>>,
    ) -> Self {
        Self {
            quantity,
            unit,
            from_zero: false,
            series: series.into_iter().collect(),
            limits: Vec::new(),
        }
    }

    /// Includes zero in the axis.
    #[must_use]
    pub fn with_zero(mut self) -> Self {
        self.from_zero = true;
        self
    }

    /// Draws `limits` of the curves.
    #[must_use]
    pub fn within(mut self, limits: Vec<LimitLine>) -> Self {
        self.limits = limits;
        self
    }
}

/// One figure: its file, the end of its title, its panels.
pub struct Figure<R: ?Sized> {
    /// Name of the file.
    pub file: &'static str,
    /// Words of the title behind the heading.
    pub title: &'static str,
    /// The panels, from top to bottom.
    pub charts: Vec<Chart<R>>,
}

impl<R: ?Sized> Figure<R> {
    /// Figure of `charts`.
    pub fn new(
        file: &'static str,
        title: &'static str,
        charts: impl IntoIterator<Item = Chart<R>>,
    ) -> Self {
        Self {
            file,
            title,
            charts: charts.into_iter().collect(),
        }
    }
}

/// Curve while it is gathered.
struct Trace {
    points: Decimator<1>,
    /// Last value and turns added, where the curve is an angle.
    last: Option<f64>,
    turns: f64,
}

impl Trace {
    fn new(rows: u64) -> Self {
        Self {
            points: Decimator::new(rows),
            last: None,
            turns: 0.0,
        }
    }

    fn push(&mut self, key: f64, value: f64, is_angle: bool) {
        if let Some(last) = self.last.filter(|_| is_angle) {
            if value - last > PI {
                self.turns -= TAU;
            } else if value - last < -PI {
                self.turns += TAU;
            }
        }
        self.last = Some(value);
        self.points.push(key, [value + self.turns]);
    }
}

/// Figures while their rows come.
pub struct Gathering<R: ?Sized> {
    /// The figures, whose series stand in the list of all.
    figures: Vec<Figure<R>>,
    /// Number of the series of each panel.
    counts: Vec<usize>,
    /// One list, which a tick passes in one loop.
    series: Vec<(Series<R>, Trace)>,
}

/// Figure that is ready to be drawn.
pub struct Gathered {
    /// Name of the file.
    pub file: &'static str,
    /// Words of the title behind the heading.
    pub title: &'static str,
    /// The panels, from top to bottom.
    pub panels: Vec<Panel>,
}

impl<R: ?Sized> Gathering<R> {
    /// Gathers `figures` from about `rows` rows.
    pub fn new(rows: u64, mut figures: Vec<Figure<R>>) -> Self {
        let (mut counts, mut series) = (Vec::new(), Vec::new());
        for chart in figures.iter_mut().flat_map(|figure| &mut figure.charts) {
            counts.push(chart.series.len());
            series.extend(chart.series.drain(..).map(|own| (own, Trace::new(rows))));
        }
        Self {
            figures,
            counts,
            series,
        }
    }

    /// Names of the files.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.figures.iter().map(|figure| figure.file)
    }

    /// Adds the next row, at `key` on the horizontal axis.
    pub fn push(&mut self, key: f64, row: &R) {
        for (series, trace) in &mut self.series {
            trace.push(key, (series.value)(row), series.is_angle);
        }
    }

    /// Ends the curves. `marks` are the ends of numbered stretches of the horizontal axis, such as moves.
    pub fn finish(self, marks: &[f64]) -> Vec<Gathered> {
        let (mut series, mut counts) = (self.series.into_iter(), self.counts.into_iter());
        let curve = |(series, trace): (Series<R>, Trace)| {
            let points = trace.points.finish().into_iter();
            Curve {
                label: series.label,
                points: points.map(|(key, [value])| (key, value)).collect(),
                colour: series.colour,
                dashed: series.is_dashed,
            }
        };
        let mut panel = |chart: Chart<R>| Panel {
            quantity: chart.quantity,
            unit: chart.unit,
            from_zero: chart.from_zero,
            curves: series
                .by_ref()
                .take(counts.next().unwrap_or_default())
                .map(curve)
                .collect(),
            limits: chart.limits,
            breaches: Vec::new(),
            marks: marks.to_vec(),
        };
        let figures = self.figures.into_iter();
        figures
            .map(|figure| Gathered {
                file: figure.file,
                title: figure.title,
                panels: figure.charts.into_iter().map(&mut panel).collect(),
            })
            .collect()
    }
}

impl Gathered {
    /// Draws the figure over time. `heading` begins the title.
    ///
    /// # Errors
    /// Failures of plotters.
    pub fn draw(&self, heading: &str) -> Drawn {
        draw(&format!("{heading}: {}", self.title), &self.panels)
    }
}

/// Gathers `figures` from rows that are there, each with its place on the horizontal axis.
pub fn gathered<'r, R: ?Sized + 'r>(
    figures: Vec<Figure<R>>,
    rows: impl ExactSizeIterator<Item = (f64, &'r R)>,
) -> Vec<Gathered> {
    let mut gathering = Gathering::new(rows.len() as u64, figures);
    rows.for_each(|(key, row)| gathering.push(key, row));
    gathering.finish(&[])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_drawn_without_jumps() {
        let angle = Series::new("angle", |turning: &f64| {
            f64::atan2(turning.sin(), turning.cos())
        });
        let chart = Chart::new("angle", "rad", [angle.unwrapped()]);
        let rows: Vec<f64> = (0..200).map(|tick| 0.1 * f64::from(tick)).collect();
        let figures = vec![Figure::new("angle.svg", "angle", [chart])];
        let figures = gathered(figures, rows.iter().map(|turning| (*turning, turning)));
        let drawn = &figures[0].panels[0].curves[0].points;
        assert_eq!(drawn.len(), 200);
        for (turning, value) in drawn {
            assert!((value - turning).abs() < 1e-9);
        }
    }

    #[test]
    fn curves_stand_in_the_panels_of_their_figures() {
        let chart = |factor: f64| {
            let series = Series::numbered("motor", 2, move |row: &f64, index| {
                factor * row + index as f64
            });
            Chart::new("value", "", series).with_zero()
        };
        let figures = vec![
            Figure::new("one.svg", "one", [chart(1.0)]),
            Figure::new("two.svg", "two", [chart(2.0), chart(3.0)]),
        ];
        let mut gathering = Gathering::new(2, figures);
        assert!(gathering.names().eq(["one.svg", "two.svg"]));
        gathering.push(0.0, &0.0);
        gathering.push(1.0, &10.0);
        let figures = gathering.finish(&[1.0]);
        let last = &figures[1].panels[1];
        assert_eq!(last.curves[1].points, [(0.0, 1.0), (1.0, 31.0)]);
        assert_eq!(
            (&*last.curves[1].label, &last.marks[..]),
            ("motor 2", &[1.0][..])
        );
        assert!(figures[0].draw("job").unwrap().contains("job: one"));
    }
}
