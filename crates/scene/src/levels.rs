//! Power lists of a job: rows of levels on its path, and the levels of its moves.

use crate::job_move::JobMove;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{LEVEL_PARTS, LevelRange};

/// Levels of the tool's power at equal distances along a straight part of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelRow {
    /// Number of the part in the file, from 0.
    pub source: usize,
    /// Places of D at its ends, m.
    pub ends_m: [[f64; 2]; 2],
    /// The levels: parts of 255 of the power of the part's tool.
    pub levels: Vec<u8>,
}

impl LevelRow {
    /// Place of D among the levels, in parts of a level: that of the nearest place on the row.
    fn parts(&self, at: &Pose<f64>) -> u64 {
        let [[x, y], [to_x, to_y]] = self.ends_m;
        let (width, height) = (to_x - x, to_y - y);
        let way = (at.position.x - x) * width + (at.position.y - y) * height;
        let share = (way / (width * width + height * height)).clamp(0.0, 1.0);
        // The cast of what is not a number gives 0.
        (share * self.levels.len() as f64 * f64::from(LEVEL_PARTS)).round() as u64
    }

    /// Levels of a move on the row, from number `first` on; none where the move does not go on along it.
    fn range(&self, each: &JobMove, first: u32) -> Option<(LevelRange, &[u8])> {
        let [begin, end] = [&each.from, &each.to].map(|at| self.parts(at));
        let whole = u64::from(LEVEL_PARTS);
        let (from, to) = (begin / whole, end.div_ceil(whole));
        let range = LevelRange {
            first,
            count: u16::try_from(to.checked_sub(from)?).ok()?,
            offset: (begin % whole) as u16,
            span: u32::try_from(end.checked_sub(begin)?).ok()?,
        };
        let levels = self.levels.get(from as usize..to as usize)?;
        range.is_whole().then_some((range, levels))
    }
}

/// Levels of the moves of a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobLevels {
    /// Levels of all moves, one after the other.
    pub levels: Vec<u8>,
    /// Levels of a move, by the index of the move, in order. The first of them is counted in `levels`.
    pub ranges: Vec<(u32, LevelRange)>,
}

impl JobLevels {
    /// Levels of the moves `steps`, each with the number of its part of the path. The tool is off in a move that belongs to a row and does not go
    /// on along it.
    pub(crate) fn of(rows: &[LevelRow], steps: &mut [(usize, JobMove)]) -> Self {
        let mut found = Self::default();
        if rows.is_empty() {
            return found;
        }
        for (index, (source, each)) in (0..).zip(steps) {
            let Ok(row) = rows.binary_search_by_key(source, |row| row.source) else {
                continue;
            };
            match rows[row].range(each, found.levels.len() as u32) {
                Some((range, levels)) => {
                    found.levels.extend_from_slice(levels);
                    found.ranges.push((index, range));
                }
                None => each.tool = None,
            }
        }
        found
    }

    /// Returns true if no move has levels.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// Levels of the move `index`.
    pub fn get(&self, index: u32) -> Option<&LevelRange> {
        let found = self.ranges.binary_search_by_key(&index, |(of, _)| *of);
        found.ok().map(|at| &self.ranges[at].1)
    }

    /// Index, in all levels, of the first that the moves from `index` on have.
    pub fn first_from(&self, index: u32) -> u32 {
        let behind = self.ranges.partition_point(|(of, _)| *of < index);
        let next = self.ranges.get(behind);
        next.map_or(self.levels.len() as u32, |(_, range)| range.first)
    }

    /// Moves with levels among those from index `from` on, up to `to`.
    pub fn count(&self, from: u32, to: u32) -> usize {
        let before = |index| self.ranges.partition_point(|(of, _)| *of < index);
        before(to).saturating_sub(before(from))
    }
}
