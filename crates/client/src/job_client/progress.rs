//! Count of what a machine has taken and played of a job.

use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{AnyMove, Command, Move, PathPiece, Status, Transmit};

/// Work of a job.
#[derive(Clone, Debug)]
pub enum JobWork<N: Transmit> {
    /// Moves.
    Moves(Vec<AnyMove<N>>),
    /// A path that the machine plans itself.
    Path {
        /// Pose at its start.
        start: Pose<N>,
        /// Pieces, the last one marked.
        pieces: Vec<PathPiece<N>>,
    },
}

impl<N: Transmit> From<Vec<AnyMove<N>>> for JobWork<N> {
    fn from(moves: Vec<AnyMove<N>>) -> Self {
        Self::Moves(moves)
    }
}

/// Numbers by which a machine calls the first move and the first piece of a job.
#[derive(Clone, Copy, Debug)]
struct Base {
    r#move: u32,
    piece: u32,
}

/// A job, and the part of it that the machine has. Its items are its moves, or its pieces.
#[derive(Clone, Debug)]
pub(super) struct JobProgress<N: Transmit> {
    work: JobWork<N>,
    /// Known from the first status on.
    base: Option<Base>,
    /// Items that the machine has taken.
    offered: u32,
    /// Items that the machine would still take, as far as known.
    room: u8,
}

impl<N: Transmit> JobProgress<N> {
    pub(super) fn new(work: JobWork<N>) -> Self {
        Self {
            work,
            base: None,
            offered: 0,
            room: 0,
        }
    }

    /// Returns the number of items of the job.
    pub(super) fn items(&self) -> u32 {
        // A machine counts them in 32 bits.
        match &self.work {
            JobWork::Moves(moves) => moves.len() as u32,
            JobWork::Path { pieces, .. } => pieces.len() as u32,
        }
    }

    /// Returns true if the machine plans the moves.
    pub(super) fn is_path(&self) -> bool {
        matches!(self.work, JobWork::Path { .. })
    }

    /// Returns the number of items that the machine has taken.
    pub(super) fn offered(&self) -> u32 {
        self.offered
    }

    /// Returns what the move of `index`, counted from 0, has in common with all moves.
    pub(super) fn get(&self, index: u32) -> Option<&Move<N>> {
        self.any(index).map(AnyMove::common)
    }

    fn any(&self, index: u32) -> Option<&AnyMove<N>> {
        match &self.work {
            JobWork::Moves(moves) => moves.get(usize::try_from(index).ok()?),
            JobWork::Path { .. } => None,
        }
    }

    /// Returns the pose at the start of the job.
    pub(super) fn start(&self) -> Option<Pose<N>> {
        match &self.work {
            JobWork::Moves(moves) => moves.first().map(|each| each.common().from),
            JobWork::Path { start, .. } => Some(*start),
        }
    }

    /// Returns the index of the move that the machine calls `number`.
    pub(super) fn index(&self, number: u32) -> Option<u32> {
        let index = number.wrapping_sub(self.base?.r#move);
        let most = match self.is_path() {
            true => u32::MAX / 2,
            false => self.items(),
        };
        (index < most).then_some(index)
    }

    /// Returns the items played to their end. Pieces count when all are.
    pub(super) fn done(&self, status: &Status<N>) -> u32 {
        let moves = self.moves_done(status);
        match self.is_path() {
            false => moves,
            true => {
                let all = self.taken(status) == self.items();
                let over = all && !status.planning && status.done == status.next;
                if over { self.items() } else { 0 }
            }
        }
    }

    /// Returns the moves played to their end.
    pub(super) fn moves_done(&self, status: &Status<N>) -> u32 {
        self.base
            .map_or(0, |base| status.done.wrapping_sub(base.r#move))
    }

    /// Returns the items that the machine says it has taken. Fewer than were there before read as a
    /// huge number.
    pub(super) fn taken(&self, status: &Status<N>) -> u32 {
        self.base.map_or(0, |base| match self.is_path() {
            false => status.next.wrapping_sub(base.r#move),
            true => status.piece.wrapping_sub(base.piece),
        })
    }

    /// Reads the room from `status`. The first status says what the items are counted from.
    pub(super) fn update(&mut self, status: &Status<N>) {
        // A machine does not say for how many pieces it has room: it refuses what it has none for.
        self.room = if self.is_path() { 1 } else { status.room };
        self.base.get_or_insert(Base {
            r#move: status.next,
            piece: status.piece,
        });
    }

    /// Lets the next status say what the items are counted from.
    pub(super) fn restart_count(&mut self) {
        self.base = None;
    }

    /// Goes on behind the items that the machine has taken.
    pub(super) fn resume_behind(&mut self, taken: u32) {
        self.offered = taken;
    }

    /// Returns the command that offers the next item, with the machine's number, if the machine has room.
    pub(super) fn next_offer(&self) -> Option<Command<N>> {
        let base = self.base?;
        match &self.work {
            JobWork::Moves(_) => {
                let next = self.any(self.offered).filter(|_| self.room > 0)?;
                Some(
                    next.numbered(base.r#move.wrapping_add(self.offered))
                        .command(),
                )
            }
            JobWork::Path { pieces, .. } => {
                let next = pieces.get(usize::try_from(self.offered).ok()?);
                let next = next.filter(|_| self.room > 0)?;
                Some(Command::Path(PathPiece {
                    number: base.piece.wrapping_add(self.offered),
                    ..*next
                }))
            }
        }
    }

    /// Offers nothing before the next status.
    pub(super) fn is_full(&mut self) {
        self.room = 0;
    }

    /// Counts an item that the machine has taken. Returns true if no other follows at once.
    pub(super) fn count_offered(&mut self) -> bool {
        self.offered += 1;
        self.room = self.room.saturating_sub(u8::from(!self.is_path()));
        self.room == 0 || self.offered == self.items()
    }
}
