//! Figures of tolerances: the bound of the error at the tool, and the band of each torque.

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel, draw};
use trirrr_figures::style::{ANGLE, MOTORS, PATH, RGBColor, X, Y};
use trirrr_tolerances::TimeSpan;

/// Intervals of a move that are likely.
const USUAL_INTERVALS: u64 = 32;
const TORQUES: [&str; 3] = ["torque 1", "torque 2", "torque 3"];

/// Bounds of a job, thinned out in bounded memory, as far as they are proven without a gap.
pub struct ToleranceTraces {
    /// Distance, dx, dy, dalpha.
    errors: Decimator<4>,
    /// Least and greatest torque of each motor, in a scene that computes torques.
    torques: Option<Decimator<6>>,
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
        let points = 2 * USUAL_INTERVALS * moves as u64;
        Self {
            errors: Decimator::new(points),
            torques: torque.then(|| Decimator::new(points)),
            gap: None,
        }
    }

    /// Adds the next interval. A curve across a gap would be a guess, so that nothing is added after one.
    pub fn push(&mut self, span: &TimeSpan) {
        let is_whole = span.tool.is_some() && (self.torques.is_none() || span.torques.is_some());
        if !is_whole {
            self.gap.get_or_insert(span.start_s);
        }
        let (Some(tool), None) = (&span.tool, self.gap) else {
            return;
        };
        let [dx, dy, dalpha] = tool.sizes();
        for t in [span.start_s, span.end_s] {
            self.errors.push(t, [tool.distance_m(), dx, dy, dalpha]);
            if let (Some(torques), Some([[a, b], [c, d], [e, f]])) =
                (&mut self.torques, span.torques)
            {
                torques.push(t, [a, b, c, d, e, f]);
            }
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
        let errors = self.errors.finish();
        let curve =
            |index: usize, label: &'static str, colour| curve(&errors, index, label, colour);
        let panel = |quantity, unit, from_zero, curves| Panel {
            quantity,
            unit,
            from_zero,
            curves,
            ..Panel::default()
        };
        let position = vec![
            curve(0, "distance", PATH),
            curve(1, "x", X),
            curve(2, "y", Y),
        ];
        let mut figures = vec![(
            FILES[0],
            "bound of the error at the tool",
            vec![
                panel("position", "m", true, position),
                panel("orientation", "rad", true, vec![curve(3, "\u{3b1}", ANGLE)]),
            ],
        )];
        if let Some(torques) = self.torques {
            let points = torques.finish();
            let band = |(motor, quantity): (usize, &&'static str)| {
                let (least, greatest) = (2 * motor, 2 * motor + 1);
                let curves = [(least, "least"), (greatest, "greatest")];
                let colour = MOTORS[motor];
                let curves =
                    curves.map(|(index, label)| self::curve(&points, index, label, colour));
                panel(quantity, "N m", false, curves.into())
            };
            let panels = TORQUES.iter().enumerate().map(band).collect();
            figures.push((FILES[1], "bounds of the motors' torques", panels));
        }
        let write = |(file, title, panels): (&str, &str, Vec<Panel>)| {
            let drawn = draw(&format!("{heading}: {title}"), &panels);
            results.figure(file, drawn)
        };
        figures.into_iter().map(write).collect()
    }
}

fn curve<const K: usize>(
    points: &[(f64, [f64; K])],
    index: usize,
    label: &'static str,
    colour: RGBColor,
) -> Curve {
    Curve {
        label: label.into(),
        points: points
            .iter()
            .map(|(t, values)| (*t, values[index]))
            .collect(),
        colour: Some(colour),
        dashed: false,
    }
}
