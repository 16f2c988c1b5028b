//! Drives on the CAN bus: the job in frames, and failures of the wire and of drives in the middle of a move.

use super::job::FIRST_TICK;
use super::{OSCILLATOR_HZ, Row, Subject, fact, time};
use crate::bus::{CanBus, DriveFailure, WireFrame};
use crate::chip::{Crystal, Kind, SYS_TICK};
use crate::cpu::Board;
use crate::host::Host;
use crate::time::{MS, SECOND, Time, of_seconds};
use anyhow::{Context, Result, bail, ensure};
use embedded_can::{Frame, Id};
use std::f64::consts::TAU;
use trirrr_protocol::message::State;
use trirrr_scene::{CanProtocol, Scene};

/// Command of CANSimple with a position, and bits of it in an identifier.
const SET_POSITION: u16 = 0x0C;
const COMMAND_BITS: u16 = 5;

/// Command of moteus with a position: the mode, and floats from the register of positions on.
const MOVE: [u8; 5] = [0x01, 0x00, 0x0A, 0x0F, 0x20];

/// Largest error of a position in a frame, rad at the joint: a float of some turns.
const FRAME_ERROR_RAD: f64 = 1e-4;

/// Torque of a drive that is off, N m.
pub(super) const NO_TORQUE: f64 = 1e-9;

/// Time between looks at the machine.
pub(super) const LOOK: Time = MS / 4;

pub(super) fn bus(board: &mut Board) -> Result<&mut (dyn CanBus + 'static)> {
    board.chip().bus.as_deref_mut().context("a bus")
}

fn tick(subject: &Subject) -> Time {
    of_seconds(1.0 / subject.scene.tick_rate_hz)
}

/// Plays the job: frames against angles, the machine against both, load of the bus.
pub(super) fn job(subject: &Subject) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    let mut host = subject.host(&mut board)?;
    let end = board.now() + subject.longest();
    let mut path: Vec<(Time, [f64; 3])> = Vec::new();
    while host.ended.is_none() && board.now() < end {
        let now = board.now();
        host.run(&mut board, now + LOOK)?;
        path.push((board.now(), bus(&mut board)?.angles()));
    }
    let told = match &host.ended {
        Some(Ok(())) => "played".into(),
        Some(Err(why)) => why.clone(),
        None => "no end".into(),
    };
    let mut rows = vec![fact("can", "the job", told, "played")];
    if let Some(broken) = bus(&mut board)?.broken() {
        rows.push(fact("can", "the machine", broken.to_owned(), "moves"));
    }
    let tells_positions = of_protocol(&subject.scene, |protocol| {
        matches!(protocol, CanProtocol::Odrive | CanProtocol::Moteus)
    });
    if tells_positions {
        rows.extend(frames(subject, &mut board, &host)?);
    }
    rows.extend(following(subject, &board, &host, &path)?);
    let load = bus(&mut board)?.load();
    rows.push(Row {
        case: "can",
        subject: "load of the bus".into(),
        measured: format!("{:.1} %", load * 100.0),
        bound: "≤ 100 %".into(),
        holds: load > 0.1 && load <= 1.0,
    });
    Ok(rows)
}

/// Rows of a board whose crystal is missing or another one: its bits would be too long or too short, so it sends none.
pub(super) fn without_crystal(subject: &Subject) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    let boots = [
        ("crystal missing", Crystal::Missing),
        ("crystal of 12 MHz", Crystal::Runs { mhz: 12 }),
    ];
    // Only the STM32F405 measures its crystal. With another one the line of an STM32G474 has another rate, too: nobody is told.
    let count = match subject.kind {
        Kind::Stm32f405 => boots.len(),
        Kind::Stm32g474 => 1,
    };
    for (what, crystal) in boots.into_iter().take(count) {
        let mut board = subject.switch_on_with(&subject.image, crystal, OSCILLATOR_HZ[0])?;
        let mut host = subject.host(&mut board)?;
        let now = board.now();
        host.run(&mut board, now + 3 * SECOND)?;
        let sent = bus(&mut board)?.sent().len();
        rows.push(fact(
            "bus-clock",
            &format!("{what}: frames on the bus"),
            sent.to_string(),
            "0",
        ));
        let told = match &host.ended {
            Some(Err(told)) => told.clone(),
            Some(Ok(())) => "the job was played".into(),
            None => "nothing".into(),
        };
        rows.push(Row {
            case: "bus-clock",
            subject: format!("{what}: the client is told"),
            holds: told.contains("drive 1"),
            measured: told,
            bound: "drive 1".into(),
        });
    }
    Ok(rows)
}

fn of_protocol(scene: &Scene, is: impl Fn(CanProtocol) -> bool) -> bool {
    let drives = scene.drives.iter().flatten();
    let cans = drives.filter_map(trirrr_scene::Drive::can);
    cans.map(|can| can.protocol).all(is)
}

/// Returns the position of a frame that commands drive `node`, turns of its rotor.
fn position(frame: &WireFrame, node: u32) -> Option<f64> {
    let id = match frame.id() {
        Id::Standard(id) => id,
        // moteus: from source 0, to be answered; five bytes, then three floats.
        Id::Extended(id) => {
            let moves = id.as_raw() == 0x8000 | node && frame.data().starts_with(&MOVE);
            let bytes = frame.data().get(MOVE.len()..)?.first_chunk::<4>()?;
            return moves.then(|| f32::from_le_bytes(*bytes).into());
        }
    };
    let of = u32::from(id.as_raw() >> COMMAND_BITS) == node;
    let commands = id.as_raw() & ((1 << COMMAND_BITS) - 1) == SET_POSITION;
    let bytes = frame.data().first_chunk::<4>()?;
    (of && commands).then(|| f32::from_le_bytes(*bytes).into())
}

/// Rows of the command frames of each drive against the angles of telemetry.
fn frames(subject: &Subject, board: &mut Board, host: &Host) -> Result<Vec<Row>> {
    let handlers: Vec<Time> = board
        .handled
        .iter()
        .filter(|handled| handled.exception == SYS_TICK)
        .map(|handled| handled.begin)
        .collect();
    let period = tick(subject);
    let drives = subject.scene.drives.as_ref().context("drives")?;
    let sent = bus(board)?.sent();
    let mut rows = Vec::new();
    for (leg, drive) in drives.iter().enumerate() {
        let node = drive.can().context("a drive on the bus")?.node_id;
        let gear = if drive.reversed {
            -drive.gear_ratio
        } else {
            drive.gear_ratio
        };
        let of_drive: Vec<(Time, f64)> = sent
            .iter()
            .filter_map(|(time, frame)| Some((*time, position(frame, node)?)))
            .collect();
        let mut zero = None;
        let (mut most, mut compared, mut alone) = (0.0_f64, 0_u32, true);
        for sample in &host.samples {
            let index = sample.tick.wrapping_sub(FIRST_TICK) as usize;
            let Some(begin) = handlers.get(index).copied() else {
                continue;
            };
            let from = of_drive.partition_point(|(time, _)| *time < begin);
            let to = of_drive.partition_point(|(time, _)| *time < begin + period);
            let [(_, turns)] = of_drive[from..to] else {
                alone &= to == from;
                continue;
            };
            // A drive has its own zero: the first frame of the job tells it.
            let angle = turns / gear * TAU - f64::from(sample.angles[leg]);
            let zero = *zero.get_or_insert(angle);
            let off = angle - zero;
            most = most.max((off - TAU * (off / TAU).round()).abs());
            compared += 1;
        }
        rows.push(Row {
            case: "can",
            subject: format!(
                "drive {}: off the commanded angle in {compared} frames by at most",
                leg + 1
            ),
            measured: format!("{:.1} µrad", most * 1e6),
            bound: format!("≤ {:.0} µrad", FRAME_ERROR_RAD * 1e6),
            holds: compared > 200 && most <= FRAME_ERROR_RAD,
        });
        rows.push(fact(
            "can",
            &format!("drive {}: at most one command in a tick", leg + 1),
            alone.to_string(),
            "true",
        ));
    }
    Ok(rows)
}

/// Row of the machine's joints against the angles of telemetry, in the middle of their ticks.
pub(super) fn following(
    subject: &Subject,
    board: &Board,
    host: &Host,
    path: &[(Time, [f64; 3])],
) -> Result<Vec<Row>> {
    let handlers: Vec<Time> = board
        .handled
        .iter()
        .filter(|handled| handled.exception == SYS_TICK)
        .map(|handled| handled.begin)
        .collect();
    let bound = subject
        .scene
        .feedback
        .unwrap_or_default()
        .following_moving_rad;
    let mut most = [0.0_f64; 3];
    let mut compared = 0;
    for sample in &host.samples {
        let index = sample.tick.wrapping_sub(FIRST_TICK) as usize;
        let Some(begin) = handlers.get(index) else {
            continue;
        };
        // The angles of a tick are those at its begin.
        let at = path.partition_point(|(time, _)| time < begin);
        let Some((_, angles)) = path.get(at) else {
            continue;
        };
        compared += 1;
        for (leg, most) in most.iter_mut().enumerate() {
            let off = angles[leg] - f64::from(sample.angles[leg]);
            *most = most.max((off - TAU * (off / TAU).round()).abs());
        }
    }
    ensure!(compared > 100, "{compared} samples of a job");
    let (_, last) = path.last().context("a path")?;
    let (_, first) = path.first().context("a path")?;
    let turned = last.iter().zip(first).map(|(last, first)| last - first);
    let case = if subject.has(super::Needs::Bus) {
        "can"
    } else {
        "amplifiers"
    };
    let moved = path.iter().map(|(_, angles)| (angles[0] - first[0]).abs());
    let moved = moved.chain(turned.map(f64::abs)).fold(0.0, f64::max);
    let most = most.into_iter().fold(0.0, f64::max);
    Ok(vec![Row {
        case,
        subject: format!("joints that turn by {moved:.2} rad: off their commands by at most"),
        measured: format!("{:.4} rad", most),
        bound: format!("≤ {bound} rad"),
        holds: most <= bound && moved > 0.05,
    }])
}

/// Returns a board in the middle of its job, with drives on that move, and its host.
fn in_mid_move(subject: &Subject) -> Result<(Board, Host)> {
    let mut board = subject.switch_on()?;
    let mut host = subject.host(&mut board)?;
    let start = bus(&mut board)?.angles();
    go_into_move(&mut board, &mut host, start)?;
    Ok((board, host))
}

/// Goes on until a joint is a tenth of a radian from where it is at the `start` of the job, and the job plays.
pub(super) fn go_into_move(board: &mut Board, host: &mut Host, start: [f64; 3]) -> Result<()> {
    let end = board.now() + 6 * SECOND;
    loop {
        let now = board.now();
        ensure!(now < end, "no joint has moved within 6 s");
        host.run(board, now + LOOK)?;
        if let Some(Err(told)) = &host.ended {
            bail!("{told}");
        }
        ensure!(host.ended.is_none(), "the job is over before its middle");
        let angles = bus(board)?.angles();
        let mut pairs = angles.iter().zip(start);
        let plays = host
            .client()
            .status()
            .is_some_and(|status| status.state == State::Running);
        if plays && pairs.any(|(now, start)| (now - start).abs() > 0.1) {
            return Ok(());
        }
    }
}

/// Goes on for `seconds` of time. Returns the time since `since` after which no drive had a torque any more.
fn torques_end(
    board: &mut Board,
    host: &mut Host,
    since: Time,
    until: Time,
) -> Result<Option<Time>> {
    let mut last = Some(since);
    while board.now() < until {
        let now = board.now();
        if host.ended.is_none() {
            host.run(board, now + LOOK)?;
        } else {
            board.run(now + LOOK)?;
        }
        let on = bus(board)?
            .torques()
            .into_iter()
            .any(|torque| torque.abs() > NO_TORQUE);
        match (on, last) {
            (true, _) => last = None,
            (false, None) => last = Some(board.now()),
            (false, Some(_)) => {}
        }
    }
    Ok(last.map(|last| last - since))
}

/// A failure in the middle of a move.
struct Failure {
    case: &'static str,
    what: &'static str,
    fail: fn(&mut (dyn CanBus + 'static)),
    /// Ticks after which no drive may have a torque, beyond the timeout of the drives' watchdogs.
    ticks: u32,
    /// The timeout counts: no order reaches a drive, or a drive has to be missed first.
    waits: bool,
    /// The controller of the board goes off the bus.
    goes_off: bool,
    /// Part of what the client is told.
    told: &'static str,
}

/// Rows of a failure: torques end in time, and the client is told.
fn failure(subject: &Subject, failure: &Failure) -> Result<Vec<Row>> {
    let (mut board, mut host) = in_mid_move(subject)?;
    let since = board.now();
    (failure.fail)(bus(&mut board)?);
    let waits = match failure.waits {
        true => of_seconds(subject.scene.feedback.unwrap_or_default().timeout_s),
        false => 0,
    };
    let bound = waits + Time::from(failure.ticks) * tick(subject);
    let off = torques_end(&mut board, &mut host, since, since + bound + 300 * MS)?;
    let told = match &host.ended {
        Some(Err(told)) => told.clone(),
        Some(Ok(())) => "the job was played".into(),
        None => "nothing".into(),
    };
    Ok(vec![
        Row {
            case: failure.case,
            subject: format!("{}: no torque after", failure.what),
            measured: off.map_or("on".into(), time),
            bound: format!("≤ {}", time(bound)),
            holds: off.is_some_and(|off| off > 0 && off <= bound),
        },
        Row {
            case: failure.case,
            subject: format!("{}: the client is told", failure.what),
            holds: told.contains(failure.told),
            measured: told,
            bound: failure.told.into(),
        },
        fact(
            failure.case,
            &format!("{}: the controller goes off the bus", failure.what),
            (board.chip().bus_offs() > 0).to_string(),
            &failure.goes_off.to_string(),
        ),
    ])
}

/// The wires touch, or are cut, in mid-move.
pub(super) fn wire(subject: &Subject) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for case in [
        Failure {
            case: "bus-off",
            what: "wires touch",
            fail: |bus| bus.faults().is_shorted = true,
            ticks: 3,
            waits: true,
            goes_off: true,
            told: "bus",
        },
        Failure {
            case: "bus-off",
            what: "wire cut",
            fail: |bus| bus.faults().is_cut = true,
            ticks: 3,
            waits: true,
            goes_off: false,
            told: "bus",
        },
    ] {
        rows.extend(failure(subject, &case)?);
    }
    rows.push(recovery(subject)?);
    Ok(rows)
}

/// Row of the time from wires that do not touch any more to the next frame that a drive acknowledges.
fn recovery(subject: &Subject) -> Result<Row> {
    let (mut board, _) = in_mid_move(subject)?;
    bus(&mut board)?.faults().is_shorted = true;
    let end = board.now() + 50 * MS;
    board.run(end)?;
    let since = board.now();
    let sent = bus(&mut board)?.sent().len();
    bus(&mut board)?.faults().is_shorted = false;
    board.run(since + 50 * MS)?;
    let bus = bus(&mut board)?;
    let back = bus.sent().get(sent).map(|(time, _)| *time - since);
    // 128 times 11 bits of silence, which frames of the drives may interrupt, and a tick.
    let bits = SECOND / Time::from(bus.bit_rate_hz());
    let bound = 128 * 11 * bits + 2 * tick(subject);
    Ok(Row {
        case: "bus-off",
        subject: "wires do not touch any more: a frame goes out after".into(),
        measured: back.map_or("none".into(), time),
        bound: format!("≤ {}", time(bound)),
        holds: back.is_some_and(|back| back <= bound),
    })
}

/// A drive fails in mid-move, or its plug is pulled.
pub(super) fn drive(subject: &Subject) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for case in [
        Failure {
            case: "drive",
            what: "drive 2 too hot",
            fail: |bus| bus.fail(1, DriveFailure::Hot),
            // A heartbeat comes 50 times per second.
            ticks: 14,
            waits: false,
            goes_off: false,
            told: "drive 2",
        },
        Failure {
            case: "drive",
            what: "drive 2 unplugged",
            fail: |bus| bus.fail(1, DriveFailure::Unplugged),
            ticks: 4,
            waits: true,
            goes_off: false,
            told: "drive 2",
        },
    ] {
        rows.extend(failure(subject, &case)?);
    }
    Ok(rows)
}
