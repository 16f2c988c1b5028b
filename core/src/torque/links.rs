//! Loads that the legs' own masses add. The scene chooses the kind by type: with [`Massless`] links
//! an image holds no link code.

use crate::inverse::LegMotion;
use crate::machine::{LegParameters, Parameters};
use crate::number::{Number, dot, perpendicular};
use crate::source::ToSource;
use crate::to_source;
use core::fmt::{self, Debug};
use nalgebra::Vector2;

/// The inertia and weight of one leg's links against their angles. `None` is not zero but absent:
/// known at compile time, so that nothing is computed with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegLoad<N> {
    /// Q1 - q (r1 . r2): what the motor supplies besides the force along the distal link; rotor
    /// included.
    pub at_motor: Option<N>,
    /// q = Q2 / l2^2: against theta_2.
    pub distal_over_l2_sq: Option<N>,
}

impl<N: Number> LegLoad<N> {
    /// The load of links without mass and motors without rotor inertia.
    pub const NONE: Self = Self {
        at_motor: None,
        distal_over_l2_sq: None,
    };

    /// Returns `true` if the load is [in range](crate::number::Arithmetic::in_range).
    #[inline(always)]
    pub fn fits(&self) -> bool {
        let fits = |load: Option<N>| load.is_none_or(|load| N::in_range([load]));
        fits(self.at_motor) && fits(self.distal_over_l2_sq)
    }
}

/// Kind of [`Links`]. Each kind has room for those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LinksKind {
    /// No mass, no rotor inertia.
    Massless,
    /// No mass, but rotor inertia.
    Rotors,
    /// Mass, no gravity in the plane.
    MassiveHorizontal,
    /// Mass, and gravity in the plane.
    MassiveInPlane,
}

impl LinksKind {
    /// Returns the leanest kind that has room for `parameters`.
    pub(crate) fn of(parameters: &Parameters) -> Self {
        let g = parameters.gravity_m_s2;
        let rotors = parameters
            .legs
            .iter()
            .any(|leg| leg.rotor_inertia_kgm2 != 0.0);
        match (parameters.links_are_massless(), rotors) {
            (true, false) => Self::Massless,
            (true, true) => Self::Rotors,
            (false, _) if g.x == 0.0 && g.y == 0.0 => Self::MassiveHorizontal,
            (false, _) => Self::MassiveInPlane,
        }
    }
}

/// A kind of links.
pub trait Links<N: Number>: Copy + Debug + PartialEq + Send + Sync + ToSource + 'static {
    /// The same kind in another number type.
    type Over<M: Number>: Links<M>;

    /// Kind of the links; of [`AnyLinks`] the widest.
    const KIND: LinksKind;

    /// Returns the kind of these links: a constant, but for [`AnyLinks`].
    #[inline(always)]
    fn kind(&self) -> LinksKind {
        Self::KIND
    }

    /// Builds the coefficients from checked parameters, of the kind `kind` where the type holds several.
    fn build(kind: LinksKind, parameters: &Parameters) -> Self;

    /// The same without weight.
    fn inertial(&self) -> Self;

    /// The load of leg `leg`, 0 to 2.
    fn load(&self, leg: usize, motion: &LegMotion<N>) -> LegLoad<N>;
}

/// Links without mass, motors without rotor inertia.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Massless;

to_source!(pub [] Massless [] in trirrr_core::torque::links {});

impl<N: Number> Links<N> for Massless {
    type Over<M: Number> = Self;
    const KIND: LinksKind = LinksKind::Massless;

    fn build(_: LinksKind, _: &Parameters) -> Self {
        Self
    }

    fn inertial(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn load(&self, _: usize, _: &LegMotion<N>) -> LegLoad<N> {
        LegLoad::NONE
    }
}

/// Links without mass, motors with rotor inertia: N^2 Jr at the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotors<N> {
    /// N^2 Jr of each leg.
    inertia: [N; 3],
}

to_source!([N: Number] Rotors [N] in trirrr_core::torque::links { inertia: [N; 3] });

impl<N: Number> Links<N> for Rotors<N> {
    type Over<M: Number> = Rotors<M>;
    const KIND: LinksKind = LinksKind::Rotors;

    fn build(_: LinksKind, parameters: &Parameters) -> Self {
        Self {
            inertia: parameters
                .legs
                .map(|leg| N::from_f64(leg.rotor_inertia_kgm2)),
        }
    }

    fn inertial(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn load(&self, leg: usize, motion: &LegMotion<N>) -> LegLoad<N> {
        LegLoad {
            at_motor: Some(self.inertia[leg] * motion.accelerations.proximal),
            distal_over_l2_sq: None,
        }
    }
}

/// Links with mass and inertia, motors with rotor inertia. `G` says whether gravity has a
/// component in the plane: [`Horizontal`] or [`InPlane`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Massive<N, G> {
    /// The links of each leg.
    legs: [MassiveLeg<N>; 3],
    /// Gravity in the plane, if there is any.
    gravity: G,
}

to_source!([N: Number, G: Gravity<N>] Massive [N, G] in trirrr_core::torque::links {
    legs: [MassiveLeg<N>; 3],
    gravity: G,
});

/// The links of one leg, with centres of mass at c1, c2 from the inner joints and central inertias I1, I2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassiveLeg<N> {
    /// m1 c1^2 + I1 + m2 l1^2 + N^2 Jr
    proximal_inertia: N,
    /// m1 c1 / l1 + m2
    proximal_weight: N,
    /// m2 c2 / l2
    coupling: N,
    /// (m2 c2^2 + I2) / l2^2
    distal_inertia: N,
    /// m2 c2 / l2^3
    distal_coupling: N,
}

to_source!([N: Number] MassiveLeg [N] in trirrr_core::torque::links {
    proximal_inertia: N,
    proximal_weight: N,
    coupling: N,
    distal_inertia: N,
    distal_coupling: N,
});

impl<N: Number> MassiveLeg<N> {
    /// Builds the coefficients from checked parameters.
    pub fn build(leg: &LegParameters) -> Self {
        let (l1, l2) = (leg.proximal_m, leg.distal_m);
        let (m1, c1) = (leg.proximal.mass_kg, leg.proximal.com_m);
        let (m2, c2) = (leg.distal.mass_kg, leg.distal.com_m);
        Self {
            proximal_inertia: N::from_f64(
                m1 * c1 * c1 + leg.proximal.inertia_kgm2 + m2 * l1 * l1 + leg.rotor_inertia_kgm2,
            ),
            proximal_weight: N::from_f64(m1 * c1 / l1 + m2),
            coupling: N::from_f64(m2 * c2 / l2),
            distal_inertia: N::from_f64((m2 * c2 * c2 + leg.distal.inertia_kgm2) / (l2 * l2)),
            distal_coupling: N::from_f64(m2 * c2 / (l2 * l2 * l2)),
        }
    }

    /// Returns the load by thesis (4.3) to (4.6), corrected. With D = r1 x r2:
    ///
    /// ```text
    /// Q1 = J1 acc1 + (m2 c2 / l2) ((r1.r2) acc2 - D rate2^2) - (m1 c1 / l1 + m2) g.E r1
    /// Q2 = J2 acc2 + (m2 c2 / l2) ((r1.r2) acc1 + D rate1^2 - g.E r2)
    /// ```
    #[inline(always)]
    pub fn load<G: Gravity<N>>(&self, motion: &LegMotion<N>, gravity: &G) -> LegLoad<N> {
        let (at, rates, acc) = (&motion.position.links, &motion.rates, &motion.accelerations);
        let r1_dot_r2 = at.r1_dot_r2;

        let centripetal = rates.distal * rates.distal;
        let reaction = N::ab_minus_cd(r1_dot_r2, acc.distal, at.r1_cross_r2, centripetal);
        let mut proximal =
            N::sum_ab_plus_cd(self.proximal_inertia, acc.proximal, self.coupling, reaction);
        if let Some(weight) = gravity.across(at.r1) {
            proximal = proximal - N::product(self.proximal_weight, weight);
        }

        let centripetal = rates.proximal * rates.proximal;
        let mut reaction = N::sum_ab_plus_cd(r1_dot_r2, acc.proximal, at.r1_cross_r2, centripetal);
        if let Some(weight) = gravity.across(at.r2) {
            reaction = reaction - weight.widen();
        }
        let reaction = N::round(reaction);
        let q = N::ab_plus_cd(
            self.distal_inertia,
            acc.distal,
            self.distal_coupling,
            reaction,
        );
        LegLoad {
            at_motor: Some(N::round(proximal - N::product(q, r1_dot_r2))),
            distal_over_l2_sq: Some(q),
        }
    }
}

impl<N: Number, G: Gravity<N>> Links<N> for Massive<N, G> {
    type Over<M: Number> = Massive<M, G::Over<M>>;
    const KIND: LinksKind = G::MASSIVE;

    fn build(_: LinksKind, parameters: &Parameters) -> Self {
        Self {
            legs: parameters.legs.each_ref().map(MassiveLeg::build),
            gravity: G::build(parameters.gravity_m_s2),
        }
    }

    fn inertial(&self) -> Self {
        Self {
            gravity: self.gravity.none(),
            ..*self
        }
    }

    #[inline(always)]
    fn load(&self, leg: usize, motion: &LegMotion<N>) -> LegLoad<N> {
        self.legs[leg].load(motion, &self.gravity)
    }
}

/// Gravity as the links feel it. Chosen by type.
pub trait Gravity<N: Number>: Copy + Debug + PartialEq + Send + Sync + ToSource + 'static {
    /// The same kind in another number type.
    type Over<M: Number>: Gravity<M>;

    /// Kind of links with mass under this gravity.
    const MASSIVE: LinksKind;

    /// From the vector g, m/s^2.
    fn build(gravity_m_s2: Vector2<f64>) -> Self;

    /// The same kind, but g = 0.
    fn none(&self) -> Self;

    /// g . E r, if there is gravity.
    fn across(&self, r: Vector2<N>) -> Option<N>;
}

/// The machine lies flat: no gravity in its plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Horizontal;

to_source!(pub [] Horizontal [] in trirrr_core::torque::links {});

impl<N: Number> Gravity<N> for Horizontal {
    type Over<M: Number> = Self;
    const MASSIVE: LinksKind = LinksKind::MassiveHorizontal;

    fn build(_: Vector2<f64>) -> Self {
        Self
    }

    fn none(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn across(&self, _: Vector2<N>) -> Option<N> {
        None
    }
}

/// Gravity has a component in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InPlane<N> {
    /// g.
    gravity: Vector2<N>,
}

to_source!([N: Number] InPlane [N] in trirrr_core::torque::links { gravity: Vector2<N> });

impl<N: Number> InPlane<N> {
    /// Takes the vector g.
    pub fn new(gravity: Vector2<N>) -> Self {
        Self { gravity }
    }
}

impl<N: Number> Gravity<N> for InPlane<N> {
    type Over<M: Number> = InPlane<M>;
    const MASSIVE: LinksKind = LinksKind::MassiveInPlane;

    fn build(gravity_m_s2: Vector2<f64>) -> Self {
        Self {
            gravity: gravity_m_s2.map(N::from_f64),
        }
    }

    fn none(&self) -> Self {
        Self::new(Vector2::new(N::ZERO, N::ZERO))
    }

    #[inline(always)]
    fn across(&self, r: Vector2<N>) -> Option<N> {
        Some(dot(self.gravity, perpendicular(r)))
    }
}

/// Links of any kind, for hosts: the kind is a value, so that the code around it is compiled once.
/// Each variant computes the bits of its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyLinks<N> {
    /// No mass, no rotor inertia.
    Massless(Massless),
    /// No mass, but rotor inertia.
    Rotors(Rotors<N>),
    /// Mass, no gravity in the plane.
    Horizontal(Massive<N, Horizontal>),
    /// Mass, and gravity in the plane.
    InPlane(Massive<N, InPlane<N>>),
}

impl<N: Number> Links<N> for AnyLinks<N> {
    type Over<M: Number> = AnyLinks<M>;
    const KIND: LinksKind = LinksKind::MassiveInPlane;

    fn kind(&self) -> LinksKind {
        match self {
            Self::Massless(_) => LinksKind::Massless,
            Self::Rotors(_) => LinksKind::Rotors,
            Self::Horizontal(_) => LinksKind::MassiveHorizontal,
            Self::InPlane(_) => LinksKind::MassiveInPlane,
        }
    }

    fn build(kind: LinksKind, parameters: &Parameters) -> Self {
        match kind {
            LinksKind::Massless => Self::Massless(Massless),
            LinksKind::Rotors => Self::Rotors(Rotors::build(kind, parameters)),
            LinksKind::MassiveHorizontal => Self::Horizontal(Massive::build(kind, parameters)),
            LinksKind::MassiveInPlane => Self::InPlane(Massive::build(kind, parameters)),
        }
    }

    fn inertial(&self) -> Self {
        match self {
            Self::Massless(links) => Self::Massless(*links),
            Self::Rotors(links) => Self::Rotors(*links),
            Self::Horizontal(links) => Self::Horizontal(links.inertial()),
            Self::InPlane(links) => Self::InPlane(links.inertial()),
        }
    }

    #[inline(always)]
    fn load(&self, leg: usize, motion: &LegMotion<N>) -> LegLoad<N> {
        match self {
            Self::Massless(_) => LegLoad::NONE,
            Self::Rotors(links) => links.load(leg, motion),
            Self::Horizontal(links) => links.load(leg, motion),
            Self::InPlane(links) => links.load(leg, motion),
        }
    }
}

/// Source of the part of the kind that the value has: an image names that type.
impl<N: Number> ToSource for AnyLinks<N> {
    /// No image has this type.
    fn write_type(_: &mut dyn fmt::Write) -> fmt::Result {
        Err(fmt::Error)
    }

    fn write_value(&self, out: &mut dyn fmt::Write) -> fmt::Result {
        match self {
            Self::Massless(part) => part.write_value(out),
            Self::Rotors(part) => part.write_value(out),
            Self::Horizontal(part) => part.write_value(out),
            Self::InPlane(part) => part.write_value(out),
        }
    }
}
