//! A scene that the host can change while the machine is idle.

use super::{Scene, Setup};
use crate::coefficients::{Coefficients, allow_jerk};
use crate::contact::ContactCoefficients;
use crate::feedback::FeedbackCoefficients;
use crate::homing::{NoHoming, Plan};
use crate::number::ServiceNumber;
use crate::offered::PlayedCurves;
use crate::planner::PathPlanner;
use crate::settings::Settings;
use core::marker::PhantomData;
use heapless::spsc::Queue;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, LegParameters, Parameters};
use trirrr_core::model::{Model, ModelKind};
use trirrr_core::setpoint::Quintics;
use trirrr_core::units::Units;
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::message::{MoveBatch, Refusal};

/// Scene that the host can change, within the room that the model `M` has. It plays
/// moves of the kinds `K`, and plans paths by `P`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjustable<M, K = Quintics, P = ()> {
    parameters: Parameters,
    limits: LimitParameters,
    types: PhantomData<(M, K, P)>,
}

impl<M: Model, K: PlayedCurves, P> Adjustable<M, K, P> {
    /// Starts with this machine, in its own units. `M` has to be the model of the machine.
    pub fn new(parameters: Parameters, limits: LimitParameters) -> Self {
        Self {
            parameters,
            limits,
            types: PhantomData,
        }
    }

    /// Returns true if the model can hold the changed scene.
    fn has_room_for(&self, parameters: &Parameters, limits: &LimitParameters) -> bool {
        let keeps = M::TORQUES || (limits.torque_nm.is_none() && limits.power_w.is_none());
        let keeps = keeps && (K::JERK || limits.jerk_rad_s3.is_none());
        keeps && M::KIND.has_room_for(ModelKind::of(parameters, M::TORQUES))
    }
}

impl<N: ServiceNumber, M: Model<N = N>, K: PlayedCurves, P: PathPlanner<N>> Scene
    for Adjustable<M, K, P>
{
    type N = N;
    type Model = M;
    type Slot = Queue<Setup<M>, 2>;
    type Replacement = Section;
    type Batch = MoveBatch<N>;
    type Curves = K;
    type Planner = P;
    type Part = Section;
    type Levels = ();
    type Homing = NoHoming;
    type Feedback = ();
    type Contact = ();
    type Retreat = crate::retreat::NoRetreat;
    type Interlocks = ();
    type Coefficients = Coefficients<M>;

    fn coefficients(&self, settings: &Settings<N>) -> Result<Coefficients<M>, BuildError> {
        allow_jerk::<K>(self.limits.jerk_rad_s3)?;
        let period = N::factor_to_f64(settings.period);
        Coefficients::build(&self.parameters, &self.limits, settings.ramp, period)
    }

    fn part(&self, name: SectionName, units: &Units) -> Option<Section> {
        let si = units.inverse();
        Section::of(
            name,
            &si.parameters(&self.parameters),
            &si.limits(&self.limits),
        )
    }

    #[inline(always)]
    fn levels(&self) -> u16 {
        0
    }

    fn homing(&self) -> NoHoming {
        NoHoming
    }

    #[inline(always)]
    fn interlocks(&self) {}

    #[inline(always)]
    fn feedback(&self) -> Option<&FeedbackCoefficients<N>> {
        None
    }

    #[inline(always)]
    fn contact(&self) -> Option<&ContactCoefficients<N>> {
        None
    }

    #[inline(always)]
    fn plan(&self) -> Option<Plan<N>> {
        None
    }

    fn changed(
        &self,
        section: &Section,
        units: &Units,
    ) -> Result<(Parameters, LimitParameters), Refusal<N>> {
        let si = units.inverse();
        let mut parameters = si.parameters(&self.parameters);
        let mut limits = si.limits(&self.limits);
        match section {
            Section::Leg { index, leg } => {
                let place = parameters.legs.get_mut(usize::from(*index));
                *place.ok_or(Refusal::NoSuchLeg)? = LegParameters::from(leg);
            }
            Section::Platform(platform) => parameters = platform.put_into(&parameters),
            Section::Limits(section) => limits = section.into(),
        }
        if !self.has_room_for(&parameters, &limits) {
            return Err(Refusal::NotInImage);
        }
        Ok((units.parameters(&parameters), units.limits(&limits)))
    }

    fn adopt(
        &mut self,
        parameters: Parameters,
        limits: LimitParameters,
        built: Coefficients<M>,
        kept: &mut Coefficients<M>,
    ) {
        (self.parameters, self.limits, *kept) = (parameters, limits, built);
    }
}
