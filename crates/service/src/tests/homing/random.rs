//! Any offsets, switches, stages and contacts.

use super::*;
use crate::number::ServiceNumber;
use proptest::prelude::*;
use trirrr_core::number::Fixed;

fn contact() -> impl Strategy<Value = Contact> {
    prop_oneof![
        Just(Contact::Switch),
        Just(Contact::Stall),
        Just(Contact::Torque),
        Just(Contact::Unfelt)
    ]
}

fn motor() -> impl Strategy<Value = (HomingMotor, f64)> {
    (
        any::<bool>(),
        // How far the reference is from the motor at the home pose, and the offset.
        0.15f64..0.9,
        -0.5f64..0.5,
        (0.1f64..0.8, 0.02f64..0.1, 0.5f64..1.5, 0.03f64..0.1),
        0u8..3,
    )
        .prop_map(
            |(positive, away, offset, (search, latch, acceleration, back), stage)| {
                let motor = HomingMotor {
                    angle_rad: if positive { away } else { -away },
                    positive,
                    search_rate_rad_s: search,
                    latch_rate_rad_s: latch,
                    acceleration_rad_s2: acceleration,
                    back_off_rad: back,
                    travel_max_rad: 1.5,
                    stall_torque_nm: STALL_TORQUE,
                    stage,
                };
                (motor, offset)
            },
        )
}

fn machine<N: ServiceNumber>(
    contact: Contact,
    debounce_ticks: u16,
    motors: [(HomingMotor, f64); 3],
) -> Machine<N> {
    let pose = home::<f64>();
    let angles = home_angles();
    let mut parameters = HomingParameters {
        contact,
        motors: motors.map(|(motor, _)| motor),
        debounce_ticks,
        stall_is_fault: false,
        start: [pose.position.x, pose.position.y, pose.angle],
        times: HomingTimes::default(),
    };
    for (motor, angle) in parameters.motors.iter_mut().zip(angles) {
        motor.angle_rad = wrapped(motor.angle_rad + angle);
    }
    let mut offset = motors.map(|(_, offset)| offset);
    for (offset, (motor, _)) in offset.iter_mut().zip(&motors) {
        let sign = motor.sign();
        let beyond = *offset * sign - motor.angle_rad.abs();
        // No further on a switch than it is backed off by, and not behind a stop.
        let most = match contact {
            Contact::Switch => 0.9 * motor.back_off_rad,
            _ => -0.01,
        };
        if beyond > most {
            *offset -= (beyond - most) * sign;
        }
    }
    Machine::new(timed(parameters), offset)
}

fn homes<N: ServiceNumber>(contact: Contact, debounce: u16, motors: [(HomingMotor, f64); 3]) {
    let mut machine = machine::<N>(contact, debounce, motors);
    for _ in 0..debounce {
        machine.tick();
    }
    machine.home();
    for (i, error) in machine.errors().into_iter().enumerate() {
        let resolution = 1.05 * PERIOD_S * machine.parameters.motors[i].latch_rate_rad_s;
        assert!(error.abs() <= resolution + 1e-6, "motor {i}: {error}");
    }
    assert_eq!(machine.bench.status().end.map(|end| end.pose), Some(home()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Wherever the motors are, they are known afterwards, and the machine stands at its start.
    #[test]
    fn the_motors_are_found(
        contact in contact(),
        debounce in 1u16..12,
        motors in [motor(), motor(), motor()],
    ) {
        homes::<f64>(contact, debounce, motors);
        homes::<f32>(contact, debounce, motors);
        homes::<Fixed>(contact, debounce, motors);
    }

    /// Whatever is asked meanwhile, it can be homed in the end.
    #[test]
    fn whatever_is_asked_it_homes_in_the_end(
        motors in [motor(), motor(), motor()],
        actions in proptest::collection::vec((0u8..8, 0u32..200), 1..30),
    ) {
        let mut machine = machine::<f64>(Contact::Switch, 3, motors);
        for (action, ticks) in actions {
            let command = match action {
                0..=2 => Command::Home,
                3 => Command::Stop,
                4 => Command::ClearFault,
                5 => Command::Recover(trirrr_protocol::message::Recovery { to: home(), ticks: 600 }),
                6 => Command::Start,
                _ => {
                    let code = trirrr_protocol::message::FaultCode::Board;
                    machine.bench.service.foreground.raise(code, None, 0.0, 0.0);
                    Command::Status
                }
            };
            machine.bench.ask(command);
            for _ in 0..ticks {
                machine.tick();
            }
        }
        machine.bench.ask(Command::Stop);
        for _ in 0..200 {
            machine.tick();
        }
        machine.bench.ask(Command::ClearFault);
        machine.tick();
        machine.bench.ask(Command::Enable);
        machine.tick();
        let stopped = machine.bench.service.foreground.state();
        prop_assert!(stopped.is_at_rest(), "{stopped:?}");
        // Wherever that is, it is not far behind a switch.
        machine.home();
        for (motor, error) in machine.parameters.motors.iter().zip(machine.errors()) {
            prop_assert!(error.abs() <= 1.05 * PERIOD_S * motor.latch_rate_rad_s + 1e-6);
        }
    }
}
