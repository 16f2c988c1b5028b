//! Check of a machine's description. The stages behind it do not check again.

use super::{BuildError, LegParameters, LinkParameters, Parameters, Quantity};
use crate::number::Number;

const FINITE: &str = "a finite number within the range of the number type";
const POSITIVE: &str = "a positive number within the range of the number type";
const FOURTH_POWER: &str = "a length whose fourth power is within the range of the number type";
const WITHIN_HALF: &str = "at most 1/2, in units that fit the number type";
const NEAR: &str = "a place near enough for the number type";
const IN_RANGE: &str = "a length in units in which it is in range of the number type";
const NOT_NEGATIVE: &str = "a number that is not negative, within the range of the number type";

impl Parameters {
    /// Refuses a description that is no machine in the number type `N`: a value that is not finite, a
    /// link without length, a negative mass or inertia. A massless platform is accepted.
    ///
    /// # Errors
    /// The first quantity that is refused.
    pub fn check<N: Number>(&self) -> Result<(), BuildError> {
        for (index, leg) in self.legs.iter().enumerate() {
            check_leg::<N>(leg).map_err(|error| BuildError {
                leg: Some(index),
                ..error
            })?;
        }
        // The torques divide by det A; where it overflowed they would come out as zero.
        finite::<N>(Quantity::GreatestDetA, self.greatest_det_a())?;
        // Fixed point holds the two as factors, whose range is that of an f64.
        if N::PROPAGATES_NON_FINITE {
            not_negative::<N>(Quantity::PlatformMass, self.platform.mass_kg)?;
            not_negative::<N>(Quantity::PlatformInertia, self.platform.inertia_kgm2)?;
        } else {
            not_negative::<f64>(Quantity::PlatformMass, self.platform.mass_kg)?;
            not_negative::<f64>(Quantity::PlatformInertia, self.platform.inertia_kgm2)?;
        }
        for (quantity, vector) in [
            (Quantity::PlatformCentreOfMass, self.platform.com_m),
            (Quantity::Gravity, self.gravity_m_s2),
            (Quantity::WrenchForce, self.wrench_force_n),
        ] {
            finite::<N>(quantity, vector.x)?;
            finite::<N>(quantity, vector.y)?;
        }
        finite::<N>(Quantity::WrenchTorque, self.wrench_torque_nm)
    }
}

fn check_leg<N: Number>(leg: &LegParameters) -> Result<(), BuildError> {
    finite::<N>(Quantity::Base, leg.base_m.x)?;
    finite::<N>(Quantity::Base, leg.base_m.y)?;
    for place in [leg.base_m.x, leg.base_m.y] {
        require::<N>(
            N::within_reach_range(N::from_f64(place)),
            Quantity::Base,
            place,
            NEAR,
        )?;
    }
    positive::<N>(Quantity::ProximalLength, leg.proximal_m)?;
    positive::<N>(Quantity::DistalLength, leg.distal_m)?;
    // The dyad multiplies differences of squared lengths.
    let reach = leg.proximal_m + leg.distal_m;
    if N::PROPAGATES_NON_FINITE {
        let fourth_power = N::from_f64(reach * reach * reach * reach);
        let held = fourth_power > N::ZERO && fourth_power.is_finite();
        require::<N>(held, Quantity::Reach, reach, FOURTH_POWER)?;
    } else {
        let held = N::in_range([N::from_f64(reach)]);
        require::<N>(held, Quantity::Reach, reach, IN_RANGE)?;
    }
    not_negative::<N>(Quantity::JointRadius, leg.joint_radius_m)?;
    if !N::PROPAGATES_NON_FINITE {
        let held = leg.joint_radius_m <= 0.5;
        require::<N>(held, Quantity::JointRadius, leg.joint_radius_m, WITHIN_HALF)?;
    }
    // An angle is no quantity of the tick: its sine and cosine are taken here.
    if N::PROPAGATES_NON_FINITE {
        finite::<N>(Quantity::JointAngle, leg.joint_angle_rad)?;
    } else {
        finite::<f64>(Quantity::JointAngle, leg.joint_angle_rad)?;
    }
    let proximal = [
        Quantity::ProximalMass,
        Quantity::ProximalCentreOfMass,
        Quantity::ProximalInertia,
    ];
    check_link::<N>(&leg.proximal, proximal)?;
    let distal = [
        Quantity::DistalMass,
        Quantity::DistalCentreOfMass,
        Quantity::DistalInertia,
    ];
    check_link::<N>(&leg.distal, distal)?;
    not_negative::<N>(Quantity::RotorInertia, leg.rotor_inertia_kgm2)
}

fn check_link<N: Number>(
    link: &LinkParameters,
    [mass, com, inertia]: [Quantity; 3],
) -> Result<(), BuildError> {
    not_negative::<N>(mass, link.mass_kg)?;
    finite::<N>(com, link.com_m)?;
    not_negative::<N>(inertia, link.inertia_kgm2)
}

fn finite<N: Number>(quantity: Quantity, value: f64) -> Result<(), BuildError> {
    require::<N>(true, quantity, value, FINITE)
}

fn positive<N: Number>(quantity: Quantity, value: f64) -> Result<(), BuildError> {
    // After rounding to N: a length that vanishes there is no length.
    require::<N>(N::from_f64(value) > N::ZERO, quantity, value, POSITIVE)
}

fn not_negative<N: Number>(quantity: Quantity, value: f64) -> Result<(), BuildError> {
    require::<N>(value >= 0.0, quantity, value, NOT_NEGATIVE)
}

fn require<N: Number>(
    condition: bool,
    quantity: Quantity,
    value: f64,
    expected: &'static str,
) -> Result<(), BuildError> {
    if condition && N::from_f64(value).is_finite() {
        Ok(())
    } else {
        Err(BuildError {
            quantity,
            leg: None,
            value,
            expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::example;
    use std::string::ToString;

    #[test]
    fn names_the_quantity_the_leg_and_the_value() {
        let mut parameters = example();
        parameters.legs[1].distal_m = -0.2;
        let error = parameters.check::<f64>().unwrap_err();
        assert_eq!(
            (error.quantity, error.leg),
            (Quantity::DistalLength, Some(1))
        );
        assert_eq!(
            error.to_string(),
            "length of the distal link of leg 2 is -0.2, expected a positive number within the range of the \
             number type"
        );
    }

    #[test]
    fn a_size_is_told_by_its_exponent() {
        let mut parameters = example();
        parameters.legs[0].distal_m = 1e300;
        let text = parameters.check::<f64>().unwrap_err().to_string();
        assert!(text.contains(" of leg 1 is 1e300, expected "), "{text}");
    }

    #[test]
    fn refuses_what_the_number_type_cannot_hold() {
        let mut parameters = example();
        parameters.legs[2].proximal_m = 1e-60;
        assert_eq!(parameters.check::<f64>(), Ok(()));
        let error = parameters.check::<f32>().unwrap_err();
        assert_eq!(
            (error.quantity, error.leg),
            (Quantity::ProximalLength, Some(2))
        );

        let mut parameters = example();
        parameters.platform.mass_kg = 1e60;
        assert_eq!(parameters.check::<f64>(), Ok(()));
        let error = parameters.check::<f32>().unwrap_err();
        assert_eq!((error.quantity, error.leg), (Quantity::PlatformMass, None));
    }

    #[test]
    fn refuses_machines_whose_products_the_number_type_cannot_hold() {
        let sized = |length: f64, radius: f64| {
            let mut parameters = example();
            for leg in &mut parameters.legs {
                (leg.proximal_m, leg.distal_m) = (length, length);
                leg.joint_radius_m = radius;
            }
            parameters.check::<f32>().map_err(|error| error.quantity)
        };
        assert_eq!(sized(1e9, 1e8), Ok(()));
        assert_eq!(sized(1e-9, 1e-10), Ok(()));
        assert_eq!(sized(1e10, 1e8), Err(Quantity::Reach));
        assert_eq!(sized(1e-12, 1e-13), Err(Quantity::Reach));
        assert_eq!(sized(1e9, 1e13), Err(Quantity::GreatestDetA));
    }

    #[test]
    fn refuses_every_value_that_is_not_finite() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let spoilt: [fn(&mut Parameters) -> &mut f64; 19] = [
                |p| &mut p.legs[0].base_m.x,
                |p| &mut p.legs[0].base_m.y,
                |p| &mut p.legs[0].proximal_m,
                |p| &mut p.legs[0].distal_m,
                |p| &mut p.legs[0].joint_radius_m,
                |p| &mut p.legs[0].joint_angle_rad,
                |p| &mut p.legs[0].proximal.mass_kg,
                |p| &mut p.legs[0].proximal.com_m,
                |p| &mut p.legs[0].proximal.inertia_kgm2,
                |p| &mut p.legs[0].distal.mass_kg,
                |p| &mut p.legs[0].distal.com_m,
                |p| &mut p.legs[0].distal.inertia_kgm2,
                |p| &mut p.legs[0].rotor_inertia_kgm2,
                |p| &mut p.platform.mass_kg,
                |p| &mut p.platform.inertia_kgm2,
                |p| &mut p.platform.com_m.x,
                |p| &mut p.gravity_m_s2.y,
                |p| &mut p.wrench_force_n.x,
                |p| &mut p.wrench_torque_nm,
            ];
            for place in spoilt {
                let mut parameters = example();
                *place(&mut parameters) = bad;
                let error = parameters.check::<f64>().unwrap_err();
                assert!(!error.value.is_finite(), "{error}");
            }
        }
    }
}
