//! The scene: read, and replaced where the image has code for it.

use super::*;
use trirrr_core::machine::Quantity;
use trirrr_core::model::Kinematic;
use trirrr_core::setpoint::Cubics;
use trirrr_protocol::message::scene::{Limits, Section, SectionName};
use trirrr_protocol::message::{Bounded, FaultCode, QuinticMove};

crate::scene! {
    /// The thesis machine, whose parts cannot be changed.
    Fixed: Compiled<'static, Dynamic<f64>>
}

fn read<S: Scene<N = f64>>(bench: &mut Bench<S>, name: SectionName) -> Section {
    match bench.ask(Command::Read(name)) {
        Reply::Section(section) => section,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_scene_can_be_read() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let Section::Leg { index, leg } = read(&mut bench, SectionName::Leg(1)) else {
        panic!("a leg");
    };
    assert_eq!((index, leg.base_m, leg.proximal_m), (1, [0.5, 0.433], 0.2));
    assert_eq!(
        trirrr_core::machine::LegParameters::from(&leg),
        example().legs[1]
    );
    let Section::Platform(platform) = read(&mut bench, SectionName::Platform) else {
        panic!("the platform");
    };
    assert_eq!(platform.put_into(&example()), example());
    assert_eq!(platform.mass_kg, 0.5);
    assert!(matches!(
        read(&mut bench, SectionName::Limits),
        Section::Limits(_)
    ));
    assert_eq!(bench.refused_read(SectionName::Leg(3)), Refusal::NoSuchLeg);
}

impl Bench<Thesis<f64>> {
    fn refused_read(&mut self, name: SectionName) -> Refusal<f64> {
        self.refused(Command::Read(name))
    }
}

#[test]
fn an_image_without_the_code_refuses_overrides() {
    let parameters: &_ = Box::leak(Box::new(example()));
    let limits = Box::leak(Box::new(LimitParameters::default()));
    let coefficients =
        Coefficients::<Dynamic<f64>>::build(parameters, limits, Ramp::within(RAMP, None), PERIOD_S)
            .unwrap();
    let part = |name| {
        let section = Section::of(name, parameters, limits).unwrap();
        let mut room = [0; 256];
        &*postcard::to_slice(&section, &mut room)
            .unwrap()
            .to_vec()
            .leak()
    };
    let scene = Compiled {
        coefficients: Box::leak(Box::new(coefficients)),
        parts: Parts {
            legs: [0, 1, 2].map(|leg| part(SectionName::Leg(leg))),
            platform: part(SectionName::Platform),
            limits: part(SectionName::Limits),
        },
        types: core::marker::PhantomData::<(Cubics, ())>,
    };
    let mut bench = Bench::<Fixed>::of(scene, home());
    // It plays cubics only, and does not read the rest.
    let quintic = QuinticMove {
        common: rest(0, home(), home(), 10),
        start_acceleration: [0.0; 3],
        end_acceleration: [0.0; 3],
    };
    assert_eq!(
        bench.refused(Command::Quintic(quintic)),
        Refusal::NoQuintics
    );
    for name in [
        SectionName::Leg(2),
        SectionName::Platform,
        SectionName::Limits,
    ] {
        let section = Section::of(name, parameters, limits);
        assert_eq!(Some(read(&mut bench, name)), section);
    }
    assert_eq!(
        bench.refused(Command::Read(SectionName::Leg(3))),
        Refusal::NoSuchLeg
    );
    let [section, other] = [0, 1].map(|leg| read(&mut bench, SectionName::Leg(leg)));
    let sequence = bench.sequence;
    assert_eq!(
        bench.refused(Command::Replace(section)),
        Refusal::NotAdjustable
    );
    // It does not read the part, but sees that it is the same, or another.
    for (section, refusal) in [
        (section, Refusal::NotAdjustable),
        (other, Refusal::SequenceReused),
    ] {
        let again = bench.ask_as(sequence, Command::Replace(section));
        assert_eq!(again, Reply::Refused(refusal));
    }
    // Otherwise it does all that others do.
    bench.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 50));
    bench.done(Command::Start);
    bench.ticks(60);
    assert_eq!(bench.status().done, 1);
}

#[test]
fn a_machine_without_torques_has_no_limit_of_them() {
    type Machine = Coefficients<Kinematic<f64>>;
    let of = |limits: LimitParameters| {
        Machine::build(&example(), &limits, Ramp::within(RAMP, None), PERIOD_S)
    };
    assert!(of(LimitParameters::default()).is_ok());
    let some = Some([1.0; 3]);
    for (limits, quantity) in [
        (
            LimitParameters {
                torque_nm: some,
                ..LimitParameters::default()
            },
            Quantity::TorqueLimit,
        ),
        (
            LimitParameters {
                power_w: some,
                ..LimitParameters::default()
            },
            Quantity::PowerLimit,
        ),
    ] {
        assert_eq!(of(limits).unwrap_err().quantity, quantity);
    }

    let scene = Adjustable::new(example(), LimitParameters::default());
    let channels: Channels<Adjustable<Kinematic<f64>>, 8, 64> = Channels::new();
    let mut channels = Box::new(channels);
    let (mut foreground, mut background) = channels.split(scene, home(), settings()).unwrap();
    let mut sequence = 0;
    let mut ask = |command| {
        let reply = hear(&mut background, sequence, command);
        sequence = match &reply {
            Reply::Hello(identity) => identity.next_sequence,
            _ => sequence.wrapping_add(1),
        };
        while background.step() {}
        reply
    };
    ask(Command::Hello(Hello {
        protocol: PROTOCOL,
        schema: SCHEMA,
        scene: SCENE,
    }));
    assert_eq!(ask(Command::Enable), Reply::Done);
    foreground.tick();
    let limited = Limits {
        torque_nm: some,
        ..(&LimitParameters::default()).into()
    };
    let reply = ask(Command::Replace(Section::Limits(limited)));
    assert_eq!(reply, Reply::Refused(Refusal::NotInImage));
    // A mass is nobody's business, and a move is a move.
    let Reply::Section(Section::Platform(mut platform)) = ask(Command::Read(SectionName::Platform))
    else {
        panic!("the platform");
    };
    platform.com_m = [0.01, 0.0];
    assert_eq!(
        ask(Command::Replace(Section::Platform(platform))),
        Reply::Done
    );
    foreground.tick();
    let offered = rest(0, home(), pose(0.28, 0.28, 0.2), 50);
    assert_eq!(ask(Command::Move(offered)), Reply::Done);
    assert_eq!(ask(Command::Start), Reply::Done);
    for _ in 0..25 {
        let output = foreground.tick();
        assert!(output.motors.iter().all(|motor| motor.torque == 0.0));
    }
    assert!(
        foreground
            .output()
            .motors
            .iter()
            .all(|motor| motor.rate != 0.0)
    );
}

#[test]
fn overrides_are_refused_while_there_is_a_job() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let section = read(&mut bench, SectionName::Leg(0));
    bench.done(Command::Move(rest(0, home(), pose(0.28, 0.28, 0.2), 100)));
    for _ in 0..2 {
        assert_eq!(
            bench.refused(Command::Replace(section)),
            Refusal::State(State::Idle)
        );
        bench.judge();
    }
    bench.done(Command::Start);
    bench.ticks(10);
    assert_eq!(
        bench.refused(Command::Replace(section)),
        Refusal::State(State::Running)
    );
}

/// A link measured anew: the motors do not move, the platform is found to stand elsewhere, and the
/// next job runs on the new geometry.
#[test]
fn a_geometry_override_moves_the_pose_and_not_the_motors() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let before = bench.tick();
    let Section::Leg { index, mut leg } = read(&mut bench, SectionName::Leg(0)) else {
        panic!("a leg");
    };
    leg.distal_m += 0.001;
    bench.done(Command::Replace(Section::Leg { index, leg }));
    bench.ticks(2);
    let after = bench.tick();
    for (motor, old) in after.motors.iter().zip(&before.motors) {
        // Newton's last step is below four roundings of the legs' reach, 0.4 m; the motors' angles
        // follow the pose by less than 20 rad/m here.
        assert!((motor.angle - old.angle).abs() < 20.0 * 8.0 * 0.4 * f64::EPSILON);
    }
    let pose_now = bench.status().end.unwrap().pose;
    let moved = (pose_now.position - home::<f64>().position).abs().max();
    assert!(moved > 1e-5 && moved < 1e-2, "{moved}");
    assert_eq!(
        read(&mut bench, SectionName::Leg(0)),
        Section::Leg { index, leg }
    );

    // It is another machine that admits and plays from now on.
    let mut parameters = example();
    parameters.legs[0].distal_m += 0.001;
    let target = pose(0.25, 0.25, 0.1);
    bench.offer(rest(0, pose_now, target, 100));
    bench.done(Command::Start);
    bench.until(State::Idle);
    let geometry = trirrr_core::machine::Geometry::<f64>::build(&parameters).unwrap();
    let angles = geometry.motor_angles(&geometry.position(&target).unwrap());
    for (motor, angle) in bench.service.foreground.output().motors.iter().zip(angles) {
        assert_eq!(motor.angle, angle);
    }
}

#[test]
fn new_limits_count_for_the_admission_and_in_the_tick() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let Section::Limits(limits) = read(&mut bench, SectionName::Limits) else {
        panic!("limits");
    };
    bench.done(Command::Replace(Section::Limits(Limits {
        rate_rad_s: Some([0.1; 3]),
        ..limits
    })));
    bench.ticks(1);
    assert_eq!(bench.service.foreground.guard.limits().rate, Some([0.1; 3]));
    bench.done(Command::Move(rest(0, home(), pose(0.28, 0.28, 0.2), 100)));
    bench.judge();
    let violation = bench.status().refused.unwrap().violation.unwrap();
    assert_eq!((violation.what, violation.limit), (Bounded::Rate, 0.1));
    assert_eq!(
        FaultCode::Limit(violation.what).bounded(),
        Some(Bounded::Rate)
    );
}

#[test]
fn what_cannot_be_built_is_refused_by_name_and_changes_nothing() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let before = read(&mut bench, SectionName::Leg(2));
    let Section::Leg { leg, .. } = before else {
        panic!("a leg");
    };
    let Section::Platform(platform) = read(&mut bench, SectionName::Platform) else {
        panic!("the platform");
    };
    let Section::Limits(limits) = read(&mut bench, SectionName::Limits) else {
        panic!("limits");
    };
    let parameter = |quantity, leg| Refusal::Parameter { quantity, leg };
    let with = |change: fn(&mut trirrr_protocol::message::scene::Leg)| {
        let mut leg = leg;
        change(&mut leg);
        Section::Leg { index: 2, leg }
    };
    let cases = [
        (
            with(|leg| leg.distal_m = -1.0),
            parameter(Quantity::DistalLength, Some(2)),
        ),
        (
            with(|leg| leg.base_m[1] = f64::NAN),
            parameter(Quantity::Base, Some(2)),
        ),
        (Section::Leg { index: 3, leg }, Refusal::NoSuchLeg),
        (
            with(|leg| leg.rotor_inertia_kgm2 = 0.1),
            Refusal::NotInImage,
        ),
        (with(|leg| leg.proximal[0] = 0.1), Refusal::NotInImage),
        (with(|leg| leg.distal_m = 1e-3), Refusal::NoPose),
        (
            Section::Platform(trirrr_protocol::message::scene::Platform {
                com_m: [0.01, 0.0],
                ..platform
            }),
            Refusal::NotInImage,
        ),
        (
            Section::Platform(trirrr_protocol::message::scene::Platform {
                mass_kg: -0.5,
                ..platform
            }),
            parameter(Quantity::PlatformMass, None),
        ),
        (
            Section::Limits(Limits {
                torque_nm: Some([1.0, 0.0, 1.0]),
                ..limits
            }),
            parameter(Quantity::TorqueLimit, Some(1)),
        ),
    ];
    for (section, refusal) in cases {
        assert_eq!(bench.refused(Command::Replace(section)), refusal);
        bench.ticks(1);
        assert_eq!(read(&mut bench, SectionName::Leg(2)), before);
        assert_eq!(bench.status().end.unwrap().pose, home());
    }
    bench.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 50));
    bench.done(Command::Start);
    bench.until(State::Idle);
}
