//! A job on the machine's service in this process, and the plant that follows.

use crate::arrays::{array, table};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicBool, Ordering};
use trirrr_client::describe::Units;
use trirrr_client::local::{self, HostNumber, LocalService, Sensed};
use trirrr_client::records::{Samples, is_of_a_job};
use trirrr_client::runner::{JobPart, JobRunner};
use trirrr_core::status::Status;
use trirrr_drives::ObeyingDrives;
use trirrr_drives::count::Countable;
use trirrr_drives::stepper::Line;
use trirrr_plant::table::COLUMNS as PLANT_COLUMNS;
use trirrr_plant::{Outcome, PlantEnd, PlantRun};
use trirrr_scene::record::{Record, tick_columns};
use trirrr_scene::{Scene, in_number_type, offer, pipeline};
use trirrr_service::ServiceNumber;

/// Ticks from one question for Ctrl-C to the next.
const ASKED_EVERY: u64 = 1 << 10;

/// A job that was played.
#[derive(Default)]
struct PlayedJob {
    /// Reason why the job is not complete.
    reason: Option<String>,
    ticks: Vec<f64>,
    rows: usize,
    plant_rows: Vec<[f64; PLANT_COLUMNS.len()]>,
    plant: Option<Outcome>,
    /// The exception of Ctrl-C.
    interrupt: Option<PyErr>,
}

/// Plays the job of `scene`, with its plant if `plant`; tables and reasons by name.
pub(crate) fn run<'py>(
    py: Python<'py>,
    scene: &Scene,
    plant: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let played = py.detach(|| in_number_type!(scene.number, N => play::<N>(scene, plant)));
    let played = played
        .map_err(|reason| PyValueError::new_err(format!("scene {}: {reason}", scene.name)))?;
    if let Some(interrupt) = played.interrupt {
        return Err(interrupt);
    }
    let columns: Vec<&str> = tick_columns(scene.torque).collect();
    let shape = [played.rows, columns.len()];
    let found = PyDict::new(py);
    found.set_item("reason", played.reason)?;
    found.set_item("columns", columns)?;
    found.set_item("ticks", array(py, played.ticks, &shape)?)?;
    found.set_item("plant_columns", PLANT_COLUMNS)?;
    if let Some(outcome) = played.plant {
        found.set_item("plant", table(py, played.plant_rows)?)?;
        found.set_item("plant_reason", plant_reason(&outcome.end))?;
        found.set_item("plant_warnings", outcome.warnings)?;
    }
    Ok(found)
}

/// Reason why the plant did not come to the end of the job.
fn plant_reason(end: &PlantEnd) -> Option<String> {
    match end {
        PlantEnd::Interrupted { t } => Some(format!("the plant was stopped at t = {t} s")),
        end => end.reason(),
    }
}

fn play<N: HostNumber + Countable>(scene: &Scene, plant: bool) -> Result<PlayedJob, String> {
    let units = trirrr_scene::units::<N>(scene).map_err(|error| error.to_string())?;
    let pipeline = pipeline::of_scene::<N>(scene, units).map_err(|error| error.to_string())?;
    let line = Line::new();
    let plant = match plant {
        true => Some(PlantRun::<N>::build(scene, &line).map_err(|refusal| refusal.to_string())?),
        false => None,
    };
    // The service hears the drives of the plant.
    let is_closed = plant.is_some() && scene.feedback.is_some();
    let run = |machine: &mut dyn LocalService<N>| {
        let angles = machine.motors().each_ref().map(|motor| motor.angle);
        let moves = offer::moves::<N>(scene, &units);
        let hello = local::hello::<N>(scene);
        let mut playing = Playing {
            runner: JobRunner::new(machine, moves, hello, scene.tick_rate_hz),
            drives: is_closed.then(|| ObeyingDrives::new(angles)),
            plant,
            job: PlayedJob::default(),
            torque: scene.torque,
        };
        let mut samples = Samples::new(&*pipeline, Units::of_scene(scene, &units));
        playing
            .play(&mut samples)
            .map_err(|status| status.to_string())?;
        Ok(playing.finished())
    };
    let sensed = match is_closed {
        true => Sensed::drives(scene),
        false => Sensed::default(),
    };
    local::with_machine_in(scene, units, sensed, run).map_err(|error| error.reason)?
}

/// A job under way.
struct Playing<'a, 'l, N: ServiceNumber> {
    runner: JobRunner<'a, N>,
    /// Drives until the job begins, of a machine that hears them: the plant stands in its brakes.
    drives: Option<ObeyingDrives<N>>,
    plant: Option<PlantRun<'l, N>>,
    job: PlayedJob,
    torque: bool,
}

impl<N: ServiceNumber + Countable> Playing<'_, '_, N> {
    /// Plays every tick.
    fn play(&mut self, samples: &mut Samples<'_, N>) -> Result<(), Status> {
        for tick in 0_u64.. {
            if let Some(result) = self.runner.talk() {
                self.job.reason = result.err().map(|why| self.runner.describe(&why));
                break;
            }
            if tick.is_multiple_of(ASKED_EVERY)
                && let Err(interrupt) = Python::attach(|py| py.check_signals())
            {
                self.job.interrupt = Some(interrupt);
                break;
            }
            let part = self.runner.part();
            self.hear(part);
            self.runner.tick();
            self.follow(part);
            if let Some(played) = self.runner.collect()
                && is_of_a_job(played.sample.state)
            {
                self.keep(&samples.played(&played)?);
            }
        }
        Ok(())
    }

    /// Tells the service what its drives measure.
    fn hear(&mut self, part: JobPart) {
        let Some(drives) = &self.drives else {
            return;
        };
        let of_plant = match part {
            JobPart::Before => None,
            JobPart::Path | JobPart::After => self.plant.as_mut().and_then(PlantRun::measure),
        };
        self.runner
            .hear(of_plant.unwrap_or_else(|| drives.measure()));
    }

    /// Gives the output of the tick to the drives.
    fn follow(&mut self, part: JobPart) {
        let output = self.runner.output();
        if let Some(drives) = &mut self.drives {
            drives.apply(output);
        }
        if let Some(plant) = self.plant.as_mut().filter(|_| part != JobPart::Before) {
            let rows = &mut self.job.plant_rows;
            plant.tick(output, &mut |row| rows.push(row.values()));
        }
    }

    fn keep(&mut self, record: &Record) {
        self.job.ticks.extend(record.tick_row(self.torque));
        self.job.rows += 1;
    }

    /// Lets the plant come to its end.
    fn finished(self) -> PlayedJob {
        let Self { plant, mut job, .. } = self;
        let stop = AtomicBool::new(false);
        if let Some(plant) = plant {
            stop.store(job.interrupt.is_some(), Ordering::Relaxed);
            let rows = &mut job.plant_rows;
            job.plant = Some(plant.finish(&stop, &mut |row| rows.push(row.values())));
        }
        job
    }
}
