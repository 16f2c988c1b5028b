//! Figures of the simulated machine.

use super::charts::{Charts, Figure, Labelled, named};
use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_plant::redundant::RedundantRow;

/// Gathers the figure of a simulated machine.
pub struct RedundantPlantTraces {
    figures: [Figure<RedundantRow>; 2],
}

impl RedundantPlantTraces {
    /// Gathers the job of `scene`.
    pub fn new(scene: &RedundantScene) -> Self {
        let charts = Charts {
            ticks: u64::from(scene.ticks()) + 1,
        };
        let legs = 0..scene.legs.len();
        let joint = |leg: usize| -> Labelled<RedundantRow> {
            let value = move |row: &RedundantRow| row.joint_errors[leg];
            (format!("joint {}", leg + 1), Box::new(value))
        };
        let motor = |leg: usize| -> Labelled<RedundantRow> {
            let value = move |row: &RedundantRow| row.torques[leg];
            (format!("motor {}", leg + 1), Box::new(value))
        };
        let with_slider = legs.clone().filter(|&leg| scene.sliders[leg].is_some());
        let sliders: Vec<usize> = with_slider.collect();
        let mut errors = vec![
            charts.of(
                "tool",
                "m",
                named::<RedundantRow, 2>([("x", |row| row.error[0]), ("y", |row| row.error[1])]),
            ),
            charts.of(
                "platform angle",
                "rad",
                named::<RedundantRow, 1>([("\u{3b1}", |row| row.error[2])]),
            ),
            charts.of("joints", "rad", legs.clone().map(joint)),
        ];
        let mut loads = vec![charts.of("torque", "N m", legs.map(motor))];
        if !sliders.is_empty() {
            let of_row = |pick: fn(&RedundantRow) -> &Vec<Option<f64>>| {
                let curve = move |&leg: &usize| -> Labelled<RedundantRow> {
                    let value = move |row: &RedundantRow| pick(row)[leg].unwrap_or(0.0);
                    (format!("slider {}", leg + 1), Box::new(value))
                };
                sliders.iter().map(curve).collect::<Vec<_>>()
            };
            errors.push(charts.of("sliders", "m", of_row(|row| &row.slider_errors)));
            loads.push(charts.of("force", "N", of_row(|row| &row.forces)));
        }
        Self {
            figures: [
                Figure {
                    file: "tracking.svg",
                    title: "tracking error of the plant",
                    charts: errors,
                },
                Figure {
                    file: "plant_torque.svg",
                    title: "torques and forces of the plant's loops",
                    charts: loads,
                },
            ],
        }
    }

    /// Adds the next row.
    pub fn push(&mut self, row: &RedundantRow) {
        for figure in &mut self.figures {
            figure.push(row.t, row);
        }
    }

    /// Names of the files that [`write`](Self::write) writes.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.figures.iter().map(|figure| figure.file)
    }

    /// Draws the figures into the folder of `results`. `heading` begins every title.
    ///
    /// # Errors
    /// Failed: a file that cannot be drawn or written.
    pub fn write(
        self,
        results: &mut ResultFolder,
        heading: &str,
    ) -> Result<Vec<PathBuf>, CliError> {
        let files = self.figures.into_iter();
        files.map(|figure| figure.write(results, heading)).collect()
    }
}
