//! Emergency stop, door, limit switches and probe.

use super::super::interlock::{Interlocks, LatchedContact};
use super::{Foreground, TickEnds};
use crate::feature::{Feature, Optional};
use crate::guard::LimitBreach;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::states::{Transition, Trigger};
use trirrr_protocol::message::{Acting, FaultCode, State};

impl<N: ServiceNumber, S: Scene<N = N>, E: TickEnds<S>> Foreground<'_, S, E> {
    /// Stops for a person or a contact: by a fault if the emergency stop was pressed or a motor has reached its limit switch, by a
    /// hold while the door is open, by a stop where the probe of a run touches.
    #[inline(always)]
    pub(super) fn check_interlocks(&mut self) {
        let inputs = self.features.interlocks.get_mut();
        if inputs.is_some_and(Interlocks::take_stop) {
            self.latch(LimitBreach {
                code: FaultCode::EmergencyStop,
                index: None,
                value: N::ZERO,
                limit: N::ZERO,
            });
        }
        // Homing moves the motors onto their switches and off them. Drives that are off, or go on, move nothing.
        let watched = self.output.is_on()
            && !self.features.is_homing()
            && !matches!(self.state, State::Enabling | State::Unhomed);
        let inputs = self.features.interlocks.get_mut();
        if let Some(motor) = inputs.and_then(|all| all.take_limit(watched)) {
            self.latch(LimitBreach {
                code: FaultCode::LimitSwitch,
                index: Some(motor),
                value: N::ZERO,
                limit: N::ZERO,
            });
        }
        if self.features.is_open() {
            self.wait_for_door();
        }
        if self
            .features
            .probe
            .get_mut()
            .is_some_and(|probe| probe.is_tripped())
        {
            self.touch();
        }
    }

    /// Returns true while a door is open, or was since the job ran last.
    #[inline]
    pub(super) fn waits_for_door(&self) -> bool {
        S::Interlocks::EXISTS && (self.features.is_open() || self.job.left.is_some())
    }

    /// The run with the probe is over. The readings of this tick belong to the angles that were commanded in the last one.
    #[cold]
    fn touch(&mut self) {
        let readings = self.features.readings();
        let contact = LatchedContact {
            tick: self.clock,
            pose: self.pose,
            angles: readings.map(|all| all.each_ref().map(|reading| reading.angle)),
        };
        if let Some(probe) = self.features.probe.get_mut() {
            probe.touch(contact);
        }
        self.note_change();
        self.change(Trigger::Touch, Acting::Probe);
    }

    /// Holds a job, and gives any other motion up, as where the host is silent. In each tick: a job that an order of this tick or moves
    /// that came would let go on waits all the same.
    #[inline(never)]
    fn wait_for_door(&mut self) {
        self.leave();
        match self.change(Trigger::Door, Acting::Door) {
            Transition::To(State::Stopping) => self.features.stop_homing(),
            Transition::To(_) => self.travel.held = true,
            _ => {}
        }
    }
}
