//! Overrides: another geometry, other loads, other limits.

use super::super::link::Order;
use super::super::scene::{Put, Scene, Setup, refusal};
use super::{Background, End};
use crate::admission::Admission;
use crate::forward::Forward;
use crate::limits::Limits;
use crate::message::scene::Section;
use crate::message::{Refusal, State};
use crate::number::Number;
use crate::singularity::Distances;
use crate::tick::Tick;
use crate::torque::links::Links;
use crate::torque::payload::Payload;

/// Newton steps after which a pose is not found. From the pose before a calibration it takes three
/// or four.
const MOST_STEPS: u32 = 32;

impl<N, P, L, S, U> Background<'_, N, P, L, S, U>
where
    N: Number,
    P: Payload<N>,
    L: Links<N>,
    S: Scene<N, P, L>,
    U: Put<Setup<N, P, L>>,
{
    /// Replaces a part of the scene. The motors stay where they are; where the platform then is,
    /// is found by forward kinematics from where it was.
    pub(super) fn change(&mut self, section: &Section) -> Result<(), Refusal<N>> {
        let (si, units) = (self.settings.scene.into_si(), self.settings.scene.units());
        let parameters = si.parameters(self.scene.parameters());
        let limits = si.limits(self.scene.limits());
        let (parameters, limits) = self.scene.changed(parameters, limits, section)?;
        let (parameters, limits) = (units.parameters(&parameters), units.limits(&limits));
        self.waits()?;
        let end = self.end.ok_or(Refusal::State(self.state))?;
        let tick = Tick::<N, P, L>::build(&parameters).map_err(refusal)?;
        let built = Limits::build(&limits).map_err(refusal)?;
        let geometry = *tick.geometry();
        let pose = match section {
            Section::Leg { .. } => {
                let forward = Forward::build(&parameters, &geometry);
                let found = forward.solve(&self.angles, end.pose, MOST_STEPS);
                found.map_err(|_| Refusal::NoPose)?.pose
            }
            Section::Platform(_) | Section::Limits(_) => end.pose,
        };
        let distances = Distances::build(&parameters);
        let ramp = self.settings.ramp_ticks;
        let period = N::factor_to_f64(self.settings.period);
        let admission = Admission::build(&parameters, built, ramp, period).map_err(refusal)?;

        let setup = Setup {
            tick,
            limits: built,
            pose,
        };
        if !self.orders.has_room() || !self.setups.put(setup) {
            return Err(Refusal::Busy);
        }
        self.order(Order::Adopt, State::Idle)?;
        self.scene.adopt(parameters, limits);
        (self.geometry, self.limits) = (geometry, built);
        (self.distances, self.admission) = (distances, admission);
        self.end = Some(End::at_rest(pose));
        Ok(())
    }
}
