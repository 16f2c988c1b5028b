//! A type that holds more than a machine needs gives what the leaner type gives.

use nalgebra::Vector2;
use std::cell::RefCell;
use trirrr_core::machine::{LinkParameters, Parameters};
use trirrr_core::model::Dynamic;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Motion;
use trirrr_core::torque::links::{Horizontal, InPlane, Links, Massive, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset, Payload};
use trirrr_tests::bound::Worst;
use trirrr_tests::evaluate::with;
use trirrr_tests::random::{case, for_all};
use trirrr_tests::results;

fn motion<P: Payload<f64>, L: Links<f64>>(
    parameters: &Parameters,
    setpoint: &Setpoint<f64>,
) -> Motion<f64> {
    with::<Dynamic<f64, P, L>>(parameters, setpoint).expect("a motion")
}

fn torques(motion: &Motion<f64>) -> [f64; 3] {
    motion.motors.map(|motor| motor.torque)
}

fn without_link_masses(mut parameters: Parameters) -> Parameters {
    for leg in &mut parameters.legs {
        leg.proximal = LinkParameters::default();
        leg.distal = LinkParameters::default();
    }
    parameters
}

fn without_rotors(mut parameters: Parameters) -> Parameters {
    for leg in &mut parameters.legs {
        leg.rotor_inertia_kgm2 = 0.0;
    }
    parameters
}

/// Zeros are added and multiplied exactly: the same bits.
#[test]
fn zero_masses_are_massless_links() {
    for_all(2000, case(), |case| {
        let parameters = without_link_masses(case.parameters);
        let setpoint = &case.setpoint;
        let rotors = torques(&motion::<Offset<f64>, Rotors<f64>>(&parameters, setpoint));
        let massive = torques(&motion::<Offset<f64>, Massive<f64, InPlane<f64>>>(
            &parameters,
            setpoint,
        ));
        assert_eq!(rotors, massive);

        let parameters = without_rotors(parameters);
        let massless = torques(&motion::<Offset<f64>, Massless>(&parameters, setpoint));
        let rotors = torques(&motion::<Offset<f64>, Rotors<f64>>(&parameters, setpoint));
        let massive = torques(&motion::<Offset<f64>, Massive<f64, InPlane<f64>>>(
            &parameters,
            setpoint,
        ));
        assert_eq!(massless, rotors);
        assert_eq!(massless, massive);
    });
}

#[test]
fn zero_gravity_is_horizontal() {
    for_all(2000, case(), |case| {
        let mut parameters = case.parameters;
        parameters.gravity_m_s2 = Vector2::new(0.0, 0.0);
        let horizontal = torques(&motion::<Offset<f64>, Massive<f64, Horizontal>>(
            &parameters,
            &case.setpoint,
        ));
        let in_plane = torques(&motion::<Offset<f64>, Massive<f64, InPlane<f64>>>(
            &parameters,
            &case.setpoint,
        ));
        assert_eq!(horizontal, in_plane);
    });
}

/// The two payloads sum inertia, weight and wrench in different orders: within twice 2 u cond.
#[test]
fn zero_offset_is_centred() {
    let worst = RefCell::new(Worst::default());
    for_all(1000, case(), |case| {
        let mut parameters = case.parameters;
        parameters.platform.com_m = Vector2::new(0.0, 0.0);
        let setpoint = &case.setpoint;
        let centred = torques(&motion::<Centred<f64>, Massive<f64, InPlane<f64>>>(
            &parameters,
            setpoint,
        ));
        let offset = torques(&motion::<Offset<f64>, Massive<f64, InPlane<f64>>>(
            &parameters,
            setpoint,
        ));
        let conditions = results::isotropic_conditions(&parameters, setpoint);
        for (name, cond) in results::names().into_iter().zip(conditions) {
            if let ("tau", Some(leg)) = (name.stem, name.leg) {
                let bound = 4.0 * f64::UNIT_ROUNDOFF * cond;
                let difference = offset[leg] - centred[leg];
                worst
                    .borrow_mut()
                    .compare(|| format!("{case:?}"), difference, bound);
            }
        }
    });
    worst.into_inner().assert_within("payloads", 0.02..=1.0);
}

/// What the links are made of moves neither angles nor rates nor accelerations.
#[test]
fn masses_change_no_kinematics() {
    for_all(2000, case(), |case| {
        let heavy =
            motion::<Offset<f64>, Massive<f64, InPlane<f64>>>(&case.parameters, &case.setpoint);
        let light = motion::<Centred<f64>, Massless>(&case.parameters, &case.setpoint);
        assert_eq!(heavy.legs, light.legs);
        for (a, b) in heavy.motors.iter().zip(&light.motors) {
            assert_eq!(
                (a.angle, a.rate, a.acceleration),
                (b.angle, b.rate, b.acceleration)
            );
        }
    });
}
