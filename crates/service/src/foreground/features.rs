//! The tick's ends of the features, and what each does in a tick.
//!
//! | hook | called |
//! |---|---|
//! | [`begin_tick`](TickFeatures::begin_tick) | first in a tick |
//! | [`drop_stale`](TickFeatures::drop_stale) | in each tick, before its order |
//! | [`begin_path`](TickFeatures::begin_path) | at the start of a path |
//! | [`begin_move`](TickFeatures::begin_move) | as a move begins |
//! | [`keep_move`](TickFeatures::keep_move) | as a move gives way to the next |
//! | [`end_moves`](TickFeatures::end_moves) | as the last move of a path is over |
//! | [`drop_queue`](TickFeatures::drop_queue) | as all that is queued is dropped |
//! | [`enter`](TickFeatures::enter) | as the state changes |
//! | [`settle`](TickFeatures::settle), [`sample`](TickFeatures::sample) | last in a tick |

use crate::contact::ContactWatch;
use crate::digital::DigitalPlayer;
use crate::feature::{Feature, Of, Optional};
use crate::feedback::{DriveWatch, Readings};
use crate::handoff::QueuedMove;
use crate::homing::Cycle;
use crate::interlock::{Interlocks, ProbeLatch};
use crate::levels::LevelPlayer;
use crate::number::ServiceNumber;
use crate::queue::Receiver;
use crate::retreat::Trail;
use crate::scene::{ChangesOf, CurvesOf, ModelOf, OffsetsOf, QuinticsOf, Scene, Setup};
use crate::splice::SplicePlayer;
use trirrr_core::tick::Motor;
use trirrr_protocol::message::{InputState, InputStates, State};

/// Cycle of homing; none where the machine knows its motors.
type HomingCycle<'q, S> = Option<Cycle<'q, <S as Scene>::N, OffsetsOf<S>>>;

/// The tick's end of each feature.
pub(crate) struct TickFeatures<'q, S: Scene, X: Feature = QuinticsOf<S>> {
    pub(crate) splices: Of<X, SplicePlayer<'q, S::N, CurvesOf<S>>>,
    pub(crate) setups: Of<ChangesOf<S>, Receiver<'q, Setup<ModelOf<S>>>>,
    /// Angles that this tick has added for changed encoder offsets.
    pub(crate) shifted: OffsetsOf<S>,
    pub(crate) levels: Of<S::Levels, LevelPlayer<'q, S::N>>,
    pub(crate) homing: Of<S::Homing, HomingCycle<'q, S>>,
    pub(crate) feedback: Of<S::Feedback, DriveWatch<'q, S::N>>,
    pub(crate) contact: Of<S::Contact, ContactWatch<'q, S::N>>,
    /// Moves to go back on after a contact.
    pub(crate) trail: Of<S::Retreat, Trail<S::N, CurvesOf<S>>>,
    pub(crate) interlocks: Of<S::Interlocks, Interlocks<S::Interlocks>>,
    pub(crate) probe: Of<S::Probe, ProbeLatch<S::N>>,
    pub(crate) digital: Of<S::Digital, DigitalPlayer<'q>>,
}

impl<'q, N: ServiceNumber, S: Scene<N = N>, X: Feature> TickFeatures<'q, S, X> {
    /// Takes the inputs of homing, which belong to where `motors` were commanded in the last tick.
    #[inline(always)]
    pub(super) fn begin_tick(&mut self, inputs: [bool; 3], motors: &[Motor<N>; 3]) {
        let readings = self.feedback.get().and_then(|watch| watch.readings());
        if let Some(Some(cycle)) = self.homing.get_mut() {
            cycle.listen(inputs, motors, readings);
        }
        if let Some(shifted) = self.shifted.get_mut() {
            *shifted = None;
        }
    }

    /// Drops what belongs to moves of another generation.
    #[inline(always)]
    pub(super) fn drop_stale(&mut self, generation: u8) {
        if let Some(levels) = self.levels.get_mut() {
            levels.drop_stale(generation);
        }
        if let Some(digital) = self.digital.get_mut() {
            digital.drop_stale(generation);
        }
    }

    /// Forgets the moves that were played.
    #[inline(always)]
    pub(super) fn begin_path(&mut self) {
        if let Some(trail) = self.trail.get_mut() {
            trail.clear();
        }
    }

    /// Takes what belongs to move `number`, which begins.
    #[inline(always)]
    pub(super) fn begin_move(&mut self, number: u32, generation: u8) {
        if let Some(levels) = self.levels.get_mut() {
            levels.begin(number, generation);
        }
        if let Some(digital) = self.digital.get_mut() {
            digital.begin(number, generation);
        }
    }

    /// Keeps the move under way, which was played for `ticks`, for a retreat.
    #[inline(always)]
    pub(super) fn keep_move(&mut self, current: Option<&QueuedMove<N, CurvesOf<S>>>, ticks: u32) {
        if let (Some(trail), Some(current)) = (self.trail.get_mut(), current) {
            trail.keep(*current, ticks);
        }
    }

    /// No move is under way any more: its levels go.
    #[inline(always)]
    pub(super) fn end_moves(&mut self) {
        if let Some(levels) = self.levels.get_mut() {
            levels.end();
        }
    }

    /// Drops what belongs to moves.
    #[inline(always)]
    pub(super) fn drop_queue(&mut self) {
        if let Some(splices) = self.splices.get_mut() {
            splices.drop_queue();
        }
        self.end_moves();
        self.begin_path();
    }

    /// The machine comes to `state`; `plays`: a job goes on.
    #[inline(always)]
    pub(super) fn enter(&mut self, state: State, plays: bool) {
        if let Some(probe) = self.probe.get_mut().filter(|_| !plays) {
            probe.disarm();
        }
        if let Some(digital) = self.digital.get_mut() {
            digital.enter(state);
        }
    }

    /// Ends tick `tick`; `runs`: the tool may be on. Returns true if there is something to report.
    #[inline(always)]
    pub(super) fn settle(&mut self, runs: bool, tick: u32) -> bool {
        self.digital
            .get_mut()
            .is_some_and(|digital| digital.settle(runs, tick))
    }

    /// Sends the samples of tick `tick`.
    #[inline(always)]
    pub(super) fn sample(&mut self, tick: u32) {
        if let Some(watch) = self.feedback.get_mut() {
            watch.sample(tick);
        }
    }

    /// Returns the homing of a machine that has to be homed.
    #[inline(always)]
    pub(super) fn homing(&mut self) -> Option<&mut Cycle<'q, N, OffsetsOf<S>>> {
        self.homing.get_mut()?.as_mut()
    }

    /// Returns true if the machine has to be homed at all.
    #[inline(always)]
    pub(crate) fn needs_homing(&self) -> bool {
        self.homing.get().is_some_and(Option::is_some)
    }

    /// Returns true while homing looks for motors, or brings them to rest after it was given up.
    #[inline(always)]
    pub(super) fn is_homing(&self) -> bool {
        let homing = self.homing.get().and_then(Option::as_ref);
        homing.is_some_and(Cycle::is_under_way)
    }

    /// Brings motors that are homed to rest, and gives up.
    #[inline(always)]
    pub(super) fn stop_homing(&mut self) {
        if let Some(Some(cycle)) = self.homing.get_mut() {
            cycle.stop();
        }
    }

    /// Returns the watch over drives that tell something.
    #[inline(always)]
    pub(super) fn measuring(&mut self) -> Option<&mut DriveWatch<'q, N>> {
        self.feedback.get_mut().filter(|watch| watch.measures())
    }

    /// Returns what the drives told last.
    #[inline(always)]
    pub(super) fn readings(&self) -> Option<&Readings<N>> {
        self.feedback.get()?.readings()
    }

    /// Returns true while the door is open.
    #[inline(always)]
    pub(crate) fn is_open(&self) -> bool {
        self.interlocks.get().is_some_and(Interlocks::is_open)
    }

    /// Returns true while the emergency stop is pressed.
    #[inline(always)]
    pub(crate) fn is_pressed(&self) -> bool {
        self.interlocks.get().is_some_and(Interlocks::is_pressed)
    }

    /// Returns true while a motor stands on its limit switch.
    #[inline(always)]
    pub(crate) fn is_at_limit(&self) -> bool {
        self.interlocks.get().is_some_and(Interlocks::is_at_limit)
    }

    /// Returns the states of the interlocks.
    #[inline]
    pub(crate) fn input_states(&self) -> InputStates {
        let probe = self.probe.get();
        let probe = probe.map_or(InputState::Absent, ProbeLatch::state);
        let interlocks = self.interlocks.get();
        interlocks.map_or(InputStates::ABSENT, |all| all.states(probe))
    }
}
