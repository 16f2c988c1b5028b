//! Result of a run.

use super::plant::Simulated;
use crate::failure::CliError;
use crate::histogram::Histogram;
use crate::player::STOPPED;
use crate::realtime::Deadlines;
use crate::recording::{Recorded, RecordedDrives};
use std::path::PathBuf;
use std::time::Duration;
use trirrr_plant::Outcome;
use trirrr_scene::NumberType;

/// End of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobEnd {
    /// The whole job was played.
    Complete,
    /// The user stopped the run.
    Stopped,
    /// The machine refused the job or one of its moves, for this reason.
    Refused(String),
    /// The machine has this fault.
    Fault(String),
}

impl JobEnd {
    /// Reason why the job is not complete.
    fn reason(&self) -> Option<String> {
        match self {
            JobEnd::Complete => None,
            JobEnd::Stopped => Some(STOPPED.into()),
            JobEnd::Refused(why) | JobEnd::Fault(why) => Some(why.clone()),
        }
    }
}

/// Result of a job, besides its ticks.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// End of the job.
    pub end: JobEnd,
    /// Duration of the run.
    pub elapsed: Duration,
    /// Durations of the computation of a tick.
    pub computation: Histogram,
    /// Statistics of the deadlines, in real time.
    pub deadlines: Option<Deadlines>,
}

/// Result of a run. `O` is the outcome of the plant.
#[derive(Clone, Debug)]
pub struct RunReport<O = Outcome> {
    /// End and times of the job.
    pub played: RunResult,
    /// Number of setpoints of the whole job.
    pub setpoints: u64,
    /// Records, their extremes and files.
    pub job: Recorded,
    /// Number type of the computation.
    pub scalar: NumberType,
    /// Records of the drives, if they were simulated and tell something.
    pub drives: Option<RecordedDrives>,
    /// Result of the plant, if the scene has one.
    pub plant: Option<Simulated<O>>,
}

impl<O> RunReport<O> {
    /// Reason why the results are not complete.
    pub(crate) fn reason(&self) -> Option<String> {
        let of_plant = || self.plant.as_ref()?.reason.clone();
        self.played.end.reason().or_else(of_plant)
    }

    /// Files of the job, of the drives and of the plant.
    pub(crate) fn all_files(&self) -> Vec<PathBuf> {
        let of_drives = self.drives.iter().flat_map(|drives| &drives.files);
        let of_plant = self.plant.iter().flat_map(|plant| &plant.files);
        let own = self.job.files.iter().chain(of_drives);
        own.chain(of_plant).cloned().collect()
    }

    /// End of the job and of its plant.
    ///
    /// # Errors
    /// Failed: the plant has not come to the end of the job.
    pub(crate) fn end(&self) -> Result<JobEnd, CliError> {
        let end = self.played.end.clone();
        match self.plant.as_ref().filter(|_| end == JobEnd::Complete) {
            Some(plant) if plant.is_stopped => Ok(JobEnd::Stopped),
            Some(Simulated {
                reason: Some(why), ..
            }) => Err(CliError::Failed(why.clone())),
            _ => Ok(end),
        }
    }
}
