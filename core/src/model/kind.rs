//! The kind of model that a machine needs, and the one place where a kind becomes a type.

use super::{AnyDynamic, Dynamic, Kinematic, Model};
use crate::machine::Parameters;
use crate::number::Number;
use crate::torque::links::{Horizontal, InPlane, LinksKind, Massive, Massless, Rotors};
use crate::torque::payload::{Centred, Offset, Payload, PayloadKind};

/// Kind of a [`Model`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelKind {
    /// [`Kinematic`]: no torques.
    Kinematic,
    /// [`Dynamic`]: torques, for a kind of payload and a kind of links.
    Dynamic(PayloadKind, LinksKind),
}

/// A machine, and the kind that its model has to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfKind<'a> {
    /// The machine, checked, in its own units.
    pub parameters: &'a Parameters,
    /// Kind of the model; without one it is the kind of the type. A type of one kind needs none.
    pub kind: Option<ModelKind>,
}

impl OfKind<'_> {
    /// Returns the kinds of payload and links asked for.
    pub(super) fn parts(&self) -> Option<(PayloadKind, LinksKind)> {
        match self.kind {
            Some(ModelKind::Dynamic(payload, links)) => Some((payload, links)),
            Some(ModelKind::Kinematic) | None => None,
        }
    }
}

impl<'a> From<&'a Parameters> for OfKind<'a> {
    fn from(parameters: &'a Parameters) -> Self {
        Self {
            parameters,
            kind: None,
        }
    }
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

    /// Asks for a model of this kind of the machine `parameters`.
    pub fn with(self, parameters: &Parameters) -> OfKind<'_> {
        OfKind {
            parameters,
            kind: Some(self),
        }
    }

    /// Runs `visitor` for the type that holds this kind on a host. The model is built [of this kind](Self::with).
    pub fn visit<N: Number, V: ModelVisitor<N>>(self, visitor: V) -> V::Output {
        match self {
            Self::Kinematic => visitor.visit::<Kinematic<N>>(),
            Self::Dynamic(..) => visitor.visit::<AnyDynamic<N>>(),
        }
    }

    /// Runs `visitor` for the type of this kind alone, as images have it.
    pub fn visit_image<N: Number, V: ModelVisitor<N>>(self, visitor: V) -> V::Output {
        match self {
            Self::Kinematic => visitor.visit::<Kinematic<N>>(),
            Self::Dynamic(PayloadKind::Centred, links) => links.visit::<N, Centred<N>, V>(visitor),
            Self::Dynamic(PayloadKind::Offset, links) => links.visit::<N, Offset<N>, V>(visitor),
        }
    }
}

impl LinksKind {
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
    use crate::number::{Coarse, Fixed};
    use crate::setpoint::{Pose, Setpoint};
    use crate::status::Status;
    use crate::tick::{Motion, Tick};
    use nalgebra::{Vector2, Vector3};
    use std::string::String;

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
        for kind in kinds() {
            assert_eq!(kind.visit_image(OwnKind), kind);
        }
    }

    /// Motion at each setpoint, and the source of the model, by a type that holds a kind.
    struct Evaluated<'a, N: Number>(OfKind<'a>, &'a [Setpoint<N>]);

    impl<N: Number> ModelVisitor<N> for Evaluated<'_, N> {
        type Output = (std::vec::Vec<Result<Motion<N>, Status>>, String);

        fn visit<M: Model<N = N>>(self) -> Self::Output {
            let tick = Tick::<M>::build(self.0).expect("a machine");
            let mut source = String::new();
            tick.model().write_value(&mut source).expect("a source");
            let motions = self.1.iter().map(|setpoint| tick.evaluate(setpoint));
            (motions.collect(), source)
        }
    }

    /// A machine with everything, and one without load, at rest and in motion.
    fn compare_with_the_types_of_images<N: Number>() {
        let mut loaded = example();
        loaded.gravity_m_s2 = Vector2::new(0.05, -0.15);
        loaded.wrench_force_n = Vector2::new(0.08, -0.05);
        loaded.wrench_torque_nm = 0.002;
        loaded.platform.com_m = Vector2::new(0.01, 0.03);
        for (leg, mass) in loaded.legs.iter_mut().zip([0.3, 0.2, 0.25]) {
            (leg.proximal.mass_kg, leg.proximal.com_m) = (mass, 0.1);
            (leg.distal.mass_kg, leg.distal.com_m) = (0.2, 0.15);
            leg.rotor_inertia_kgm2 = 0.003;
        }
        let setpoints = [0.0, 0.4, 1.0].map(|size| Setpoint {
            pose: Pose::<N>::from_f64(0.26 - 0.03 * size, 0.23, 0.2 + size),
            velocity: (Vector3::new(0.1, -0.05, 0.2) * size).map(N::from_f64),
            acceleration: (Vector3::new(-0.05, 0.1, 0.2) * size).map(N::from_f64),
        });
        for parameters in [example(), loaded] {
            for kind in kinds() {
                let evaluated = || Evaluated(kind.with(&parameters), &setpoints);
                let (motions, source) = kind.visit(evaluated());
                assert!(motions.iter().any(Result::is_ok), "{kind:?}");
                assert_eq!(kind.visit_image(evaluated()), (motions, source), "{kind:?}");
            }
        }
    }

    #[test]
    fn a_kind_as_a_value_gives_the_bits_and_the_source_of_its_type() {
        compare_with_the_types_of_images::<f64>();
        compare_with_the_types_of_images::<f32>();
        compare_with_the_types_of_images::<Fixed>();
        compare_with_the_types_of_images::<Coarse>();
    }

    fn kinds() -> impl Iterator<Item = ModelKind> {
        use {LinksKind::*, PayloadKind::*};
        let links = [Massless, Rotors, MassiveHorizontal, MassiveInPlane];
        let dynamic = [Centred, Offset]
            .into_iter()
            .flat_map(move |payload| links.map(|links| ModelKind::Dynamic(payload, links)));
        dynamic.chain([ModelKind::Kinematic])
    }

    /// A machine whose links weigh nothing takes the same torques however its legs move.
    #[test]
    fn only_masses_of_the_legs_load_the_motors_by_their_motion() {
        let parameters = example();
        let dynamic = |links| {
            let kind = ModelKind::Dynamic(PayloadKind::Offset, links);
            AnyDynamic::<f64>::build(kind.with(&parameters)).has_leg_loads()
        };
        assert!(!Kinematic::<f64>::build((&parameters).into()).has_leg_loads());
        assert!(!Dynamic::<f64>::build((&parameters).into()).has_leg_loads());
        assert!(!dynamic(LinksKind::Massless));
        for links in [
            LinksKind::Rotors,
            LinksKind::MassiveHorizontal,
            LinksKind::MassiveInPlane,
        ] {
            assert!(dynamic(links));
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
