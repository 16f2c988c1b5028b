//! Coefficients over the box of the tolerances.

use crate::model::BoxModel;
use crate::parameter::{HalfWidths, OfLeg, OfPlatform, Parameter};
use nalgebra::Vector2;
use trirrr_core::dyad::{Rrr, Triangle};
use trirrr_core::machine::{Geometry, Leg, Parameters};
use trirrr_core::model::Dynamic;
use trirrr_core::number::Arithmetic;
use trirrr_core::tick::Tick;
use trirrr_core::torque::balance::Balance;
use trirrr_core::torque::links::{InPlane, Massive, MassiveLeg};
use trirrr_core::torque::payload::Offset;

/// The model that has room for every machine.
pub(crate) type AnyModel =
    Dynamic<BoxModel, Offset<BoxModel>, Massive<BoxModel, InPlane<BoxModel>>>;

/// By how much a leg differs from the nominal one.
pub(crate) struct UncertainLeg {
    /// Base joint.
    pub(crate) base: Vector2<BoxModel>,
    /// Platform joint, in the platform's frame.
    pub(crate) joint: Vector2<BoxModel>,
    /// Length of the proximal link, relative to the nominal one.
    pub(crate) stretch: BoxModel,
    /// Angle of the motor.
    pub(crate) angle: BoxModel,
    /// (l2^2 - nominal l2^2) / 2.
    pub(crate) half_distal_sq: BoxModel,
    /// 1 / l2^2.
    pub(crate) inverse_distal_sq: BoxModel,
}

/// Writes the coefficients over the box. The core's own `build` has them from exact parameters.
pub(crate) struct BoxCoefficients<'a> {
    pub(crate) parameters: &'a Parameters,
    pub(crate) half_widths: &'a HalfWidths,
}

impl BoxCoefficients<'_> {
    fn deviation(&self, leg: usize, of: OfLeg) -> BoxModel {
        self.half_widths.deviation(Parameter::of_leg(leg, of), 1.0)
    }

    pub(crate) fn leg(&self, index: usize) -> UncertainLeg {
        let leg = &self.parameters.legs[index];
        let vector = |x, y| Vector2::new(self.deviation(index, x), self.deviation(index, y));
        let stretch = Parameter::of_leg(index, OfLeg::Proximal);
        let distal = self.deviation(index, OfLeg::Distal);
        let l2 = self.of_leg(leg.distal_m, index, OfLeg::Distal);
        UncertainLeg {
            base: vector(OfLeg::BaseX, OfLeg::BaseY),
            joint: vector(OfLeg::JointX, OfLeg::JointY),
            stretch: self.half_widths.deviation(stretch, leg.proximal_m),
            angle: self.deviation(index, OfLeg::MotorAngle),
            half_distal_sq: distal * BoxModel::point(leg.distal_m)
                + BoxModel::HALF * (distal * distal),
            inverse_distal_sq: BoxModel::ONE.div(l2 * l2),
        }
    }

    fn of_leg(&self, nominal: f64, leg: usize, of: OfLeg) -> BoxModel {
        self.half_widths.around(nominal, Parameter::of_leg(leg, of))
    }

    fn of_platform(&self, nominal: f64, of: OfPlatform) -> BoxModel {
        self.half_widths.around(nominal, Parameter::of_platform(of))
    }

    /// A leg of the core with the lengths of the box.
    fn core_leg(&self, index: usize, nominal: &Leg<BoxModel>) -> Leg<BoxModel> {
        let leg = &self.parameters.legs[index];
        let l1 = self.of_leg(leg.proximal_m, index, OfLeg::Proximal);
        let l2 = self.of_leg(leg.distal_m, index, OfLeg::Distal);
        // The torques read the lengths alone; the triangle belongs to the inverse kinematics.
        let triangle = Triangle::new(leg.proximal_m, leg.distal_m, leg.elbow.sign());
        let dyad = Rrr::from_coefficients(triangle, l1, l1 * l1, l2 * l2);
        Leg::from_coefficients(nominal.base(), nominal.joint(), dyad)
    }

    /// The links of a leg, as [`MassiveLeg::build`] has them.
    fn links(&self, index: usize) -> MassiveLeg<BoxModel> {
        let leg = &self.parameters.legs[index];
        let of = |nominal: f64, of: OfLeg| self.of_leg(nominal, index, of);
        let l1 = of(leg.proximal_m, OfLeg::Proximal);
        let inverse_l2 = BoxModel::ONE.div(of(leg.distal_m, OfLeg::Distal));
        let m1 = of(leg.proximal.mass_kg, OfLeg::ProximalMass);
        let c1 = of(leg.proximal.com_m, OfLeg::ProximalCentre);
        let i1 = of(leg.proximal.inertia_kgm2, OfLeg::ProximalInertia);
        let m2 = of(leg.distal.mass_kg, OfLeg::DistalMass);
        let c2 = of(leg.distal.com_m, OfLeg::DistalCentre);
        let i2 = of(leg.distal.inertia_kgm2, OfLeg::DistalInertia);
        let rotor = of(leg.rotor_inertia_kgm2, OfLeg::Rotor);
        let inverse_sq = inverse_l2 * inverse_l2;
        let coupling = m2 * c2 * inverse_l2;
        MassiveLeg::from_coefficients(
            m1 * (c1 * c1) + i1 + m2 * (l1 * l1) + rotor,
            (m1 * c1).div(l1) + m2,
            coupling,
            (m2 * (c2 * c2) + i2) * inverse_sq,
            coupling * inverse_sq,
        )
    }

    pub(crate) fn tick(&self, nominal: &Geometry<BoxModel>) -> Tick<AnyModel> {
        let p = self.parameters;
        let platform = |nominal, of| self.of_platform(nominal, of);
        let gravity = p.gravity_m_s2.map(BoxModel::point);
        let force = p.wrench_force_n;
        let payload = Offset::from_coefficients(
            platform(p.platform.mass_kg, OfPlatform::Mass),
            platform(p.platform.inertia_kgm2, OfPlatform::Inertia),
            Vector2::new(
                platform(p.platform.com_m.x, OfPlatform::CentreX),
                platform(p.platform.com_m.y, OfPlatform::CentreY),
            ),
            gravity,
            Vector2::new(
                platform(force.x, OfPlatform::ForceX),
                platform(force.y, OfPlatform::ForceY),
            ),
            platform(p.wrench_torque_nm, OfPlatform::Torque),
        );
        let l2 = self.of_leg(p.legs[0].distal_m, 0, OfLeg::Distal);
        let balance = Balance::from_coefficients(BoxModel::ONE.div(l2 * l2), BoxModel::ZERO);
        let links = [0, 1, 2].map(|leg| self.links(leg));
        let legs = [0, 1, 2].map(|leg| self.core_leg(leg, &nominal.legs()[leg]));
        Tick::from_coefficients(
            Geometry::from_coefficients(legs),
            Dynamic::from_coefficients(
                balance,
                payload,
                Massive::from_coefficients(links, InPlane::new(gravity)),
            ),
        )
    }
}
