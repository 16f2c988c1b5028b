//! Figure of a plan: speed along the path beside the bound of any motion's speed; alpha where it was chosen.

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel, draw};
use trirrr_figures::style::{ANGLE, LIMIT, PATH};

/// Speeds of a plan, thinned out in bounded memory.
pub struct PlanTraces {
    /// Speed, the bound of any motion's speed there, and alpha.
    values: Decimator<3>,
    with_alpha: bool,
}

impl PlanTraces {
    /// For a plan of `points` points; `with_alpha` draws alpha, too.
    pub fn new(points: u64, with_alpha: bool) -> Self {
        Self {
            values: Decimator::new(points),
            with_alpha,
        }
    }

    /// Adds the speed at time `t`, its bound at that place of the path, and alpha.
    pub fn push(&mut self, t: f64, values: [f64; 3]) {
        self.values.push(t, values);
    }

    /// Draws the figure into the folder of `results`; the file written.
    ///
    /// # Errors
    /// Failed: a file that cannot be drawn or written.
    pub fn write(self, results: &mut ResultFolder, name: &str) -> Result<PathBuf, CliError> {
        let points = self.values.finish();
        let curve = |index: usize, label: &'static str| Curve {
            label: label.into(),
            points: points
                .iter()
                .map(|(t, values)| (*t, values[index]))
                .collect(),
            colour: Some([PATH, LIMIT, ANGLE][index]),
            dashed: index == 1,
        };
        let mut panels = vec![Panel {
            quantity: "speed of D",
            unit: "m/s",
            from_zero: true,
            curves: vec![curve(1, "bound of any motion"), curve(0, "plan")],
            ..Panel::default()
        }];
        if self.with_alpha {
            panels.push(Panel {
                quantity: "orientation",
                unit: "rad",
                from_zero: false,
                curves: vec![curve(2, "\u{3b1}, chosen")],
                ..Panel::default()
            });
        }
        let drawn = draw(&format!("{name}: the plan and its bound"), &panels);
        results.figure("plan.svg", drawn)
    }
}
