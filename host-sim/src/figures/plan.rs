//! Figure of a plan: speed along the path beside the bound of any motion's speed.

use super::FigureError;
use std::io;
use std::path::{Path, PathBuf};
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel, draw};

/// Speeds of a plan, thinned out in bounded memory.
pub struct PlanTraces {
    /// Speed, and the bound of any motion's speed there.
    speeds: Decimator<2>,
}

impl PlanTraces {
    /// For a plan of `points` points.
    pub fn new(points: u64) -> Self {
        Self {
            speeds: Decimator::new(points),
        }
    }

    /// Adds the speed at time `t`, and its bound at that place of the path.
    pub fn push(&mut self, t: f64, speeds: [f64; 2]) {
        self.speeds.push(t, speeds);
    }

    /// Draws the figure into `folder`, which must exist; the file written.
    ///
    /// # Errors
    /// The file that could not be written, and why.
    pub fn write(self, folder: &Path, name: &str) -> Result<PathBuf, FigureError> {
        let points = self.speeds.finish();
        let curve = |index: usize, label: &'static str| Curve {
            label: label.into(),
            points: points
                .iter()
                .map(|(t, speeds)| (*t, speeds[index]))
                .collect(),
        };
        let panel = Panel {
            quantity: "speed of D",
            unit: "m/s",
            from_zero: true,
            curves: vec![curve(0, "plan"), curve(1, "bound of any motion")],
        };
        let path = folder.join("plan.svg");
        draw(&format!("{name}: the plan and its bound"), &[panel])
            .map_err(|error| io::Error::other(error.to_string()))
            .and_then(|svg| std::fs::write(&path, svg))
            .map(|()| path.clone())
            .map_err(|source| FigureError { path, source })
    }
}
