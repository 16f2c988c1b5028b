//! A probe: the contact that ends a run, and where that was.

use super::debounce::DebouncedInput;
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::InputState;

/// Probe, and its last run.
///
/// A run ends in the first tick whose reading differs: bounces follow the contact, and none comes before it. Only the state that
/// is told is free of bounces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ProbeLatch<N: Number> {
    contact: DebouncedInput,
    exists: bool,
    /// Reading of this tick, bounces and all.
    touches: bool,
    /// Reading that ends the run under way.
    awaited: Option<bool>,
    run: Option<LatchedRun<N>>,
}

/// Run of a probe as the tick reports it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LatchedRun<N: Number> {
    Armed,
    Touched(LatchedContact<N>),
    NotTouched,
}

/// Contact as the tick knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LatchedContact<N: Number> {
    pub(crate) tick: u32,
    pub(crate) pose: Pose<N>,
    /// Joint angles that the drives told last.
    pub(crate) angles: Option<[N::Angle; 3]>,
}

impl<N: Number> ProbeLatch<N> {
    /// Probe whose state is told free of bounces of so many ticks; `None`: the scene names no probe.
    pub(crate) fn new(debounce_ticks: Option<u16>) -> Self {
        Self {
            contact: DebouncedInput::new(debounce_ticks.unwrap_or(1)),
            exists: debounce_ticks.is_some(),
            touches: false,
            awaited: None,
            run: None,
        }
    }

    /// Returns the state that is told.
    pub(crate) fn state(&self) -> InputState {
        match self.exists {
            true => InputState::of(self.contact.is_active()),
            false => InputState::Absent,
        }
    }

    /// Takes the reading of a tick. Returns true if the state that is told has changed.
    #[inline]
    pub(crate) fn read(&mut self, touches: bool) -> bool {
        self.touches = self.exists && touches;
        self.exists && self.contact.read(touches)
    }

    /// Returns true if a run may begin: its contact is still to change.
    pub(crate) fn is_ready(&self, away: bool) -> bool {
        self.exists && self.contact.is_active() == away
    }

    /// A run begins, which a reading other than `away` ends.
    pub(crate) fn arm(&mut self, away: bool) {
        self.awaited = Some(!away);
        self.run = Some(LatchedRun::Armed);
    }

    /// Returns true in the tick of a run whose reading ends it.
    #[inline]
    pub(crate) fn is_tripped(&self) -> bool {
        self.awaited == Some(self.touches)
    }

    /// The run has ended by its contact.
    pub(crate) fn touch(&mut self, contact: LatchedContact<N>) {
        self.awaited = None;
        self.run = Some(LatchedRun::Touched(contact));
    }

    /// The job is over, or another begins. Returns true if a run has ended with that, without its contact.
    pub(crate) fn disarm(&mut self) -> bool {
        let ends = self.awaited.take().is_some();
        if ends {
            self.run = Some(LatchedRun::NotTouched);
        }
        ends
    }

    /// Returns the last run.
    pub(crate) fn run(&self) -> Option<&LatchedRun<N>> {
        self.run.as_ref()
    }
}
