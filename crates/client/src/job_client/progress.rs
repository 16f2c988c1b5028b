//! Count of what a machine has taken and played of a job.

use super::supply::{MoveChecksum, SuppliedMoves};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{
    AnyMove, BATCH, Command, JobAccount, JobLabel, Move, MoveBatch, OfferedMoves, PathPiece,
    Status, Transmit,
};
use trirrr_protocol::wire::checksum;

/// Work of a job.
#[derive(Clone, Debug)]
pub enum JobWork<N: Transmit> {
    /// Moves.
    Moves(Vec<AnyMove<N>>),
    /// Moves that the owner of the client supplies as the job goes on.
    Supplied(SuppliedMoves<N>),
    /// A path that the machine plans itself.
    Path {
        /// Pose at its start.
        start: Pose<N>,
        /// Pieces, the last one marked.
        pieces: Vec<PathPiece<N>>,
    },
}

impl<N: Transmit> JobWork<N> {
    /// Returns the number of items: moves, or pieces.
    pub fn items(&self) -> u32 {
        // A machine counts them in 32 bits.
        match self {
            Self::Moves(moves) => moves.len() as u32,
            Self::Supplied(moves) => moves.items(),
            Self::Path { pieces, .. } => pieces.len() as u32,
        }
    }

    /// Returns the label of the job under `name`. Its checksum is over all items.
    pub fn label(&self, name: &str) -> JobLabel {
        // Every part has a length that is known beforehand.
        let add = |sum: u32, part: Option<u32>| checksum(&(sum, part)).unwrap_or_default();
        let check = match self {
            Self::Moves(moves) => {
                let mut check = MoveChecksum::default();
                moves.iter().for_each(|each| check.add(each));
                check.value()
            }
            Self::Supplied(moves) => moves.check().value(),
            Self::Path { pieces, .. } => pieces.iter().map(checksum).fold(0, add),
        };
        JobLabel {
            name: trirrr_service::name(name),
            items: self.items(),
            check,
        }
    }
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
    /// Items that were offered,
    offered: u32,
    /// those of them that the machine has taken, as far as known,
    taken: u32,
    /// and moves that were on their way to it at the last status.
    flying: u32,
    /// Items that the machine would still take, as far as known.
    room: u16,
    /// Most moves in a batch.
    batch: usize,
}

impl<N: Transmit> JobProgress<N> {
    pub(super) fn new(work: JobWork<N>) -> Self {
        Self {
            work,
            base: None,
            offered: 0,
            taken: 0,
            flying: 0,
            room: 0,
            batch: 1,
        }
    }

    /// Returns the number of items of the job.
    pub(super) fn items(&self) -> u32 {
        self.work.items()
    }

    /// Returns true if the machine plans the moves.
    pub(super) fn is_path(&self) -> bool {
        matches!(self.work, JobWork::Path { .. })
    }

    /// Returns the number of items that the machine has taken, as far as known.
    pub(super) fn has_taken(&self) -> u32 {
        self.taken
    }

    /// Sets the most moves that the machine takes in a batch.
    pub(super) fn set_batch(&mut self, batch: u8) {
        self.batch = usize::from(batch).clamp(1, BATCH);
    }

    /// Returns what the move of `index`, counted from 0, has in common with all moves.
    pub(super) fn get(&self, index: u32) -> Option<&Move<N>> {
        self.any(index).map(AnyMove::common)
    }

    fn any(&self, index: u32) -> Option<&AnyMove<N>> {
        let (moves, first) = self.here()?;
        moves.get(usize::try_from(index.checked_sub(first)?).ok()?)
    }

    /// The moves that the client has, and the index of the first; none of a path.
    fn here(&self) -> Option<(&[AnyMove<N>], u32)> {
        match &self.work {
            JobWork::Moves(moves) => Some((moves, 0)),
            JobWork::Supplied(moves) => Some(moves.here()),
            JobWork::Path { .. } => None,
        }
    }

    /// Returns the moves of a job that are supplied as it goes on.
    pub(super) fn supplied(&self) -> Option<&SuppliedMoves<N>> {
        match &self.work {
            JobWork::Supplied(moves) => Some(moves),
            JobWork::Moves(_) | JobWork::Path { .. } => None,
        }
    }

    /// The same, to change.
    pub(super) fn supplied_mut(&mut self) -> Option<&mut SuppliedMoves<N>> {
        match &mut self.work {
            JobWork::Supplied(moves) => Some(moves),
            JobWork::Moves(_) | JobWork::Path { .. } => None,
        }
    }

    /// Returns the number of items that were offered.
    pub(super) fn has_offered(&self) -> u32 {
        self.offered
    }

    /// Returns the pose at the start of the job.
    pub(super) fn start(&self) -> Option<Pose<N>> {
        match &self.work {
            JobWork::Moves(moves) => moves.first().map(|each| each.common().from),
            JobWork::Supplied(moves) => Some(moves.start()),
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

    /// Takes in a status. The first one says what the items are counted from. `flying` are the moves that were offered behind the
    /// question for it, oldest first.
    pub(super) fn update(
        &mut self,
        status: &Status<N>,
        flying: impl Iterator<Item = OfferedMoves>,
    ) {
        self.base.get_or_insert(Base {
            r#move: status.next,
            piece: status.piece,
        });
        let mut next = status.next;
        for moves in flying {
            // Those before the next are in the status already.
            if moves.number == next {
                next = moves.next();
            }
        }
        self.flying = next.wrapping_sub(status.next);
        self.room = match self.is_path() {
            // A machine does not say for how many pieces it has room: it refuses what it has none for.
            true => 1,
            false => status.room.saturating_sub(self.flying as u16),
        };
    }

    /// Counts the items as the machine does since the job was named.
    pub(super) fn count_from(&mut self, job: &JobAccount) {
        self.base = Some(Base {
            r#move: job.first_move,
            piece: job.first_piece,
        });
    }

    /// Lets the next status say what the items are counted from.
    pub(super) fn restart_count(&mut self) {
        self.base = None;
    }

    /// Goes on behind the items that the machine has taken, and those on their way to it.
    pub(super) fn resume_behind(&mut self, taken: u32) {
        self.taken = taken;
        self.offered = taken.wrapping_add(self.flying);
    }

    /// Returns the command that offers the next items, with the machine's numbers, if the machine has room.
    pub(super) fn next_offer(&self) -> Option<Command<N>> {
        let base = self.base.filter(|_| self.room > 0)?;
        let number = base.r#move.wrapping_add(self.offered);
        match &self.work {
            JobWork::Moves(_) | JobWork::Supplied(_) => {
                let (moves, first) = self.here()?;
                let index = usize::try_from(self.offered.checked_sub(first)?).ok()?;
                self.next_moves(moves, index, number, moves.len())
            }
            JobWork::Path { pieces, .. } => Some(Command::Path(PathPiece {
                number: base.piece.wrapping_add(self.offered),
                ..*pieces.get(usize::try_from(self.offered).ok()?)?
            })),
        }
    }

    /// The command that offers moves from `index` on, before `end`.
    fn next_moves(
        &self,
        moves: &[AnyMove<N>],
        index: usize,
        number: u32,
        end: usize,
    ) -> Option<Command<N>> {
        let next = moves.get(index)?;
        let before = index.checked_sub(1).and_then(|index| moves.get(index));
        let most = self.batch.min(usize::from(self.room));
        let behind = moves.get(index..end)?;
        let behind = behind.get(..most).unwrap_or(behind);
        let batch = before.map(|before| MoveBatch::new(number, &before.end(), behind));
        // A single move says where it starts, which may not be where the last one ends.
        let batch = batch.filter(|batch| batch.steps().count() > 1);
        Some(match batch {
            Some(batch) => Command::Moves(batch),
            None => next.numbered(number).command(),
        })
    }

    /// Offers nothing before the next status.
    pub(super) fn is_full(&mut self) {
        self.room = 0;
    }

    /// Counts what was offered.
    pub(super) fn count_offered(&mut self, command: &Command<N>) {
        match command.offered() {
            Some(moves) => {
                self.offered = self.offered.wrapping_add(moves.count);
                self.room = self.room.saturating_sub(moves.count as u16);
            }
            None => self.offered = self.offered.wrapping_add(1),
        }
    }

    /// Counts what the machine has taken.
    pub(super) fn count_taken(&mut self, command: &Command<N>) {
        let end = match (command.offered(), self.base) {
            (Some(moves), Some(base)) => moves.next().wrapping_sub(base.r#move),
            _ => self.taken + 1,
        };
        if end <= self.items() {
            self.taken = self.taken.max(end);
        }
    }

    /// Returns true if nothing can be offered before the next status.
    pub(super) fn waits(&self) -> bool {
        self.room == 0 || self.offered == self.items()
    }
}
