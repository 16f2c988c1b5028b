//! Values of a scene that come over the line: read, checked, and built from.

use super::*;
use crate::scene::needs_of_model;
use trirrr_core::machine::Quantity;
use trirrr_core::model::{Kinematic, ModelKind};
use trirrr_core::setpoint::{Cubics, Quintics};
use trirrr_core::torque::links::{Horizontal, Massive};
use trirrr_core::torque::payload::Centred;
use trirrr_protocol::message::scene::{Leg, Section, SectionName};
use trirrr_protocol::message::{SceneNeed, UpdateRefusal};
use trirrr_protocol::wire::{of_bytes, to_bytes};

fn values() -> SceneValues {
    let machine = example();
    let Settings {
        ramp,
        host_timeout_ticks,
        telemetry_every,
        power,
        reactions,
        ..
    } = settings::<f32>();
    SceneValues {
        key: SCENE,
        name: name("values"),
        units: [0; 3],
        start: [0.21, 0.22, 0.157],
        legs: machine.legs.each_ref().map(Into::into),
        platform: (&machine).into(),
        limits: (&LimitParameters::default()).into(),
        ramp,
        host_timeout_ticks,
        telemetry_every,
        power,
        reactions,
        planning: None,
        homing: None,
        feedback: None,
        contact: None,
        steppers: None,
    }
}

fn check(values: &SceneValues) -> Result<(), UpdateRefusal> {
    values.check::<Dynamic<f32>, Quintics, ()>(&settings())
}

#[test]
fn values_survive_their_bytes_and_the_longest_have_room() {
    let longest = SceneValues {
        key: u32::MAX,
        planning: Some(Planning::NONE),
        steppers: Some(
            [StepperValues {
                microsteps: u32::MAX,
                gear_ratio: 20.0,
                reversed: true,
            }; 3],
        ),
        ..values()
    };
    for values in [values(), longest] {
        let mut room = [0; SceneValues::LONGEST];
        let bytes = to_bytes(&values, &mut room).expect("room for the longest");
        assert_eq!(of_bytes(bytes), Some(values));
        let damaged = &bytes[..bytes.len() - 1];
        assert_eq!(of_bytes::<SceneValues>(damaged), None);
    }
}

/// A service of the values tells their key, and has their machine.
#[test]
fn a_service_is_built_from_values() {
    let values = SceneValues {
        legs: values().legs.map(|leg| Leg {
            proximal_m: 0.21,
            ..leg
        }),
        ..values()
    };
    assert_eq!(check(&values), Ok(()));
    let scene = Adjustable::<Dynamic<f32>>::new(values.parameters(), values.limits());
    let own = settings::<f32>();
    let mut bench = Bench::<Thesis<f32>>::off(scene, values.start(), values.settings(&own));
    let identity = bench.greet();
    bench.service.background.next_sequence_is(0);
    assert_eq!((identity.scene, identity.name), (SCENE, name("values")));
    let Reply::Section(Section::Leg { leg, .. }) = bench.ask(Command::Read(SectionName::Leg(2)))
    else {
        panic!("a leg");
    };
    assert_eq!(leg.proximal_m, 0.21);
}

#[test]
fn what_a_model_lacks_is_named() {
    let needs = |kind| -> Vec<SceneNeed> { needs_of_model(kind).collect() };
    assert_eq!(needs(ModelKind::Kinematic), []);
    let mut heavy = values();
    heavy.legs[1].distal = [0.3, 0.1, 0.001];
    let lacks = |need| Err(UpdateRefusal::SceneNeeds(need));
    assert_eq!(check(&heavy), lacks(SceneNeed::Rotors));
    type Lying = Dynamic<f32, Centred<f32>, Massive<f32, Horizontal>>;
    let on_lying = |values: &SceneValues| values.check::<Lying, Quintics, ()>(&settings());
    assert_eq!(on_lying(&heavy), Ok(()));
    heavy.platform.gravity_m_s2 = [0.0, -9.81];
    assert_eq!(on_lying(&heavy), lacks(SceneNeed::Gravity));
    let mut off = values();
    off.platform.com_m = [0.01, 0.0];
    assert_eq!(check(&off), lacks(SceneNeed::PayloadOffset));
}

#[test]
fn what_cannot_be_built_is_refused_before_it_is_kept() {
    let refused = |quantity, leg| Err(UpdateRefusal::SceneValue { quantity, leg });
    let mut wrong = values();
    wrong.legs[2].distal_m = -0.2;
    assert_eq!(check(&wrong), refused(Quantity::DistalLength, Some(2)));
    let mut limited = values();
    limited.limits.torque_nm = Some([0.1; 3]);
    assert_eq!(check(&limited), Ok(()));
    let kinematic = limited.check::<Kinematic<f32>, Quintics, ()>(&settings());
    assert_eq!(kinematic, refused(Quantity::TorqueLimit, Some(0)));
    let mut smooth = values();
    smooth.limits.jerk_rad_s3 = Some([100.0; 3]);
    let cubic = smooth.check::<Dynamic<f32>, Cubics, ()>(&settings());
    assert_eq!(cubic, refused(Quantity::JerkLimit, Some(0)));
    let far = SceneValues {
        start: [5.0, 0.0, 0.0],
        ..values()
    };
    assert_eq!(check(&far), Err(UpdateRefusal::SceneStart));
}

#[test]
fn numbers_that_no_scene_has_are_refused() {
    let motor = StepperValues {
        microsteps: 3200,
        gear_ratio: 1.0,
        reversed: false,
    };
    let geared = |gear_ratio| {
        Some([
            motor,
            motor,
            StepperValues {
                gear_ratio,
                ..motor
            },
        ])
    };
    let nan = Planning {
        lever: f64::NAN,
        ..Planning::NONE
    };
    for wrong in [
        SceneValues { key: 0, ..values() },
        SceneValues {
            start: [0.21, f64::NAN, 0.0],
            ..values()
        },
        SceneValues {
            ramp: Ramp::within(0, None),
            ..values()
        },
        SceneValues {
            planning: Some(nan),
            ..values()
        },
        SceneValues {
            steppers: geared(0.0),
            ..values()
        },
        SceneValues {
            steppers: geared(f64::INFINITY),
            ..values()
        },
    ] {
        assert_eq!(check(&wrong), Err(UpdateRefusal::SceneLayout), "{wrong:?}");
    }
    let good = SceneValues {
        steppers: geared(5.0),
        planning: Some(Planning::NONE),
        ..values()
    };
    assert_eq!(check(&good), Ok(()));
}
