//! Figures of a job, gathered tick by tick in bounded memory.

use super::animation::Animation;
use super::coloured_path;
use super::job::DrawnJob;
use super::machine::{self, DrawnInstant, Scenery};
use crate::failure::CliError;
use crate::results::ResultFolder;
use crate::tick_record::AnyTick;
use std::path::PathBuf;
use trirrr_figures::chart::Gathering;
use trirrr_figures::decimate::Decimator;

/// The machine is drawn at its start, its end and each of these fractions of the job.
const INSTANTS: [(u64, u64); 3] = [(1, 4), (1, 2), (3, 4)];

/// Gathers the curves of all figures from the records of a run.
pub struct Traces {
    job: DrawnJob,
    over_time: Gathering<AnyTick>,
    /// x, y, speed of D, and the largest torque.
    path: Decimator<4>,
    animation: Animation,
    ticks: u64,
    seen: u64,
    instants: Vec<DrawnInstant>,
    last: Option<DrawnInstant>,
}

/// Name of the figure of the torques, and of that of the powers.
const OF_MOTORS: [&str; 2] = ["torque.svg", "power.svg"];

/// Name of the animation's page.
const ANIMATION: &str = "animation.html";

impl Traces {
    /// Gathers a `job` of `ticks` records.
    pub fn new(ticks: u64, job: DrawnJob) -> Self {
        Self {
            over_time: Gathering::new(ticks, job.figures()),
            path: Decimator::new(ticks),
            animation: Animation::new(ticks, job.torque),
            job,
            ticks,
            seen: 0,
            instants: Vec::new(),
            last: None,
        }
    }

    /// Names of the files that [`write`](Self::write) writes.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        let others = ["machine.svg", "path.svg", ANIMATION];
        self.over_time.names().chain(others)
    }

    /// Adds the record of the next tick.
    pub fn push(&mut self, record: &AnyTick) {
        let t = record.t();
        self.over_time.push(t, record);
        let [[x, y, _], [vx, vy, _], _] = record.platform();
        let torques = record.each_leg().map(|leg| leg.torque.abs());
        let values = [x, y, vx.hypot(vy), torques.fold(0.0, f64::max)];
        self.path.push(t, values);
        self.animation.push(record);
        match &mut self.last {
            // In the memory of the one before.
            Some(last) => last.set(record),
            none => *none = Some(record.into()),
        }
        if is_drawn(self.seen, self.ticks.saturating_sub(1)) {
            self.instants.push(record.into());
        }
        self.seen += 1;
    }

    /// Returns the time of the last record, s.
    pub fn last_s(&self) -> Option<f64> {
        self.last.as_ref().map(|last| last.t)
    }

    /// Draws everything into the folder of `results`, and returns the files written, in order, and the curves of the motors.
    ///
    /// `heading` begins every title: the scene's name, and where the run ended early, when.
    ///
    /// # Errors
    /// Failed: a file that cannot be drawn or written.
    pub fn write(
        self,
        results: &mut ResultFolder,
        heading: &str,
    ) -> Result<(Vec<PathBuf>, MotorCurves), CliError> {
        let figures = self.over_time.finish(&self.job.ends_s);
        let mut written = super::write(results, heading, &figures)?;
        let motors = OF_MOTORS.map(|file| {
            let figure = figures.iter().find(|figure| figure.file == file)?;
            let curves = figure.panels[0].curves.iter();
            Some(curves.map(|curve| curve.points.clone()).collect())
        });
        let path = self.path.finish();
        let scenery = Scenery {
            instants: with_end(self.instants, self.last),
            guides: self.job.guides,
            path: path.iter().map(|(_, [x, y, ..])| [*x, *y]).collect(),
            broken: Vec::new(),
        };
        let title = format!("{heading}: the machine and its path");
        let page = Ok(self.animation.page(heading));
        for (file, drawn) in [
            ("machine.svg", machine::draw(&title, &scenery)),
            ("path.svg", coloured_path::draw(heading, &path)),
            (ANIMATION, page),
        ] {
            written.push(results.figure(file, drawn)?);
        }
        let [torques, powers] = motors;
        Ok((written, MotorCurves { torques, powers }))
    }
}

/// Instants, and the end, once, whether the job came to its end or was stopped.
fn with_end(mut instants: Vec<DrawnInstant>, end: Option<DrawnInstant>) -> Vec<DrawnInstant> {
    instants.extend(end);
    instants.dedup();
    instants
}

/// Returns true if the machine is drawn at `tick` of a job that ends with `last_tick`.
fn is_drawn(tick: u64, last_tick: u64) -> bool {
    let at = |(part, whole): &(u64, u64)| {
        tick == (u128::from(last_tick) * u128::from(*part) / u128::from(*whole)) as u64
    };
    tick == 0 || INSTANTS.iter().any(at)
}

/// Points of a curve of each motor over time.
pub(super) type MotorPoints = Vec<Vec<(f64, f64)>>;

/// Curves of the motors as the job asks for them, beside those of a plant.
#[derive(Clone, Debug, Default)]
pub struct MotorCurves {
    /// Torques, N m.
    pub(super) torques: Option<MotorPoints>,
    /// Powers, W.
    pub(super) powers: Option<MotorPoints>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_scene::record::Record;

    #[test]
    fn the_machine_is_drawn_at_start_quarters_and_end() {
        let times = |ticks: u64, pushed: u64| {
            let mut traces = Traces::new(ticks, DrawnJob::default());
            for tick in 0..pushed {
                traces.push(&Record {
                    t: tick as f64,
                    ..Record::default()
                });
            }
            let instants = with_end(traces.instants, traces.last).into_iter();
            instants.map(|instant| instant.t).collect::<Vec<_>>()
        };
        assert_eq!(times(101, 101), [0.0, 25.0, 50.0, 75.0, 100.0]);
        assert_eq!(times(101, 41), [0.0, 25.0, 40.0]);
        assert_eq!(times(1, 1), [0.0]);
        assert_eq!(times(2, 2), [0.0, 1.0]);
        assert!(times(2, 0).is_empty());
    }
}
