//! The scene that a service is built from, and whether it can be changed.
//!
//! [`Compiled`] is what it is: an image with it holds coefficients and no code to build any.
//! [`Adjustable`] takes overrides of geometry, loads and limits while the machine stands idle. It is
//! a choice by type, so who does not want it does not pay for it.

use super::coefficients::Coefficients;
use super::homing::{Homing, NoHoming, Plan};
use super::queue::{Receiver, Sender};
use super::settings::Settings;
use crate::admission::Enclose;
use heapless::spsc::Queue;
use serde::Serialize;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{BuildError, LegParameters, LinksKind, Parameters, PayloadKind};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_core::tick::Tick;
use trirrr_core::torque::balance::Solve;
use trirrr_core::torque::links::Links;
use trirrr_core::torque::payload::Payload;
use trirrr_core::units::Units;
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::message::{Refusal, Replacement, Unread, Written};

/// What the tick works with, built from a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<N: Enclose, P: Payload<N>, L> {
    /// The pipeline.
    pub(super) tick: Tick<N, P, L>,
    /// What its results must keep.
    pub(super) limits: Limits<N>,
    /// Where the platform stands.
    pub(super) pose: Pose<N>,
}

/// A scene, as the background keeps it.
pub trait Scene<N: Enclose, P: Payload<N>, L: Links<N>> {
    /// Room for a setup on its way to the tick.
    type Slot: Slot<Setup<N, P, L>>;

    /// What is read of a part of the scene in a request: all of it where it can be changed.
    type Replacement: Replacement;

    /// What a part of the scene is in a reply.
    type Part: Serialize;

    /// How its machine finds out where its motors are; [`NoHoming`] if it knows.
    type Homing: Homing<N>;

    /// What the service works with at the start.
    ///
    /// # Errors
    /// A machine or a limit that cannot be built.
    fn coefficients(&self, settings: &Settings<N>) -> Result<Coefficients<N, P, L>, BuildError>;

    /// The part `name`, in SI units; the machine is in `units`. None where there is no such leg.
    fn part(&self, name: SectionName, units: &Units) -> Option<Self::Part>;

    /// Homing, before it has begun.
    fn homing(&self) -> Self::Homing;

    /// What the background has to know of it; none where it is not needed.
    fn plan(&self) -> Option<Plan<N>>;

    /// The scene, in the machine's `units`, with `section` in place of its own.
    ///
    /// # Errors
    /// Why there is no such scene.
    fn changed(
        &self,
        section: &Section,
        units: &Units,
    ) -> Result<(Parameters, LimitParameters), Refusal<N>>;

    /// Takes a changed scene as its own.
    fn adopt(&mut self, parameters: Parameters, limits: LimitParameters);
}

/// Room for one item between the two halves, or for none.
pub trait Slot<T>: Send {
    /// No item.
    const EMPTY: Self;

    /// The end to put in,
    type Put<'q>: Put<T>
    where
        Self: 'q;
    /// and the end to take out.
    type Take<'q>: Take<T>
    where
        Self: 'q;

    /// Both ends.
    fn split(&mut self) -> (Self::Put<'_>, Self::Take<'_>);
}

/// The end of a slot to put in.
pub trait Put<T> {
    /// Puts `item` in; whether there was room.
    fn put(&mut self, item: T) -> bool;
}

/// The end of a slot to take out.
pub trait Take<T> {
    /// Takes the item out.
    fn take(&mut self) -> Option<T>;
}

/// A scene that stays as it is. Its coefficients may have been built long before, on another
/// machine; its description is only passed on.
#[derive(Clone, Copy, Debug)]
pub struct Compiled<'a, N: Enclose, P: Payload<N>, L: Links<N>> {
    /// What the service works with, in the machine's units.
    pub coefficients: &'a Coefficients<N, P, L>,
    /// Its description.
    pub parts: Parts<'a>,
}

/// The parts of a scene, in SI units, each a [`Section`] as the bytes that it is sent as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts<'a> {
    /// The legs.
    pub legs: [&'a [u8]; 3],
    /// The platform and its loads.
    pub platform: &'a [u8],
    /// The limits.
    pub limits: &'a [u8],
}

/// A scene that can be changed, within what the image's types have room for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjustable {
    parameters: Parameters,
    limits: LimitParameters,
    /// What the first machine needs, and the image's types hold.
    payload: PayloadKind,
    links: LinksKind,
}

impl Adjustable {
    /// Starts with this machine, in its own units, for which the image's types were chosen.
    pub fn new(parameters: Parameters, limits: LimitParameters) -> Self {
        Self {
            payload: PayloadKind::of(&parameters),
            links: LinksKind::of(&parameters),
            parameters,
            limits,
        }
    }

    fn has_room_for<N: Enclose, P: Payload<N>>(
        &self,
        parameters: &Parameters,
        limits: &LimitParameters,
    ) -> bool {
        if !P::Balance::TORQUES {
            // Masses are nobody's business then, and a limit of a torque nobody's who could hold it.
            return limits.torque_nm.is_none() && limits.power_w.is_none();
        }
        let payload = match PayloadKind::of(parameters) {
            PayloadKind::Centred => true,
            PayloadKind::Offset => self.payload == PayloadKind::Offset,
        };
        let rank = |links| match links {
            LinksKind::Massless => 0,
            LinksKind::Rotors => 1,
            LinksKind::MassiveHorizontal => 2,
            LinksKind::MassiveInPlane => 3,
        };
        payload && rank(LinksKind::of(parameters)) <= rank(self.links)
    }
}

/// A slot without room.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSlot;

impl<T> Slot<T> for NoSlot {
    const EMPTY: Self = Self;
    type Put<'q> = Self;
    type Take<'q> = Self;

    fn split(&mut self) -> (Self, Self) {
        (Self, Self)
    }
}

impl<T> Put<T> for NoSlot {
    fn put(&mut self, _: T) -> bool {
        false
    }
}

impl<T> Take<T> for NoSlot {
    #[inline(always)]
    fn take(&mut self) -> Option<T> {
        None
    }
}

impl<T: Send> Slot<T> for Queue<T, 2> {
    const EMPTY: Self = Queue::new();
    type Put<'q>
        = QueuePut<'q, T>
    where
        T: 'q;
    type Take<'q>
        = QueueTake<'q, T>
    where
        T: 'q;

    fn split(&mut self) -> (QueuePut<'_, T>, QueueTake<'_, T>) {
        let (put, take) = Queue::split(self);
        (QueuePut(Sender::new(put)), QueueTake(Receiver::new(take)))
    }
}

/// The end of a queue to put in.
pub struct QueuePut<'q, T>(Sender<'q, T>);

/// The end of a queue to take out.
pub struct QueueTake<'q, T>(Receiver<'q, T>);

impl<T> Put<T> for QueuePut<'_, T> {
    fn put(&mut self, item: T) -> bool {
        self.0.send(item)
    }
}

impl<T> Take<T> for QueueTake<'_, T> {
    fn take(&mut self) -> Option<T> {
        self.0.receive()
    }
}

impl<'a, N: Enclose, P: Payload<N>, L: Links<N>> Scene<N, P, L> for Compiled<'a, N, P, L> {
    type Slot = NoSlot;
    type Replacement = Unread;
    type Part = Written<'a>;
    type Homing = NoHoming;

    #[inline(always)]
    fn coefficients(&self, _: &Settings<N>) -> Result<Coefficients<N, P, L>, BuildError> {
        Ok(*self.coefficients)
    }

    fn part(&self, name: SectionName, _: &Units) -> Option<Written<'a>> {
        Some(Written(match name {
            SectionName::Leg(index) => self.parts.legs.get(usize::from(index))?,
            SectionName::Platform => self.parts.platform,
            SectionName::Limits => self.parts.limits,
        }))
    }

    #[inline(always)]
    fn homing(&self) -> NoHoming {
        NoHoming
    }

    #[inline(always)]
    fn plan(&self) -> Option<Plan<N>> {
        None
    }

    // Inlined, so that what would come of a change is seen to be unreachable.
    #[inline(always)]
    fn changed(&self, _: &Section, _: &Units) -> Result<(Parameters, LimitParameters), Refusal<N>> {
        Err(Refusal::NotAdjustable)
    }

    fn adopt(&mut self, _: Parameters, _: LimitParameters) {}
}

impl<N, P, L> Scene<N, P, L> for Adjustable
where
    N: Enclose,
    P: Payload<N>,
    L: Links<N>,
{
    type Slot = Queue<Setup<N, P, L>, 2>;
    type Replacement = Section;
    type Part = Section;
    type Homing = NoHoming;

    fn coefficients(&self, settings: &Settings<N>) -> Result<Coefficients<N, P, L>, BuildError> {
        let period = N::factor_to_f64(settings.period);
        Coefficients::build(&self.parameters, &self.limits, settings.ramp_ticks, period)
    }

    fn part(&self, name: SectionName, units: &Units) -> Option<Section> {
        let si = units.inverse();
        Section::of(
            name,
            &si.parameters(&self.parameters),
            &si.limits(&self.limits),
        )
    }

    fn homing(&self) -> NoHoming {
        NoHoming
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
        if !self.has_room_for::<N, P>(&parameters, &limits) {
            return Err(Refusal::NotInImage);
        }
        Ok((units.parameters(&parameters), units.limits(&limits)))
    }

    fn adopt(&mut self, parameters: Parameters, limits: LimitParameters) {
        (self.parameters, self.limits) = (parameters, limits);
    }
}

/// What a scene that cannot be built is refused with.
pub(super) fn refusal<N: Number>(error: BuildError) -> Refusal<N> {
    Refusal::Parameter {
        quantity: error.quantity,
        leg: error.leg.map(|leg| leg as u8),
    }
}
