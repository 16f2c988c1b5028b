//! Inputs as the tick reports them.

use super::Background;
use crate::feature::Feature;
use crate::feedback::pose_near;
use crate::handoff::Order;
use crate::interlock::{LatchedContact, LatchedRun, ProbeLatch};
use crate::number::ServiceNumber;
use crate::scene::Scene;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Event, InputState, InputStates, ProbeContact, ProbeRun, Refusal};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Takes in what the tick reported of the inputs.
    #[inline(always)]
    pub(super) fn apply_interlocks(
        &mut self,
        states: Option<&InputStates>,
        probe: Option<&ProbeLatch<N>>,
    ) {
        if let Some(states) = states
            && *states != self.status.inputs
        {
            self.status.inputs = *states;
            self.push_event(Event::Inputs(*states));
        }
        // An older report must not overwrite the run that an order in flight begins.
        if let Some(probe) = probe
            && self.view.awaited.is_none()
        {
            self.apply_probe(probe.run());
        }
    }

    #[inline(never)]
    fn apply_probe(&mut self, run: Option<&LatchedRun<N>>) {
        let told = match (run, self.status.probe) {
            (None, _) => None,
            (Some(LatchedRun::Armed), _) => Some(ProbeRun::Armed),
            (Some(LatchedRun::NotTouched), _) => Some(ProbeRun::NotTouched),
            // The pose by the drives is known already.
            (Some(LatchedRun::Touched(new)), Some(ProbeRun::Touched(known)))
                if known.tick == new.tick =>
            {
                return;
            }
            (Some(LatchedRun::Touched(contact)), _) => Some(ProbeRun::Touched(ProbeContact {
                tick: contact.tick,
                pose: contact.pose,
                measured: self.measured(contact),
            })),
        };
        if told == self.status.probe {
            return;
        }
        self.status.probe = told;
        if let Some(run) = told {
            self.push_event(Event::Probe(run));
        }
    }

    /// Pose by the angles that the drives told: one search by Newton's method from the commanded pose.
    fn measured(&self, contact: &LatchedContact<N>) -> Option<Pose<N>> {
        let coefficients = self.features.measured()?;
        pose_near(coefficients, contact.angles.as_ref()?, contact.pose)
    }

    /// Plays what is queued until the probe's contact changes.
    #[inline(always)]
    pub(super) fn start_probing(&mut self, away: bool) -> Result<(), Refusal<N>> {
        if !S::Probe::EXISTS {
            return Err(Refusal::NoProbe);
        }
        self.start_as(Order::Probe { away })?;
        self.status.probe = Some(ProbeRun::Armed);
        Ok(())
    }

    /// Refuses a run whose contact is there already.
    pub(super) fn require_contact_ahead(&self, away: bool) -> Result<(), Refusal<N>> {
        match (self.status.inputs.probe, away) {
            (InputState::Absent, _) => Err(Refusal::NoProbe),
            (InputState::Active, false) => Err(Refusal::ProbeTouches),
            (InputState::Clear, true) => Err(Refusal::ProbeOpen),
            _ => Ok(()),
        }
    }

    /// Refuses a job while a motor stands on its limit switch.
    #[inline(always)]
    pub(super) fn require_free_limits(&self) -> Result<(), Refusal<N>> {
        if !S::Interlocks::EXISTS {
            return Ok(());
        }
        let limits = self.status.inputs.limits;
        match (0..).zip(limits).find(|(_, state)| state.is_active()) {
            Some((motor, _)) => Err(Refusal::LimitSwitch { motor }),
            None => Ok(()),
        }
    }

    /// Refuses what would move the machine while an input is active. The tick looks, too: the door may open before the order comes.
    #[inline(always)]
    pub(super) fn require_clear_inputs(&self) -> Result<(), Refusal<N>> {
        self.require_released_stop()?;
        match S::Interlocks::EXISTS && self.status.inputs.door.is_active() {
            true => Err(Refusal::DoorOpen),
            false => Ok(()),
        }
    }

    /// Refuses what would acknowledge the emergency stop, or switch the drives on, while it is pressed.
    #[inline(always)]
    pub(super) fn require_released_stop(&self) -> Result<(), Refusal<N>> {
        match S::Interlocks::EXISTS && self.status.inputs.emergency_stop.is_active() {
            true => Err(Refusal::EmergencyStop),
            false => Ok(()),
        }
    }
}
