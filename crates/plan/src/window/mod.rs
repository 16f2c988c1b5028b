//! Plans along a window: paths of any length, in memory of a fixed size and steps of bounded work.
//!
//! Pieces go in, [moves](WindowMove) come out, long before the last piece is known. Between the two the window measures
//! cells as far ahead as it has room for, plans them so that the machine can stop at the last one, and makes moves of
//! the first half. The next plan begins there. So a motion is as fast as that of [`course`](crate::course)
//! where the window is longer than the way on which the machine brakes, and slower where it is not.
//!
//! Whoever plays the moves judges each, and tells the window. A move that is refused is cut; where it cannot be cut, the limits of
//! its cells are lowered and the rest is planned again. All that was kept before stays.

mod law;
mod look;
mod moves;
mod numbered;
mod planner;

use crate::cell::{Obstacle, Planner};
use crate::fit::{LONGEST_S, rest};
use crate::piece::{Piece, PieceJoint};
use heapless::Deque;
use law::{Along, Cursor, STANDING};
use look::{HeldPiece, Look};
use moves::Until;
use numbered::{Maybe, Numbered, set};
pub use planner::{ServicePlanner, ToolSetting};
use trirrr_core::model::Model;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::{Ends, Pose, Quintics, Setpoint};
use trirrr_service::admission::{Enclose, Path};
use trirrr_service::features::Planning;

/// Most samples of the motion at a time.
const SAMPLES: usize = 40;
/// Part of the tolerances that smoothing may use; the rest is for what moves differ from the smoothed motion.
const SMOOTHING: f64 = 0.8;

/// Tick and tolerances of the moves of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowSettings {
    /// Seconds per tick.
    pub period_s: f64,
    /// Ticks of the shortest move, positive; the motion is smoothed over twice as many.
    pub ticks: u32,
    /// Largest distance of D from the path, m.
    pub tolerance_m: f64,
    /// Largest deviation of alpha from that on the path, rad.
    pub tolerance_rad: f64,
    /// Largest distance of a platform joint from D, m.
    pub lever_m: f64,
    /// Rate at which a hold may change the pace anywhere on the path, in paces per second; 0 leaves no room for holds.
    pub hold_rate: f64,
}

impl WindowSettings {
    /// The numbers that a window computes with.
    pub fn planning<N: Number>(&self) -> Planning<N> {
        let step_s = self.period_s * f64::from(self.ticks);
        let number = N::from_f64;
        let tolerances = [self.tolerance_m, self.tolerance_rad];
        let longest = (LONGEST_S / step_s) as u32;
        Planning {
            period: number(self.period_s),
            step: number(step_s),
            ticks: self.ticks,
            longest: longest.min(SAMPLES as u32 - 3).max(1),
            // A move may differ from the smoothed motion by half of this.
            tolerances: tolerances.map(|all| number(2.0 * (1.0 - SMOOTHING) * all)),
            // The smoothed motion is off by a sixth of the square of a step times the acceleration.
            bends: tolerances.map(|all| number(6.0 * SMOOTHING / (step_s * step_s) * all)),
            lever: number(self.lever_m),
            hold_rate: number(self.hold_rate),
        }
    }
}

/// A piece that a window takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowPiece<B: Number, T> {
    /// The geometry. It begins where the last one ends.
    pub piece: Piece<B>,
    /// Greatest speed of D, m/s, if it is limited.
    pub feed: Option<B>,
    /// Comes out with each move whose middle lies on the piece.
    pub tag: T,
    /// Number by which a refusal names the piece.
    pub number: u32,
}

/// A move that a window has made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowMove<B: Number, T> {
    /// Pose, velocity and acceleration at both ends.
    pub ends: Ends<B, Quintics>,
    /// Duration in ticks, positive.
    pub ticks: u32,
    /// Tag of the piece that holds its middle.
    pub tag: T,
}

/// State of a window after a [step](Window::step).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outlook<B: Number, T> {
    /// There is more to do.
    Working,
    /// Nothing to do before a piece comes, or the end is declared.
    Waiting,
    /// A move. The window waits for [`keep`](Window::keep), [`cut`](Window::cut) or [`give_up`](Window::give_up).
    Move(WindowMove<B, T>),
}

/// Reason why a path was given up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowRefusal<B> {
    /// Number of the piece.
    pub piece: u32,
    /// Parameter of the piece, 0 to 1.
    pub p: B,
    /// The obstacle.
    pub obstacle: Obstacle,
}

/// The planned motion at an instant.
#[derive(Clone, Copy, Debug)]
struct Sample<B: Number> {
    pose: Pose<B>,
    /// The way on from there.
    cursor: Cursor<B>,
    /// Number of the piece.
    piece: u32,
    /// The smoothed motion is at rest there.
    rests: bool,
}

/// A move that is not judged yet.
#[derive(Clone, Copy, Debug)]
struct Draft<B: Number> {
    steps: u32,
    end: Setpoint<B>,
}

/// Planner of a path that comes piece by piece. `PIECES` and `CELLS` say how many it holds.
pub struct Window<N: Enclose, T, const PIECES: usize, const CELLS: usize> {
    settings: Planning<N::Bound>,
    look: Look<N::Bound, CELLS>,
    pieces: Numbered<HeldPiece<N::Bound, T>, PIECES>,
    /// The piece that came last.
    last: Maybe<Piece<N::Bound>>,
    /// The motion stops before the piece with this number.
    closed: Option<u32>,
    samples: Deque<Sample<N::Bound>, SAMPLES>,
    /// Place between the last sample and the next, where a cell ends between the two.
    under_way: Option<Cursor<N::Bound>>,
    /// Time to the next sample.
    ahead: N::Bound,
    /// The motion at the second sample, where the last move that was kept ends.
    state: Option<Setpoint<N::Bound>>,
    /// Longest move that is tried next, in steps.
    longest: u32,
    strikes: u32,
    draft: Option<Draft<N::Bound>>,
    refusal: Maybe<WindowRefusal<N::Bound>>,
}

impl<N: Enclose, T: Copy + PartialEq, const PIECES: usize, const CELLS: usize>
    Window<N, T, PIECES, CELLS>
{
    /// A window that holds nothing, in memory that need not be written: [`stand`](Self::stand) begins a path.
    pub const fn new(settings: Planning<N::Bound>) -> Self {
        Self {
            settings,
            look: Look::new(),
            pieces: Numbered::new(),
            last: Maybe::new(),
            closed: None,
            samples: Deque::new(),
            under_way: None,
            ahead: N::Bound::ZERO,
            state: None,
            longest: 0,
            strikes: 0,
            draft: None,
            refusal: Maybe::new(),
        }
    }

    /// Drops everything and begins a path: the machine stands at `pose`.
    pub fn stand(&mut self, pose: Pose<N::Bound>) {
        self.look = Look::new();
        self.pieces = Numbered::new();
        self.last.clear();
        self.closed = None;
        self.samples.clear();
        for _ in 0..=STANDING {
            let _ = self.samples.push_back(Sample {
                pose,
                cursor: Cursor::before(0),
                piece: 0,
                rests: false,
            });
        }
        self.under_way = None;
        self.ahead = self.settings.step;
        self.state = Some(rest(pose));
        self.longest = self.settings.longest;
        self.strikes = 0;
        self.draft = None;
        self.refusal.clear();
    }

    /// The planner of the machine with these coefficients.
    pub(super) fn planner<'a, M: Model<N = N>>(
        &self,
        path: &'a Path<M>,
    ) -> Planner<M, &'a Path<M>> {
        let Planning {
            hold_rate, bends, ..
        } = self.settings;
        Planner::over(path, hold_rate).with_bend(bends)
    }

    /// Pieces for which there is room.
    pub fn room(&self) -> usize {
        let count = self.pieces.end().wrapping_sub(self.pieces.first());
        PIECES.saturating_sub(count as usize)
    }

    /// Pose at the end of the path, as far as it is known; none before it begins.
    pub fn end(&self) -> Option<Pose<N::Bound>> {
        let last = self.last.first().map(|last| last.at(N::Bound::ONE).pose);
        last.or(self.state.map(|state| state.pose))
    }

    /// Takes a piece, which begins where the path ends. Returns false where there is no room for it, or the path was
    /// given up. A piece without a length is left out.
    pub fn push(&mut self, piece: WindowPiece<N::Bound, T>) -> bool {
        let index = self.pieces.end();
        let open = self.last.first().filter(|_| self.closed != Some(index));
        let WindowPiece {
            piece,
            feed,
            tag,
            number,
        } = piece;
        let piece = self.straightened(piece);
        if !piece.has_length() {
            return self.refusal.is_empty() && self.room() > 0;
        }
        let entry = HeldPiece {
            piece,
            feed,
            tag,
            number,
            joint: open.and_then(|last| PieceJoint::of(last, &piece)),
        };
        let taken = self.refusal.is_empty() && self.pieces.push(entry);
        if taken {
            set(&mut self.last, piece);
        }
        taken
    }

    /// The straight piece between the ends of one whose tangents are lost in the rounding of its poses, where nobody can tell the two
    /// apart.
    fn straightened(&self, piece: Piece<N::Bound>) -> Piece<N::Bound> {
        let [metres, radians] = self.settings.tolerances;
        let [plane, turning] = piece.extents();
        match plane <= metres && turning <= radians && !piece.has_direction() {
            true => Piece::line(piece.at(N::Bound::ZERO).pose, piece.at(N::Bound::ONE).pose),
            false => piece,
        }
    }

    /// Declares the end: the motion stops at the end of what has come, even if more comes.
    pub fn close(&mut self) {
        self.closed = Some(self.pieces.end());
    }

    /// Returns true if no piece can follow on those that came without a stop.
    pub fn is_closed(&self) -> bool {
        self.closed == Some(self.pieces.end())
    }

    /// Takes other settings, for the next path.
    pub(super) fn set(&mut self, settings: Planning<N::Bound>) {
        self.settings = settings;
    }

    /// Reason why the path was given up, if it was. All moves that were kept stay; the motion comes to rest where it
    /// can.
    pub fn refusal(&self) -> Option<WindowRefusal<N::Bound>> {
        self.refusal.first().copied()
    }

    /// Returns true if moves for all that came are made.
    pub fn is_done(&self) -> bool {
        if self.samples.is_empty() {
            return true;
        }
        let measured = self.look.piece == self.pieces.end() || !self.refusal.is_empty();
        let standing = self.samples.len() == 1 + usize::from(STANDING);
        let at_end = self.samples.back().map(|sample| sample.cursor.cell);
        measured && standing && self.draft.is_none() && at_end == Some(self.look.cells.end())
    }

    /// Bounded work: a cell, a sample or a move. `path` has the coefficients of the machine, those of its admission.
    pub fn step<M: Model<N = N>>(&mut self, path: &Path<M>) -> Outlook<N::Bound, T> {
        if self.draft.is_some() {
            return Outlook::Waiting;
        }
        if self.look.is_passing() {
            self.look.pass_step();
            return Outlook::Working;
        }
        if let Some(until) = self.until() {
            return self.fit(until);
        }
        let moved = self.sample();
        if moved || self.measure(path) {
            return Outlook::Working;
        }
        // All that is known is measured, or there is no room for more.
        let at_close = self.closed == Some(self.look.piece) && self.look.to == N::Bound::ZERO;
        let all = at_close || !self.refusal.is_empty();
        let is_full = !self.look.has_room() || self.room() == 0;
        if (all || is_full) && self.look.commit(all) {
            return Outlook::Working;
        }
        if is_full && !all {
            // Only a move makes room.
            let steps = (self.samples.len() as u32).saturating_sub(1 + u32::from(STANDING));
            if steps > 0 {
                return self.fit(Until { steps, rest: None });
            }
            // All that there is room for lasts no longer than a move.
            if self.look.commit_half() {
                return Outlook::Working;
            }
            self.give_up();
        }
        Outlook::Waiting
    }

    /// Measures a cell. Returns false if there is none to measure, or no room.
    fn measure<M: Model<N = N>>(&mut self, path: &Path<M>) -> bool {
        let number = self.look.piece;
        if !self.look.has_room() || !self.refusal.is_empty() {
            return false;
        }
        let Some(entry) = self.pieces.get(number) else {
            return false;
        };
        let next = number.wrapping_add(1);
        // Where the motion stops, cells are shorter: the piece behind has to be known.
        let follows = self.pieces.get(next);
        if follows.is_none() && self.closed != Some(next) {
            return false;
        }
        let stops = [
            entry.joint.is_none(),
            follows.is_none_or(|next| next.joint.is_none()),
        ];
        let (planner, step) = (self.planner(path), self.settings.step);
        match self.look.measure(&planner, entry, stops, step) {
            Ok(()) => {
                if self.look.to == N::Bound::ONE {
                    let joint = follows.and_then(|next| next.joint);
                    let scale = joint.map_or(N::Bound::ONE, |joint| joint.scale.sqrt());
                    self.look.next_piece(scale);
                }
            }
            Err(obstacle) => {
                let refusal = WindowRefusal {
                    piece: entry.number,
                    p: self.look.to,
                    obstacle,
                };
                set(&mut self.refusal, refusal);
                self.look.leave_out(number);
            }
        }
        true
    }

    /// Takes a step towards the next sample. Returns false if that is not possible now.
    fn sample(&mut self) -> bool {
        let Some(last) = self.samples.back().copied() else {
            return false;
        };
        if self.samples.is_full() {
            return false;
        }
        let mut cursor = self.under_way.unwrap_or(last.cursor);
        if last.cursor.standing > 0 {
            let sample = Sample {
                cursor: Cursor {
                    standing: last.cursor.standing - 1,
                    ..last.cursor
                },
                rests: last.cursor.standing == STANDING,
                ..last
            };
            return self.samples.push_back(sample).is_ok();
        }
        match cursor.advance(&self.look, self.ahead) {
            Along::Ahead => return false,
            Along::Stuck => {
                self.give_up();
                return false;
            }
            Along::Left(time) => {
                self.ahead = time;
                self.under_way = Some(cursor);
                return true;
            }
            Along::There | Along::Stop => {}
        }
        self.under_way = None;
        self.ahead = self.settings.step;
        // At a stop the cursor is in front of the cell behind: the place is the end of the one before.
        let here = match cursor.standing {
            0 => cursor.cell,
            _ => cursor.cell.wrapping_sub(1),
        };
        let Some((piece, place)) = self.look.cells.get(here).map(|cell| {
            let at = if cursor.standing == 0 {
                cursor.at
            } else {
                cell.cell.length()
            };
            (cell.piece, cell.from + at)
        }) else {
            return false;
        };
        let Some(entry) = self.pieces.get(piece) else {
            return false;
        };
        let sample = Sample {
            pose: entry.piece.at(place).pose,
            cursor,
            piece,
            rests: false,
        };
        self.samples.push_back(sample).is_ok()
    }
}
