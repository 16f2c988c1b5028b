//! A scene that the host can change while the machine is idle.

use super::declare::lacks;
use super::{Changed, Machine, NoImage, Scene};
use crate::built::{Coefficients, allow_jerk};
use crate::curves::PlayedCurves;
use crate::feature::On;
use crate::number::ServiceNumber;
use crate::planner::PathPlanner;
use crate::settings::Settings;
use core::f64::consts::PI;
use core::marker::PhantomData;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, LegParameters, Parameters, Quantity};
use trirrr_core::model::{Model, ModelKind, OfKind};
use trirrr_core::setpoint::Quintics;
use trirrr_core::units::Units;
use trirrr_protocol::message::Refusal;
use trirrr_protocol::message::scene::{Section, SectionName};

/// Scene that the host can change, within the room that the model `M` has. It plays
/// moves of the kinds `K`, and plans paths by `P`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjustable<M, K = Quintics, P = ()> {
    parameters: Parameters,
    limits: LimitParameters,
    /// Kind of the model, where `M` holds several.
    kind: Option<ModelKind>,
    /// Encoder offsets, rad.
    offsets_rad: [f64; 3],
    types: PhantomData<(M, K, P)>,
}

impl<M: Model, K: PlayedCurves, P> Adjustable<M, K, P> {
    /// Starts with this machine, in its own units. `M` has to be the model of the machine.
    pub fn new(parameters: Parameters, limits: LimitParameters) -> Self {
        Self {
            parameters,
            limits,
            kind: None,
            offsets_rad: [0.0; 3],
            types: PhantomData,
        }
    }

    /// Builds the model of the machine, and takes changes of the scene, as an image does whose type is of this kind alone.
    pub fn of_kind(self, kind: ModelKind) -> Self {
        Self {
            kind: Some(kind),
            ..self
        }
    }

    fn machine<'a>(&self, parameters: &'a Parameters) -> OfKind<'a> {
        OfKind {
            parameters,
            kind: self.kind,
        }
    }

    /// Returns true if the model can hold the changed scene.
    fn has_room_for(&self, parameters: &Parameters, limits: &LimitParameters) -> bool {
        let keeps = M::TORQUES || (limits.torque_nm.is_none() && limits.power_w.is_none());
        let keeps = keeps && (K::JERK || limits.jerk_rad_s3.is_none());
        let own = self.kind.unwrap_or(M::KIND);
        keeps && own.has_room_for(ModelKind::of(parameters, M::TORQUES))
    }
}

/// Scene of the machine alone, as a host reads its requests.
impl<N: ServiceNumber, M: Model<N = N>, K: PlayedCurves, P: PathPlanner<N>> Scene
    for Adjustable<M, K, P>
{
    type N = N;
    type Machine = Self;
    type Batches = On;
    type Update = NoImage;
    lacks!();
}

impl<N: ServiceNumber, M: Model<N = N>, K: PlayedCurves, P: PathPlanner<N>> Machine
    for Adjustable<M, K, P>
{
    type N = N;
    type Model = M;
    type Curves = K;
    type Planner = P;
    type Changes = On;
    type Part = Section;
    type Coefficients = Coefficients<M>;

    fn coefficients(&self, settings: &Settings<N>) -> Result<Coefficients<M>, BuildError> {
        allow_jerk::<K>(self.limits.jerk_rad_s3)?;
        let period = N::factor_to_f64(settings.period);
        let machine = self.machine(&self.parameters);
        Coefficients::build(machine, &self.limits, settings.ramp, period)
    }

    fn part(&self, name: SectionName, units: &Units) -> Option<Section> {
        let si = units.inverse();
        let mut part = Section::of(
            name,
            &si.parameters(&self.parameters),
            &si.limits(&self.limits),
        );
        if let Some(Section::Leg { index, leg }) = &mut part
            && let Some(offset) = self.offsets_rad.get(usize::from(*index))
        {
            leg.encoder_offset_rad = *offset;
        }
        part
    }

    fn changed(&self, section: &Section, units: &Units) -> Result<Changed, Refusal<N>> {
        let si = units.inverse();
        let mut parameters = si.parameters(&self.parameters);
        let mut limits = si.limits(&self.limits);
        let mut offsets_rad = self.offsets_rad;
        match section {
            Section::Leg { index, leg } => {
                let place = usize::from(*index);
                let parts = parameters
                    .legs
                    .get_mut(place)
                    .zip(offsets_rad.get_mut(place));
                let (own, offset) = parts.ok_or(Refusal::NoSuchLeg)?;
                *own = LegParameters::from(leg);
                *offset = leg.encoder_offset_rad;
                // Beyond half a turn it would be another angle, and no number is within it.
                if !(offset.abs() <= PI) {
                    return Err(Refusal::Parameter {
                        quantity: Quantity::EncoderOffset,
                        leg: Some(*index),
                    });
                }
            }
            Section::Platform(platform) => parameters = platform.put_into(&parameters),
            Section::Limits(section) => limits = section.into(),
        }
        if !self.has_room_for(&parameters, &limits) {
            return Err(Refusal::NotInImage);
        }
        let parameters = units.parameters(&parameters);
        Ok(Changed {
            tool_way: parameters.platform.tool_point_m - self.parameters.platform.tool_point_m,
            parameters,
            kind: self.kind,
            limits: units.limits(&limits),
            offsets_rad,
            shift_rad: [0, 1, 2].map(|motor| offsets_rad[motor] - self.offsets_rad[motor]),
        })
    }

    fn adopt(&mut self, changed: &Changed, built: Coefficients<M>, kept: &mut Coefficients<M>) {
        (self.parameters, self.limits) = (changed.parameters, changed.limits);
        self.offsets_rad = changed.offsets_rad;
        *kept = built;
    }
}
