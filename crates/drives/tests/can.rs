//! Drives on the CAN bus, byte for byte. What the bytes have to be is taken from the documentation
//! and the tests of those who make the drives.

mod common;

use common::{output, wrapped};
use core::f64::consts::TAU;
use embedded_can::{ErrorKind, Frame, Id, StandardId};
use std::cell::RefCell;
use std::rc::Rc;
use trirrr_core::number::{Fixed, Number};
use trirrr_drives::can::{
    Bus, CanDrives, Moteus, NoFrame, Odrive, Protocol, Resolution, RotorCommand, RotorScale, Say,
};
use trirrr_protocol::message::DriveFault;

/// A frame that holds up to `LONGEST` bytes: 8 in classic CAN, 64 in CAN FD.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Sent<const LONGEST: usize> {
    id: Id,
    data: Vec<u8>,
}

type Classic = Sent<8>;
type Fd = Sent<64>;

impl<const LONGEST: usize> Frame for Sent<LONGEST> {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        (data.len() <= LONGEST).then(|| Self {
            id: id.into(),
            data: data.into(),
        })
    }

    fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.data.len()
    }

    fn data(&self) -> &[u8] {
        &self.data
    }
}

impl<const LONGEST: usize> Sent<LONGEST> {
    /// Identifier and bytes in hexadecimal, as candump and cansend have them.
    fn text(&self) -> String {
        let Id::Standard(id) = self.id else {
            panic!("an eleven-bit identifier");
        };
        let bytes: String = self.data.iter().map(|byte| format!("{byte:02x}")).collect();
        format!("{:03x}#{bytes}", id.as_raw())
    }
}

const STILL: RotorCommand = RotorCommand {
    position: 0.0,
    velocity: 0.0,
    torque: 0.0,
};

fn said<const L: usize>(protocol: &impl Protocol, node: u8, say: Say) -> String {
    protocol.frame::<Sent<L>>(node, &say).unwrap().text()
}

/// moteus: docs/protocol/can.md, its example frame without the two queries at its end;
/// lib/cpp/mjbots/moteus/test/moteus_protocol_test.cc: `PositionDefaults`, `PositionMaximal` (the
/// values, its frame holds more registers), `MakeStop`.
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
        format!("001#{}{}", "01000a07206000200150ff", "50")
    );
    assert_eq!(
        said::<64>(&float, 1, Say::Move(STILL)),
        format!("001#{}{}", "01000a0f20000000000000000000000000", "505050")
    );
    // Int16 of 0.25 turns, 0.5 turns/s and 1 N m: c409, d007, 6400.
    let command = RotorCommand {
        position: 0.25,
        velocity: 0.5,
        torque: 1.0,
    };
    assert_eq!(
        said::<64>(&int16, 127, Say::Move(command)),
        "07f#01000a0720c409d007640050"
    );
    // Floats of 1 and 2, docs/integration/can-fd.md: 0000803f, 00000040.
    let command = RotorCommand {
        position: 1.0,
        velocity: 2.0,
        torque: 1.0,
    };
    assert_eq!(
        said::<64>(&float, 1, Say::Move(command)),
        "001#01000a0f200000803f000000400000803f505050"
    );
    assert_eq!(said::<64>(&float, 1, Say::Off), "001#010000");
    // Lengths that CAN FD has.
    for resolution in [Resolution::Int16, Resolution::Float] {
        let frame: Fd = Moteus { resolution }.frame(1, &Say::Move(STILL)).unwrap();
        assert!([12, 20].contains(&frame.data.len()));
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
    let steps = [0, 1, 2, 3].map(|step| said::<8>(&Odrive, 3, Say::Prepare(step, command)));
    assert_eq!(
        steps,
        [
            "078#",
            "06b#0300000001000000",
            "06c#b6f39d3f3cf67d00",
            "067#08000000",
        ]
    );
    assert_eq!(said::<8>(&Odrive, 63, Say::Off), "7e7#01000000");
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

/// Heartbeats as candump shows them in docs/can-guide.rst, and one with an error.
#[test]
fn a_heartbeat_with_an_error_is_heard() {
    let heard = |id: u16, data: [u8; 8]| {
        let id = StandardId::new(id).unwrap();
        Odrive.error(&Classic::new(id, &data).unwrap())
    };
    assert_eq!(heard(0x001, [0, 0, 0, 0, 1, 0, 0, 0]), None);
    assert_eq!(heard(0x021, [0, 0, 0, 0, 8, 0, 0, 0]), None);
    // Estop requested, 0x4000.
    assert_eq!(heard(0x021, [0, 0x40, 0, 0, 1, 0, 0, 0]), Some((1, 0x4000)));
    // Encoder estimates are none.
    assert_eq!(heard(0x029, [1, 2, 3, 4, 5, 6, 7, 8]), None);
}

/// A controller with three mailboxes, which the bus empties or does not.
#[derive(Clone, Debug, Default)]
struct Mailboxes(Rc<RefCell<State>>);

#[derive(Debug, Default)]
struct State {
    waiting: Vec<Classic>,
    carried: Vec<Classic>,
    received: Vec<Classic>,
    off: bool,
}

#[derive(Clone, Copy, Debug)]
struct Off;

impl embedded_can::Error for Off {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl embedded_can::nb::Can for Mailboxes {
    type Frame = Classic;
    type Error = Off;

    fn transmit(&mut self, frame: &Classic) -> nb::Result<Option<Classic>, Off> {
        let mut state = self.0.borrow_mut();
        if state.off {
            return Err(nb::Error::Other(Off));
        }
        if state.waiting.len() == 3 {
            return Err(nb::Error::WouldBlock);
        }
        state.waiting.push(frame.clone());
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<Classic, Off> {
        self.0
            .borrow_mut()
            .received
            .pop()
            .ok_or(nb::Error::WouldBlock)
    }
}

impl Bus for Mailboxes {
    fn abort(&mut self) {
        self.0.borrow_mut().waiting.clear();
    }
}

impl Mailboxes {
    /// The bus carries what waits.
    fn carry(&self) -> Vec<String> {
        let mut state = self.0.borrow_mut();
        let waiting = state.waiting.split_off(0);
        state.carried.extend(waiting.clone());
        waiting.iter().map(Classic::text).collect()
    }
}

const GEAR: f64 = 8.0;
const ZERO: f64 = 0.3;
const START: [f64; 3] = [2.9, -0.4, -3.0];

fn drives<N: trirrr_drives::count::Countable>(
    bus: &Mailboxes,
    units: [f64; 2],
) -> CanDrives<N, Odrive, Mailboxes> {
    let scale = |reversed| RotorScale::new(GEAR, reversed, ZERO, units[0], units[1]);
    CanDrives::new(
        Odrive,
        bus.clone(),
        [1, 2, 3],
        [scale(false), scale(true), scale(false)],
        START.map(N::angle_from_f64),
    )
}

fn standing<N: Number>(enabled: bool) -> trirrr_service::Output<N> {
    output(START.map(|angle| [angle, 0.0, 0.0]), enabled)
}

#[test]
fn drives_go_on_step_by_step_and_off_at_once() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0]);
    drives.apply(&standing(false)).unwrap();
    assert_eq!(
        bus.carry(),
        ["027#01000000", "047#01000000", "067#01000000"]
    );
    let mut first = vec![];
    for _ in 0..6 {
        drives.apply(&standing(true)).unwrap();
        let carried = bus.carry();
        assert_eq!(carried.len(), 3);
        first.push(carried[0][..3].to_owned());
    }
    assert_eq!(first, ["038", "02b", "02c", "027", "02c", "02c"]);
    // A fault, and the bus did not carry the tick before: the commands are dropped.
    drives.apply(&standing(true)).unwrap();
    drives.apply(&standing(false)).unwrap();
    assert_eq!(
        bus.carry(),
        ["027#01000000", "047#01000000", "067#01000000"]
    );
    // And on again from the start.
    drives.apply(&standing(true)).unwrap();
    assert_eq!(bus.carry()[0], "038#");
}

/// Position, velocity and torque that a frame says, by the fields of the documentation.
fn fields(text: &str) -> [f64; 3] {
    let (_, data) = text.split_once('#').unwrap();
    let bytes: Vec<u8> = (0..data.len() / 2)
        .map(|at| u8::from_str_radix(&data[2 * at..2 * at + 2], 16).unwrap())
        .collect();
    let position = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let velocity = i16::from_le_bytes([bytes[4], bytes[5]]);
    let torque = i16::from_le_bytes([bytes[6], bytes[7]]);
    [
        position.into(),
        f64::from(velocity) / 1000.0,
        f64::from(torque) / 1000.0,
    ]
}

/// Over several turns of the joints: what the rotors are told is N theta / 2 pi from the zero,
/// unwrapped, N w / 2 pi and tau / N.
fn rotors<N: trirrr_drives::count::Countable>(units: [f64; 2], tolerance: f64) {
    let bus = Mailboxes::default();
    let mut drives = drives::<N>(&bus, units);
    let (mut turned, mut farthest) = (0.0, 0.0_f64);
    for tick in 0..3000 {
        let rate = f64::sin(f64::from(tick) * 2e-3) * 20.0;
        turned += rate * 1e-3;
        farthest = farthest.max(turned);
        let torque = f64::cos(f64::from(tick) * 7e-3) * 3.0;
        let wanted = START.map(|start| {
            let angle = wrapped(start + turned);
            [angle, rate / units[0], torque / units[1]]
        });
        drives.apply(&output::<N>(wanted, true)).unwrap();
        let carried = bus.carry();
        if tick < 4 {
            continue;
        }
        for (index, text) in carried.iter().enumerate() {
            let sign = if index == 1 { -1.0 } else { 1.0 };
            // At the start within half a turn of the zero.
            let turn = if index == 2 { TAU } else { 0.0 };
            let joint = START[index] - ZERO + turn + turned;
            let [position, velocity, torque_found] = fields(text);
            assert!(
                (position - sign * GEAR * joint / TAU).abs() < tolerance,
                "{tick} {index}"
            );
            assert!((velocity - sign * GEAR * rate / TAU).abs() < 0.5e-3 + 1e-5);
            assert!((torque_found - sign * torque / GEAR).abs() < 0.5e-3 + 1e-5);
        }
    }
    assert!(farthest > 3.0 * TAU, "{farthest}");
}

#[test]
fn rotors_are_told_turns_and_their_own_torque() {
    // Up to 30 turns in binary32, and its angles.
    rotors::<f32>([1.0, 1.0], 1e-5);
    rotors::<f64>([1.0, 1.0], 1e-5);
    // In units of its own.
    rotors::<Fixed>([16.0, 2.0], 1e-5);
}

#[test]
fn a_bus_that_fails_is_a_fault_with_its_name() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0]);
    for _ in 0..5 {
        drives.apply(&standing(true)).unwrap();
        bus.carry();
    }
    drives.apply(&standing(true)).unwrap();
    // Nobody acknowledged.
    let failure = drives.apply(&standing(true)).unwrap_err();
    assert_eq!(
        (failure.what, failure.drive),
        (DriveFault::BusBusy, Some(0))
    );
    bus.carry();
    bus.0.borrow_mut().off = true;
    let failure = drives.apply(&standing(true)).unwrap_err();
    assert_eq!(failure.what, DriveFault::BusOff);
    // Off is off, whatever the bus does.
    drives.apply(&standing(false)).unwrap();
}

#[test]
fn a_drive_that_reports_an_error_is_a_fault() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0]);
    let heartbeat = |node: u16| {
        let id = StandardId::new(node << 5 | 1).unwrap();
        Classic::new(id, &[0, 2, 0, 0, 1, 0, 0, 0]).unwrap()
    };
    // An old one, which is being cleared, and that of a stranger.
    bus.0.borrow_mut().received = vec![heartbeat(2)];
    for _ in 0..4 {
        drives.apply(&standing(true)).unwrap();
        bus.carry();
    }
    bus.0.borrow_mut().received = vec![heartbeat(9)];
    drives.apply(&standing(true)).unwrap();
    bus.carry();
    bus.0.borrow_mut().received = vec![heartbeat(2)];
    let failure = drives.apply(&standing(true)).unwrap_err();
    assert_eq!(
        (failure.what, failure.drive),
        (DriveFault::Reported, Some(1))
    );
    assert_eq!(failure.value, 512.0);
}

#[test]
fn a_command_beyond_its_field_is_a_fault() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0]);
    for _ in 0..4 {
        drives.apply(&standing(true)).unwrap();
        bus.carry();
    }
    // 8 * 26 / 2 pi is 33.1 turns per second.
    let mut wanted = START.map(|angle| [angle, 0.0, 0.0]);
    wanted[2][1] = 26.0;
    let failure = drives.apply(&output(wanted, true)).unwrap_err();
    assert_eq!((failure.what, failure.drive), (DriveFault::Range, Some(2)));
}
