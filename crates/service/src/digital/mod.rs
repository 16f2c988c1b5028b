//! Spare inputs and outputs of a scene.
//!
//! The host switches an output at once, or with the motion: in the tick in which a move begins. The background keeps such a change
//! until its move is admitted, then hands it to the tick through a queue, before the move itself. Outputs are off in a fault and
//! while the drives are off; those that are on [in jobs](DigitalParameters::in_jobs) only are off wherever the tool is.

mod player;
mod sender;

pub(crate) use player::DigitalPlayer;
pub(crate) use sender::DigitalSender;

use crate::feature::ChannelMemory;
use crate::queue::{Receiver, Sender};
use heapless::spsc::Queue;
use trirrr_core::to_source;
use trirrr_protocol::message::{DIGITAL, State};

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

to_source!(pub [] DigitalParameters [] in trirrr_service::features {
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

/// Queue of the changes that come with the motion.
#[derive(Debug)]
pub(crate) struct DigitalPorts {
    changes: Queue<OutputChange, { CHANGES + 1 }>,
}

impl ChannelMemory for DigitalPorts {
    const EMPTY: Self = Self {
        changes: Queue::new(),
    };
}

impl DigitalPorts {
    /// Returns both ends.
    pub(crate) fn split(
        &mut self,
        parameters: DigitalParameters,
    ) -> (DigitalSender<'_>, DigitalPlayer<'_>) {
        let (put, take) = self.changes.split();
        let sender = DigitalSender::new(Sender::new(put), parameters);
        let player = DigitalPlayer::new(Receiver::new(take), &parameters);
        (sender, player)
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
