//! Figure of the drives: how far the platform is off by what they measure, and what pushes it.

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_client::drive_records::DriveRecord;
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel, draw};
use trirrr_figures::style::{ANGLE, PATH, RGBColor, X, Y};

/// Samples of the drives, thinned out for the figure in bounded memory.
pub struct DriveTraces {
    torque: bool,
    points: Decimator<4>,
}

impl DriveTraces {
    /// Name of the figure.
    pub const FILE: &str = "drives.svg";

    /// For about `rows` samples, of a scene with or without `torque`.
    pub fn new(rows: u64, torque: bool) -> Self {
        Self {
            torque,
            points: Decimator::new(rows),
        }
    }

    /// Adds the next sample. The platform of one without a pose is not drawn off its path.
    pub fn push(&mut self, record: &DriveRecord) {
        let [off, _] = record.off.unwrap_or_default();
        let [x, y, moment] = record.wrench;
        self.points.push(record.t, [off, x, y, moment]);
    }

    /// Draws `drives.svg` into the folder of `results`; the file written.
    ///
    /// # Errors
    /// Failed: the file cannot be drawn or written.
    pub fn write(self, results: &mut ResultFolder, heading: &str) -> Result<PathBuf, CliError> {
        let points = self.points.finish();
        let panel = |quantity, unit, labels: &[(&'static str, RGBColor, usize)]| Panel {
            quantity,
            unit,
            from_zero: true,
            curves: labels
                .iter()
                .map(|(label, colour, index)| Curve {
                    label: (*label).into(),
                    points: points.iter().map(|(t, all)| (*t, all[*index])).collect(),
                    colour: Some(*colour),
                    dashed: false,
                })
                .collect(),
            ..Panel::default()
        };
        let mut panels = vec![panel("D off its path", "m", &[("measured", PATH, 0)])];
        if self.torque {
            let force = [("x", X, 1), ("y", Y, 2)];
            panels.push(panel("estimated force", "N", &force));
            let moment = [("about D", ANGLE, 3)];
            panels.push(panel("estimated moment", "N m", &moment));
        }
        let drawn = draw(&format!("{heading}: what the drives measure"), &panels);
        results.figure(Self::FILE, drawn)
    }
}
