//! Figure of the drives: how far the platform is off by what they measure, and what pushes it.

use super::FigureError;
use std::io;
use std::path::{Path, PathBuf};
use trirrr_client::drive_records::DriveRecord;
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel, draw};

/// Samples of the drives, thinned out for the figure in bounded memory.
pub struct DriveTraces {
    torque: bool,
    points: Decimator<4>,
}

impl DriveTraces {
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

    /// Draws `drives.svg` into `folder`, which must exist; the file written.
    ///
    /// # Errors
    /// The file could not be written, and why.
    pub fn write(self, folder: &Path, heading: &str) -> Result<PathBuf, FigureError> {
        let path = folder.join("drives.svg");
        let points = self.points.finish();
        let panel = |quantity, unit, labels: &[(&'static str, usize)]| Panel {
            quantity,
            unit,
            from_zero: true,
            curves: labels
                .iter()
                .map(|(label, index)| Curve {
                    label: (*label).into(),
                    points: points.iter().map(|(t, all)| (*t, all[*index])).collect(),
                })
                .collect(),
        };
        let mut panels = vec![panel("tool off its path", "m", &[("measured", 0)])];
        if self.torque {
            panels.push(panel("estimated force", "N", &[("x", 1), ("y", 2)]));
            panels.push(panel("estimated moment", "N m", &[("alpha", 3)]));
        }
        draw(&format!("{heading}: what the drives measure"), &panels)
            .map_err(|error| io::Error::other(error.to_string()))
            .and_then(|svg| std::fs::write(&path, svg))
            .map_err(|source| FigureError {
                path: path.clone(),
                source,
            })?;
        Ok(path)
    }
}
