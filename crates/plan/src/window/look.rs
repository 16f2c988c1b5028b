//! Cells ahead: measured one by one, and the two passes over them.

use super::numbered::{Maybe, Numbered, set};
use crate::cell::{Cell, Obstacle, Planner};
use crate::extreme::{greater, lesser, unbounded};
use crate::passes::{greatest_end, greatest_start};
use crate::piece::{Piece, PieceJoint, length};
use trirrr_core::model::Model;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_service::admission::{Enclose, Path};

/// Part of the limits that the plan uses; the rest is for what moves differ from it. The less where poses are rounded to 24
/// bits: a step is so short that this is seen in its acceleration.
const SHARE: f64 = 0.995;
const SHARE_OF_ROUNDED: f64 = 0.98;
/// The same while the motion is too fast for the plan.
const WHOLE: f64 = 0.998;
/// The same where rounding is most of the acceleration: no share is small enough there.
const SHARE_MIN: f64 = 0.5;
/// Roundings by which the poses at the ends of a step change its acceleration, times the square of the step. Within half a metre of the base
/// they are four at most, by 5.8 quarters at each end in both coordinates; longer moves have fewer. On a piece at whose end
/// the motion stops all four count: how it brakes there follows from the pace at which it comes, and no lower limit changes it.
const ROUNDINGS: [u32; 2] = [2, 4];
/// Cells on the way on which the machine brakes from the greatest pace.
const CELLS_TO_BRAKE: u32 = 8;
/// Longest cell on a piece at a stop, in p.
const AT_STOP: f64 = 0.0625;
/// The same at the stop itself, and how it grows with the distance.
const NEXT_TO_STOP: [f64; 2] = [0.02, 0.3];
/// Part of a limit that the errors of a cell may take.
const BLUR: f64 = 0.01;
/// Shortest cell, in p.
const SHORTEST: f64 = 1.0 / 4096.0;
/// Part of the greatest acceleration by which a turn may add to it.
const TURNING: f64 = 0.015;
/// Factor by which a cell may be longer than the one before.
const GROWTH: u32 = 4;

/// A piece of a path with what goes for it alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldPiece<B: Number, T> {
    pub(super) piece: Piece<B>,
    /// Greatest speed of D, if it is limited.
    pub(super) feed: Option<B>,
    pub(super) tag: T,
    /// Number by which a refusal names the piece.
    pub(super) number: u32,
    /// Place between the piece before and this one; none: the motion stops between the two.
    pub(super) joint: Option<PieceJoint<B>>,
}

/// A cell with its place and the pace that is planned.
#[derive(Clone, Debug)]
pub(super) struct Planned<B> {
    pub(super) cell: Cell<B>,
    /// Number of the piece.
    pub(super) piece: u32,
    /// p at its start.
    pub(super) from: B,
    /// Greatest x at the start where pieces meet: 0 where the motion stops there.
    most: B,
    /// x at the start: final up to the cell that is committed next.
    pub(super) square: B,
    /// Greatest x at the start from which the end can be reached.
    ceiling: B,
}

/// A pass over the cells that is under way.
#[derive(Clone, Copy, Debug)]
struct Pass<B> {
    /// Number of the cell that is next.
    index: u32,
    /// x behind the cell in the backward pass.
    behind: B,
    forward: bool,
    /// Number behind the last cell that is to be committed.
    until: u32,
}

/// Cells from the one under way to as far as the window sees.
#[derive(Clone, Debug)]
pub(super) struct Look<B, const CELLS: usize> {
    pub(super) cells: Numbered<Planned<B>, CELLS>,
    /// Cells before this one are committed: x at both of their ends is final.
    pub(super) committed: u32,
    pass: Maybe<Pass<B>>,
    /// Number of the piece that is measured, and p up to which it is.
    pub(super) piece: u32,
    pub(super) to: B,
    /// Length of the next cell, in p of that piece.
    span: B,
    /// Start, length and blur of the stretch that was measured last.
    measured: [B; 3],
    /// Length below which the errors of a cell do not fall any more.
    clear: B,
    /// Sign of det A on the path, once it is known.
    side: Maybe<bool>,
}

impl<B: Number> Planned<B> {
    /// Returns true if the motion stops at its start, however it is planned.
    pub(super) fn stops(&self) -> bool {
        self.most == B::ZERO
    }
}

impl<B: Number, const CELLS: usize> Look<B, CELLS> {
    pub(super) const fn new() -> Self {
        Self {
            cells: Numbered::new(),
            committed: 0,
            pass: Maybe::new(),
            piece: 0,
            to: B::ZERO,
            span: B::ZERO,
            measured: [B::ZERO; 3],
            clear: B::ZERO,
            side: Maybe::new(),
        }
    }

    /// Returns true if a pass is under way.
    pub(super) fn is_passing(&self) -> bool {
        !self.pass.is_empty()
    }

    /// Measures one cell of `entry`, or finds that a shorter one is needed. `stops`: the motion stops where the piece
    /// begins or ends. `step`: time from one sample of the motion to the next.
    pub(super) fn measure<M: Model<N: Enclose<Bound = B>>, T>(
        &mut self,
        planner: &Planner<M, &Path<M>>,
        entry: &HeldPiece<B, T>,
        stops: [bool; 2],
        step: B,
    ) -> Result<(), Obstacle> {
        let from = self.to;
        let left = B::ONE - from;
        // Nothing is known at the beginning.
        let mut span = if self.span > B::ZERO {
            lesser(self.span, left)
        } else {
            left
        };
        if stops[0] || stops[1] {
            let [least, growth] = NEXT_TO_STOP.map(B::from_f64);
            span = lesser(span, B::from_f64(AT_STOP));
            if stops[0] {
                span = lesser(span, least + growth * from);
            }
            if stops[1] {
                span = lesser(span, (least + growth * left).div(B::ONE + growth));
            }
        }
        // What would be left behind it is no cell. From rest to rest it takes two.
        let rests = self.committed == self.cells.end();
        if left - span < B::HALF * span {
            span = match span < left || rests {
                true => B::HALF * left,
                false => left,
            };
        }
        let whole = !(span < left);
        let to = if whole { B::ONE } else { from + span };
        match self.try_measure(planner, entry, [from, to], stops[1], step) {
            Ok(Ok((mut cell, rate))) => {
                let most = match (from == B::ZERO, entry.joint) {
                    (false, _) => unbounded(),
                    (true, None) => B::ZERO,
                    (true, Some(joint)) => {
                        cell.join(joint.scale);
                        most_at(&joint, rate, step)
                    }
                };
                self.cells.push(Planned {
                    cell,
                    piece: self.piece,
                    from,
                    most,
                    square: B::ZERO,
                    ceiling: B::ZERO,
                });
                self.to = to;
                Ok(())
            }
            Ok(Err(shorter)) => {
                self.span = shorter;
                Ok(())
            }
            Err(obstacle) => match span > B::from_f64(SHORTEST) {
                true => {
                    self.span = B::HALF * span;
                    self.clear = B::ZERO;
                    Ok(())
                }
                false => Err(obstacle),
            },
        }
    }

    /// Measures the stretch `ends` of a piece at whose end the motion `stops` or not, with about the greatest acceleration along it; the
    /// inner error is a length that suits it better.
    fn try_measure<M: Model<N: Enclose<Bound = B>>, T>(
        &mut self,
        planner: &Planner<M, &Path<M>>,
        entry: &HeldPiece<B, T>,
        ends: [B; 2],
        stops: bool,
        step: B,
    ) -> Result<Result<(Cell<B>, B), B>, Obstacle> {
        let mut cell = self.cell(planner, entry, ends)?;
        let span = cell.length;
        let Reach { square, rate, blur } = Reach::of(&cell);
        let braking = square.div(rate + rate);
        // The samples see nothing of what is much shorter than they are apart.
        let seen = B::HALF * step * square.sqrt();
        let [known_from, known_span, known_blur] = self.measured;
        let is_shorter = ends[0] == known_from && span < known_span * B::ratio(1, 4);
        if is_shorter && blur > known_blur * B::ratio(3, 4) {
            // Rounding: the errors stay, however short a cell is.
            self.clear = span;
        }
        self.measured = [ends[0], span, blur];
        let clear = span * B::from_f64(BLUR).div(blur + B::from_f64(1e-3 * BLUR));
        let suited = lesser(
            greater(braking.div(B::ratio(CELLS_TO_BRAKE, 1)), seen),
            greater(clear, self.clear),
        );
        let shortest = B::from_f64(SHORTEST);
        if suited + suited < span && span > shortest + shortest && square > B::ZERO {
            return Ok(Err(greater(suited, shortest)));
        }
        self.span = lesser(suited, span * B::ratio(GROWTH, 1));
        let middle = B::HALF * (ends[0] + ends[1]);
        let acceleration = rate * length(entry.piece.at(middle).first);
        let noise = B::UNIT_ROUNDOFF * B::ratio(ROUNDINGS[usize::from(stops)], 1);
        leave_room(&mut cell, noise.div(acceleration * step * step));
        cell.reserve(planner.ramp());
        Ok(Ok((cell, rate)))
    }

    /// Measures the stretch `ends`.
    fn cell<M: Model<N: Enclose<Bound = B>>, T>(
        &mut self,
        planner: &Planner<M, &Path<M>>,
        entry: &HeldPiece<B, T>,
        ends: [B; 2],
    ) -> Result<Cell<B>, Obstacle> {
        let models = entry.piece.models();
        let mut side = self.side.first().copied();
        let measured = planner.measure(&models, ends, entry.feed, &mut side);
        if let Some(side) = side {
            set(&mut self.side, side);
        }
        Ok(measured?.cell())
    }

    /// Goes on to the next piece, whose p is `scale` of that of the last.
    pub(super) fn next_piece(&mut self, scale: B) {
        self.piece = self.piece.wrapping_add(1);
        self.to = B::ZERO;
        self.span = lesser(self.span * scale, B::ONE);
        (self.measured, self.clear) = ([B::ZERO; 3], B::ZERO);
    }

    /// Drops the cells of piece `piece`, the last one, if the motion can stop before them.
    pub(super) fn leave_out(&mut self, piece: u32) {
        let mut first = self.cells.end();
        let is_of_piece = |number: u32| {
            let before = self.cells.get(number.wrapping_sub(1));
            before.is_some_and(|cell| cell.piece == piece)
        };
        while first != self.committed && is_of_piece(first) {
            first = first.wrapping_sub(1);
        }
        // Where no other cell waits, it stops there only if it has come to rest.
        let rests = self
            .cells
            .get(first)
            .is_none_or(|cell| cell.square == B::ZERO);
        if first != self.committed || rests {
            self.cells.truncate(first);
        }
    }

    /// Measures the rest of cell `number` from p = `at` again, as its first part is played already.
    pub(super) fn shorten<M: Model<N: Enclose<Bound = B>>, T>(
        &mut self,
        planner: &Planner<M, &Path<M>>,
        entry: &HeldPiece<B, T>,
        number: u32,
        at: B,
        square: B,
    ) -> Result<(), Obstacle> {
        let Some(planned) = self.cells.get(number) else {
            return Ok(());
        };
        let begins = planned.from + at;
        let to = planned.from + planned.cell.length;
        let rest = match begins < to && at > B::ZERO {
            true => Some(self.cell(planner, entry, [begins, to])?),
            false => None,
        };
        let Some(planned) = self.cells.get_mut(number) else {
            return Ok(());
        };
        if let Some(rest) = rest {
            planned.cell.limits = rest.limits;
            planned.cell.length = to - begins;
            planned.from = begins;
        }
        planned.square = square;
        planned.most = unbounded();
        planned.cell.join(B::ONE);
        self.committed = number;
        self.pass.clear();
        Ok(())
    }

    /// Returns true if another cell can be measured.
    pub(super) fn has_room(&self) -> bool {
        self.cells.has_room()
    }

    /// Begins to commit cells: all, or those in the first half of the window. The motion can stop in the other half, and only
    /// there: where it is all that is left, cells have to come before others are committed. Returns false if there are none.
    pub(super) fn commit(&mut self, all: bool) -> bool {
        let end = self.cells.end();
        let held = end.wrapping_sub(self.cells.first());
        let stays = if all { 0 } else { held / 2 };
        self.commit_but(stays)
    }

    /// Begins to commit half of the cells that are left, and the last one at last: the motion stops behind it. Returns false if
    /// there is none.
    pub(super) fn commit_half(&mut self) -> bool {
        self.commit_but(self.cells.end().wrapping_sub(self.committed) / 2)
    }

    fn commit_but(&mut self, stays: u32) -> bool {
        let end = self.cells.end();
        let waits = end.wrapping_sub(self.committed);
        let commits = waits > stays;
        if commits {
            self.begin_pass(end.wrapping_sub(stays));
        }
        commits
    }

    /// Begins the passes over the cells that are not committed, to commit those before `until`.
    pub(super) fn begin_pass(&mut self, until: u32) {
        let pass = Pass {
            index: self.cells.end(),
            behind: B::ZERO,
            forward: false,
            until,
        };
        set(&mut self.pass, pass);
    }

    /// One cell of the pass that is under way.
    pub(super) fn pass_step(&mut self) {
        let Some(mut pass) = self.pass.pop() else {
            return;
        };
        if !pass.forward {
            if pass.index != self.committed {
                pass.index = pass.index.wrapping_sub(1);
                if let Some(planned) = self.cells.get_mut(pass.index) {
                    let guess = planned.ceiling;
                    let reached = greatest_start(&planned.cell, pass.behind, guess);
                    planned.ceiling = lesser(reached, planned.most);
                    pass.behind = planned.ceiling.div(planned.cell.joint);
                }
            } else {
                pass.forward = true;
            }
            set(&mut self.pass, pass);
            return;
        }
        if pass.index == pass.until {
            self.committed = pass.until;
            return;
        }
        let next = pass.index.wrapping_add(1);
        let [ceiling, joint] = match self.cells.get(next) {
            Some(next) => [next.ceiling, next.cell.joint],
            None => [B::ZERO, B::ONE],
        };
        if let Some(end) = self.reached(pass.index, ceiling.div(joint))
            && let Some(planned) = self.cells.get_mut(next)
        {
            planned.square = end * joint;
        }
        pass.index = next;
        set(&mut self.pass, pass);
    }

    /// Greatest x at the end of cell `number`, at most `cap`, unless the motion is too fast for the plan: limits that moves have
    /// lowered behind its start. Then it brakes by all that the limits leave, and no harder, until it is as slow as the plan.
    fn reached(&mut self, number: u32, cap: B) -> Option<B> {
        let planned = self.cells.get_mut(number)?;
        let least = planned.ceiling + planned.ceiling * B::ratio(1, 1024);
        let is_too_fast = planned.square > least && cap > B::ZERO;
        let share = planned.cell.share;
        if is_too_fast {
            planned.cell.share = greater(share, B::from_f64(WHOLE));
        }
        let end = greatest_end(&planned.cell, planned.square, cap);
        planned.cell.share = share;
        Some(if is_too_fast { end } else { lesser(end, cap) })
    }

    /// x at the end of cell `number`, which is committed.
    pub(super) fn end_square(&self, number: u32) -> B {
        match self.cells.get(number.wrapping_add(1)) {
            Some(next) => next.square.div(next.cell.joint),
            None => B::ZERO,
        }
    }

    /// Lowers the limits of the cells from `from` to `to`, both included, to `share` of what the passes use now.
    pub(super) fn tighten(&mut self, [from, to]: [u32; 2], share: B) {
        let mut number = from;
        while let Some(planned) = self.cells.get_mut(number) {
            planned.cell.tighten(share);
            planned.cell.apply_tightening();
            if number == to {
                return;
            }
            number = number.wrapping_add(1);
        }
    }
}

/// Greatest x at the start of a piece with about the greatest acceleration `rate`. The motion takes the turn at its joint on the length of
/// the piece, and between two samples, `step` apart, by a part of `rate`.
fn most_at<B: Number>(joint: &PieceJoint<B>, rate: B, step: B) -> B {
    let PieceJoint { scale, turn } = *joint;
    if !(turn > B::ZERO) {
        return unbounded();
    }
    // In parts of the piece: the shorter of the two.
    let shorter = lesser(scale.sqrt(), B::ONE);
    let pace = (B::from_f64(TURNING) * rate * step).div(turn);
    lesser((rate * shorter).div(turn), pace * pace)
}

/// Leaves the part of the limits that moves need beside the plan, where rounding is the part `noise` of the acceleration.
fn leave_room<B: Number>(cell: &mut Cell<B>, noise: B) {
    let is_rounded = B::UNIT_ROUNDOFF > B::from_f64(1e-12);
    let most = B::from_f64(if is_rounded { SHARE_OF_ROUNDED } else { SHARE });
    let share = lesser(most, B::from_f64(SHARE) - noise);
    cell.tighten(greater(share, B::from_f64(SHARE_MIN)));
    cell.apply_tightening();
}

/// Size of what a cell allows.
struct Reach<B> {
    /// About the greatest x.
    square: B,
    /// About the greatest acceleration along the path.
    rate: B,
    /// Part of a limit that the errors of the coefficients take then.
    blur: B,
}

impl<B: Arithmetic> Reach<B> {
    fn of(cell: &Cell<B>) -> Self {
        let (mut square, mut rate) = (unbounded(), unbounded());
        let all = || cell.limits.rows.iter();
        for row in all() {
            let room = row.limit - row.rest.magnitude();
            square = lesser(square, room.div(row.square.constant.abs()));
            if let Some(acceleration) = row.acceleration {
                rate = lesser(rate, room.div(acceleration.constant.abs()));
            }
        }
        let mut blur = B::ZERO;
        for row in all() {
            let room = row.limit - row.rest.magnitude();
            let error = row.acceleration.map_or(B::ZERO, |line| line.error * rate);
            let error = error + row.square.error * square + row.rest.error;
            blur = greater(blur, error.div(room));
        }
        Self { square, rate, blur }
    }
}
