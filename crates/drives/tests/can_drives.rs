//! Three drives on the CAN bus: going on, following, going off, and what they are heard to say.

mod common;

use common::frame::Sent;
use common::{output, powered, wrapped};
use core::f64::consts::TAU;
use embedded_can::ErrorKind;
use std::cell::RefCell;
use std::rc::Rc;
use trirrr_core::number::{Fixed, Number};
use trirrr_drives::can::{Absolute, Bus, CanDrives, Odrive, RotorScale};
use trirrr_drives::count::Countable;
use trirrr_protocol::message::{DriveFault, DriveReading, DriveState};
use trirrr_service::Power;

type Classic = Sent<8>;

/// A controller with three mailboxes, which the bus empties or does not.
#[derive(Clone, Debug, Default)]
struct Mailboxes(Rc<RefCell<State>>);

#[derive(Debug, Default)]
struct State {
    waiting: Vec<Classic>,
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
        let received = &mut self.0.borrow_mut().received;
        match received.is_empty() {
            true => Err(nb::Error::WouldBlock),
            false => Ok(received.remove(0)),
        }
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
        let waiting = self.0.borrow_mut().waiting.split_off(0);
        waiting.iter().map(Classic::text).collect()
    }

    /// The drives say this.
    fn say(&self, texts: &[String]) {
        let frames = texts.iter().map(|text| Classic::of_text(text));
        self.0.borrow_mut().received.extend(frames);
    }
}

const GEAR: f64 = 8.0;
const ZERO: f64 = 0.3;
const START: [f64; 3] = [2.9, -0.4, -3.0];
const SIGNS: [f64; 3] = [1.0, -1.0, 1.0];
const IDLE: u8 = 1;
const CLOSED_LOOP: u8 = 8;

fn drives<N: Countable>(
    bus: &Mailboxes,
    units: [f64; 2],
    absolute: Absolute,
) -> CanDrives<N, Odrive, Mailboxes> {
    let scale =
        |sign: f64| RotorScale::new(GEAR, sign < 0.0, ZERO, units[0], units[1]).knows(absolute);
    CanDrives::new(
        Odrive,
        bus.clone(),
        [1, 2, 3],
        SIGNS.map(scale),
        START.map(N::angle_from_f64),
        100,
    )
}

fn standing<N: Number>(power: Power) -> trirrr_service::Output<N> {
    powered(START.map(|angle| [angle, 0.0, 0.0]), power)
}

fn heartbeat(node: usize, error: u32, state: u8) -> String {
    let bytes = error.swap_bytes();
    format!("{:03x}#{bytes:08x}{state:02x}000000", node << 5 | 1)
}

fn estimate(node: usize, turns: f64, rate: f64) -> String {
    let [turns, rate] = [turns, rate].map(|value| (value as f32).to_bits().swap_bytes());
    format!("{:03x}#{turns:08x}{rate:08x}", node << 5 | 9)
}

/// Turns of a rotor from its zero, its joint at the start.
fn at_start(index: usize) -> f64 {
    SIGNS[index] * GEAR * wrapped(START[index] - ZERO) / TAU
}

/// All drives are heard: in `state`, at `turns`.
fn hear(bus: &Mailboxes, state: u8, turns: [f64; 3]) {
    for (index, turns) in turns.into_iter().enumerate() {
        bus.say(&[
            heartbeat(index + 1, 0, state),
            estimate(index + 1, turns, 0.0),
        ]);
    }
}

fn ask(command: u16) -> Vec<String> {
    (1..=3)
        .map(|node| format!("{:03x}#R8", node << 5 | command))
        .collect()
}

fn idle() -> Vec<String> {
    (1..=3)
        .map(|node| format!("{:03x}#01000000", node << 5 | 7))
        .collect()
}

#[test]
fn drives_are_asked_go_on_step_by_step_and_off_at_once() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
    let mut tick = |power: Power| {
        let readings = drives.measure();
        drives.apply(&standing(power)).unwrap();
        (readings.map(|reading| reading.state), bus.carry())
    };
    // Nothing but questions: estimates, errors and voltage in turn; whether off or checked.
    assert_eq!(tick(Power::Off), ([DriveState::Silent; 3], ask(0x03)));
    assert_eq!(tick(Power::Check), ([DriveState::Silent; 3], ask(0x17)));
    // Not even when they are to go on, as long as nobody knows where they are.
    assert_eq!(tick(Power::On), ([DriveState::Silent; 3], ask(0x09)));
    hear(&bus, IDLE, [0, 1, 2].map(at_start));
    assert_eq!(tick(Power::Check), ([DriveState::Off; 3], ask(0x03)));
    let mut first = vec![];
    for _ in 0..5 {
        let (_, carried) = tick(Power::On);
        assert_eq!(carried.len(), 3);
        first.push(carried[0][..3].to_owned());
    }
    // Mode, position, closed loop, and commands. Nothing clears errors.
    assert_eq!(first, ["02b", "02c", "027", "02c", "02c"]);
    hear(&bus, CLOSED_LOOP, [0, 1, 2].map(at_start));
    assert_eq!(tick(Power::On).0, [DriveState::On; 3]);
    // Off, again and again until the drives say so themselves.
    for _ in 0..20 {
        assert_eq!(tick(Power::Off).1, idle());
    }
    hear(&bus, IDLE, [0, 1, 2].map(at_start));
    let (states, carried) = tick(Power::Off);
    assert_eq!(
        (states, carried[0].ends_with("#R8")),
        ([DriveState::Off; 3], true)
    );
    // And on again from the start.
    assert_eq!(tick(Power::On).1[0], "02b#0300000001000000");
}

#[test]
fn commands_that_wait_are_dropped_where_the_drives_go_off() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
    hear(&bus, IDLE, [0, 1, 2].map(at_start));
    drives.measure();
    drives.apply(&standing(Power::On)).unwrap();
    // The bus has carried nothing.
    drives.apply(&standing(Power::Off)).unwrap();
    assert_eq!(bus.carry(), idle());
}

/// Three orders to go off at least; then a drive is asked once it says anew that it is off. One that prepares to go on, or that was
/// off some time ago, has not said so.
#[test]
fn drives_are_told_to_stop_until_they_say_anew_that_they_have() {
    const PREPARING: u8 = 3;
    // State that the drives tell in the first ticks of these, and orders to go off in 20 ticks.
    for (state, heard, orders) in [
        (IDLE, 20, 3),
        (PREPARING, 20, 20),
        (IDLE, 1, 20),
        (CLOSED_LOOP, 20, 20),
    ] {
        let bus = Mailboxes::default();
        let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
        hear(&bus, IDLE, [0, 1, 2].map(at_start));
        drives.measure();
        drives.apply(&standing(Power::On)).unwrap();
        bus.carry();
        let mut told = 0;
        for tick in 0..20 {
            if tick < heard {
                hear(&bus, state, [0, 1, 2].map(at_start));
            }
            drives.measure();
            drives.apply(&standing(Power::Off)).unwrap();
            told += i32::from(bus.carry() == idle());
        }
        assert_eq!(told, orders, "{state} heard {heard} times");
    }
}

/// A board that has started anew while its drives were on finds them so, and tells them to stop. One that finds them
/// calibrate themselves leaves them alone.
#[test]
fn drives_that_are_found_on_are_told_to_stop() {
    for (state, told) in [(CLOSED_LOOP, idle()), (3, ask(0x03))] {
        let bus = Mailboxes::default();
        let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
        hear(&bus, state, [0.0; 3]);
        drives.measure();
        drives.apply(&standing(Power::Off)).unwrap();
        assert_eq!(bus.carry(), told);
    }
}

#[test]
fn errors_are_cleared_in_one_tick_and_only_where_that_is_said() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
    hear(&bus, IDLE, [0, 1, 2].map(at_start));
    bus.say(&[heartbeat(2, 0x2000, IDLE)]);
    let readings = drives.measure();
    assert_eq!(
        (readings[1].state, readings[1].error),
        (DriveState::Fault, 0x2000)
    );
    drives.apply(&standing(Power::Clear)).unwrap();
    assert_eq!(bus.carry(), ["038#", "058#", "078#"]);
    for power in [
        Power::Off,
        Power::Check,
        Power::On,
        Power::On,
        Power::On,
        Power::Off,
    ] {
        hear(&bus, IDLE, [0, 1, 2].map(at_start));
        let readings = drives.measure();
        assert_eq!((readings[1].state, readings[1].error), (DriveState::Off, 0));
        drives.apply(&standing(power)).unwrap();
        assert!(
            bus.carry()
                .iter()
                .all(|text| text[1..3] != *"38" && text[1..3] != *"58")
        );
    }
    // A drive that has yet to go off is told to clear its errors after that.
    drives.apply(&standing(Power::On)).unwrap();
    bus.carry();
    drives.apply(&standing(Power::Clear)).unwrap();
    assert_eq!(bus.carry(), idle());
    let mut cleared = 0;
    for _ in 0..10 {
        hear(&bus, IDLE, [0, 1, 2].map(at_start));
        drives.measure();
        drives.apply(&standing(Power::Off)).unwrap();
        cleared += bus
            .carry()
            .iter()
            .filter(|text| text.ends_with("8#"))
            .count();
    }
    assert_eq!(cleared, 3);
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
/// unwrapped, N w / 2 pi and tau / N. What they say comes back as the joints.
fn rotors<N: Countable>(units: [f64; 2], tolerance: f64) {
    let bus = Mailboxes::default();
    let mut drives = drives::<N>(&bus, units, Absolute::Joint);
    // The third joint stands a turn beyond what its angle tells.
    let beyond = [0.0, 0.0, TAU];
    let rotor = |index: usize, turned: f64| {
        let joint = wrapped(START[index] - ZERO) + beyond[index] + turned;
        SIGNS[index] * GEAR * joint / TAU
    };
    hear(&bus, IDLE, [0, 1, 2].map(|index| rotor(index, 0.0)));
    drives.measure();
    drives.apply(&standing(Power::Check)).unwrap();
    bus.carry();
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
        if tick < 3 {
            continue;
        }
        for (index, text) in carried.iter().enumerate() {
            let sign = SIGNS[index];
            let [position, velocity, torque_found] = fields(text);
            assert!(
                (position - rotor(index, turned)).abs() < tolerance,
                "{tick} {index}"
            );
            assert!((velocity - sign * GEAR * rate / TAU).abs() < 0.5e-3 + 1e-5);
            assert!((torque_found - sign * torque / GEAR).abs() < 0.5e-3 + 1e-5);
            bus.say(&[estimate(index + 1, position, velocity)]);
        }
        let readings = drives.measure();
        for (index, reading) in readings.iter().enumerate() {
            let off = wrapped(N::angle_to_f64(reading.angle) - START[index] - turned);
            assert!(off.abs() < 2.0 * tolerance, "{tick} {index}: {off:e}");
            assert!((reading.rate.to_f64() * units[0] - rate).abs() < 1e-3);
        }
    }
    assert!(farthest > 3.0 * TAU, "{farthest}");
}

#[test]
fn rotors_are_told_turns_and_their_own_torque() {
    // Up to 40 turns in binary32, and its angles.
    rotors::<f32>([1.0, 1.0], 1e-5);
    rotors::<f64>([1.0, 1.0], 1e-5);
    // In units of its own.
    rotors::<Fixed>([16.0, 2.0], 1e-5);
}

/// Commanded by no more than half a turn of the joint away, but away: no frame moves a drive.
#[test]
fn a_drive_does_not_go_on_elsewhere() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
    hear(&bus, IDLE, [0, 1, 2].map(at_start));
    drives.measure();
    let mut wanted = START.map(|angle| [angle, 0.0, 0.0]);
    wanted[1][0] += 0.03;
    let failure = drives.apply(&output(wanted, true)).unwrap_err();
    assert_eq!((failure.what, failure.drive), (DriveFault::NotOn, Some(1)));
    assert!(bus.carry().is_empty());
    wanted[1][0] -= 0.01;
    drives.apply(&output(wanted, true)).unwrap();
    assert_eq!(bus.carry().len(), 3);
    // On, it follows as far as it is told.
    wanted[1][0] += 0.5;
    drives.apply(&output(wanted, true)).unwrap();
}

/// However the drive has counted: the first command is where the joint is.
#[test]
fn the_first_command_is_the_measured_position() {
    for (absolute, drive) in [
        (Absolute::Joint, [0.1, -0.2, 0.3]),
        // Up to half a turn of the rotor off the start, and whole turns off its zero.
        (Absolute::Rotor, [17.4, -3.3, 5.0].map(|turns: f64| turns)),
        (Absolute::Nothing, [123.456, -0.789, 0.0]),
    ] {
        let bus = Mailboxes::default();
        let mut drives = drives::<f32>(&bus, [1.0, 1.0], absolute);
        hear(&bus, IDLE, drive);
        let readings = drives.measure();
        drives.apply(&standing(Power::Check)).unwrap();
        for (index, reading) in readings.iter().enumerate() {
            let joint = wrapped(f64::from(reading.angle) - ZERO);
            let turns = SIGNS[index] * GEAR * joint / TAU;
            match absolute {
                Absolute::Joint => assert!((turns - drive[index]).abs() < 1e-5),
                Absolute::Rotor => {
                    let off = turns - drive[index];
                    assert!((off - off.round()).abs() < 1e-5, "{index}: {off}");
                    let from_start = wrapped(f64::from(reading.angle) - START[index]);
                    assert!(from_start.abs() <= 0.5 * TAU / GEAR + 1e-6, "{from_start}");
                }
                Absolute::Nothing => {
                    // The last bit of 123 turns of the rotor, at the joint.
                    assert!(wrapped(f64::from(reading.angle) - START[index]).abs() < 1e-5);
                }
            }
        }
        let motors = readings.map(|reading| [f64::from(reading.angle), 0.0, 0.0]);
        bus.carry();
        for _ in 0..4 {
            drives.apply(&output(motors, true)).unwrap();
            let carried = bus.carry();
            if carried[0].starts_with("02c") {
                for (text, drive) in carried.iter().zip(drive) {
                    let step = fields(text)[0] - drive;
                    // The last bit of a position of 123 turns is 7.6e-6.
                    assert!(step.abs() < 1.6e-5, "{text}: {step:e}");
                }
            }
        }
    }
}

/// A homing tells where the joints are: the angles change, what the drives are told does not.
#[test]
fn a_homing_shifts_the_angles_and_moves_nothing() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Nothing);
    hear(&bus, IDLE, [1.25, -7.5, 0.0]);
    drives.measure();
    let start = START.map(|angle| [angle, 0.0, 0.0]);
    let command = |drives: &mut CanDrives<f32, Odrive, Mailboxes>, motors| {
        drives.apply(&output(motors, true)).unwrap();
        bus.carry()
    };
    for _ in 0..3 {
        command(&mut drives, start);
    }
    let before = command(&mut drives, start)
        .iter()
        .map(|text| fields(text)[0])
        .collect::<Vec<_>>();
    let by = [0.5, -1.25, 3.0];
    drives.shift(by.map(|by| by as f32));
    let mut shifted = start;
    for (motor, by) in shifted.iter_mut().zip(by) {
        motor[0] = wrapped(motor[0] + by);
    }
    let after = command(&mut drives, shifted)
        .iter()
        .map(|text| fields(text)[0])
        .collect::<Vec<_>>();
    for (before, after) in before.iter().zip(&after) {
        assert!((before - after).abs() < 5e-6, "{before} {after}");
    }
    hear(&bus, CLOSED_LOOP, [before[0], before[1], before[2]]);
    for (reading, shifted) in drives.measure().iter().zip(shifted) {
        assert!(wrapped(f64::from(reading.angle) - shifted[0]).abs() < 5e-6);
    }
}

/// Drives by their kinds: turns that one has lost at once, or behind a gap, and those that the board is off afterwards.
#[test]
fn positions_that_jump_or_were_missing_are_a_restart() {
    use Absolute::{Joint, Nothing, Rotor};
    // (kind, ticks without a position, turns lost, restarts, turns that the board is off)
    let cases = [
        (Rotor, 0, 1.0, 1, 0.0),
        (Rotor, 0, -3.0, 1, 0.0),
        (Rotor, 0, 0.6, 1, -0.4),
        (Rotor, 0, 0.4, 0, 0.4),
        (Rotor, 9, 0.0, 0, 0.0),
        (Rotor, 10, 0.0, 1, 0.0),
        (Rotor, 10, 2.0, 1, 0.0),
        (Rotor, 5000, -1.0, 1, 0.0),
        // More ticks than an age counts.
        (Rotor, 70_000, 1.0, 1, 0.0),
        (Nothing, 0, 7.3, 1, 0.0),
        (Nothing, 500, 0.3, 1, 0.0),
        // It knows the joint, and says so anew.
        (Joint, 500, 0.0, 0, 0.0),
        (Joint, 0, 1.0, 1, 1.0),
        (Joint, 500, -1.0, 1, -1.0),
    ];
    for (absolute, gap, lost, restarts, off) in cases {
        for sign in [1.0, -1.0] {
            let bus = Mailboxes::default();
            let mut drives = drives::<f32>(&bus, [1.0, 1.0], absolute);
            let mut place = [0, 1, 2].map(at_start);
            hear(&bus, IDLE, place);
            let [_, before, _] = drives.measure();
            for _ in 0..gap {
                drives.measure();
            }
            place[1] += sign * lost;
            hear(&bus, IDLE, place);
            let [first, now, _] = drives.measure();
            let case = format!("{absolute:?} {gap} {lost}");
            // The gap is one of all drives.
            let of_first = u8::from(gap > 9 && absolute != Joint);
            assert_eq!(
                (first.restarts, now.restarts),
                (of_first, restarts),
                "{case}"
            );
            let moved = wrapped(f64::from(now.angle) - f64::from(before.angle));
            let wanted = sign * off * SIGNS[1] * TAU / GEAR;
            assert!((moved - wanted).abs() < 1e-5, "{case}: {moved}");
            // It stands, and goes on from there.
            hear(&bus, IDLE, place);
            drives.measure();
            place[1] += 0.1;
            hear(&bus, IDLE, place);
            let [_, later, _] = drives.measure();
            let moved = wrapped(f64::from(later.angle) - f64::from(now.angle));
            assert!((moved - 0.1 * SIGNS[1] * TAU / GEAR).abs() < 1e-5, "{case}");
            assert_eq!(later.restarts, restarts, "{case}");
        }
    }
}

/// Up to several turns of the rotor from one message to the next, slowly up and down again: no restart. One turn more is one.
#[test]
fn a_rotor_that_turns_fast_has_not_restarted() {
    for every in [1, 7] {
        let bus = Mailboxes::default();
        let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Rotor);
        let mut place = [0, 1, 2].map(at_start);
        hear(&bus, IDLE, place);
        drives.measure();
        for message in 0..60 {
            let pace = 0.15 * f64::from(30 - i32::abs(30 - message));
            place = place.map(|turns| turns + pace);
            for _ in 1..every {
                drives.measure();
            }
            hear(&bus, IDLE, place);
            let [.., reading] = drives.measure();
            assert_eq!(reading.restarts, 0, "{message}");
        }
        place[2] -= 1.0;
        hear(&bus, IDLE, place);
        assert_eq!(drives.measure().map(|each| each.restarts), [0, 0, 1]);
    }
}

fn reading(drives: &mut CanDrives<f32, Odrive, Mailboxes>) -> DriveReading<f32> {
    let [first, ..] = drives.measure();
    first
}

#[test]
fn a_reading_tells_the_ages_of_angle_and_state() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
    bus.say(&[heartbeat(1, 0, IDLE)]);
    assert_eq!(reading(&mut drives).state, DriveState::Silent);
    bus.say(&[estimate(1, 0.5, 0.25)]);
    let first = reading(&mut drives);
    assert_eq!(
        (first.state, first.age, first.state_age),
        (DriveState::Off, 0, 1)
    );
    assert!((first.rate - (0.25 * TAU / GEAR) as f32).abs() < 1e-6);
    for age in 2..300 {
        // Estimates alone, heartbeats of a stranger: no life of the drive.
        bus.say(&[estimate(1, 0.5, 0.25), heartbeat(9, 0, IDLE)]);
        let now = reading(&mut drives);
        assert_eq!((now.age, now.state_age), (0, age));
    }
    bus.say(&[heartbeat(1, 0, CLOSED_LOOP), estimate(1, 0.5, 0.25)]);
    let now = reading(&mut drives);
    assert_eq!((now.state, now.age, now.state_age), (DriveState::On, 0, 0));
    // Health: 24.5 V, 40.5 degrees, and 2 N m at the rotor.
    bus.say(
        &[
            "037#0000c44100000000",
            "035#0000224200000000",
            "03c#0000000000000040",
        ]
        .map(String::from),
    );
    let now = reading(&mut drives);
    assert_eq!(
        (now.supply_mv, now.temperature_c, now.torque),
        (24_500, 40, 16.0)
    );
}

#[test]
fn a_current_tells_the_torque_where_the_motor_is_known() {
    for (constant, torque) in [(0.0, 0.0), (0.25, -4.0)] {
        let bus = Mailboxes::default();
        let scale = RotorScale::new(GEAR, false, 0.0, 1.0, 1.0).torque_constant(constant);
        let angles = [0.0; 3];
        let mut drives: CanDrives<f32, Odrive, Mailboxes> =
            CanDrives::new(Odrive, bus.clone(), [1, 2, 3], [scale; 3], angles, 9);
        // -2 A.
        bus.say(&["034#00000000000000c0".into()]);
        assert_eq!(drives.measure()[0].torque, torque);
    }
}

#[test]
fn a_bus_that_fails_is_a_fault_with_its_name() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
    hear(&bus, IDLE, [0, 1, 2].map(at_start));
    drives.measure();
    for _ in 0..5 {
        drives.apply(&standing(Power::On)).unwrap();
        bus.carry();
    }
    drives.apply(&standing(Power::On)).unwrap();
    // Nobody acknowledged.
    let failure = drives.apply(&standing(Power::On)).unwrap_err();
    assert_eq!(
        (failure.what, failure.drive),
        (DriveFault::BusBusy, Some(0))
    );
    bus.carry();
    bus.0.borrow_mut().off = true;
    let failure = drives.apply(&standing(Power::On)).unwrap_err();
    assert_eq!(failure.what, DriveFault::BusOff);
    // Off is off, whatever the bus does.
    drives.apply(&standing(Power::Off)).unwrap();
}

#[test]
fn a_command_beyond_its_field_is_a_fault() {
    let bus = Mailboxes::default();
    let mut drives = drives::<f32>(&bus, [1.0, 1.0], Absolute::Joint);
    hear(&bus, IDLE, [0, 1, 2].map(at_start));
    drives.measure();
    for _ in 0..4 {
        drives.apply(&standing(Power::On)).unwrap();
        bus.carry();
    }
    // 8 * 26 / 2 pi is 33.1 turns per second.
    let mut wanted = START.map(|angle| [angle, 0.0, 0.0]);
    wanted[2][1] = 26.0;
    let failure = drives.apply(&output(wanted, true)).unwrap_err();
    assert_eq!((failure.what, failure.drive), (DriveFault::Range, Some(2)));
}
