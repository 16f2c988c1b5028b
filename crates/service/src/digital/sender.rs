//! The background's end of spare inputs and outputs.

use super::{CHANGES, DigitalParameters, OutputChange, changed};
use crate::queue::Sender;
use heapless::Deque;
use trirrr_core::number::Number;
use trirrr_protocol::message::{OutputSwitch, Refusal};

/// Changes of outputs that wait for the admission of their moves.
pub(crate) struct DigitalSender<'q> {
    changes: Sender<'q, OutputChange>,
    /// In the order of their moves.
    waiting: Deque<OutputChange, CHANGES>,
    parameters: DigitalParameters,
}

impl<'q> DigitalSender<'q> {
    pub(super) fn new(changes: Sender<'q, OutputChange>, parameters: DigitalParameters) -> Self {
        Self {
            changes,
            waiting: Deque::new(),
            parameters,
        }
    }

    /// Returns true if the scene names any input or output.
    pub(crate) fn exist(&self) -> bool {
        self.parameters.are_named()
    }

    /// Refuses outputs that the scene does not name.
    pub(crate) fn require<N: Number>(&self, bits: u8) -> Result<(), Refusal<N>> {
        let outputs = self.parameters.outputs;
        match bits.checked_shr(outputs.into()).unwrap_or(0) {
            0 => Ok(()),
            _ => Err(Refusal::NoOutput { outputs }),
        }
    }

    /// Returns the bit of the output `index`, or refuses one that the scene does not name.
    pub(crate) fn require_one<N: Number>(&self, index: u8) -> Result<u8, Refusal<N>> {
        let outputs = self.parameters.outputs;
        let bit = 1_u8.checked_shl(index.into());
        bit.filter(|_| index < outputs)
            .ok_or(Refusal::NoOutput { outputs })
    }

    /// Keeps a change for a move that is still to be offered. Of two for one move the later one counts.
    pub(crate) fn keep<N: Number>(&mut self, switch: &OutputSwitch) -> Result<(), Refusal<N>> {
        let OutputSwitch { number, on, off } = *switch;
        if let Some(last) = self.waiting.back_mut()
            && last.number == number
        {
            (last.on, last.off) = (changed(last.on, on, off), changed(last.off, off, on));
            return Ok(());
        }
        let change = OutputChange {
            number,
            // That of the queue when its move is admitted.
            generation: 0,
            on,
            off,
        };
        let has_room = self.waiting.len() + self.changes.len() < CHANGES;
        match has_room && self.waiting.push_back(change).is_ok() {
            true => Ok(()),
            false => Err(Refusal::OutputsFull),
        }
    }

    /// Hands the change of move `number`, which is admitted, to the tick.
    pub(crate) fn admit(&mut self, number: u32, generation: u8) {
        while let Some(front) = self.waiting.front()
            && front.number.wrapping_sub(number) as i32 <= 0
        {
            if front.number == number {
                self.changes.send(OutputChange {
                    generation,
                    ..*front
                });
            }
            self.waiting.pop_front();
        }
    }

    /// Drops the changes of all moves that are not admitted.
    pub(crate) fn withdraw(&mut self) {
        self.waiting.clear();
    }
}
