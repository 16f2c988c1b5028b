//! Stops on a job that is known as a whole: the time and the way that each takes.

use crate::feed::{FeedScale, PathPosition};
use crate::pace::{MovePaces, Pace};

/// Stop from normal speed, as long as the rates that are proven for each part of the job make it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stop {
    /// Ticks until the path stands.
    pub ticks: u32,
    /// Ticks of the path until there, rounded up.
    pub path_ticks: u32,
}

/// Calls `visit` with a stop that begins at the start of each part of a job, and the ticks of the job before it, the last
/// first. No stop that begins elsewhere takes longer: within a part it takes the longer, the later it begins, where the
/// part has room, and the less elsewhere. `moves` are the ticks and paces of its moves; the job ends at rest; `ramp_ticks`
/// is the ramp of the service.
pub fn each_stop(moves: &[(u32, MovePaces)], ramp_ticks: u16, mut visit: impl FnMut(u64, Stop)) {
    let mut before: u64 = moves.iter().map(|(ticks, _)| u64::from(*ticks)).sum();
    let mut next = Stop::default();
    for index in (0..moves.len()).rev() {
        let (ticks, _) = moves[index];
        before -= u64::from(ticks);
        for part in (0..1 << MovePaces::parts_log2(ticks)).rev() {
            next = Walk::at(moves, index, part, ramp_ticks).stop(next);
            let begin = Walk::begin_of(ticks, part);
            visit(before + u64::from(begin), next);
        }
    }
}

/// A stop under way.
struct Walk<'a> {
    moves: &'a [(u32, MovePaces)],
    index: usize,
    part: u32,
    /// Ticks of path behind it, and on the move.
    passed: u32,
    position: PathPosition,
    feed: FeedScale,
}

impl<'a> Walk<'a> {
    fn at(moves: &'a [(u32, MovePaces)], index: usize, part: u32, ramp_ticks: u16) -> Self {
        let mut feed = FeedScale::new(ramp_ticks);
        feed.start();
        let tick = Self::begin_of(moves[index].0, part);
        Self {
            moves,
            index,
            part,
            passed: 0,
            position: PathPosition { tick, part: 0 },
            feed,
        }
    }

    fn begin_of(ticks: u32, part: u32) -> u32 {
        match part {
            0 => 0,
            _ => MovePaces::end_of(ticks, part - 1),
        }
    }

    /// Paces and end of the part, and paces of the one behind it.
    fn parts(&self) -> (Pace, u32, Option<Pace>) {
        let (ticks, paces) = &self.moves[self.index];
        let end = MovePaces::end_of(*ticks, self.part);
        let next = match end < *ticks {
            true => Some(paces.of(self.part + 1)),
            false => self.moves.get(self.index + 1).map(|(_, next)| next.of(0)),
        };
        (paces.of(self.part), end, next)
    }

    /// Walks to rest. `next` is the stop from normal speed at the end of the first part.
    fn stop(mut self, next: Stop) -> Stop {
        let (first, first_end, _) = self.parts();
        let length = first_end - self.position.tick;
        let mut ticks = 0;
        let mut in_first = true;
        // Without room it is a whole part later at once.
        if first.slower == [0, 0] {
            return Stop {
                ticks: length + next.ticks,
                path_ticks: length + next.path_ticks,
            };
        }
        while !self.feed.is_at_rest() {
            let (pace, end, behind) = self.parts();
            let paces = [pace, behind.unwrap_or(pace)];
            let slower = |paces: &[Pace; 2]| self.feed.slower(paces);
            let step = self.feed.across(self.position, end, paces, slower);
            let from = self.position.tick;
            self.position = self.feed.take(step, self.position);
            ticks += 1;
            self.passed += self.position.tick - from;
            if self.position.tick < end {
                continue;
            }
            if in_first && self.position.part == 0 && self.feed.is_at_goal() {
                return Stop {
                    ticks: ticks + next.ticks,
                    path_ticks: self.passed + next.path_ticks,
                };
            }
            in_first = false;
            if end < self.moves[self.index].0 {
                self.part += 1;
            } else if self.index + 1 < self.moves.len() {
                self.position.tick -= self.moves[self.index].0;
                self.index += 1;
                self.part = 0;
            } else {
                // The end of the job, even if the tick would have gone further.
                self.passed -= self.position.tick - end;
                self.position.part = 0;
                break;
            }
        }
        Stop {
            ticks,
            path_ticks: self.passed + u32::from(self.position.part != 0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn stops(moves: &[(u32, MovePaces)], ramp: u16) -> Vec<(u64, Stop)> {
        let mut all = Vec::new();
        each_stop(moves, ramp, |tick, stop| all.push((tick, stop)));
        all.reverse();
        all
    }

    #[test]
    fn with_room_all_along_a_stop_takes_its_ramp() {
        let moves = [
            (40, MovePaces::FULL),
            (10, MovePaces::FULL),
            (30, MovePaces::FULL),
        ];
        let all = stops(&moves, 10);
        assert_eq!(all.len(), 8 + 1 + 8);
        for (tick, stop) in all {
            let left = 80 - tick as u32;
            let expected = match left >= 5 {
                true => 10,
                false => stop.ticks,
            };
            assert_eq!(stop.ticks, expected, "{tick}");
            assert!(stop.path_ticks <= left.min(5));
        }
    }

    #[test]
    fn without_room_it_waits_for_the_next_part_that_has_some() {
        let mut without = MovePaces::FULL;
        without.lower(
            40,
            1,
            0,
            Pace {
                slower: [0, 0],
                faster: [1, 0],
            },
        );
        let all = stops(&[(40, without), (40, MovePaces::FULL)], 10);
        let expected: [u32; 4] = [20, 15, 10, 5];
        for ((tick, stop), wait) in all.into_iter().zip(expected) {
            assert_eq!(
                (stop.ticks, stop.path_ticks),
                (wait + 10, wait + 5),
                "{tick}"
            );
        }
    }
}
