//! Moves of a long job out of its spool, for the client that plays it.

use crate::failure::CliError;
use std::io;
use std::sync::mpsc::{Receiver, SyncSender};
use trirrr_client::{JobRest, JobWork, MoveChecksum, SuppliedMoves};
use trirrr_protocol::message::{AnyMove, Transmit};
use trirrr_scene::{MoveSpool, offer};

/// Moves that are read at a time.
const CHUNK: u32 = 256;

/// Chunks that wait for a client that plays in real time.
pub(crate) const WAITING_CHUNKS: usize = 8;

/// Moves of a job from a place on: some of its own, then those of the spool.
pub(crate) struct MoveSupply<'a, N: Transmit> {
    spool: &'a MoveSpool,
    opening: Vec<AnyMove<N>>,
    /// Index in the spool of the move behind the opening,
    next: u32,
    /// ticks of the job before it,
    before_next: u64,
    /// and ticks of the opening.
    opening_ticks: u64,
}

/// Moves in a row.
pub(crate) struct SuppliedChunk<N: Transmit> {
    /// Index of the first.
    pub(crate) first: u32,
    /// Ticks before it.
    pub(crate) before: u64,
    pub(crate) moves: Vec<AnyMove<N>>,
}

fn unreadable(error: io::Error) -> CliError {
    CliError::Failed(format!(
        "the moves of the job cannot be read back from their temporary file: {error}"
    ))
}

fn ticks<N: Transmit>(moves: &[AnyMove<N>]) -> u64 {
    let ticks = moves.iter().map(|each| u64::from(each.common().ticks));
    ticks.sum()
}

impl<'a, N: Transmit> MoveSupply<'a, N> {
    /// All moves of the job.
    pub(crate) fn whole(spool: &'a MoveSpool) -> Self {
        Self {
            spool,
            opening: Vec::new(),
            next: 0,
            before_next: 0,
            opening_ticks: 0,
        }
    }

    /// The rest of the job behind the [opening](JobRest::opening) `rest`, and that.
    ///
    /// # Errors
    /// Failed: the spool cannot be read.
    pub(crate) fn behind(spool: &'a MoveSpool, rest: &JobRest<N>) -> Result<Self, CliError> {
        let opening = rest.moves().to_vec();
        let next = rest.next();
        Ok(Self {
            spool,
            next,
            before_next: spool.read(next..next + 1).map_err(unreadable)?.before,
            opening_ticks: ticks(&opening),
            opening,
        })
    }

    /// Number of the moves.
    pub(crate) fn items(&self) -> u32 {
        self.opening.len() as u32 + self.spool.count().saturating_sub(self.next)
    }

    /// Ticks of the moves.
    pub(crate) fn ticks(&self) -> u64 {
        self.opening_ticks + u64::from(self.spool.ticks()).saturating_sub(self.before_next)
    }

    /// Reads moves from `index` on: at least one, if it is one of the job.
    ///
    /// # Errors
    /// Failed: the spool cannot be read.
    pub(crate) fn read(&self, index: u32) -> Result<SuppliedChunk<N>, CliError> {
        if let Some(behind) = self
            .opening
            .get(index as usize..)
            .filter(|one| !one.is_empty())
        {
            return Ok(SuppliedChunk {
                first: index,
                before: self.opening_ticks - ticks(behind),
                moves: behind.iter().take(CHUNK as usize).copied().collect(),
            });
        }
        let at = self.next + (index - self.opening.len() as u32);
        let found = self.spool.read(at..at.saturating_add(CHUNK));
        let found = found.map_err(unreadable)?;
        Ok(SuppliedChunk {
            first: index,
            before: self.opening_ticks + (found.before - self.before_next),
            moves: offer::spooled(&found, index).collect(),
        })
    }

    /// All moves, chunk by chunk.
    pub(crate) fn chunks(&self) -> impl Iterator<Item = Result<SuppliedChunk<N>, CliError>> + '_ {
        let mut next = 0;
        std::iter::from_fn(move || {
            let chunk = (next < self.items()).then(|| self.read(next))?;
            match &chunk {
                Ok(chunk) => next += chunk.moves.len() as u32,
                Err(_) => next = u32::MAX,
            }
            Some(chunk)
        })
    }

    /// The work of a client that is supplied with the moves: its label is that of the moves in memory. Reads all of them.
    ///
    /// # Errors
    /// Failed: the spool cannot be read.
    pub(crate) fn work(&self) -> Result<JobWork<N>, CliError> {
        let mut check = MoveChecksum::default();
        let mut start = None;
        for chunk in self.chunks() {
            let chunk = chunk?;
            start = start.or(chunk.moves.first().map(|first| first.common().from));
            chunk.moves.iter().for_each(|each| check.add(each));
        }
        Ok(match start {
            Some(start) => JobWork::Supplied(SuppliedMoves::new(self.items(), check, start)),
            None => JobWork::Moves(Vec::new()),
        })
    }

    /// Sends all moves, until the receiver is gone or the spool cannot be read.
    pub(crate) fn send_all(&self, sender: &SyncSender<Result<SuppliedChunk<N>, CliError>>) {
        for chunk in self.chunks() {
            if sender.send(chunk).is_err() {
                return;
            }
        }
    }
}

/// The rest of the job in `spool` from a place on, without the moves behind its [opening](JobRest::opening).
///
/// # Errors
/// Failed: the spool cannot be read.
pub(crate) fn opening<N: Transmit>(
    spool: &MoveSpool,
    from: trirrr_client::JobPlace,
    period: N::Factor,
) -> Result<JobRest<N>, CliError> {
    let mut first = 0;
    let mut moves: Vec<AnyMove<N>> = Vec::new();
    let get = |index: u32| {
        let is_here = index
            .checked_sub(first)
            .is_some_and(|at| (at as usize) < moves.len());
        if !is_here {
            // The way goes backwards.
            first = index.saturating_sub(CHUNK);
            let end = index.saturating_add(1);
            moves = offer::spooled(&spool.read(first..end).map_err(unreadable)?, first).collect();
        }
        Ok(moves.get((index - first) as usize).copied())
    };
    JobRest::opening(get, from, period)
}

/// Next chunk of those that another thread [sends](MoveSupply::send_all).
///
/// # Errors
/// Failed: the spool cannot be read.
pub(crate) fn next_chunk<N: Transmit>(
    chunks: &Receiver<Result<SuppliedChunk<N>, CliError>>,
) -> Result<SuppliedChunk<N>, CliError> {
    // The sender goes when all moves are sent; then none is wanted.
    let gone = || CliError::Failed("the job has no more moves".into());
    chunks.recv().map_err(|_| gone())?
}
