//! Figures of tolerances: the bound of the error at the tool, and the band of each torque.

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::chart::{Chart, Figure, Gathering, Series};
use trirrr_figures::style::{ANGLE, MOTORS, PATH, X, Y};
use trirrr_tolerances::TimeSpan;

/// Intervals of a move that are likely.
const USUAL_INTERVALS: u64 = 32;
const TORQUES: [&str; 3] = ["torque 1", "torque 2", "torque 3"];

/// Bounds of a job, thinned out in bounded memory, as far as they are proven without a gap.
pub struct ToleranceTraces {
    torque: bool,
    over_time: Gathering<TimeSpan>,
    /// Start of the first interval without a bound, s.
    gap: Option<f64>,
}

/// Names of the figures; the second is of torques.
const FILES: [&str; 2] = ["tolerances.svg", "torque_band.svg"];

impl ToleranceTraces {
    /// Names of the figures of a scene with or without `torque`.
    pub fn names(torque: bool) -> &'static [&'static str] {
        &FILES[..1 + usize::from(torque)]
    }

    /// For a job of `moves` moves of a scene with or without `torque`.
    pub fn new(moves: usize, torque: bool) -> Self {
        let axis = |label, axis: usize, colour| {
            let size = move |span: &TimeSpan| span.tool.map_or(f64::NAN, |tool| tool.sizes()[axis]);
            Series::new(label, size).coloured(colour)
        };
        let distance = Series::new("distance", |span: &TimeSpan| {
            span.tool.map_or(f64::NAN, |tool| tool.distance_m())
        });
        let position = [distance.coloured(PATH), axis("x", 0, X), axis("y", 1, Y)];
        let errors = [
            Chart::new("position", "m", position).with_zero(),
            Chart::new("orientation", "rad", [axis("\u{3b1}", 2, ANGLE)]).with_zero(),
        ];
        let mut figures = vec![Figure::new(
            FILES[0],
            "bound of the error at the tool",
            errors,
        )];
        if torque {
            let bound = |label, motor: usize, bound: usize| {
                let value = move |span: &TimeSpan| {
                    span.torques
                        .map_or(f64::NAN, |torques| torques[motor][bound])
                };
                Series::new(label, value).coloured(MOTORS[motor])
            };
            let band = |(motor, quantity): (usize, &&'static str)| {
                let bounds = [bound("least", motor, 0), bound("greatest", motor, 1)];
                Chart::new(quantity, "N m", bounds)
            };
            let bands = TORQUES.iter().enumerate().map(band);
            figures.push(Figure::new(
                FILES[1],
                "bounds of the motors' torques",
                bands,
            ));
        }
        Self {
            torque,
            over_time: Gathering::new(2 * USUAL_INTERVALS * moves as u64, figures),
            gap: None,
        }
    }

    /// Adds the next interval. A curve across a gap would be a guess, so that nothing is added after one.
    pub fn push(&mut self, span: &TimeSpan) {
        if span.tool.is_none() || (self.torque && span.torques.is_none()) {
            self.gap.get_or_insert(span.start_s);
        }
        if self.gap.is_none() {
            self.over_time.push(span.start_s, span);
            self.over_time.push(span.end_s, span);
        }
    }

    /// Draws everything into the folder of `results`; the files written.
    ///
    /// # Errors
    /// Failed: a file that cannot be drawn or written.
    pub fn write_all(
        self,
        results: &mut ResultFolder,
        name: &str,
    ) -> Result<Vec<PathBuf>, CliError> {
        let heading = match self.gap {
            Some(t) => format!("{name} until t = {t} s, where no bound is proven"),
            None => name.into(),
        };
        super::write(results, &heading, &self.over_time.finish(&[]))
    }
}
