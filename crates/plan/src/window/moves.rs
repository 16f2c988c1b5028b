//! Moves of a window: made, kept, cut.

use super::law::{Cursor, STANDING};
use super::numbered::set;
use super::{Draft, Outlook, Sample, Window, WindowMove, WindowRefusal};
use crate::cell::Obstacle;
use crate::extreme::greater;
use crate::fit::{Fit, MARGIN, Motion, ends, rest, size, smoothed};
use nalgebra::Vector2;
use trirrr_core::model::Model;
use trirrr_core::number::{Arithmetic, Number, WideArithmetic};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_service::admission::{Enclose, Path};

/// Part of the feed by which a move may be faster than the motion, which leaves a little more of it.
const FASTER: f64 = 2e-3;
/// Times that the limits of cells are lowered for one move.
const STRIKES: u32 = 12;
/// Steps of the last move to a stop at least, where there are as many.
const LAST: u32 = 3;

/// Steps from the second sample up to which moves can be made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Until<B: Number> {
    pub(super) steps: u32,
    /// The pose at which the motion rests there.
    pub(super) rest: Option<Pose<B>>,
}

impl<N: Enclose, T: Copy + PartialEq, const PIECES: usize, const CELLS: usize>
    Window<N, T, PIECES, CELLS>
{
    /// None if more samples are needed.
    pub(super) fn until(&self) -> Option<Until<N::Bound>> {
        let count = self.samples.len() as u32;
        let rests = self.samples.iter().skip(2).position(|sample| sample.rests);
        // The smoothed motion asks for the sample behind it, too.
        if let Some(index) = rests.filter(|index| *index as u32 + 3 < count) {
            let rest = self.samples.get(index + 2)?;
            return Some(Until {
                steps: index as u32 + 1,
                rest: Some(rest.pose),
            });
        }
        let steps = count.saturating_sub(3);
        (steps >= self.settings.longest).then_some(Until { steps, rest: None })
    }

    /// Makes the longest move that follows the motion. It takes whole steps: that of one step is the motion itself.
    pub(super) fn fit(&mut self, until: Until<N::Bound>) -> Outlook<N::Bound, T> {
        let settings = &self.settings;
        // Of poses within a metre or so of the base.
        let noise =
            (N::Bound::UNIT_ROUNDOFF + N::Bound::UNIT_ROUNDOFF).div(settings.step * settings.step);
        let fit = Fit {
            period: N::Bound::ONE.div(settings.period).reciprocal(),
            tolerances: settings.tolerances,
            lever: settings.lever,
            faster: N::Bound::from_f64(FASTER),
            noise,
            largest: self.largest(),
        };
        let Some(state) = self.state else {
            return Outlook::Waiting;
        };
        let mut steps = self.steps_of_tag(self.longest.min(until.steps));
        loop {
            // The last move to a stop is no shorter than can be changed: its second pose is given.
            let left = until.steps - steps;
            if until.rest.is_some() && left > 0 && left < LAST && until.steps > LAST {
                steps = until.steps - LAST;
            }
            let ticks = steps * self.settings.ticks;
            let end = match until.rest.filter(|_| steps == until.steps) {
                Some(pose) => rest(pose),
                None => self.at(8 * ticks),
            };
            let states = [state, end];
            if steps <= 1 || fit.difference(self, [0, ticks], &states) <= N::Bound::ONE {
                self.draft = Some(Draft { steps, end });
                let tag = self.samples.get(steps as usize / 2 + 1);
                let tag = tag.and_then(|sample| self.pieces.get(sample.piece));
                return match tag {
                    Some(entry) => Outlook::Move(WindowMove {
                        ends: ends(&states),
                        ticks,
                        tag: entry.tag,
                    }),
                    None => Outlook::Waiting,
                };
            }
            steps = (steps * 3 / 4).max(1);
        }
    }

    /// Returns `most` steps, or as many as there are until the tag changes, at least 1: a move ends there.
    fn steps_of_tag(&self, most: u32) -> u32 {
        let piece = |step: u32| self.sample_at(step + 1).map(|sample| sample.piece);
        let first = piece(0);
        let tag = |number: Option<u32>| {
            let entry = number.and_then(|number| self.pieces.get(number));
            entry.map(|entry| entry.tag)
        };
        let changes = |&step: &u32| {
            let here = piece(step);
            here != first && tag(here) != tag(first)
        };
        // Pieces follow one another: where the last is the first, no other lies between.
        match piece(most) == first {
            true => most,
            false => (1..=most)
                .find(changes)
                .map_or(most, |step| (step - 1).max(1)),
        }
    }

    fn sample_at(&self, index: u32) -> Option<&Sample<N::Bound>> {
        self.samples.get(index as usize)
    }

    /// Largest acceleration of the samples.
    fn largest(&self) -> N::Bound {
        let mut largest = N::Bound::ZERO;
        let lever = self.settings.lever;
        let poses = || self.samples.iter().map(|sample| &sample.pose);
        for ((before, here), after) in poses().zip(poses().skip(1)).zip(poses().skip(2)) {
            let change = here.displacement(after) - before.displacement(here);
            largest = greater(largest, size(change, lever));
        }
        let step = self.settings.step;
        largest.div(step * step)
    }

    /// The move that was made is played.
    pub fn keep(&mut self) {
        let Some(draft) = self.draft.take() else {
            return;
        };
        self.state = Some(draft.end);
        for _ in 0..draft.steps {
            let _ = self.samples.pop_front();
        }
        self.longest = self.settings.longest;
        self.strikes = 0;
        if let Some(oldest) = self.samples.front() {
            self.look.cells.drop_before(oldest.cursor.cell);
            self.pieces.drop_before(oldest.piece);
        }
    }

    /// The move that was made exceeds a limit by the part `by`, or is not proven to keep it: another takes its place. A shorter one,
    /// down to the planned motion itself, comes before a lower pace: a motion that brakes as hard as it may has no lower one, and the
    /// excess is that of the first instant, not the largest. The lower the pace, the less it leaves the path, too.
    pub fn cut<M: Model<N = N>>(&mut self, path: &Path<M>, by: N::Bound) {
        let Some(Draft { steps, .. }) = self.draft.take() else {
            return;
        };
        if steps > 1 {
            self.longest = steps / 2;
            return;
        }
        self.strikes += 1;
        self.longest = self.settings.longest;
        let margin = N::Bound::from_f64(MARGIN) * N::Bound::ratio(1 << self.strikes, 1);
        let share = N::Bound::ONE.div(N::Bound::ONE + greater(by, N::Bound::ZERO) + margin);
        if self.strikes > STRIKES || !self.lower(path, steps, share) {
            self.give_up();
        }
    }

    /// Plans again from the last sample that the kept moves need, with lower limits for the next `steps`.
    fn lower<M: Model<N = N>>(&mut self, path: &Path<M>, steps: u32, share: N::Bound) -> bool {
        let last = self.samples.get(steps as usize + 3).or(self.samples.back());
        let Some(last_cell) = last.map(|sample| sample.cursor.cell) else {
            return false;
        };
        self.samples.truncate(1 + usize::from(STANDING));
        self.under_way = None;
        self.ahead = self.settings.step;
        let Some(sample) = self.samples.back_mut() else {
            return false;
        };
        let Cursor {
            cell, at, square, ..
        } = sample.cursor;
        sample.cursor.at = N::Bound::ZERO;
        let committed = self.look.committed;
        let Some(entry) = self
            .look
            .cells
            .get(cell)
            .and_then(|planned| self.pieces.get(planned.piece))
        else {
            return false;
        };
        let planner = self.planner(path);
        let shortened = self.look.shorten(&planner, entry, cell, at, square);
        self.look.tighten([cell, last_cell], share);
        self.look.begin_pass(committed);
        shortened.is_ok()
    }

    /// No move like that which was made can be played: the path ends here. What was kept stays.
    pub fn give_up(&mut self) {
        let place = self.sample_at(1);
        let piece = place.map_or(self.look.piece, |sample| sample.piece);
        let refusal = WindowRefusal {
            piece: self.pieces.get(piece).map_or(piece, |entry| entry.number),
            p: N::Bound::ZERO,
            obstacle: Obstacle::Refused,
        };
        set(&mut self.refusal, refusal);
        self.draft = None;
        self.samples.clear();
    }
}

impl<N: Enclose, T: Copy + PartialEq, const PIECES: usize, const CELLS: usize> Motion<N::Bound>
    for Window<N, T, PIECES, CELLS>
{
    fn at(&self, eighths: u32) -> Setpoint<N::Bound> {
        let per_step = 8 * self.settings.ticks;
        let index = eighths.checked_div(per_step).unwrap_or(0);
        let w = N::Bound::ratio(eighths - index * per_step, per_step);
        let poses = [0, 1, 2, 3].map(|other| self.sample_at(index + other));
        match poses {
            [Some(a), Some(b), Some(c), Some(d)] => {
                smoothed([a, b, c, d].map(|each| &each.pose), w, self.settings.step)
            }
            // There are samples as far as moves are made, and a knot itself does without the last.
            [Some(a), Some(b), Some(c), None] => {
                smoothed([a, b, c, c].map(|each| &each.pose), w, self.settings.step)
            }
            _ => rest(Pose {
                position: Vector2::new(N::Bound::ZERO, N::Bound::ZERO),
                angle: N::Bound::angle(N::Bound::ZERO),
            }),
        }
    }

    fn feed(&self, eighths: u32) -> Option<N::Bound> {
        let index = eighths.checked_div(8 * self.settings.ticks).unwrap_or(0);
        let piece = self.sample_at(index + 1)?.piece;
        self.pieces.get(piece)?.feed
    }
}
