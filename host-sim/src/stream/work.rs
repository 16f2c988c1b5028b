//! Moves of a streamed job, in memory or in the spool of a long one.

use super::starts::MoveStarts;
use crate::failure::CliError;
use crate::supply::{MoveSupply, opening};
use trirrr_client::{JobPlace, JobRest, JobWork};
use trirrr_core::units::Units;
use trirrr_protocol::message::{AnyMove, Transmit};
use trirrr_scene::{JobLevels, MoveSpool, Scene, offer};

/// Work for the client of a stream.
pub(super) struct StreamWork<'a, N: Transmit> {
    pub(super) work: JobWork<N>,
    /// Ticks before each of the moves, as far as they are known.
    pub(super) starts: MoveStarts,
    /// Ticks of the moves.
    pub(super) ticks: u64,
    /// Moves that the client is supplied with.
    pub(super) supply: Option<MoveSupply<'a, N>>,
    /// A place on the path that is passed without the tool is to be passed again.
    pub(super) uses_tool: bool,
}

/// Moves of a whole job.
pub(super) enum StreamMoves<'a, N: Transmit> {
    /// The moves, and the levels of some.
    InMemory(Vec<AnyMove<N>>, &'a JobLevels),
    /// The spool of a long job, which has no levels.
    InFile(&'a MoveSpool),
}

impl<'a, N: Transmit> StreamMoves<'a, N> {
    /// Moves of the job of `scene`.
    pub(super) fn of(scene: &'a Scene, units: &Units) -> Self {
        match &scene.job.spool {
            Some(spool) => Self::InFile(spool),
            None => Self::InMemory(offer::moves(scene, units), &scene.job.levels),
        }
    }

    /// All of them.
    ///
    /// # Errors
    /// Failed: the spool cannot be read.
    pub(super) fn whole(&self) -> Result<JobWork<N>, CliError> {
        match self {
            Self::InMemory(moves, levels) => Ok(JobWork::of(moves.clone(), levels)),
            Self::InFile(spool) => MoveSupply::whole(spool).work(),
        }
    }

    /// The rest of the job from a place on; of a long one without the moves in the spool.
    ///
    /// # Errors
    /// Failed: the spool cannot be read.
    pub(super) fn rest(&self, from: JobPlace, period: N::Factor) -> Result<JobRest<N>, CliError> {
        match self {
            Self::InMemory(moves, levels) => Ok(JobRest::listed(moves, levels, from, period)),
            Self::InFile(spool) => opening(spool, from, period),
        }
    }

    /// Work of that rest.
    ///
    /// # Errors
    /// Failed: the spool cannot be read.
    pub(super) fn work(&self, rest: &JobRest<N>) -> Result<StreamWork<'a, N>, CliError> {
        match self {
            Self::InMemory(..) => Ok(StreamWork::of_rest(rest)),
            Self::InFile(spool) => {
                let supply = MoveSupply::behind(spool, rest)?;
                Ok(StreamWork {
                    work: supply.work()?,
                    starts: MoveStarts::default(),
                    ticks: supply.ticks(),
                    supply: Some(supply),
                    // The moves are not here: they may.
                    uses_tool: true,
                })
            }
        }
    }
}

impl<N: Transmit> StreamWork<'_, N> {
    fn of_rest(rest: &JobRest<N>) -> Self {
        let ticks = rest.moves().iter().map(|each| each.common().ticks);
        let mut starts = MoveStarts::default();
        let ticks = starts.extend(0, 0, ticks);
        Self {
            starts,
            ticks,
            work: rest.work(),
            supply: None,
            uses_tool: rest
                .moves()
                .iter()
                .any(|each| each.common().tool_power > N::ZERO),
        }
    }

    /// Work of a path that the machine of `scene` plans: about the moves that are planned here.
    pub(super) fn of_path(work: JobWork<N>, scene: &Scene) -> Self {
        let moves = scene.job.moves.iter().map(|each| each.duration_ticks);
        let mut starts = MoveStarts::default();
        let ticks = starts.extend(0, 0, moves);
        Self {
            work,
            starts,
            ticks,
            supply: None,
            // Nor could it be: its moves are not known here.
            uses_tool: false,
        }
    }
}
