//! The kind of model that a machine needs, and the one place where a kind becomes a type.

use super::{Dynamic, Kinematic, Model};
use crate::machine::Parameters;
use crate::number::Number;
use crate::torque::links::{Horizontal, InPlane, Massive, Massless, Rotors};
use crate::torque::payload::{Centred, Offset, Payload};

/// Kind of a [`Model`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelKind {
    /// [`Kinematic`]: no torques.
    Kinematic,
    /// [`Dynamic`]: torques, for a kind of payload and a kind of links.
    Dynamic(PayloadKind, LinksKind),
}

/// Kind of a [`Payload`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PayloadKind {
    /// The centre of mass is the reference point.
    Centred,
    /// The centre of mass lies at an offset from the reference point.
    Offset,
}

/// Kind of [`Links`](crate::torque::links::Links). Each kind has room for those before.
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

/// Code that is generic over the model.
///
/// A scene names its model at run time, a pipeline names its model by type. [`ModelKind::visit`]
/// leads from the one to the other.
pub trait ModelVisitor<N: Number> {
    /// Result of the code.
    type Output;

    /// Runs the code for the model `M`.
    fn visit<M: Model<N = N>>(self) -> Self::Output;
}

impl ModelKind {
    /// Returns the leanest kind that has room for `parameters`; `torque`: torques are asked for.
    pub fn of(parameters: &Parameters, torque: bool) -> Self {
        match torque {
            false => Self::Kinematic,
            true => Self::Dynamic(PayloadKind::of(parameters), LinksKind::of(parameters)),
        }
    }

    /// Returns true if a machine of kind `other` can be computed by a model of this kind.
    pub fn has_room_for(self, other: Self) -> bool {
        match (self, other) {
            (Self::Kinematic, other) => other == Self::Kinematic,
            (Self::Dynamic(..), Self::Kinematic) => false,
            (Self::Dynamic(payload, links), Self::Dynamic(other_payload, other_links)) => {
                payload >= other_payload && links >= other_links
            }
        }
    }

    /// Returns true if the motion of the legs takes torques, beside that of the platform.
    pub const fn has_leg_loads(self) -> bool {
        !matches!(
            self,
            Self::Kinematic | Self::Dynamic(_, LinksKind::Massless)
        )
    }

    /// Runs `visitor` for the model of this kind.
    pub fn visit<N: Number, V: ModelVisitor<N>>(self, visitor: V) -> V::Output {
        match self {
            Self::Kinematic => visitor.visit::<Kinematic<N>>(),
            Self::Dynamic(PayloadKind::Centred, links) => links.visit::<N, Centred<N>, V>(visitor),
            Self::Dynamic(PayloadKind::Offset, links) => links.visit::<N, Offset<N>, V>(visitor),
        }
    }
}

impl PayloadKind {
    fn of(parameters: &Parameters) -> Self {
        let com = parameters.platform.com_m;
        if com.x == 0.0 && com.y == 0.0 {
            Self::Centred
        } else {
            Self::Offset
        }
    }
}

impl LinksKind {
    fn of(parameters: &Parameters) -> Self {
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

    fn visit<N, P, V>(self, visitor: V) -> V::Output
    where
        N: Number,
        P: Payload<N>,
        V: ModelVisitor<N>,
    {
        match self {
            Self::Massless => visitor.visit::<Dynamic<N, P, Massless>>(),
            Self::Rotors => visitor.visit::<Dynamic<N, P, Rotors<N>>>(),
            Self::MassiveHorizontal => visitor.visit::<Dynamic<N, P, Massive<N, Horizontal>>>(),
            Self::MassiveInPlane => visitor.visit::<Dynamic<N, P, Massive<N, InPlane<N>>>>(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::example;

    /// Returns the kind that the visited model says of itself.
    struct OwnKind;

    impl ModelVisitor<f64> for OwnKind {
        type Output = ModelKind;

        fn visit<M: Model<N = f64>>(self) -> ModelKind {
            M::KIND
        }
    }

    #[test]
    fn every_kind_leads_to_a_model_of_its_kind() {
        use {LinksKind::*, PayloadKind::*};
        let links = [Massless, Rotors, MassiveHorizontal, MassiveInPlane];
        let dynamic = [Centred, Offset]
            .into_iter()
            .flat_map(|payload| links.map(|links| ModelKind::Dynamic(payload, links)));
        for kind in dynamic.chain([ModelKind::Kinematic]) {
            assert_eq!(kind.visit(OwnKind), kind);
        }
    }

    /// A machine whose links weigh nothing takes the same torques however its legs move.
    #[test]
    fn only_masses_of_the_legs_load_the_motors_by_their_motion() {
        let dynamic = |links| ModelKind::Dynamic(PayloadKind::Offset, links);
        assert!(!ModelKind::Kinematic.has_leg_loads());
        assert!(!dynamic(LinksKind::Massless).has_leg_loads());
        for links in [
            LinksKind::Rotors,
            LinksKind::MassiveHorizontal,
            LinksKind::MassiveInPlane,
        ] {
            assert!(dynamic(links).has_leg_loads());
        }
    }

    #[test]
    fn a_kind_has_room_for_itself_and_for_leaner_ones() {
        use {LinksKind::*, PayloadKind::*};
        let lean = ModelKind::of(&example(), true);
        assert_eq!(lean, ModelKind::Dynamic(Centred, Massless));
        let rich = ModelKind::Dynamic(Offset, MassiveInPlane);
        assert!(rich.has_room_for(lean) && lean.has_room_for(lean));
        assert!(!lean.has_room_for(rich));
        let kinematic = ModelKind::of(&example(), false);
        assert!(kinematic.has_room_for(kinematic));
        assert!(!kinematic.has_room_for(lean) && !rich.has_room_for(kinematic));
    }
}
