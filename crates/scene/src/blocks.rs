//! Long paths, cut into blocks that are planned by themselves: the machine stands between two of them.

use crate::job_move::Tool;
use crate::job_path::{Dwell, JobPath};
use crate::outputs::PathOutputs;
use crate::{NumberType, Scene};
use core::ops::Range;
use trirrr_plan::course::PathPiece;

/// Fewest pieces of a block.
const PIECES: usize = 4096;

/// Pieces beyond which a block may end where the tool works, and does not mark the place: its power follows the speed.
const PIECES_WORKING: usize = 2 * PIECES;

/// Most pieces of a block.
const PIECES_MAX: usize = 16 * PIECES;

/// Part of a path that is planned by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct PathBlock {
    /// The path, its tables counted from `first`. Corners are rounded.
    pub(crate) path: JobPath,
    /// Number in the file of the first table.
    pub(crate) first: usize,
    /// Pieces of the whole path before it.
    pub(crate) before: usize,
}

impl PathBlock {
    /// Number in the file of the first table, from 0.
    pub fn first(&self) -> usize {
        self.first
    }
}

/// Cuts a path into blocks as its pieces come. The machine stands between two blocks: where it does so anyway, or else where
/// the tool is off, or where its power follows the speed. Holds one block at most.
#[derive(Clone, Debug)]
pub struct BlockCutter {
    /// Part behind the last cut. Pieces and dwells have the numbers of the file, tools begin with `first`.
    open: JobPath,
    first: usize,
    before: usize,
    /// Pieces behind which there is no cut.
    looked: usize,
}

impl BlockCutter {
    /// Begins a path that is followed within `tolerance_m` and `tolerance_rad`.
    pub fn new(tolerance_m: f64, tolerance_rad: f64) -> Self {
        Self {
            open: JobPath {
                tolerance_m,
                tolerance_rad,
                ..JobPath::default()
            },
            first: 0,
            before: 0,
            looked: PIECES,
        }
    }

    /// Adds the work of the tool in the table `source` of the file. It comes before a piece or a dwell of that table.
    pub fn tool(&mut self, source: usize, tool: Option<Tool>) {
        let Some(index) = source.checked_sub(self.first) else {
            return;
        };
        if self.open.tools.len() <= index {
            self.open.tools.resize(index + 1, None);
        }
        self.open.tools[index] = tool;
    }

    /// Adds a stand behind the pieces of the tables before it.
    pub fn dwell(&mut self, dwell: Dwell) {
        self.open.dwells.push(dwell);
    }

    /// Adds a change of outputs, which comes before the piece or the dwell of its table.
    pub fn outputs(&mut self, outputs: PathOutputs) {
        self.open.outputs.push(outputs);
    }

    /// Adds a piece, its corners rounded; the tables of pieces do not go back. Returns the block that ends before it or earlier, if one
    /// does.
    pub fn piece(&mut self, piece: PathPiece) -> Option<PathBlock> {
        self.open.pieces.push(piece);
        let count = self.open.pieces.len();
        if count <= PIECES_WORKING {
            return None;
        }
        let ends = self.looked..count.min(PIECES_MAX);
        self.looked = ends.end;
        let found = ends.into_iter().find(|end| self.may_end(*end));
        let end = found.or((count > PIECES_MAX).then_some(PIECES_MAX))?;
        Some(self.cut(end))
    }

    /// Returns what is left, if anything is.
    pub fn finish(mut self) -> Option<PathBlock> {
        if self.open.pieces.is_empty() {
            return None;
        }
        self.number_from_first();
        Some(PathBlock {
            path: self.open,
            first: self.first,
            before: self.before,
        })
    }

    /// Returns true if a block may end before the piece `end`.
    fn may_end(&self, end: usize) -> bool {
        let path = &self.open;
        let tool = |piece: &PathPiece| {
            path.tools
                .get(piece.source.wrapping_sub(self.first))
                .copied()
                .flatten()
        };
        let is_off = |tool: Option<Tool>| tool.is_none_or(|tool| tool.power == 0.0);
        let follows = |tool: Option<Tool>| tool.is_none_or(|tool| tool.speed_m_s > 0.0);
        let (before, here) = (&path.pieces[end - 1], &path.pieces[end]);
        let tools = [tool(before), tool(here)];
        here.stops
            || tools.into_iter().any(is_off)
            || (end >= PIECES_WORKING && tools.into_iter().all(follows))
    }

    fn cut(&mut self, end: usize) -> PathBlock {
        let path = &mut self.open;
        let next = path.pieces[end].source;
        let mut behind = path.pieces.split_off(end);
        behind[0].stops = true;
        let is_behind = |dwell: &Dwell| dwell.source >= next;
        let dwells = path.dwells.iter().filter(|dwell| is_behind(dwell));
        let is_change_behind = |change: &PathOutputs| change.source >= next;
        let changes = path.outputs.iter();
        let changes = changes.filter(|change| is_change_behind(change));
        let left = JobPath {
            pieces: behind,
            free: None,
            dwells: dwells.copied().collect(),
            tools: path.tools[next - self.first..].to_vec(),
            rows: Vec::new(),
            outputs: changes.copied().collect(),
            ..*path
        };
        path.outputs.retain(|change| !is_change_behind(change));
        path.dwells.retain(|dwell| !is_behind(dwell));
        path.tools.truncate(next + 1 - self.first);
        self.number_from_first();
        let block = PathBlock {
            path: std::mem::replace(&mut self.open, left),
            first: self.first,
            before: self.before,
        };
        self.first = next;
        self.before += end;
        self.looked = PIECES;
        block
    }

    /// Counts the tables of what is open from its first one on.
    fn number_from_first(&mut self) {
        let sources = self.open.pieces.iter_mut().map(|each| &mut each.source);
        let dwells = self.open.dwells.iter_mut().map(|each| &mut each.source);
        let outputs = self.open.outputs.iter_mut().map(|each| &mut each.source);
        for source in sources.chain(dwells).chain(outputs) {
            *source = source.saturating_sub(self.first);
        }
    }
}

/// Returns true if `path` is planned as one block: a short one, one whose alpha is free, and one in numbers of little range, where
/// the moves of all runs are judged together.
pub(crate) fn is_one_block(scene: &Scene, path: &JobPath) -> bool {
    path.free.is_some() || scene.number == NumberType::Fixed || path.pieces.len() <= PIECES_WORKING
}

/// Blocks of a path that is in memory, one after the other.
pub(crate) fn blocks(path: &JobPath) -> impl Iterator<Item = PathBlock> + '_ {
    let mut cutter = Some(BlockCutter::new(path.tolerance_m, path.tolerance_rad));
    let mut pieces = path.pieces.iter();
    let mut dwells = path.dwells.iter().peekable();
    let mut outputs = path.outputs.iter().peekable();
    let mut tools = 0..path.tools.len();
    core::iter::from_fn(move || {
        let open = cutter.as_mut()?;
        let mut tables_to = |open: &mut BlockCutter, end: usize| {
            let these: Range<usize> = tools.start..end.max(tools.start).min(tools.end);
            tools.start = these.end;
            these.for_each(|source| open.tool(source, path.tools[source]));
            while let Some(dwell) = dwells.next_if(|dwell| dwell.source < end) {
                open.dwell(*dwell);
            }
            while let Some(change) = outputs.next_if(|change| change.source < end) {
                open.outputs(*change);
            }
        };
        for piece in pieces.by_ref() {
            tables_to(open, piece.source + 1);
            if let Some(block) = open.piece(*piece) {
                return Some(block);
            }
        }
        tables_to(open, path.tools.len());
        cutter.take()?.finish()
    })
}
