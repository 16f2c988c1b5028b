//! Figures of the job of a redundant machine.

use super::charts::{Charts, Figure, named};
use crate::failure::CliError;
use crate::figures::machine::{self, DrawnInstant, Scenery};
use crate::figures::traces::is_drawn;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::decimate::Decimator;
use trirrr_linkage::redundant::scene::{RedundantRecord, RedundantScene};

/// Gathers the figures of a job.
pub struct RedundantTraces {
    figures: Vec<Figure<RedundantRecord>>,
    guides: Vec<[[f64; 2]; 2]>,
    path: Decimator<2>,
    last_tick: u64,
    seen: u64,
    instants: Vec<DrawnInstant>,
}

impl RedundantTraces {
    /// Gathers the job of `scene`.
    pub fn new(scene: &RedundantScene) -> Self {
        let ticks = u64::from(scene.ticks()) + 1;
        Self {
            figures: figures(scene, &Charts { ticks }),
            guides: guides(scene),
            path: Decimator::new(ticks),
            last_tick: ticks - 1,
            seen: 0,
            instants: Vec::new(),
        }
    }

    /// Adds the record of the next tick.
    pub fn push(&mut self, record: &RedundantRecord) {
        for figure in &mut self.figures {
            figure.push(record.t, record);
        }
        self.path.push(record.t, [record.pose[0], record.pose[1]]);
        if is_drawn(self.seen, self.last_tick) || self.seen == self.last_tick {
            self.instants.push(DrawnInstant {
                t: record.t,
                legs: record.legs.iter().map(|leg| leg.leg).collect(),
            });
        }
        self.seen += 1;
    }

    /// Names of the files that [`write`](Self::write) writes.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        let figures = self.figures.iter().map(|figure| figure.file);
        figures.chain([MACHINE])
    }

    /// Draws everything into the folder of `results`, and returns the files in order. `heading` begins every title.
    ///
    /// # Errors
    /// Failed: a file that cannot be drawn or written.
    pub fn write(
        self,
        results: &mut ResultFolder,
        heading: &str,
    ) -> Result<Vec<PathBuf>, CliError> {
        let mut files = Vec::new();
        for figure in self.figures {
            files.push(figure.write(results, heading)?);
        }
        let points = self.path.finish().into_iter();
        let scenery = Scenery {
            instants: self.instants,
            guides: self.guides,
            path: points.map(|(_, [x, y])| (x, y)).collect(),
            broken: Vec::new(),
        };
        let title = format!("{heading}: the machine and its path");
        files.push(results.figure(MACHINE, machine::draw(&title, &scenery))?);
        Ok(files)
    }
}

/// Figure of the machine along its path.
const MACHINE: &str = "machine.svg";

/// Both ends of each guide, m.
fn guides(scene: &RedundantScene) -> Vec<[[f64; 2]; 2]> {
    let legs = scene.legs.iter().zip(&scene.sliders);
    legs.filter_map(|(leg, slider)| {
        let slider = (*slider)?;
        let (sin, cos) = slider.direction_rad.sin_cos();
        let at = |position: f64| [leg.base_m.x + cos * position, leg.base_m.y + sin * position];
        Some([at(slider.travel.low_m), at(slider.travel.high_m)])
    })
    .collect()
}

fn figures(scene: &RedundantScene, charts: &Charts) -> Vec<Figure<RedundantRecord>> {
    let legs = scene.legs.len();
    let with_slider = (0..legs).filter(|&leg| scene.sliders[leg].is_some());
    let sliders: Vec<usize> = with_slider.collect();
    let mut angles = charts.of_legs("motor angle", "rad", legs, |leg| leg.leg.th1);
    angles
        .curves
        .iter_mut()
        .for_each(|curve| curve.unwrap = true);
    let mut torque = vec![charts.of_legs("torque", "N m", legs, |leg| leg.leg.torque)];
    if legs > 3 {
        let least = charts.of_legs("least norm", "N m", legs, |leg| leg.least_torque);
        torque.push(least);
        let norms = named::<RedundantRecord, 2>([
            ("with preload", |it| it.torque_norm()),
            ("without", |it| it.least_norm()),
        ]);
        torque.push(charts.of("norm", "N m", norms));
    }
    let mut all = vec![
        Figure {
            file: "pose.svg",
            title: "pose of the platform",
            charts: vec![
                charts.of(
                    "position",
                    "m",
                    named::<RedundantRecord, 2>([("x", |it| it.pose[0]), ("y", |it| it.pose[1])]),
                ),
                charts.of(
                    "angle",
                    "rad",
                    named::<RedundantRecord, 1>([("\u{3b1}", |it| it.pose[2])]),
                ),
            ],
        },
        Figure {
            file: "joint_rate.svg",
            title: "angles and rates of the motors",
            charts: vec![
                angles,
                charts.of_legs("motor rate", "rad/s", legs, |leg| leg.leg.dth1),
            ],
        },
        Figure {
            file: "torque.svg",
            title: "torques of the motors",
            charts: torque,
        },
        Figure {
            file: "power.svg",
            title: "powers of the motors",
            charts: vec![charts.of_legs("power", "W", legs, |leg| leg.leg.power)],
        },
        Figure {
            file: "joint_force.svg",
            title: "forces in the joints",
            charts: vec![
                charts.of_legs("force in A", "N", legs, |leg| size(leg.joints[0])),
                charts.of_legs("force in B", "N", legs, |leg| size(leg.joints[1])),
                charts.of_legs("force in C", "N", legs, |leg| size(leg.joints[2])),
            ],
        },
        Figure {
            file: "singularity.svg",
            title: "scale-free distances to singularity",
            charts: vec![
                charts.of_legs("serial", "", legs, |leg| leg.leg.serial),
                charts.of(
                    "parallel",
                    "",
                    named::<RedundantRecord, 1>([("machine", |it| it.parallel)]),
                ),
            ],
        },
    ];
    if !sliders.is_empty() {
        all.push(Figure {
            file: "slider.svg",
            title: "sliders",
            charts: vec![
                charts.of_sliders("position", "m", &sliders, |slider| slider.position),
                charts.of_sliders("velocity", "m/s", &sliders, |slider| slider.velocity),
                charts.of_sliders("force", "N", &sliders, |slider| slider.force),
                charts.of_sliders("power", "W", &sliders, |slider| slider.power),
            ],
        });
    }
    all
}

fn size([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
