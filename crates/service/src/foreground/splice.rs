//! Change-over to a chain of moves, in the middle of a move.

use super::super::handoff::{Ahead, QueuedMove};
use super::super::pace::{Room, RoomCount};
use super::super::splice::{CutOrder, Place, SpliceOrder};
use super::{Foreground, Path, TickEnds};
use crate::feature::Optional;
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, Scene};
use trirrr_protocol::message::State;

impl<N: ServiceNumber, S: Scene<N = N>, E: TickEnds<S>> Foreground<'_, S, E> {
    /// Drops a move of the common queue that was cut, and takes an order.
    #[inline]
    pub(super) fn take_splice(&mut self) {
        let Some(splices) = self.features.splices.get_mut() else {
            return;
        };
        let order = splices.take_order();
        if splices.hides_queue {
            match self.ends.next_move() {
                Some(next) if next.generation != self.job.generation => {
                    self.ends.take_move();
                }
                _ => splices.hides_queue = false,
            }
        }
        if let Some(order) = order {
            self.obey_splice(order);
        }
    }

    #[inline(never)]
    fn obey_splice(&mut self, order: SpliceOrder) {
        self.unreported = true;
        let cut = match order {
            SpliceOrder::Locate => return,
            SpliceOrder::Cut(cut) => cut,
            SpliceOrder::Withdraw => {
                let stands = self.state == State::Holding && self.travel.feed.is_at_rest();
                if let Some(splices) = self.features.splices.get_mut() {
                    splices.withdraw(stands);
                }
                return;
            }
        };
        let accepted = self.is_in_time(&cut);
        if let Some(splices) = self.features.splices.get_mut() {
            splices.accept(cut, accepted);
        }
        if accepted {
            // From now on the path leads into the chain: what counts is the room there.
            self.travel.passed = RoomCount::NOTHING;
            self.travel.part.end = self.clip(self.travel.part.end);
        }
    }

    /// Returns true if the cut is still ahead, and the path can come to rest on the chain. It gets there from wherever it stands: the
    /// background orders no other cut.
    fn is_in_time(&self, cut: &CutOrder) -> bool {
        let moves = matches!(self.state, State::Running | State::Slowing | State::Holding);
        let Some(splices) = self.features.splices.get() else {
            return false;
        };
        let is_first = splices.pending().is_none() || splices.is_withdrawn();
        let Place { number, tick } = cut.at;
        let is_ahead = match number.wrapping_sub(self.number()) as i32 {
            0 => self.travel.position.tick < tick,
            later => later > 0,
        };
        let rests = || cut.ahead.rests_from(cut.first);
        let stops = || {
            let room = |x: usize| Room::NONE.left(&cut.ahead.room, x);
            let part = self.travel.position.part;
            self.travel
                .feed
                .can_stop(self.travel.feed.steady(), part, room)
        };
        moves
            && is_first
            && is_ahead
            && self.travel.path == Path::Move
            && cut.generation == self.job.generation
            && (rests() || stops())
    }

    /// Number of the move under way, or of the last one.
    #[inline]
    pub(super) fn number(&self) -> u32 {
        self.job.begun.wrapping_sub(1)
    }

    /// A tick of the move under way, or that of the cut where it comes first.
    #[inline]
    pub(super) fn clip(&self, tick: u32) -> u32 {
        match self.features.splices.get() {
            Some(splices) => splices.clip(self.number(), tick),
            None => tick,
        }
    }

    /// Returns true while a cut is ahead: then only the room of its chain is counted.
    #[inline]
    pub(super) fn is_cut_ahead(&self) -> bool {
        self.features
            .splices
            .get()
            .is_some_and(|all| all.pending().is_some())
    }

    /// Returns true while no move can come: the queue is full, or a cut is ahead, before which none is taken. Then the path goes as fast
    /// as what there is allows.
    // Seldom asked for, from several places.
    #[inline(never)]
    pub(super) fn gets_no_more(&self) -> bool {
        let chain = self.features.splices.get().map_or(0, |all| all.len());
        let [waiting, places] = self.ends.fill();
        self.is_cut_ahead() || waiting + chain >= places
    }

    /// Cut that is ahead: none, one, or one whose chain was given back.
    #[cfg(test)]
    pub(crate) fn cut_ahead(&self) -> &'static str {
        match (self.is_cut_ahead(), self.waits_for_chain()) {
            (false, _) => "no cut",
            (_, false) => "cut",
            _ => "withdrawn",
        }
    }

    /// Returns true while the path waits for another chain in place of one that was given back.
    pub(super) fn waits_for_chain(&self) -> bool {
        self.features
            .splices
            .get()
            .is_some_and(|all| all.is_withdrawn())
    }

    /// Changes over to the chain where the move under way is cut. Returns false if it is not.
    #[inline]
    pub(super) fn change_to_chain(&mut self) -> bool {
        let number = self.number();
        let Some(splices) = self.features.splices.get_mut() else {
            return false;
        };
        if !splices.cuts(number) {
            return false;
        }
        if let Some(at) = splices.cut() {
            self.begin_chain(at.tick);
        }
        true
    }

    #[inline(never)]
    fn begin_chain(&mut self, tick: u32) {
        self.job.generation = self.job.generation.wrapping_add(1);
        // The part of a tick goes on.
        self.travel.position.tick = self.travel.position.tick.saturating_sub(tick);
        self.features.keep_move(self.travel.current.as_ref(), tick);
        self.begin_next();
        self.job.done = self.number();
        self.unreported = true;
    }

    /// The move that follows the one under way.
    #[inline]
    pub(super) fn next_move(&self) -> Option<&QueuedMove<N, CurvesOf<S>>> {
        let Some(splices) = self.features.splices.get() else {
            return self.ends.next_move();
        };
        match splices.peek(self.number()) {
            None if !splices.hides_queue => self.ends.next_move(),
            next => next,
        }
    }

    /// The same, taken out.
    #[inline]
    pub(super) fn receive_move(&mut self) -> Option<QueuedMove<N, CurvesOf<S>>> {
        let Some(splices) = self.features.splices.get_mut() else {
            return self.ends.take_move();
        };
        match splices.receive() {
            None if !splices.hides_queue => self.ends.take_move(),
            next => next,
        }
    }

    /// Account of what is admitted.
    #[inline]
    pub(super) fn ahead(&self) -> Ahead {
        let own = self.features.splices.get();
        own.and_then(|splices| splices.ahead(self.job.generation))
            .unwrap_or_else(|| self.ends.ahead())
    }
}
