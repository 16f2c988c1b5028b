//! The model of a machine: number type, and what a tick computes besides the motion of its joints.
//!
//! A scene chooses its model by type. An image therefore holds the code of one model and of
//! nothing else. A host compiles [`AnyDynamic`] instead, which holds the kind of its parts as values and computes the same
//! bits.
//!
//! | model | computes |
//! |---|---|
//! | [`Kinematic`] | angles, rates and accelerations |
//! | [`Dynamic`] | torques as well, for one kind of payload and one kind of links |

mod kind;

pub use kind::{ModelKind, ModelVisitor, OfKind};

use crate::inverse::{LegMotion, Rotation};
use crate::number::Number;
use crate::setpoint::Setpoint;
use crate::source::ToSource;
use crate::status::Status;
use crate::to_source;
use crate::torque::balance::{Balance, Forces};
use crate::torque::lines::DistalLines;
use crate::torque::links::{AnyLinks, LegLoad, Links, LinksKind, Massless};
use crate::torque::payload::{AnyPayload, Centred, Payload};
use core::fmt::Debug;
use core::marker::PhantomData;

/// Number type and dynamics of a machine, with the coefficients of the dynamics.
pub trait Model: Copy + Debug + PartialEq + Send + Sync + ToSource + 'static {
    /// Number type of the whole pipeline.
    type N: Number;

    /// The same model in another number type.
    type Over<N: Number>: Model<N = N>;

    /// Kind of the model; of [`AnyDynamic`] the widest.
    const KIND: ModelKind;

    /// True if the model computes torques.
    const TORQUES: bool;

    /// Builds the coefficients from checked parameters, of the kind asked for where the type holds several.
    fn build(machine: OfKind<'_>) -> Self;

    /// Returns `true` if the motion of the legs takes torques, beside that of the platform.
    fn has_leg_loads(&self) -> bool;

    /// The same without weight and external wrench: torques of the motion alone.
    fn inertial(&self) -> Self;

    /// Returns the load that the links of leg `leg`, 0 to 2, put on the motors.
    fn load(&self, leg: usize, motion: &LegMotion<Self::N>) -> LegLoad<Self::N>;

    /// Solves for the forces along the distal links, unless the pose is singular. The `lines` are formed where none are
    /// given. The angle of `setpoint` is resolved in `rotation`. Number types that
    /// [propagate](crate::number::Arithmetic::PROPAGATES_NON_FINITE) what is not finite leave the question to
    /// [`is_singular`](Self::is_singular).
    ///
    /// # Errors
    /// [`Status::ParallelSingular`], [`Status::OutOfRange`].
    fn forces(
        &self,
        lines: Option<&DistalLines<Self::N>>,
        legs: &[LegMotion<Self::N>; 3],
        loads: &[LegLoad<Self::N>; 3],
        setpoint: &Setpoint<Self::N>,
        rotation: &Rotation<Self::N>,
    ) -> Result<Forces<Self::N>, Status>;

    /// Returns `true` if the torques of a pose with the determinant `det_a` are not defined.
    fn is_singular(&self, det_a: Self::N) -> bool;

    /// The torques alone, for legs whose motion and distal lines are known.
    ///
    /// # Errors
    /// [`Status::ParallelSingular`], [`Status::OutOfRange`].
    fn torques(
        &self,
        lines: Option<&DistalLines<Self::N>>,
        legs: &[LegMotion<Self::N>; 3],
        setpoint: &Setpoint<Self::N>,
        rotation: &Rotation<Self::N>,
    ) -> Result<[Self::N; 3], Status> {
        let load = |leg: usize| self.load(leg, &legs[leg]);
        let loads = [load(0), load(1), load(2)];
        let forces = self.forces(lines, legs, &loads, setpoint, rotation)?;
        match self.is_singular(forces.det_a) {
            true => Err(Status::ParallelSingular),
            false => Ok(forces.torques(legs, &loads)),
        }
    }
}

/// Positions, rates and accelerations only, for motors that take positions, such as steppers.
///
/// Every force and torque is zero. The torque that a pose near a parallel singularity would take
/// does not matter to such a machine. The admission still keeps the distance from the singularity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinematic<N> {
    number: PhantomData<N>,
}

to_source!([N: Number] Kinematic [N] in trirrr_core::model { number: PhantomData<N> });

impl<N: Number> Model for Kinematic<N> {
    type N = N;
    type Over<M: Number> = Kinematic<M>;

    const KIND: ModelKind = ModelKind::Kinematic;
    const TORQUES: bool = false;

    fn build(_: OfKind<'_>) -> Self {
        Self::from_coefficients(PhantomData)
    }

    #[inline(always)]
    fn has_leg_loads(&self) -> bool {
        false
    }

    fn inertial(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn load(&self, _: usize, _: &LegMotion<N>) -> LegLoad<N> {
        LegLoad::NONE
    }

    #[inline(always)]
    fn forces(
        &self,
        lines: Option<&DistalLines<N>>,
        legs: &[LegMotion<N>; 3],
        _: &[LegLoad<N>; 3],
        _: &Setpoint<N>,
        _: &Rotation<N>,
    ) -> Result<Forces<N>, Status> {
        let formed = || DistalLines::of(legs.each_ref().map(|leg| &leg.position)).det_a;
        Ok(Forces {
            along: [N::ZERO; 3],
            det_a: lines.map_or_else(formed, |lines| lines.det_a),
        })
    }

    #[inline(always)]
    fn is_singular(&self, _: N) -> bool {
        false
    }
}

/// Torques by virtual work, for the payload `P` and the links `L`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamic<N: Number, P = Centred<N>, L = Massless> {
    /// Solver for the forces of the legs.
    balance: Balance<N>,
    /// Platform and external loads.
    payload: P,
    /// Masses of the legs.
    links: L,
}

to_source!([N: Number, P: Payload<N>, L: Links<N>] Dynamic [N, P, L] in trirrr_core::model {
    balance: Balance<N>,
    payload: P,
    links: L,
});

/// Torques of a machine whose kind is a value: one type for a host, where an image has one of eight.
pub type AnyDynamic<N> = Dynamic<N, AnyPayload<N>, AnyLinks<N>>;

impl<N: Number, P: Payload<N>, L: Links<N>> Model for Dynamic<N, P, L> {
    type N = N;
    type Over<M: Number> = Dynamic<M, P::Over<M>, L::Over<M>>;

    const KIND: ModelKind = ModelKind::Dynamic(P::KIND, L::KIND);
    const TORQUES: bool = true;

    fn build(machine: OfKind<'_>) -> Self {
        let parameters = machine.parameters;
        let (payload, links) = machine.parts().unwrap_or((P::KIND, L::KIND));
        Self {
            balance: Balance::build(parameters),
            payload: P::build(payload, parameters),
            links: L::build(links, parameters),
        }
    }

    #[inline(always)]
    fn has_leg_loads(&self) -> bool {
        self.links.kind() > LinksKind::Massless
    }

    fn inertial(&self) -> Self {
        Self {
            payload: self.payload.inertial(),
            links: self.links.inertial(),
            ..*self
        }
    }

    #[inline(always)]
    fn load(&self, leg: usize, motion: &LegMotion<N>) -> LegLoad<N> {
        self.links.load(leg, motion)
    }

    #[inline(always)]
    fn forces(
        &self,
        lines: Option<&DistalLines<N>>,
        legs: &[LegMotion<N>; 3],
        loads: &[LegLoad<N>; 3],
        setpoint: &Setpoint<N>,
        rotation: &Rotation<N>,
    ) -> Result<Forces<N>, Status> {
        let demand = self.payload.demand(setpoint, rotation);
        self.balance.forces(lines, legs, &demand, loads)
    }

    #[inline(always)]
    fn is_singular(&self, det_a: N) -> bool {
        self.balance.is_singular(det_a)
    }
}
