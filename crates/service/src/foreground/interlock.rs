//! Emergency stop and door.

use super::super::homing::Homing;
use super::super::interlock::InterlockKind;
use super::super::scene::Scene;
use super::Foreground;
use crate::guard::LimitBreach;
use crate::number::ServiceNumber;
use trirrr_protocol::message::{Acting, FaultCode, State};

impl<N: ServiceNumber, S: Scene<N = N>> Foreground<'_, S> {
    /// Stops for a person: by a fault if the emergency stop was pressed, by a hold while the door is open.
    #[inline(always)]
    pub(super) fn check_interlocks(&mut self) {
        if self.interlocks.take_stop() {
            self.latch(LimitBreach {
                code: FaultCode::EmergencyStop,
                index: None,
                value: N::ZERO,
                limit: N::ZERO,
            });
        }
        if self.interlocks.is_open() {
            self.wait_for_door();
        }
    }

    /// Holds a job, and gives any other motion up, as where the host is silent. In each tick: a job that an order of this tick or moves
    /// that came would let go on waits all the same.
    #[inline(never)]
    fn wait_for_door(&mut self) {
        match self.state {
            State::Running | State::Slowing => {
                self.held = true;
                self.transition_to(State::Slowing, Acting::Door);
            }
            State::Holding => {
                self.held = true;
                self.transition_to(State::Holding, Acting::Door);
            }
            State::Recovering | State::Homing => {
                self.homing.stop();
                self.transition_to(State::Stopping, Acting::Door);
            }
            _ => {}
        }
    }
}
