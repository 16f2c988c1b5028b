//! Emergency stop and door, as the tick reports them.

use super::Background;
use crate::interlock::InterlockKind;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use trirrr_protocol::message::{Event, InputStates, Refusal};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Takes in what the tick reported of the inputs.
    #[inline(always)]
    pub(super) fn apply_interlocks(&mut self, states: Option<&InputStates>) {
        if let Some(states) = states.filter(|states| **states != self.status.inputs) {
            self.status.inputs = *states;
            self.push_event(Event::Inputs(*states));
        }
    }

    /// Refuses what would move the machine while an input is active. The tick looks, too: the door may open before the order comes.
    #[inline(always)]
    pub(super) fn require_clear_inputs(&self) -> Result<(), Refusal<N>> {
        self.require_released_stop()?;
        match S::Interlocks::EXIST && self.status.inputs.door.is_active() {
            true => Err(Refusal::DoorOpen),
            false => Ok(()),
        }
    }

    /// Refuses what would acknowledge the emergency stop, or switch the drives on, while it is pressed.
    #[inline(always)]
    pub(super) fn require_released_stop(&self) -> Result<(), Refusal<N>> {
        match S::Interlocks::EXIST && self.status.inputs.emergency_stop.is_active() {
            true => Err(Refusal::EmergencyStop),
            false => Ok(()),
        }
    }
}
