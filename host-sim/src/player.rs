//! One way to play and record a job, for a machine in this program and for a board: the scene in the units of its number type, the
//! records of the ticks, and their files.

use crate::failure::CliError;
use crate::figures::DrawnJob;
use crate::numbers;
use crate::recording::LagrangeColumns;
use crate::recording::{DriveRecorder, Recorded, RecordedDrives, Recorder};
use crate::results::ResultFolder;
use trirrr_client::describe;
use trirrr_client::records::Samples;
use trirrr_core::number::Number;
use trirrr_core::units::Units;
use trirrr_protocol::message::{DriveSample, Telemetry, Transmit};
use trirrr_scene::pipeline::{self, Pipeline};
use trirrr_scene::record::Record;
use trirrr_scene::{NumberType, Scene};

/// Reason of a job that the user ended.
pub(crate) const STOPPED: &str = "stopped by the user";

/// Scene in a number type. Its units are computed here and nowhere else: in fixed point they take a look at all ticks of the job.
pub(crate) struct PlayedScene<'s, N: Number> {
    pub(crate) scene: &'s Scene,
    pub(crate) scalar: NumberType,
    /// Units of the machine.
    pub(crate) units: Units,
    pipeline: Box<dyn Pipeline<N>>,
}

impl<'s, N: Number> PlayedScene<'s, N> {
    /// Takes `scene` in the number type `scalar`, which is `N`.
    ///
    /// # Errors
    /// Refused: a job or a machine that the number type cannot hold.
    pub(crate) fn new(scene: &'s Scene, scalar: NumberType) -> Result<Self, CliError> {
        let units = numbers::units::<N>(scene)?;
        let refused = |why| CliError::Refused(format!("scene {}: {why}", scene.name));
        Ok(Self {
            scene,
            scalar,
            units,
            pipeline: pipeline::of_scene(scene, units).map_err(refused)?,
        })
    }

    /// Units of the machine as the client has them.
    fn words(&self) -> describe::Units {
        describe::Units::of_scene(self.scene, &self.units)
    }
}

/// Contents of the files of a job.
pub(crate) struct JobFiles {
    /// Records of the job, about.
    pub(crate) records: u64,
    /// The first of so many records has a row in the table.
    pub(crate) every: u32,
    pub(crate) drawn: DrawnJob,
    pub(crate) lagrange: Option<LagrangeColumns>,
    /// Ticks from one sample of the drives to the next, where they are asked.
    pub(crate) drives_every: Option<u16>,
}

/// Turns the samples of a job into records, and writes them.
pub(crate) struct JobRecorder<'a, N: Transmit> {
    pub(crate) samples: Samples<'a, N>,
    recorder: Recorder,
    /// Samples of the drives, if they tell something.
    drives: Option<DriveRecorder<N>>,
    name: &'a str,
}

/// Files of a job, before their folder is ended.
pub(crate) struct RecordedJob {
    pub(crate) job: Recorded,
    /// Records of the drives, if they tell something and the job has begun.
    pub(crate) drives: Option<RecordedDrives>,
    pub(crate) results: ResultFolder,
}

impl<'a, N: Transmit> JobRecorder<'a, N> {
    /// Prepares the tables of the job of `played` in the folder of `results`; the first record begins the results.
    ///
    /// # Errors
    /// Refused: the machine, or a file that is in the way. Failed: a table cannot be written.
    pub(crate) fn create(
        played: &'a PlayedScene<'_, N>,
        mut results: ResultFolder,
        files: JobFiles,
    ) -> Result<Self, CliError> {
        let (scene, units) = (played.scene, played.words());
        let drives = match files.drives_every {
            Some(every) => DriveRecorder::create(&mut results, scene, units, every)?,
            None => None,
        };
        let recorder = Recorder::create(results, files.records, files.drawn, files.lagrange)?;
        Ok(Self {
            samples: Samples::new(&*played.pipeline, units),
            recorder: recorder.thinned(files.every),
            drives,
            name: &scene.name,
        })
    }

    /// Returns `true` if the drives tell something.
    pub(crate) fn has_drives(&self) -> bool {
        self.drives.is_some()
    }

    /// Returns the number of records.
    pub(crate) fn rows(&self) -> u64 {
        self.recorder.rows()
    }

    /// Writes the `record` of a tick, which the `samples` have made of `sample`.
    ///
    /// # Errors
    /// Failed: a table cannot be written.
    pub(crate) fn write(&mut self, record: &Record, sample: &Telemetry<N>) -> Result<(), CliError> {
        self.recorder.record(record)?;
        match &mut self.drives {
            Some(drives) => drives.command(sample),
            None => Ok(()),
        }
    }

    /// Takes a sample of the drives.
    ///
    /// # Errors
    /// Failed: the table cannot be written.
    pub(crate) fn drives(&mut self, sample: &DriveSample<N>) -> Result<(), CliError> {
        match &mut self.drives {
            Some(drives) => drives.drives(sample),
            None => Ok(()),
        }
    }

    /// Ends the tables and draws the figures. Those of a job that is not complete say when it ended.
    ///
    /// # Errors
    /// Failed: a file cannot be written.
    pub(crate) fn finish(self, is_complete: bool) -> Result<RecordedJob, CliError> {
        let (job, mut results) = self.recorder.finish(self.name, is_complete)?;
        let drives = self.drives.filter(|_| results.has_begun());
        let drives = drives.map(|drives| drives.finish(&mut results, self.name));
        Ok(RecordedJob {
            job,
            drives: drives.transpose()?,
            results,
        })
    }
}
