//! Spare inputs and outputs: commands of the host, and states as the tick reports them.

use super::Background;
use crate::digital::falls;
use crate::feature::Optional;
use crate::handoff::Order;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use trirrr_protocol::message::{DigitalStates, Event, OutputSwitch, Refusal};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Switches an output at once. Off it goes in every state.
    #[inline(always)]
    pub(super) fn switch_output(&mut self, index: u8, is_on: bool) -> Result<(), Refusal<N>> {
        let digital = self
            .features
            .digital
            .get()
            .ok_or(Refusal::NoOutput { outputs: 0 })?;
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
        match self.features.digital.get() {
            Some(digital) => digital.require(switch.on | switch.off)?,
            None => return Err(Refusal::NoOutput { outputs: 0 }),
        }
        self.end_of_moves()?;
        if switch.number != self.status.next {
            return Err(Refusal::MoveNumber {
                expected: self.status.next,
            });
        }
        match self.features.digital.get_mut() {
            Some(digital) => digital.keep(switch),
            None => Ok(()),
        }
    }

    /// Takes in what the tick reported of the inputs and outputs.
    #[inline(always)]
    pub(super) fn apply_digital(&mut self, report: Option<&DigitalStates>) {
        if let Some(states) = report
            && self
                .features
                .digital
                .get()
                .is_some_and(|digital| digital.exist())
            && self.status.digital != Some(*states)
        {
            self.status.digital = Some(*states);
            self.push_event(Event::Digital(*states));
        }
    }
}
