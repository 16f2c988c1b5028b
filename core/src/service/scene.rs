//! The scene that a service is built from, and whether it can be changed.
//!
//! [`Compiled`] is what it is: an image with it holds no code to build a machine anew.
//! [`Adjustable`] takes overrides of geometry, loads and limits while the machine stands idle. It is
//! a choice by type, so who does not want it does not pay for it.

use super::queue::{Receiver, Sender};
use crate::limits::{LimitParameters, Limits};
use crate::machine::{BuildError, LegParameters, LinksKind, Parameters, PayloadKind};
use crate::message::Refusal;
use crate::message::scene::{Leg, Platform, Section, SectionName};
use crate::number::Number;
use crate::setpoint::Pose;
use crate::tick::Tick;
use crate::torque::links::Links;
use crate::torque::payload::Payload;
use heapless::spsc::Queue;

/// What the tick works with, built from a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<N: Number, P, L> {
    /// The pipeline.
    pub(super) tick: Tick<N, P, L>,
    /// What its results must keep.
    pub(super) limits: Limits<N>,
    /// Where the platform stands.
    pub(super) pose: Pose<N>,
}

/// A scene, as the background keeps it.
pub trait Scene<N: Number, P: Payload<N>, L: Links<N>> {
    /// Room for a setup on its way to the tick.
    type Slot: Slot<Setup<N, P, L>>;

    /// The machine, in its own units.
    fn parameters(&self) -> &Parameters;

    /// Its limits, in the same units.
    fn limits(&self) -> &LimitParameters;

    /// The scene, given in SI units as `parameters` and `limits`, with `section` in place of its own.
    ///
    /// # Errors
    /// Why there is no such scene.
    fn changed(
        &self,
        parameters: Parameters,
        limits: LimitParameters,
        section: &Section,
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

/// A scene that stays as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compiled<'a> {
    /// The machine, in its own units.
    pub parameters: &'a Parameters,
    /// Its limits, in the same units.
    pub limits: &'a LimitParameters,
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

    fn has_room_for(&self, parameters: &Parameters) -> bool {
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

impl<N: Number, P: Payload<N>, L: Links<N>> Scene<N, P, L> for Compiled<'_> {
    type Slot = NoSlot;

    fn parameters(&self) -> &Parameters {
        self.parameters
    }

    fn limits(&self) -> &LimitParameters {
        self.limits
    }

    fn changed(
        &self,
        _: Parameters,
        _: LimitParameters,
        _: &Section,
    ) -> Result<(Parameters, LimitParameters), Refusal<N>> {
        Err(Refusal::NotAdjustable)
    }

    fn adopt(&mut self, _: Parameters, _: LimitParameters) {}
}

impl<N, P, L> Scene<N, P, L> for Adjustable
where
    N: Number,
    P: Payload<N> + Send,
    L: Links<N> + Send,
{
    type Slot = Queue<Setup<N, P, L>, 2>;

    fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    fn limits(&self) -> &LimitParameters {
        &self.limits
    }

    fn changed(
        &self,
        mut parameters: Parameters,
        mut limits: LimitParameters,
        section: &Section,
    ) -> Result<(Parameters, LimitParameters), Refusal<N>> {
        match section {
            Section::Leg { index, leg } => {
                let place = parameters.legs.get_mut(usize::from(*index));
                *place.ok_or(Refusal::NoSuchLeg)? = LegParameters::from(leg);
            }
            Section::Platform(platform) => parameters = platform.put_into(&parameters),
            Section::Limits(section) => limits = section.into(),
        }
        if !self.has_room_for(&parameters) {
            return Err(Refusal::NotInImage);
        }
        Ok((parameters, limits))
    }

    fn adopt(&mut self, parameters: Parameters, limits: LimitParameters) {
        (self.parameters, self.limits) = (parameters, limits);
    }
}

/// The part `name` of a scene, given in SI units.
pub(super) fn section<N: Number>(
    name: SectionName,
    parameters: &Parameters,
    limits: &LimitParameters,
) -> Result<Section, Refusal<N>> {
    match name {
        SectionName::Leg(index) => {
            let leg = parameters.legs.get(usize::from(index));
            let leg = Leg::from(leg.ok_or(Refusal::NoSuchLeg)?);
            Ok(Section::Leg { index, leg })
        }
        SectionName::Platform => Ok(Section::Platform(Platform::from(parameters))),
        SectionName::Limits => Ok(Section::Limits(limits.into())),
    }
}

/// What a scene that cannot be built is refused with.
pub(super) fn refusal<N: Number>(error: BuildError) -> Refusal<N> {
    Refusal::Parameter {
        quantity: error.quantity,
        leg: error.leg.map(|leg| leg as u8),
    }
}
