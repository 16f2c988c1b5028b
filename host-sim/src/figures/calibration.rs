//! Figures of a calibration: residuals of the rows before and after, over the rows and in the plane.

use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_calibration::{DeviceReading, JudgedRow};
use trirrr_figures::canvas::Drawn;
use trirrr_figures::panel::{Curve, Panel, draw_over};
use trirrr_figures::plane::View;
use trirrr_figures::scale::{Axis, Margin};
use trirrr_figures::sketch::{Sketch, SketchMark, Swatch};
use trirrr_figures::style::{BLUE, INK, VERMILLION};

const SIDE: f64 = 560.0;

/// Part of the width that the longest vector has.
const LONGEST: f64 = 0.12;

/// Residuals that are drawn.
pub struct CalibrationFigures<'a> {
    /// Name of the scene.
    pub name: &'a str,
    /// Rows, outliers too.
    pub rows: &'a [JudgedRow],
}

impl CalibrationFigures<'_> {
    /// Draws everything into the folder of `results`; the files written.
    ///
    /// # Errors
    /// Failed: a file that cannot be drawn or written.
    pub fn write_all(&self, results: &mut ResultFolder) -> Result<Vec<PathBuf>, CliError> {
        let mut files = vec![results.figure("residuals.svg", self.over_rows())?];
        let places = self.places();
        if !places.is_empty() {
            files.push(results.figure("vectors.svg", self.in_plane(&places))?);
        }
        Ok(files)
    }

    fn over_rows(&self) -> Drawn {
        let size = |[first, second, _]: [f64; 3], row: &JudgedRow| match row.row.reading {
            DeviceReading::Place { .. } => first.hypot(second),
            DeviceReading::Distance { .. } => first.abs(),
        };
        let curve = |label: &'static str, of: &dyn Fn(&JudgedRow) -> Option<[f64; 3]>| Curve {
            label: label.into(),
            points: (1..)
                .zip(self.rows)
                .filter_map(|(number, row)| Some((f64::from(number), size(of(row)?, row))))
                .collect(),
            ..Curve::default()
        };
        let panel = |quantity, curves| Panel {
            quantity,
            unit: "m",
            from_zero: true,
            curves,
            ..Panel::default()
        };
        let kept = |row: &JudgedRow| (!row.is_outlier).then_some(row.after);
        let panels = [
            panel("before", vec![curve("nominal", &|row| Some(row.before))]),
            panel(
                "after",
                vec![
                    curve("fitted", &kept),
                    curve("kept out", &|row| row.checked),
                ],
            ),
        ];
        let over = Axis::new(1.0, self.rows.len() as f64, "", Margin::Exact, 10.0);
        let title = format!("{}: measured less computed place", self.name);
        draw_over(&title, "row", &over, &panels)
    }

    /// Measured places with their differences before and after.
    fn places(&self) -> Vec<[[f64; 2]; 3]> {
        let rows = self.rows.iter().filter(|row| !row.is_outlier);
        let each = rows.filter_map(|row| match row.row.reading {
            DeviceReading::Place { place_m, .. } => Some([
                place_m,
                [row.before[0], row.before[1]],
                [row.after[0], row.after[1]],
            ]),
            DeviceReading::Distance { .. } => None,
        });
        each.collect()
    }

    fn in_plane(&self, places: &[[[f64; 2]; 3]]) -> Drawn {
        let shown: Vec<[f64; 2]> = places.iter().map(|place| place[0]).collect();
        let view = View::around(&shown, "m", (0.0, 0.0), SIDE);
        let longest = [1, 2].map(|which: usize| {
            let sizes = places
                .iter()
                .map(|place| place[which][0].hypot(place[which][1]));
            sizes.fold(1e-12, f64::max)
        });
        // Both sets of vectors are as long as a part of the window.
        let pixels = LONGEST * view.width;
        let scales = longest.map(|longest| pixels * view.pixel() / longest);
        let colours = [VERMILLION, BLUE];
        let vectors = |[[x, y], vectors @ ..]: &[[f64; 2]; 3]| {
            let ends = [0, 1].map(|set| vectors[set].map(|part| scales[set] * part));
            let lines = [0, 1].map(|set| {
                let [dx, dy] = ends[set];
                SketchMark::Line(vec![[*x, *y], [x + dx, y + dy]], colours[set], 1.8)
            });
            lines
                .into_iter()
                .chain([SketchMark::Dot([*x, *y], 2.2, INK)])
        };
        let entry = |set: usize, word: &str| {
            let text = format!("{word}, longest {:.1} um", 1e6 * longest[set]);
            vec![(Swatch::Line(colours[set], 2.5, pixels), text)]
        };
        let sketch = Sketch {
            title: format!("{}: measured less computed places", self.name),
            axes: ["x", "y"],
            side: SIDE,
            under: Vec::new(),
            over: places.iter().flat_map(vectors).collect(),
            legend: vec![entry(0, "before"), entry(1, "after")],
            shown,
        };
        sketch.draw()
    }
}
