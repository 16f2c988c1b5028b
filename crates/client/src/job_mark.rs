//! Place on a job, and its account that outlives its host: with it another one goes on.

/// Place on the path of a job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct JobPlace {
    /// Index of the move, counted from 0,
    pub index: u32,
    /// and its tick.
    pub at: u32,
}

/// Part of a job that a machine has: items that it had taken, and the number of the first move, once the machine had the name of the job.
pub type BegunJob = (u32, Option<u32>);

/// Account of a job, as far as its host knows. Places are on the whole job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JobMark {
    /// Items that the machine had taken.
    pub taken: u32,
    /// Number of the first move on the machine, once it had the name of the job.
    pub first_move: Option<u32>,
    /// Place from which the job was played.
    pub from: JobPlace,
    /// Place up to which it was played with its tool.
    pub reached: JobPlace,
}

impl JobMark {
    /// Returns the mark of a job that is played from `from` on, of which no machine has anything.
    pub fn at(from: JobPlace) -> Self {
        Self {
            from,
            reached: from,
            ..Self::default()
        }
    }

    /// Returns the mark by which the job goes on: from its own beginning where a machine has something of it, else from the place that was
    /// reached.
    #[must_use]
    pub fn resumed(self) -> Self {
        match self.begun() {
            Some(_) => self,
            None => Self::at(self.reached),
        }
    }

    /// Returns the part that a machine has; none where it did not even get the name of the job.
    pub fn begun(&self) -> Option<BegunJob> {
        let is_begun = self.taken > 0 || self.first_move.is_some();
        is_begun.then_some((self.taken, self.first_move))
    }
}
