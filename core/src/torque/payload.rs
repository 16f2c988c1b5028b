//! The platform and its load: inertia, weight and the external wrench.

use super::demand::Demand;
use crate::inverse::Rotation;
use crate::machine::Parameters;
use crate::number::{Number, cross};
use crate::setpoint::Setpoint;
use crate::source::ToSource;
use crate::to_source;
use core::fmt::{self, Debug};
use nalgebra::Vector2;

/// Kind of a [`Payload`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PayloadKind {
    /// The centre of mass is the reference point.
    Centred,
    /// The centre of mass lies at an offset from the reference point.
    Offset,
}

impl PayloadKind {
    /// Returns the leanest kind that has room for `parameters`.
    pub(crate) fn of(parameters: &Parameters) -> Self {
        let com = parameters.platform.com_m;
        if com.x == 0.0 && com.y == 0.0 {
            Self::Centred
        } else {
            Self::Offset
        }
    }
}

/// A kind of platform. The scene chooses it by type, so that an image holds the code of one.
pub trait Payload<N: Number>: Copy + Debug + PartialEq + Send + Sync + ToSource + 'static {
    /// The same kind in another number type.
    type Over<M: Number>: Payload<M>;

    /// Kind of the payload; of [`AnyPayload`] the widest.
    const KIND: PayloadKind;

    /// Builds the coefficients from checked parameters, of the kind `kind` where the type holds several.
    fn build(kind: PayloadKind, parameters: &Parameters) -> Self;

    /// The same without weight and external wrench.
    fn inertial(&self) -> Self;

    /// F and M for one setpoint, whose angle is resolved in `rotation`.
    fn demand(&self, setpoint: &Setpoint<N>, rotation: &Rotation<N>) -> Demand<N>;
}

/// A platform whose centre of mass is its reference point D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centred<N: Number> {
    /// Mass.
    mass: N::Factor,
    /// Moment of inertia about the centre of mass.
    inertia: N::Factor,
    /// -m g - W: what is constant in F.
    static_force: Vector2<N>,
    /// -Walpha: what is constant in M.
    static_moment: N,
}

to_source!([N: Number] Centred [N] in trirrr_core::torque::payload {
    mass: N::Factor,
    inertia: N::Factor,
    static_force: Vector2<N>,
    static_moment: N,
});

impl<N: Number> Payload<N> for Centred<N> {
    type Over<M: Number> = Centred<M>;
    const KIND: PayloadKind = PayloadKind::Centred;

    fn build(_: PayloadKind, parameters: &Parameters) -> Self {
        let mass = parameters.platform.mass_kg;
        let force = -(parameters.gravity_m_s2 * mass + parameters.wrench_force_n);
        Self {
            mass: N::factor_from_f64(mass),
            inertia: N::factor_from_f64(parameters.platform.inertia_kgm2),
            static_force: force.map(N::from_f64),
            static_moment: N::from_f64(-parameters.wrench_torque_nm),
        }
    }

    fn inertial(&self) -> Self {
        Self {
            static_force: Vector2::new(N::ZERO, N::ZERO),
            static_moment: N::ZERO,
            ..*self
        }
    }

    #[inline(always)]
    fn demand(&self, setpoint: &Setpoint<N>, _: &Rotation<N>) -> Demand<N> {
        let a = setpoint.acceleration;
        Demand {
            force: Vector2::new(
                a.x.scaled(self.mass) + self.static_force.x,
                a.y.scaled(self.mass) + self.static_force.y,
            ),
            moment: a.z.scaled(self.inertia) + self.static_moment,
        }
    }
}

/// A platform whose centre of mass lies at an offset from D, as with a payload held out of centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset<N: Number> {
    /// Mass.
    mass: N::Factor,
    /// Moment of inertia about the centre of mass.
    inertia: N::Factor,
    /// s in the platform's frame.
    com: Vector2<N>,
    /// g.
    gravity: Vector2<N>,
    /// W.
    wrench_force: Vector2<N>,
    /// Walpha.
    wrench_moment: N,
}

to_source!([N: Number] Offset [N] in trirrr_core::torque::payload {
    mass: N::Factor,
    inertia: N::Factor,
    com: Vector2<N>,
    gravity: Vector2<N>,
    wrench_force: Vector2<N>,
    wrench_moment: N,
});

impl<N: Number> Payload<N> for Offset<N> {
    type Over<M: Number> = Offset<M>;
    const KIND: PayloadKind = PayloadKind::Offset;

    fn build(_: PayloadKind, parameters: &Parameters) -> Self {
        Self {
            mass: N::factor_from_f64(parameters.platform.mass_kg),
            inertia: N::factor_from_f64(parameters.platform.inertia_kgm2),
            com: parameters.platform.com_m.map(N::from_f64),
            gravity: parameters.gravity_m_s2.map(N::from_f64),
            wrench_force: parameters.wrench_force_n.map(N::from_f64),
            wrench_moment: N::from_f64(parameters.wrench_torque_nm),
        }
    }

    fn inertial(&self) -> Self {
        let zero = Vector2::new(N::ZERO, N::ZERO);
        Self {
            gravity: zero,
            wrench_force: zero,
            wrench_moment: N::ZERO,
            ..*self
        }
    }

    #[inline(always)]
    fn demand(&self, setpoint: &Setpoint<N>, rotation: &Rotation<N>) -> Demand<N> {
        let (velocity, a) = (setpoint.velocity, setpoint.acceleration);
        let s = rotation.apply(self.com);
        // By coordinates: large numbers are copied as parts of vectors.
        let turning_sq = velocity.z * velocity.z;
        let inertial = |a_d: N, across: N, along: N, gravity: N| {
            let a_com = a_d + (across * a.z - along * turning_sq);
            (a_com - gravity).scaled(self.mass)
        };
        let inertial = Vector2::new(
            inertial(a.x, -s.y, s.x, self.gravity.x),
            inertial(a.y, s.x, s.y, self.gravity.y),
        );
        Demand {
            force: Vector2::new(
                inertial.x - self.wrench_force.x,
                inertial.y - self.wrench_force.y,
            ),
            moment: a.z.scaled(self.inertia) + cross(s, inertial) - self.wrench_moment,
        }
    }
}

/// A platform of either kind, for hosts: the kind is a value, so that the code around it is compiled once.
/// Each variant computes the bits of its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyPayload<N: Number> {
    /// The centre of mass is D.
    Centred(Centred<N>),
    /// The centre of mass lies at an offset from D.
    Offset(Offset<N>),
}

impl<N: Number> Payload<N> for AnyPayload<N> {
    type Over<M: Number> = AnyPayload<M>;
    const KIND: PayloadKind = PayloadKind::Offset;

    fn build(kind: PayloadKind, parameters: &Parameters) -> Self {
        match kind {
            PayloadKind::Centred => Self::Centred(Centred::build(kind, parameters)),
            PayloadKind::Offset => Self::Offset(Offset::build(kind, parameters)),
        }
    }

    fn inertial(&self) -> Self {
        match self {
            Self::Centred(payload) => Self::Centred(payload.inertial()),
            Self::Offset(payload) => Self::Offset(payload.inertial()),
        }
    }

    #[inline(always)]
    fn demand(&self, setpoint: &Setpoint<N>, rotation: &Rotation<N>) -> Demand<N> {
        match self {
            Self::Centred(payload) => payload.demand(setpoint, rotation),
            Self::Offset(payload) => payload.demand(setpoint, rotation),
        }
    }
}

/// Source of the part of the kind that the value has: an image names that type.
impl<N: Number> ToSource for AnyPayload<N> {
    /// No image has this type.
    fn write_type(_: &mut dyn fmt::Write) -> fmt::Result {
        Err(fmt::Error)
    }

    fn write_value(&self, out: &mut dyn fmt::Write) -> fmt::Result {
        match self {
            Self::Centred(part) => part.write_value(out),
            Self::Offset(part) => part.write_value(out),
        }
    }
}
