//! The line over USB: a host that enumerates the board, resets and suspends its bus, does not read, and sends without a break.

use super::{OSCILLATOR_HZ, Row, Subject, fact, off_within, slots, time};
use crate::chip::SYS_TICK;
use crate::cpu::Board;
use crate::host::{Host, HostLine, LOOK};
use crate::time::{MICROSECOND, MS, SECOND, Time, of_seconds, period, seconds};
use crate::trace::Level;
use crate::usb::{PACKET, UsbHost};
use crate::wiring::{DIRECTIONS, STEPS};
use anyhow::{Context, Result, ensure};
use trirrr_bench::faulty_link::Random;
use trirrr_protocol::message::{Command, Message, Reply, Request};

/// From the pull-up of D+ to the open port: 142 ms of it are waits of the host.
const ENUMERATED_WITHIN: Time = 150 * MS;

/// Time for a host that is back, with its enumeration.
const BACK: Time = 200 * MS;

/// Requests of a transfer, and how many are under way at most.
const REQUESTS: u32 = 3000;
const UNDER_WAY: u32 = 4;

/// Bytes of the stack that have to be left.
const STACK_LEFT: usize = 4096;

/// Resets of the bus at random times.
const RESETS: u32 = 30;
const SEED: u64 = 1;

/// Full packets in a frame (USB 2.0, 5.8.4).
const MOST_PACKETS: u32 = 19;

fn plug(board: &mut Board) -> Result<&mut UsbHost> {
    board.chip().plug.as_mut().context("a host at the plug")
}

/// Row of the errors that the host has seen, and the model of the controller.
fn errors(board: &mut Board, case: &'static str) -> Result<Row> {
    let mut errors = plug(board)?.errors.clone();
    errors.extend(board.chip().unknown.iter().cloned());
    let errors = match errors.is_empty() {
        true => "none".into(),
        false => errors.join("; "),
    };
    let what = "errors at the host, and registers used wrongly";
    Ok(fact(case, what, errors, "none"))
}

/// Row of the room that the stack has left at its deepest: no walk over the code finds the depth of an image with USB.
fn stack(board: &Board, case: &'static str) -> Result<Row> {
    let left = board.painted_stack()?;
    Ok(Row {
        case,
        subject: "stack: bytes left at its deepest".into(),
        measured: left.to_string(),
        bound: format!("≥ {STACK_LEFT}"),
        holds: left >= STACK_LEFT,
    })
}

/// Row of a host that says hello.
fn answers(subject: &Subject, board: &mut Board, case: &'static str, when: &str) -> Result<Row> {
    let mut host = subject.host(board)?;
    let now = board.now();
    host.run(board, now + 30 * MS)?;
    let answers = host.client().identity().is_some().to_string();
    Ok(fact(
        case,
        &format!("{when}: the board answers"),
        answers,
        "true",
    ))
}

/// A host takes the board for what it is, in time.
pub(super) fn enumeration(subject: &Subject) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    // The start masks all interrupts, and ends before the first tick.
    let ticks = |board: &Board| {
        let mut handled = board.handled.iter();
        handled.any(|handled| handled.exception == SYS_TICK)
    };
    while !ticks(&board) {
        let now = board.now();
        ensure!(now < SECOND, "no tick within a second");
        board.run(now + MS)?;
    }
    let started = board.now();
    board.watch_masks();
    subject.host(&mut board)?;
    let mut rows = Vec::new();
    let host = plug(&mut board)?;
    let found = &host.found;
    let took = host.attached.zip(host.opened).map(|(from, to)| to - from);
    rows.push(Row {
        case: "enumeration",
        subject: "from the pull-up of D+ to an open port".into(),
        measured: took.map_or("never".into(), time),
        bound: format!("≤ {}", time(ENUMERATED_WITHIN)),
        holds: took.is_some_and(|took| took <= ENUMERATED_WITHIN),
    });
    let identity = format!("{:04x}:{:04x}", found.vendor, found.product);
    let texts = found.texts.get(..2).unwrap_or_default().join(", ");
    let digits = found.texts.get(2).map_or(0, String::len).to_string();
    for (what, measured, bound) in [
        ("vendor and product", identity, "1209:0001"),
        ("their texts", texts, "trirrr, trirrr"),
        ("digits of the serial number", digits, "24"),
    ] {
        rows.push(fact("enumeration", what, measured, bound));
    }
    rows.push(errors(&mut board, "enumeration")?);
    rows.push(slots::masked(subject, &board, "enumeration", "in all that"));
    rows.push(slots::late(
        subject,
        &mut board,
        "enumeration",
        "in all that",
        started,
    )?);
    Ok(rows)
}

/// Pulses of a motor, and where they lead.
fn travel(board: &Board, motor: usize) -> (usize, i32) {
    let directions = board.trace().edges(DIRECTIONS[motor]);
    let steps = board.trace().edges(STEPS[motor]).iter();
    let rises = steps.filter(|edge| edge.level == Level::High);
    rises.fold((0, 0), |(pulses, place), step| {
        let before = directions.partition_point(|turn| turn.time <= step.time);
        let turned = before.checked_sub(1).and_then(|last| directions.get(last));
        let forward = turned.is_some_and(|turn| turn.level == Level::High);
        (pulses + 1, place + if forward { 1 } else { -1 })
    })
}

/// A host resets the bus in mid-move and enumerates the board anew: the job goes on.
pub(super) fn bus_reset(subject: &Subject) -> Result<Vec<Row>> {
    let (mut quiet, mut host) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    host.play(&mut quiet, subject.longest())?;
    let (mut board, mut host) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    let since = board.now();
    board.watch_masks();
    plug(&mut board)?.reset(since);
    host.play(&mut board, subject.longest())?;
    let mut rows = Vec::new();
    for motor in 0..3 {
        let [(pulses, place), (expected, end)] = [&board, &quiet].map(|board| travel(board, motor));
        rows.push(fact(
            "bus-reset",
            &format!("motor {}: pulses, and place at the end", motor + 1),
            format!("{pulses}, {place}"),
            &format!("{expected}, {end}"),
        ));
    }
    let enumerations = plug(&mut board)?.enumerations.to_string();
    rows.push(fact("bus-reset", "enumerations", enumerations, "2"));
    rows.push(fact(
        "bus-reset",
        "resets of the chip",
        (board.resets.len() - 1).to_string(),
        "0",
    ));
    rows.push(errors(&mut board, "bus-reset")?);
    rows.push(resets_anywhere(subject, &mut board)?);
    rows.push(stack(&board, "bus-reset")?);
    rows.push(slots::masked(
        subject,
        &board,
        "bus-reset",
        "from the reset on",
    ));
    rows.push(slots::late(
        subject,
        &mut board,
        "bus-reset",
        "from the reset on",
        since,
    )?);
    Ok(rows)
}

/// Row of resets of the bus at any time, in enumerations and between packets: the board is there after the last one.
fn resets_anywhere(subject: &Subject, board: &mut Board) -> Result<Row> {
    let hello = trirrr_client::local::hello::<f32>(&subject.scene);
    let mut line = HostLine::default();
    let mut random = Random::new(SEED);
    for sequence in 0..RESETS {
        for _ in 0..UNDER_WAY {
            let command = Command::Hello(hello);
            line.say(board, &Request::<f32> { sequence, command });
        }
        let lasts = random.below(BACK / MICROSECOND) * MICROSECOND;
        let now = board.now();
        board.run(now + lasts)?;
        line.hear(board);
        let now = board.now();
        plug(board)?.reset(now);
    }
    let when = format!("{RESETS} resets of the bus at any time");
    answers(subject, board, "bus-reset", &when)
}

/// Runs the board without a word of its host, which has stopped in mid-move: the machine comes to rest as without a cable.
fn silent(
    subject: &Subject,
    board: &mut Board,
    host: &mut Host,
    case: &'static str,
    what: &str,
) -> Result<Vec<Row>> {
    let service = &subject.scene.service;
    let tick = period(1_000_000) * (1e6 / subject.scene.tick_rate_hz) as Time;
    let bound = of_seconds(service.silence_timeout_s + service.hold_ramp_s) + 3 * tick;
    let since = board.now();
    host.run(board, since + bound + BACK)?;
    let outputs = subject.outputs();
    let moving: Vec<_> = outputs
        .into_iter()
        .filter(|output| output.name != "drives" && output.name != "tool enable")
        .collect();
    let mut rows = vec![off_within(board, &moving, case, what, since, bound)];
    let resets = (board.resets.len() - 1).to_string();
    rows.push(fact(
        case,
        &format!("{what}: resets of the chip"),
        resets,
        "0",
    ));
    Ok(rows)
}

/// A host goes to sleep in mid-move, and wakes up.
pub(super) fn suspend(subject: &Subject) -> Result<Vec<Row>> {
    let (mut board, mut host) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    host.stop(&mut board);
    plug(&mut board)?.suspend();
    let what = "bus at rest in mid-move";
    let mut rows = silent(subject, &mut board, &mut host, "suspend", what)?;
    let now = board.now();
    let host = plug(&mut board)?;
    host.carry(true);
    host.resume(now);
    rows.push(answers(subject, &mut board, "suspend", "once it goes on")?);
    let enumerations = plug(&mut board)?.enumerations.to_string();
    rows.push(fact("suspend", "enumerations", enumerations, "1"));
    rows.push(errors(&mut board, "suspend")?);
    Ok(rows)
}

/// A program stops in mid-move, with the port open: it takes no bytes.
pub(super) fn reader(subject: &Subject) -> Result<Vec<Row>> {
    let (mut board, mut host) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    host.stop(&mut board);
    let what = "no reader in mid-move";
    let mut rows = silent(subject, &mut board, &mut host, "reader", what)?;
    plug(&mut board)?.carry(true);
    rows.push(answers(subject, &mut board, "reader", "once it reads")?);
    for is_open in [false, true] {
        plug(&mut board)?.open(is_open);
        let now = board.now();
        board.run(now + 10 * MS)?;
    }
    let when = "closed and opened again";
    rows.push(answers(subject, &mut board, "reader", when)?);
    rows.push(errors(&mut board, "reader")?);
    Ok(rows)
}

/// The cable is in again: the board is enumerated anew and talks.
pub(super) fn plugged_in(subject: &Subject, board: &mut Board) -> Result<Vec<Row>> {
    plug(board)?.plug(true);
    let when = "plugged in again";
    let mut rows = vec![answers(subject, board, "cable", when)?];
    let resets = (board.resets.len() - 1).to_string();
    rows.push(fact(
        "cable",
        &format!("{when}: resets of the chip"),
        resets,
        "0",
    ));
    rows.push(errors(board, "cable")?);
    Ok(rows)
}

/// Requests without a break, each of which is answered once.
pub(super) fn transfer(subject: &Subject) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    subject.host(&mut board)?;
    let mut line = HostLine::default();
    line.drop_all(&mut board);
    let since = board.now();
    board.watch_masks();
    let hello = trirrr_client::local::hello::<f32>(&subject.scene);
    let (mut sent, mut answered, mut bytes) = (0, 0, 0);
    while answered < REQUESTS {
        let now = board.now();
        ensure!(
            now < since + 60 * SECOND,
            "{answered} of {REQUESTS} requests are answered within a minute"
        );
        while sent < REQUESTS && sent < answered + UNDER_WAY {
            let request: Request<f32> = Request {
                sequence: sent,
                command: Command::Hello(hello),
            };
            line.say(&mut board, &request);
            sent += 1;
        }
        board.run(now + LOOK)?;
        for message in line.hear(&mut board) {
            if let Message::Reply { sequence, reply } = message {
                ensure!(
                    sequence == answered && matches!(reply, Reply::Hello(_)),
                    "reply {sequence} after {answered}"
                );
                answered += 1;
            }
        }
    }
    let took = board.now() - since;
    let host = plug(&mut board)?;
    bytes += host.count();
    let rate = bytes as f64 / seconds(took) / 1000.0;
    let most = host.most_packets;
    let mut rows = vec![
        fact(
            "transfer",
            &format!(
                "requests that are answered, in order, once: {rate:.0} kB/s in both directions"
            ),
            answered.to_string(),
            &REQUESTS.to_string(),
        ),
        Row {
            case: "transfer",
            subject: format!("packets of up to {PACKET} bytes in a frame, at most"),
            measured: most.to_string(),
            bound: format!("2 to {MOST_PACKETS}"),
            holds: (2..=MOST_PACKETS).contains(&most),
        },
    ];
    rows.push(errors(&mut board, "transfer")?);
    rows.push(slots::masked(subject, &board, "transfer", "meanwhile"));
    rows.push(slots::late(
        subject,
        &mut board,
        "transfer",
        "meanwhile",
        since,
    )?);
    Ok(rows)
}
