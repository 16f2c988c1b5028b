//! Count of the moves that a machine has taken and played.

use trirrr_protocol::message::{AnyMove, Move, Status, Transmit};

/// Moves of a job, and the part of them that the machine has.
#[derive(Clone, Debug)]
pub(super) struct JobProgress<N: Transmit> {
    moves: Vec<AnyMove<N>>,
    /// Number by which the machine calls the first move; known from the first status on.
    base: Option<u32>,
    /// Moves that the machine has taken.
    offered: u32,
    /// Moves that the machine would still take, as far as known.
    room: u8,
}

impl<N: Transmit> JobProgress<N> {
    pub(super) fn new(moves: Vec<AnyMove<N>>) -> Self {
        Self {
            moves,
            base: None,
            offered: 0,
            room: 0,
        }
    }

    /// Returns the number of moves of the job.
    pub(super) fn moves(&self) -> u32 {
        // A machine counts them in 32 bits.
        self.moves.len() as u32
    }

    /// Returns the number of moves that the machine has taken.
    pub(super) fn offered(&self) -> u32 {
        self.offered
    }

    /// Returns what the move of `index`, counted from 0, has in common with all moves.
    pub(super) fn get(&self, index: u32) -> Option<&Move<N>> {
        self.any(index).map(AnyMove::common)
    }

    fn any(&self, index: u32) -> Option<&AnyMove<N>> {
        self.moves.get(usize::try_from(index).ok()?)
    }

    /// Returns the index of the move that the machine calls `number`.
    pub(super) fn index(&self, number: u32) -> Option<u32> {
        let index = number.wrapping_sub(self.base?);
        (index < self.moves()).then_some(index)
    }

    /// Returns the moves played to their end.
    pub(super) fn done(&self, status: &Status<N>) -> u32 {
        self.base.map_or(0, |base| status.done.wrapping_sub(base))
    }

    /// Returns the moves that the machine says it has taken. Fewer than were there before read as a
    /// huge number.
    pub(super) fn taken(&self, status: &Status<N>) -> u32 {
        self.base.map_or(0, |base| status.next.wrapping_sub(base))
    }

    /// Reads the room from `status`. The first status says what the moves are counted from.
    pub(super) fn update(&mut self, status: &Status<N>) {
        self.room = status.room;
        self.base.get_or_insert(status.next);
    }

    /// Lets the next status say what the moves are counted from.
    pub(super) fn restart_count(&mut self) {
        self.base = None;
    }

    /// Goes on behind the moves that the machine has taken.
    pub(super) fn resume_behind(&mut self, taken: u32) {
        self.offered = taken;
    }

    /// Returns the next move to offer, with the machine's number, if the machine has room.
    pub(super) fn next_move(&self) -> Option<AnyMove<N>> {
        let next = self.any(self.offered).filter(|_| self.room > 0)?;
        Some(next.numbered(self.base?.wrapping_add(self.offered)))
    }

    /// Counts a move that the machine has taken. Returns true if no other follows at once.
    pub(super) fn count_offered(&mut self) -> bool {
        self.offered += 1;
        self.room = self.room.saturating_sub(1);
        self.room == 0 || self.offered == self.moves()
    }
}
