//! Long paths: planned in blocks, several at a time, each in memory of its own.

use crate::job::{JobMove, Tool};
use crate::job_path::{Dwell, JobPath};
use crate::planning::{Unplanned, plan_job};
use crate::{NumberType, Scene};
use core::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use trirrr_plan::course::{Effort, PathPiece};

/// Fewest pieces of a block.
const PIECES: usize = 4096;

/// Pieces beyond which a block may end where the tool works, and does not mark the place: its power follows the speed.
const PIECES_WORKING: usize = 2 * PIECES;

/// Most pieces of a block.
const PIECES_MAX: usize = 16 * PIECES;

/// Blocks of `path`. The machine stands between two of them: where it does so anyway, or else where the tool is off. One
/// block where the moves of all runs are judged together: in numbers of little range, and where alpha is free.
pub(crate) fn blocks(scene: &Scene, path: &JobPath) -> Vec<Range<usize>> {
    let count = path.pieces.len();
    let mut blocks = Vec::new();
    let mut start = 0;
    if path.free.is_none() && scene.number != NumberType::Fixed {
        while count - start > PIECES_WORKING {
            let ends = start + PIECES..count.min(start + PIECES_MAX);
            let Some(end) = end(path, start, ends) else {
                break;
            };
            blocks.push(start..end);
            start = end;
        }
    }
    blocks.push(start..count);
    blocks
}

/// End of the block that begins at `start`.
fn end(path: &JobPath, start: usize, ends: Range<usize>) -> Option<usize> {
    let tool = |piece: &PathPiece| path.tools.get(piece.source).copied().flatten();
    let is_off = |tool: Option<Tool>| tool.is_none_or(|tool| tool.power == 0.0);
    let follows = |tool: Option<Tool>| tool.is_none_or(|tool| tool.speed_m_s > 0.0);
    ends.clone()
        .find(|&end| {
            let (before, here) = (&path.pieces[end - 1], &path.pieces[end]);
            let tools = [tool(before), tool(here)];
            here.stops
                || tools.into_iter().any(is_off)
                || (end >= start + PIECES_WORKING && tools.into_iter().all(follows))
        })
        .or_else(|| (ends.len() == PIECES_MAX - PIECES).then_some(ends.end))
}

/// Moves of the `blocks` of `path`, dwells among them, each with the number of its table in the file.
///
/// # Errors
/// That of the first block that has no plan.
pub(crate) fn plan_blocks(
    scene: &Scene,
    path: &JobPath,
    blocks: &[Range<usize>],
    effort: Effort,
) -> Result<Vec<(usize, JobMove)>, Unplanned> {
    let next = AtomicUsize::new(0);
    let refused = AtomicUsize::new(usize::MAX);
    let planned = Mutex::new(vec![None; blocks.len()]);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads.min(blocks.len()) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    // What lies behind a refused block is of no use.
                    if index >= blocks.len() || refused.load(Ordering::Relaxed) < index {
                        return;
                    }
                    let moves = plan_block(scene, path, blocks, index, effort);
                    if moves.is_err() {
                        refused.fetch_min(index, Ordering::Relaxed);
                    }
                    if let Ok(mut planned) = planned.lock() {
                        planned[index] = Some(moves);
                    }
                }
            });
        }
    });
    let planned = planned.into_inner().unwrap_or_default();
    let mut moves: Vec<(usize, JobMove)> = Vec::new();
    for block in planned.into_iter().flatten() {
        let start = moves.len();
        moves.extend(block?);
        // Pieces meet but for rounding; moves do exactly.
        if start > 0 {
            moves[start].1.from = moves[start - 1].1.to;
        }
    }
    Ok(moves)
}

fn plan_block(
    scene: &Scene,
    path: &JobPath,
    blocks: &[Range<usize>],
    index: usize,
    effort: Effort,
) -> Result<Vec<(usize, JobMove)>, Unplanned> {
    let source = |block: usize| {
        blocks
            .get(block)
            .map(|block| path.pieces[block.start].source)
    };
    // Dwells before the first piece of all are of the first block, any others are of the block that they end.
    let first = if index == 0 {
        0
    } else {
        source(index).unwrap_or(0)
    };
    let behind = source(index + 1).map_or(path.tools.len(), |next| next + 1);
    let mut pieces = path.pieces[blocks[index].clone()].to_vec();
    for piece in &mut pieces {
        piece.source -= first;
    }
    pieces[0].stops = true;
    let end = source(index + 1).unwrap_or(usize::MAX);
    let own = path
        .dwells
        .iter()
        .filter(|dwell| (first..end).contains(&dwell.source));
    let dwells = own.map(|dwell| Dwell {
        source: dwell.source - first,
        ..*dwell
    });
    let block = JobPath {
        pieces,
        free: None,
        dwells: dwells.collect(),
        tools: path.tools[first..behind].to_vec(),
        rows: Vec::new(),
        ..*path
    };
    let planned = plan_job(scene, &block, effort)
        .map_err(|error| error.in_block(first, blocks[index].start))?;
    let steps = planned.steps().into_iter();
    Ok(steps.map(|(source, each)| (source + first, each)).collect())
}
