//! Count of what a machine has taken and played of a job.

use super::levels::{GivenLevels, NextLevels};
use super::supply::SuppliedMoves;
use super::work::JobWork;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_protocol::message::{
    AnyMove, BATCH, Command, JobAccount, ListedMove, Move, MoveBatch, OfferedMoves, OutputSwitch,
    PathPiece, Status, Transmit,
};
use trirrr_scene::JobOutputs;

/// Changes of outputs that a client gives ahead of their moves: a machine has room for more.
const CHANGES: usize = 12;

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
    /// Moves that are over, as far as known.
    over: u32,
    /// Levels that were given.
    given: GivenLevels,
    /// Outputs that change with moves,
    outputs: JobOutputs,
    /// and the item whose change was given last.
    switched: Option<u32>,
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
            over: 0,
            given: GivenLevels::default(),
            outputs: JobOutputs::default(),
            switched: None,
        }
    }

    /// Sets the outputs that change with moves.
    pub(super) fn set_outputs(&mut self, outputs: &JobOutputs) {
        self.outputs = outputs.clone();
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
        let (moves, first) = self.work.here()?;
        moves.get(usize::try_from(index.checked_sub(first)?).ok()?)
    }

    /// Returns the moves of a job that are supplied as it goes on.
    pub(super) fn supplied(&self) -> Option<&SuppliedMoves<N>> {
        match &self.work {
            JobWork::Supplied(moves) => Some(moves),
            JobWork::Moves(_) | JobWork::Listed { .. } | JobWork::Path { .. } => None,
        }
    }

    /// The same, to change.
    pub(super) fn supplied_mut(&mut self) -> Option<&mut SuppliedMoves<N>> {
        match &mut self.work {
            JobWork::Supplied(moves) => Some(moves),
            JobWork::Moves(_) | JobWork::Listed { .. } | JobWork::Path { .. } => None,
        }
    }

    /// Returns the number of items that were offered.
    pub(super) fn has_offered(&self) -> u32 {
        self.offered
    }

    /// Returns the pose at the start of the job.
    pub(super) fn start(&self) -> Option<Pose<N>> {
        match &self.work {
            JobWork::Supplied(moves) => Some(moves.start()),
            JobWork::Path { start, .. } => Some(*start),
            JobWork::Moves(moves) | JobWork::Listed { moves, .. } => {
                moves.first().map(|each| each.common().from)
            }
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
        self.over = self.moves_done(status).min(self.items());
        let mut next = status.next;
        for moves in flying {
            // Those before the next are in the status already.
            if moves.number == next {
                next = moves.next();
            }
        }
        self.flying = next.wrapping_sub(status.next);
        self.room = match self.is_path() {
            // A machine does not say for how many pieces it has room: it refuses what it has none for. It plans none while its queue
            // of moves is full, and takes none before long.
            true => u16::from(status.room > 0),
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
        // A change may not have come: of two for one move the last counts, and they are the same.
        self.switched = None;
    }

    /// Returns the command that offers the next items, with the machine's numbers, if the machine has room.
    pub(super) fn next_offer(&self) -> Option<Command<N>> {
        let base = self.base.filter(|_| self.room > 0)?;
        let number = base.r#move.wrapping_add(self.offered);
        if let Some(bits) = self.outputs.get(self.offered)
            && !self.is_path()
            && self.switched != Some(self.offered)
        {
            // That under way does not count, but is not known.
            let waits = self.outputs.count(self.over, self.offered);
            return (waits < CHANGES).then_some(Command::OutputsAt(OutputSwitch {
                number,
                on: bits.on,
                off: bits.off,
            }));
        }
        match &self.work {
            JobWork::Moves(_) | JobWork::Supplied(_) => {
                let (moves, first) = self.work.here()?;
                let index = usize::try_from(self.offered.checked_sub(first)?).ok()?;
                self.next_moves(moves, index, number, moves.len())
            }
            JobWork::Listed { moves, levels } => {
                let index = usize::try_from(self.offered).ok()?;
                // The next move with levels: a batch ends before it.
                let behind = levels.ranges.partition_point(|(of, _)| *of < self.offered);
                match levels.ranges.get(behind) {
                    Some((of, range)) if *of == self.offered => {
                        let span = self.over..self.offered;
                        match self.given.next(levels, range, span)? {
                            NextLevels::Piece(piece) => Some(Command::Levels(piece)),
                            NextLevels::Given(range) => {
                                let next = moves.get(index)?;
                                let start = match index.checked_sub(1) {
                                    Some(before) => moves.get(before)?.end(),
                                    None => at_rest(next.common().from),
                                };
                                let listed = ListedMove::new(number, &start, next, range);
                                Some(Command::Listed(listed))
                            }
                        }
                    }
                    next => {
                        let end = next.map_or(moves.len(), |(of, _)| *of as usize);
                        self.next_moves(moves, index, number, end)
                    }
                }
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
        // A batch ends before a move with which outputs change.
        let switched = self.outputs.next_behind(self.offered);
        let behind = switched.map_or(usize::MAX, |of| index + (of - self.offered) as usize);
        let end = end.min(behind);
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

    /// Sets the levels for which the machine has room.
    pub(super) fn set_level_room(&mut self, room: u16) {
        self.given.set_room(room);
    }

    /// The machine has taken levels.
    pub(super) fn confirm_levels(&mut self) {
        self.given.confirm();
    }

    /// Gives levels from that on which the machine calls `number`; where it calls none of the job so, those of the next move by the numbers
    /// from there on.
    pub(super) fn go_back_to_level(&mut self, number: u32) {
        if let Some(levels) = self.work.levels() {
            self.given.go_back(number, levels.first_from(self.taken));
        }
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
            None => match command {
                Command::Levels(piece) => self.given.count(piece),
                Command::OutputsAt(_) => self.switched = Some(self.offered),
                _ => self.offered = self.offered.wrapping_add(1),
            },
        }
    }

    /// Counts what the machine has taken.
    pub(super) fn count_taken(&mut self, command: &Command<N>) {
        if matches!(command, Command::OutputsAt(_)) {
            return;
        }
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
        self.room == 0
            || self.offered == self.items()
            || (self.next_offer().is_none()
                && (self.work.levels().is_some() || !self.outputs.is_empty()))
    }
}

/// The setpoint of a machine that stands at `pose`.
fn at_rest<N: Transmit>(pose: Pose<N>) -> Setpoint<N> {
    AnyMove::Cubic(Move::rest_to_rest(0, pose, pose, 1)).end()
}
