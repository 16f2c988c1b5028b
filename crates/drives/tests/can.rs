//! Drives on the CAN bus, byte for byte. What the bytes have to be is taken from the documentation
//! and the tests of those who make the drives.

mod common;

use common::frame::Sent;
use embedded_can::Frame;
use trirrr_drives::can::{
    Answer, Heard, Mit, MitRanges, Moteus, NoFrame, Odrive, Protocol, Resolution, RotorCommand,
    Say, Told,
};
use trirrr_protocol::message::DriveState;

type Classic = Sent<8>;
type Fd = Sent<64>;

const STILL: RotorCommand = RotorCommand {
    position: 0.0,
    velocity: 0.0,
    torque: 0.0,
};

fn said<const L: usize>(protocol: &impl Protocol, node: u8, say: Say) -> String {
    protocol.frame::<Sent<L>>(node, &say).unwrap().text()
}

/// moteus: docs/protocol/can.md, its example frame; lib/cpp/mjbots/moteus/test/moteus_protocol_test.cc:
/// `PositionDefaults`, `PositionMaximal` (the values, its frame holds more registers), `MakeStop`.
#[test]
fn moteus_frames_are_those_of_its_documentation() {
    let int16 = Moteus {
        resolution: Resolution::Int16,
    };
    let float = Moteus {
        resolution: Resolution::Float,
    };
    // 3.456 degrees, 25.92 degrees per second, -1.76 N m.
    let command = RotorCommand {
        position: 3.456 / 360.0,
        velocity: 25.92 / 360.0,
        torque: -1.76,
    };
    assert_eq!(
        said::<64>(&int16, 1, Say::Move(command)),
        "00008001#01000a07206000200150ff140400130d"
    );
    assert_eq!(
        said::<64>(&float, 1, Say::Move(STILL)),
        format!("00008001#01000a0f20{}1c0400130d5050", "00".repeat(12))
    );
    // Int16 of 0.25 turns, 0.5 turns/s and 1 N m: c409, d007, 6400.
    let command = RotorCommand {
        position: 0.25,
        velocity: 0.5,
        torque: 1.0,
    };
    assert_eq!(
        said::<64>(&int16, 127, Say::Move(command)),
        "0000807f#01000a0720c409d0076400140400130d"
    );
    // Floats of 1 and 2, docs/integration/can-fd.md: 0000803f, 00000040.
    let command = RotorCommand {
        position: 1.0,
        velocity: 2.0,
        torque: 1.0,
    };
    assert_eq!(
        said::<64>(&float, 1, Say::Move(command)),
        "00008001#01000a0f200000803f000000400000803f1c0400130d5050"
    );
    assert_eq!(said::<64>(&float, 1, Say::Off), "00008001#0100001c0400130d");
    assert_eq!(
        said::<64>(&int16, 1, Say::Clear),
        "00008001#010000140400130d"
    );
    assert_eq!(said::<64>(&int16, 1, Say::Ask(7)), "00008001#140400130d");
    // Lengths that CAN FD has.
    for resolution in [Resolution::Int16, Resolution::Float] {
        let frame: Fd = Moteus { resolution }.frame(1, &Say::Move(STILL)).unwrap();
        assert!([16, 24].contains(&frame.data().len()));
    }
}

#[test]
fn moteus_does_not_fit_classic_can() {
    for resolution in [Resolution::Int16, Resolution::Float] {
        let frame = Moteus { resolution }.frame::<Classic>(1, &Say::Move(STILL));
        assert_eq!(frame, Err(NoFrame::TooLong));
    }
}

/// ODrive: docs/can-protocol.rst ("0x01 << 5 | 0x0C = 0x2C"), its can-protocol.csv (fields), and the
/// maker's Python example, which packs '<I', 8 for closed loop control. Fields by IEEE 754 and two's
/// complement: 1.234 is 3F9DF3B6.
#[test]
fn odrive_frames_are_those_of_its_documentation() {
    let command = RotorCommand {
        position: 1.234,
        velocity: -2.5,
        torque: 0.125,
    };
    assert_eq!(
        said::<8>(&Odrive, 1, Say::Move(command)),
        "02c#b6f39d3f3cf67d00" // -2500, 125
    );
    let steps = [0, 1, 2].map(|step| said::<8>(&Odrive, 3, Say::Prepare(step, command)));
    assert_eq!(
        steps,
        [
            "06b#0300000001000000",
            "06c#b6f39d3f3cf67d00",
            "067#08000000",
        ]
    );
    assert_eq!(said::<8>(&Odrive, 63, Say::Off), "7e7#01000000");
    assert_eq!(said::<8>(&Odrive, 3, Say::Clear), "078#");
    let asked = [0, 1, 2, 3].map(|turn| said::<8>(&Odrive, 1, Say::Ask(turn)));
    assert_eq!(asked, ["029#R8", "023#R8", "037#R8", "029#R8"]);
}

#[test]
fn what_a_field_cannot_hold_is_refused_not_cut() {
    let beyond = |velocity, torque| {
        let command = RotorCommand {
            position: 0.0,
            velocity,
            torque,
        };
        Odrive.frame::<Classic>(1, &Say::Move(command)).err()
    };
    assert_eq!(beyond(32.767, -32.767), None);
    assert_eq!(beyond(32.768, 0.0), Some(NoFrame::Range));
    assert_eq!(beyond(0.0, -33.0), Some(NoFrame::Range));
    assert_eq!(beyond(f32::NAN, 0.0), Some(NoFrame::Range));
    let turns = RotorCommand {
        position: 3.2768,
        ..STILL
    };
    let short = Moteus {
        resolution: Resolution::Int16,
    };
    assert_eq!(short.frame::<Fd>(1, &Say::Move(turns)), Err(NoFrame::Range));
}

/// Contents of a classic frame from the text of candump.
fn heard<P: Protocol>(protocol: &P, text: &str) -> Option<(u8, Heard)> {
    protocol.hear(&Fd::of_text(text))
}

const SILENT: Heard = Heard {
    state: None,
    error: None,
    position: None,
    velocity: None,
    torque: None,
    current: None,
    temperature: None,
    supply: None,
};

fn is(state: DriveState, error: u32) -> Heard {
    Heard {
        state: Some(Told::State(state)),
        error: Some(error),
        ..SILENT
    }
}

/// Heartbeats as candump shows them in ODrive's docs/can-guide.rst, that of the package odrive-can (error 1, state 11),
/// and errors by ODriveEnums.h.
#[test]
fn an_odrive_tells_its_state_and_error() {
    let odrive = |text| heard(&Odrive, text);
    assert_eq!(
        odrive("001#0000000001000000"),
        Some((0, is(DriveState::Off, 0)))
    );
    assert_eq!(
        odrive("021#0000000008000000"),
        Some((1, is(DriveState::On, 0)))
    );
    assert_eq!(
        odrive("001#010000000b000000"),
        Some((0, is(DriveState::Fault, 1)))
    );
    // A procedure under way, and one that was refused: not calibrated.
    assert_eq!(
        odrive("7e1#0000000003010000"),
        Some((63, is(DriveState::Preparing, 0)))
    );
    assert_eq!(
        odrive("021#00000000010e0000"),
        Some((1, is(DriveState::Uncalibrated, 0)))
    );
    // Estop requested, 0x02000000; calibration error, 0x40000000; closed loop with an error is no closed loop.
    assert_eq!(
        odrive("021#0000000201000000"),
        Some((1, is(DriveState::Fault, 0x0200_0000)))
    );
    assert_eq!(
        odrive("021#0000004001000000"),
        Some((1, is(DriveState::Uncalibrated, 0x4000_0000)))
    );
    assert_eq!(
        odrive("021#0001000008000000"),
        Some((1, is(DriveState::Fault, 0x100)))
    );
    // Get Error: none; an active one; none active, but the reason of the last disarming, the watchdog.
    let error = |code| {
        Some((
            1,
            Heard {
                error: Some(code),
                ..SILENT
            },
        ))
    };
    assert_eq!(odrive("023#0000000000000000"), error(0));
    assert_eq!(odrive("023#0020000000010000"), error(0x2000));
    assert_eq!(odrive("023#0000000000000001"), error(0x0100_0000));
}

/// Fields by can_simple_messages.hpp; 1.0 is 3F800000 in IEEE 754, 2.0 40000000, -0.5 BF000000, 24.0 41C00000, 40.5
/// 42220000, not a number 7FC00000.
#[test]
fn an_odrive_tells_its_motion_and_health() {
    let odrive = |text| heard(&Odrive, text).map(|(_, heard)| heard);
    assert_eq!(
        odrive("029#0000803f000000bf"),
        Some(Heard {
            position: Some(1.0),
            velocity: Some(-0.5),
            ..SILENT
        })
    );
    // Without an encoder there is no estimate.
    assert_eq!(odrive("029#0000c07f0000c07f"), Some(SILENT));
    let current = Some(Heard {
        current: Some(-0.5),
        ..SILENT
    });
    assert_eq!(odrive("034#0000803f000000bf"), current);
    let torque = Some(Heard {
        torque: Some(2.0),
        ..SILENT
    });
    assert_eq!(odrive("03c#0000803f00000040"), torque);
    let supply = Some(Heard {
        supply: Some(24.0),
        ..SILENT
    });
    assert_eq!(odrive("037#0000c0410000803f"), supply);
    let hottest = Some(Heard {
        temperature: Some(40.5),
        ..SILENT
    });
    assert_eq!(odrive("035#0000c04100002242"), hottest);
    assert_eq!(odrive("035#000022420000c07f"), hottest);
    // Messages that it does not read, frames that are too short, and an extended identifier.
    assert_eq!(odrive("03d#0000803f0000803f"), None);
    assert_eq!(odrive("029#0000803f"), None);
    assert_eq!(odrive("00000029#0000803f000000bf"), None);
}

/// The reply in moteus' docs/protocol/can.md, and registers by docs/protocol/registers.md.
#[test]
fn a_moteus_tells_what_it_was_asked() {
    let int16 = Moteus {
        resolution: Resolution::Int16,
    };
    let (node, told) = heard(&int16, "100#2404000a005000000170ff230d181400").unwrap();
    assert_eq!(
        (node, told.state, told.error),
        (1, Some(Told::State(DriveState::On)), Some(0))
    );
    let near = |found: Option<f32>, exact: f32| (found.unwrap() - exact).abs() < 1e-6;
    assert!(near(told.position, 2.88 / 360.0) && near(told.velocity, 23.04 / 360.0));
    assert!(near(told.torque, -1.44) && near(told.supply, 12.0));
    assert_eq!(told.temperature, Some(20.0));
    // Floats, node 127: mode 0, 1 turn, -0.5 turns/s, 2 N m.
    let text = format!(
        "00007f00#2c0400{}{}{}{}230d301950",
        "00000000", "0000803f", "000000bf", "00000040"
    );
    let (node, told) = heard(&int16, &text).unwrap();
    assert_eq!(
        (node, told.state),
        (127, Some(Told::State(DriveState::Off)))
    );
    assert_eq!(
        [told.position, told.velocity, told.torque],
        [Some(1.0), Some(-0.5), Some(2.0)]
    );
    // A fault, 33; a motor that is not configured, 36; a watchdog that has run out; limited power, which is none.
    let mode = |mode: u8, code: u8| {
        let (_, told) = heard(&int16, &format!("100#2100{mode:02x}210f{code:02x}")).unwrap();
        (told.state.unwrap(), told.error.unwrap())
    };
    assert_eq!(mode(1, 33), (Told::State(DriveState::Fault), 33));
    assert_eq!(mode(1, 36), (Told::State(DriveState::Uncalibrated), 36));
    assert_eq!(mode(11, 0), (Told::State(DriveState::Fault), 0));
    assert_eq!(mode(10, 99), (Told::State(DriveState::On), 0));
    assert_eq!(mode(3, 0), (Told::State(DriveState::Preparing), 0));
    // The most negative number is none.
    let (_, told) = heard(&int16, "100#2404000a00008000800080").unwrap();
    assert_eq!([told.position, told.velocity, told.torque], [None; 3]);
    // To another host, a number of registers that the frame does not hold, and no reply at all.
    for text in ["101#21000a", "100#2404000a00", "100#14040013", "100#24"] {
        assert_eq!(heard(&int16, text), None, "{text}");
    }
}

const DM4310: Mit = Mit {
    ranges: MitRanges {
        position: 12.5,
        velocity: 30.0,
        torque: 10.0,
        kp: 500.0,
        kd: 5.0,
    },
    kp: 0.0,
    kd: 0.0,
    answer: Answer::Damiao,
    host_id: 0,
};

/// The formula of openarm_can, RobStride's manual and TMotorCANControl, which cut: to the nearest is one more at the
/// most.
fn maker(value: f64, least: f64, most: f64, bits: u32) -> u64 {
    ((value - least) * f64::from((1 << bits) - 1) / (most - least)) as u64
}

#[test]
fn mit_frames_are_those_of_their_makers() {
    let special = |say| said::<8>(&DM4310, 1, say);
    assert_eq!(special(Say::Prepare(0, STILL)), "001#fffffffffffffffc");
    assert_eq!(special(Say::Off), "001#fffffffffffffffd");
    assert_eq!(special(Say::Ask(3)), "001#fffffffffffffffd");
    assert_eq!(special(Say::Clear), "001#fffffffffffffffb");
    let ak = Mit {
        answer: Answer::TMotor,
        ..DM4310
    };
    assert_eq!(said::<8>(&ak, 1, Say::Clear), "001#fffffffffffffffd");
    // At rest without gains: the middle of each range.
    assert_eq!(
        said::<8>(&DM4310, 15, Say::Move(STILL)),
        "00f#7fff7ff0000007ff"
    );
    // At both ends.
    let turns = |radians: f64| (radians / core::f64::consts::TAU) as f32;
    let end = RotorCommand {
        position: turns(12.499_99),
        velocity: turns(29.999_99),
        torque: 10.0,
    };
    let stiff = Mit {
        kp: 500.0,
        kd: 5.0,
        ..DM4310
    };
    assert_eq!(said::<8>(&stiff, 1, Say::Move(end)), "001#ffffffffffffffff");
    let mit = Mit {
        kp: 50.0,
        kd: 1.5,
        ..DM4310
    };
    for step in -100..=100 {
        let part = f64::from(step) / 101.0;
        let [p, v, t] = [12.5 * part, -30.0 * part, 10.0 * part * part];
        let command = RotorCommand {
            position: turns(p),
            velocity: turns(v),
            torque: t as f32,
        };
        let text = said::<8>(&mit, 1, Say::Move(command));
        let word = u64::from_str_radix(text.split_once('#').unwrap().1, 16).unwrap();
        for (shift, bits, exact) in [
            (48, 16, maker(p, -12.5, 12.5, 16)),
            (36, 12, maker(v, -30.0, 30.0, 12)),
            (24, 12, maker(50.0, 0.0, 500.0, 12)),
            (12, 12, maker(1.5, 0.0, 5.0, 12)),
            (0, 12, maker(t, -10.0, 10.0, 12)),
        ] {
            let field = word >> shift & ((1 << bits) - 1);
            assert!(
                field == exact || field == exact + 1,
                "{step} {shift}: {field} {exact}"
            );
        }
    }
    let beyond = |command| DM4310.frame::<Classic>(1, &Say::Move(command)).err();
    let far = RotorCommand {
        position: 2.0,
        ..STILL
    };
    assert_eq!(beyond(far), Some(NoFrame::Range));
    assert_eq!(
        beyond(RotorCommand {
            torque: f32::NAN,
            ..STILL
        }),
        Some(NoFrame::Range)
    );
}

/// Answers by the layouts of the makers: state and address in the first byte of a Damiao, tenths of a degree of a
/// RobStride, the error in the last byte of a T-Motor AK.
#[test]
fn mit_drives_tell_their_motion() {
    let (node, told) = heard(&DM4310, "000#138000800fff2a30").unwrap();
    assert_eq!(
        (node, told.state, told.error),
        (3, Some(Told::State(DriveState::On)), Some(0))
    );
    let near =
        |found: Option<f32>, exact: f64, by: f64| (f64::from(found.unwrap()) - exact).abs() < by;
    // 0x8000 and 0x800 are half a unit beyond the middle, 0xFFF the end.
    let tau = core::f64::consts::TAU;
    assert!(near(told.position, 12.5 / 65_535.0 / tau, 1e-6));
    assert!(near(told.velocity, 30.0 / 4095.0 / tau, 1e-6));
    assert!(near(told.torque, 10.0, 1e-5));
    assert_eq!(told.temperature, Some(48.0));
    for (first, state, error) in [
        ("01", DriveState::Off, 0),
        ("b1", DriveState::Fault, 11),
        ("d1", DriveState::Fault, 13),
    ] {
        let (_, told) = heard(&DM4310, &format!("000#{first}7fff7ff7ff1919")).unwrap();
        assert_eq!(
            (told.state, told.error),
            (Some(Told::State(state)), Some(error))
        );
    }
    let robstride = Mit {
        answer: Answer::RobStride,
        host_id: 0xFD,
        ..DM4310
    };
    let (node, told) = heard(&robstride, "0fd#7f7fff7ff7ff0165").unwrap();
    assert_eq!((node, told.state), (127, Some(Told::Obeys)));
    assert!(near(told.temperature, 35.7, 1e-4));
    let ak = Mit {
        answer: Answer::TMotor,
        ..DM4310
    };
    let (_, told) = heard(&ak, "000#027fff7ff7fff600").unwrap();
    assert_eq!(
        (told.state, told.temperature),
        (Some(Told::Obeys), Some(-10.0))
    );
    let (_, told) = heard(&ak, "000#027fff7ff7ff5001").unwrap();
    assert_eq!(
        (told.state, told.error),
        (Some(Told::State(DriveState::Fault)), Some(1))
    );
    // Of another host, and too short.
    assert_eq!(heard(&DM4310, "001#138000800fff2a30"), None);
    assert_eq!(heard(&DM4310, "000#138000800fff2a"), None);
}
