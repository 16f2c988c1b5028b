//! Long jobs: planned block by block as their paths come, their moves kept in a file.

use crate::Scene;
use crate::blocks::PathBlock;
use crate::in_order::in_order;
use crate::job::Job;
use crate::outputs::JobOutputs;
use crate::planning::{check_ticks, join, plan_block};
use crate::spool::SpoolWriter;
use crate::stops::{StopMoves, StopsSoFar};
use crate::unplanned::Unplanned;
use std::fs::File;
use std::io;
use std::sync::Arc;

/// Reason why a long job is not taken. `E` is that of its source.
#[derive(Debug, thiserror::Error)]
pub enum UntakenJob<E> {
    /// The path cannot be read.
    #[error("{0}")]
    Path(E),
    /// A block has no plan.
    #[error(transparent)]
    Plan(#[from] Unplanned),
    /// The moves cannot be kept.
    #[error("the moves of the job cannot be written to a temporary file: {0}")]
    Spool(io::Error),
}

impl Scene {
    /// Gives the machine the job whose path comes in `blocks`, as [`take_path`](Self::take_path) does where the path is in memory. The
    /// moves go into `file`, which is empty, in the job's [`spool`](crate::Job::spool). Memory does not grow with the job.
    ///
    /// # Errors
    /// [`UntakenJob`]: of the first block that has one; the scene is as it was.
    pub fn take_blocks<E: Send>(
        &mut self,
        blocks: impl Iterator<Item = Result<PathBlock, E>> + Send,
        file: File,
    ) -> Result<(), UntakenJob<E>> {
        let scene = &*self;
        let mut spool = SpoolWriter::new(file);
        // None once a move is not judged again as it was when it was planned.
        let mut so_far = Some(StopsSoFar::default());
        let plan = |(index, block): (usize, PathBlock)| {
            let (steps, outputs) = plan_block(scene, &block)?;
            let moves: Vec<_> = steps.into_iter().map(|(_, each)| each).collect();
            let judged = StopMoves::judged(scene, moves.clone(), index == 0);
            let stops = judged.map(|judged| {
                let stops = judged.stops(scene, usize::MAX, false);
                (judged, stops)
            });
            Ok((moves, stops, outputs))
        };
        let blocks = blocks.enumerate().map(|(index, block)| match block {
            Ok(block) => Ok((index, block)),
            Err(error) => Err(UntakenJob::Path(error)),
        });
        let mut all_outputs = JobOutputs::default();
        in_order(blocks, plan, |(mut moves, stops, outputs)| {
            join(spool.last(), moves.first_mut());
            so_far = so_far
                .take()
                .zip(stops)
                .map(|(mut so_far, (mut judged, stops))| {
                    judged.join(spool.last());
                    so_far.add(scene, &judged, &stops);
                    so_far
                });
            all_outputs.append(spool.count(), &outputs);
            spool.write(&moves).map_err(UntakenJob::Spool)
        })?;
        check_ticks(spool.ticks())?;
        let longest_stop = so_far.map(|so_far| so_far.end(scene));
        let spool = spool.finish(longest_stop).map_err(UntakenJob::Spool)?;
        self.job = Job {
            spool: Some(Arc::new(spool)),
            outputs: all_outputs,
            ..Job::of(self.job.start, Vec::new())
        };
        Ok(())
    }
}
