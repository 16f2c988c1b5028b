//! Moves that come to the client as the job goes on: a job of any length in little memory.

use super::JobClient;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{AnyMove, Transmit};
use trirrr_protocol::wire::checksum;

/// Moves that the client has beyond those that it has offered, before it wants more.
const AHEAD: u32 = 512;

/// Moves behind those that are played: failures name a move that ended a moment ago.
const KEPT: u32 = 16;

/// Checksum over the moves of a job, as its label has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoveChecksum(u32);

impl MoveChecksum {
    /// Adds the next move.
    pub fn add<N: Transmit>(&mut self, each: &AnyMove<N>) {
        // Every part has a length that is known beforehand.
        self.0 = checksum(&(self.0, checksum(&each.step()))).unwrap_or_default();
    }

    /// The checksum of the moves so far.
    pub fn value(self) -> u32 {
        self.0
    }
}

/// Part of a job's moves that the client has.
#[derive(Clone, Debug)]
pub struct SuppliedMoves<N: Transmit> {
    items: u32,
    check: MoveChecksum,
    start: Pose<N>,
    /// Index of the first move that is here.
    first: u32,
    moves: Vec<AnyMove<N>>,
}

impl<N: Transmit> SuppliedMoves<N> {
    /// The moves of a job of `items` moves with that checksum, which begins at `start`. None is here yet:
    /// [`JobClient::wants`] says which is to be supplied.
    pub fn new(items: u32, check: MoveChecksum, start: Pose<N>) -> Self {
        Self {
            items,
            check,
            start,
            first: 0,
            moves: Vec::new(),
        }
    }

    pub(super) fn items(&self) -> u32 {
        self.items
    }

    pub(super) fn check(&self) -> MoveChecksum {
        self.check
    }

    pub(super) fn start(&self) -> Pose<N> {
        self.start
    }

    /// The moves that are here, and the index of the first.
    pub(super) fn here(&self) -> (&[AnyMove<N>], u32) {
        (&self.moves, self.first)
    }

    fn end(&self) -> u32 {
        self.first + self.moves.len() as u32
    }

    /// Index of the move that is to be supplied next, if `offered` moves were offered.
    fn wants(&self, offered: u32) -> Option<u32> {
        // The one before the next tells where that begins.
        let from = offered.saturating_sub(1);
        let next = match (self.first..=self.end()).contains(&from) {
            true => self.end(),
            // The machine is at another place of the job.
            false => from,
        };
        (next < self.items && next < offered.saturating_add(AHEAD)).then_some(next)
    }

    /// Takes the moves from `index` on. Those before `passed` are of no use any more.
    fn supply(&mut self, index: u32, moves: impl IntoIterator<Item = AnyMove<N>>, passed: u32) {
        if index != self.end() {
            self.moves.clear();
            self.first = index;
        }
        let passed = passed.saturating_sub(KEPT).clamp(self.first, self.end());
        self.moves.drain(..(passed - self.first) as usize);
        self.first = passed;
        self.moves.extend(moves);
    }
}

impl<N: Transmit> JobClient<N> {
    /// Returns the index of the move that the owner is to [supply](Self::supply) next. `None`: nothing is wanted now. Moves
    /// that were given as a whole are never wanted.
    pub fn wants(&self) -> Option<u32> {
        let offered = self.progress.has_offered();
        self.progress.supplied()?.wants(offered)
    }

    /// Takes moves of the job from the move `index` on, which is the one that is [wanted](Self::wants). Their numbers do not count.
    pub fn supply(&mut self, index: u32, moves: impl IntoIterator<Item = AnyMove<N>>) {
        let status = self.status.as_ref();
        let done = status.map_or(0, |status| self.progress.moves_done(status));
        // A machine that has started anew counts beyond any of them.
        let passed = done.min(self.progress.has_offered());
        if let Some(supplied) = self.progress.supplied_mut() {
            supplied.supply(index, moves, passed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_protocol::message::Move;

    fn moves(range: std::ops::Range<u32>) -> impl Iterator<Item = AnyMove<f64>> {
        let pose = |number: u32| Pose::from_f64(1e-3 * f64::from(number), 0.0, 0.0);
        range.map(move |number| {
            let each = Move::rest_to_rest(number, pose(number), pose(number + 1), 10);
            AnyMove::new(each, None)
        })
    }

    /// Moves that are here, by their numbers.
    fn here(supplied: &SuppliedMoves<f64>) -> std::ops::Range<u32> {
        let (moves, first) = supplied.here();
        for (index, each) in (first..).zip(moves) {
            assert_eq!(each.common().number, index);
        }
        first..first + moves.len() as u32
    }

    #[test]
    fn moves_are_wanted_ahead_and_go_when_they_are_done() {
        let start = Pose::from_f64(0.0, 0.0, 0.0);
        let mut supplied = SuppliedMoves::new(100_000, MoveChecksum::default(), start);
        let mut most = 0;
        for offered in 0..100_000 {
            while let Some(index) = supplied.wants(offered) {
                supplied.supply(
                    index,
                    moves(index..(index + 100).min(100_000)),
                    offered.saturating_sub(256),
                );
            }
            let here = here(&supplied);
            assert!(here.contains(&offered) && here.contains(&offered.saturating_sub(256)));
            assert!(here.end >= (offered + AHEAD).min(100_000));
            most = most.max(here.len());
        }
        assert!(most < 1000, "{most}");
        assert_eq!(supplied.wants(100_000), None);
    }

    #[test]
    fn another_place_of_the_job_is_supplied_from_the_move_before_it() {
        let start = Pose::from_f64(0.0, 0.0, 0.0);
        let mut supplied = SuppliedMoves::new(10_000, MoveChecksum::default(), start);
        supplied.supply(0, moves(0..600), 0);
        assert_eq!(supplied.wants(0), None);
        assert_eq!(supplied.wants(5000), Some(4999));
        supplied.supply(4999, moves(4999..5600), 0);
        assert_eq!(here(&supplied), 4999..5600);
        assert_eq!(supplied.wants(5000), None);
        // Back again: what was on its way is lost.
        assert_eq!(supplied.wants(4998), Some(4997));
    }
}
