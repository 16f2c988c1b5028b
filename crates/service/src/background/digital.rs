//! Spare inputs and outputs: commands of the host, and states as the tick reports them.

use super::Background;
use crate::digital::falls;
use crate::handoff::Order;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::splice::Optional;
use trirrr_protocol::message::{DigitalStates, Event, OutputSwitch, Refusal};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Switches an output at once. Off it goes in every state.
    #[inline(always)]
    pub(super) fn switch_output(&mut self, index: u8, is_on: bool) -> Result<(), Refusal<N>> {
        let digital = self.digital.get().ok_or(Refusal::NoOutput { outputs: 0 })?;
        let bit = digital.require_one(index)?;
        let state = self.status.state;
        match is_on {
            true if falls(state) => Err(Refusal::State(state)),
            true => self.order(Order::Output { on: bit, off: 0 }, state),
            false => self.order(Order::Output { on: 0, off: bit }, state),
        }
    }

    /// Takes a change of outputs with the next move to offer.
    #[inline(always)]
    pub(super) fn switch_at(&mut self, switch: &OutputSwitch) -> Result<(), Refusal<N>> {
        match self.digital.get() {
            Some(digital) => digital.require(switch.on | switch.off)?,
            None => return Err(Refusal::NoOutput { outputs: 0 }),
        }
        self.end_of_moves()?;
        if switch.number != self.status.next {
            return Err(Refusal::MoveNumber {
                expected: self.status.next,
            });
        }
        match self.digital.get_mut() {
            Some(digital) => digital.keep(switch),
            None => Ok(()),
        }
    }

    /// Hands the change of outputs with move `number`, which is admitted, to the tick; before the move itself.
    #[inline(always)]
    pub(super) fn admit_outputs(&mut self, number: u32) {
        let generation = self.generation;
        if let Some(digital) = self.digital.get_mut() {
            digital.admit(number, generation);
        }
    }

    /// Drops the changes of outputs with all moves that are not admitted.
    #[inline(always)]
    pub(super) fn drop_outputs(&mut self) {
        if let Some(digital) = self.digital.get_mut() {
            digital.withdraw();
        }
    }

    /// Takes in what the tick reported of the inputs and outputs.
    #[inline(always)]
    pub(super) fn apply_digital(&mut self, report: Option<&DigitalStates>) {
        if let Some(states) = report
            && self.digital.get().is_some_and(|digital| digital.exist())
            && self.status.digital != Some(*states)
        {
            self.status.digital = Some(*states);
            self.push_event(Event::Digital(*states));
        }
    }
}
