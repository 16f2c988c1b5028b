//! Replaced parts of the scene: another geometry, other loads, other limits.

use super::super::coefficients::Coefficients;
use super::super::handoff::Order;
use super::super::scene::{Put, Scene, Setup, refusal};
use super::{Background, at_rest};
use crate::admission::Judgement;
use crate::number::ServiceNumber;
use trirrr_core::forward::Forward;
use trirrr_protocol::message::scene::Section;
use trirrr_protocol::message::{Content, Refusal, State};

/// Newton steps after which a pose is not found. From the pose before a calibration it takes three
/// or four.
const MOST_STEPS: u32 = 32;

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Replaces a part of the scene. The motors stay where they are; where the platform then is,
    /// is found by forward kinematics from where it was. A part with which the machine could not stand there is refused.
    pub(super) fn change(&mut self, part: &S::Replacement) -> Result<(), Refusal<N>> {
        let section = part.content().ok_or(Refusal::NotAdjustable)?;
        let units = self.settings.scene.units();
        let (parameters, limits) = self.scene.changed(section, &units)?;
        self.require_idle()?;
        let end = self.status.end.ok_or(Refusal::State(self.status.state))?;
        let period = N::factor_to_f64(self.settings.period);
        let ramp = self.settings.ramp;
        let built = Coefficients::<S::Model>::build(&parameters, &limits, ramp, period);
        let built = built.map_err(refusal)?;
        let geometry = *built.tick.geometry();
        let pose = match section {
            Section::Leg { .. } => {
                let forward = Forward::build(&parameters, &geometry);
                let found = forward.solve(&self.angles, end.pose, MOST_STEPS);
                found.map_err(|_| Refusal::NoPose)?.pose
            }
            Section::Platform(_) | Section::Limits(_) => end.pose,
        };

        // What the tick would find in its next look is found here: a part that it cannot stand with would be a fault without a way out.
        Self::can_stand(&built.tick, &built.limits, pose)?;

        let setup = Setup {
            tick: built.tick,
            limits: built.limits,
            pose,
        };
        if !self.orders.has_room() || !self.setups.put(setup) {
            return Err(Refusal::Busy);
        }
        self.order(Order::Adopt, State::Idle)?;
        self.scene
            .adopt(parameters, limits, built, &mut self.coefficients);
        self.judgement = Judgement::new();
        self.status.end = Some(at_rest(pose));
        Ok(())
    }
}
