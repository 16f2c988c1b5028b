//! Spare inputs and outputs of a scene.
//!
//! The host switches an output at once, or with the motion: in the tick in which a move begins. The background keeps such a change
//! until its move is admitted, then hands it to the tick through a queue, before the move itself. Outputs are off in a fault and
//! while the drives are off; those that are on [in jobs](DigitalParameters::in_jobs) only are off wherever the tool is.
//!
//! The choice is a type: without spare inputs and outputs a scene has neither queue nor code for them.

mod player;
mod sender;

pub use player::DigitalPlayer;
pub use sender::DigitalSender;

use crate::queue::{Receiver, Sender};
use crate::scene::Scene;
use crate::splice::{Optional, Present};
use core::fmt::Debug;
use heapless::spsc::Queue;
use trirrr_core::to_source;
use trirrr_protocol::message::{DIGITAL, DigitalStates, State};

/// Changes with the motion that can wait: those of moves that are not judged, and of admitted ones.
const CHANGES: usize = 16;

/// Spare inputs and outputs that a scene names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DigitalParameters {
    /// Number of outputs, at most [`DIGITAL`].
    pub outputs: u8,
    /// Outputs that are on only while a job runs, a bit for each.
    pub in_jobs: u8,
    /// Number of inputs, at most [`DIGITAL`].
    pub inputs: u8,
    /// Ticks of a change of an input without bounces, that in which it counts included; at least 1.
    pub debounce_ticks: [u16; DIGITAL],
}

to_source!(pub [] DigitalParameters [] in trirrr_service {
    outputs,
    in_jobs,
    inputs,
    debounce_ticks,
});

impl DigitalParameters {
    /// Returns true if the scene names any.
    pub const fn are_named(&self) -> bool {
        self.outputs != 0 || self.inputs != 0
    }
}

/// Memory of spare inputs and outputs; `()` for a machine without any.
pub trait DigitalKind: Send + 'static {
    /// Nothing in it.
    const EMPTY: Self;

    /// Levels of the inputs in a tick, bounces and all: a bit for each, set while it is active.
    type Readings: Copy + Default;
    /// Report of the tick about them.
    type Report: Optional<DigitalStates> + Copy + Debug + PartialEq;
    /// End of the background.
    type Background<'q>: Optional<DigitalSender<'q>>;
    /// End of the tick.
    type Tick<'q>: Optional<DigitalPlayer<'q>>;

    /// Returns both ends.
    fn split(&mut self, parameters: DigitalParameters) -> (Self::Background<'_>, Self::Tick<'_>);

    /// Takes the levels of the inputs, before the tick.
    fn sense(tick: &mut Self::Tick<'_>, readings: Self::Readings);

    /// Returns the report of the tick.
    fn report(tick: &Self::Tick<'_>) -> Self::Report;
}

impl DigitalKind for () {
    const EMPTY: Self = ();
    type Readings = ();
    type Report = ();
    type Background<'q> = ();
    type Tick<'q> = ();

    #[inline(always)]
    fn split(&mut self, _: DigitalParameters) -> ((), ()) {
        ((), ())
    }

    #[inline(always)]
    fn sense((): &mut (), (): ()) {}

    #[inline(always)]
    fn report((): &()) {}
}

/// Queue of the changes that come with the motion.
#[derive(Debug)]
pub struct DigitalPorts {
    changes: Queue<OutputChange, { CHANGES + 1 }>,
}

impl DigitalKind for DigitalPorts {
    const EMPTY: Self = Self {
        changes: Queue::new(),
    };
    type Readings = u8;
    type Report = Present<DigitalStates>;
    type Background<'q> = Present<DigitalSender<'q>>;
    type Tick<'q> = Present<DigitalPlayer<'q>>;

    fn split(
        &mut self,
        parameters: DigitalParameters,
    ) -> (Present<DigitalSender<'_>>, Present<DigitalPlayer<'_>>) {
        let (put, take) = self.changes.split();
        let sender = DigitalSender::new(Sender::new(put), parameters);
        let player = DigitalPlayer::new(Receiver::new(take), &parameters);
        (Present(sender), Present(player))
    }

    #[inline]
    fn sense(tick: &mut Present<DigitalPlayer<'_>>, readings: u8) {
        tick.0.sense(readings);
    }

    #[inline]
    fn report(tick: &Present<DigitalPlayer<'_>>) -> Present<DigitalStates> {
        Present(tick.0.states())
    }
}

/// Change of outputs in the tick in which a move begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OutputChange {
    number: u32,
    /// Generation of the queue in which the move is.
    generation: u8,
    on: u8,
    off: u8,
}

/// Returns true in states in which every output is off.
pub(crate) fn falls(state: State) -> bool {
    matches!(
        state,
        State::Fault | State::Reacting | State::Disabled | State::Enabling | State::Disabling
    )
}

/// `bits` after a change.
fn changed(bits: u8, on: u8, off: u8) -> u8 {
    (bits & !off) | on
}

/// The background's end of the scene `S`.
pub(crate) type BackgroundDigital<'q, S> = <<S as Scene>::Digital as DigitalKind>::Background<'q>;

/// The tick's end.
pub(crate) type TickDigital<'q, S> = <<S as Scene>::Digital as DigitalKind>::Tick<'q>;

/// Report of the tick of scene `S`.
pub(crate) type DigitalReportOf<S> = <<S as Scene>::Digital as DigitalKind>::Report;

/// Levels of the spare inputs of scene `S` in a tick; `()` of a scene without any.
pub type DigitalReadingsOf<S> = <<S as Scene>::Digital as DigitalKind>::Readings;
