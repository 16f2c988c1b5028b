//! Failures in the middle of a job: the time until every output is off, and what the board says afterwards.

use super::{OSCILLATOR_HZ, Row, Subject, fact, name, never_on, off_within, time, usb};
use crate::chip::ResetCause;
use crate::cpu::{Board, Hang};
use crate::time::{MS, SECOND, Time, of_seconds, period};
use crate::wiring;
use anyhow::{Context, Result};

/// Time after which a board has started again and stood for a while.
const AFTER: Time = 300 * MS;

/// Time from the failure of a program to its reset.
const FAILS_WITHIN: Time = MS / 10;

/// Resets in mid-move: pins float at once, and nothing is on afterwards.
pub(super) fn resets(subject: &Subject) -> Result<Vec<Row>> {
    let outputs = subject.outputs();
    let mut rows = Vec::new();
    for cause in [ResetCause::BrownOut, ResetCause::Pin] {
        let (mut board, _) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
        let since = board.now();
        board.reset(cause)?;
        board.run(since + AFTER)?;
        let what = format!("{} in mid-move", name(cause));
        rows.push(off_within(&board, &outputs, "resets", &what, since, 0));
        rows.push(never_on(
            &board,
            &outputs,
            "resets",
            format!("300 ms after {what}"),
            since,
        ));
    }
    Ok(rows)
}

/// Rows of a program that fails at `since`: off at once, and a start with the cause `expected`.
fn failed(
    subject: &Subject,
    board: &mut Board,
    case: &'static str,
    since: Time,
    bound: Time,
    expected: &str,
) -> Result<Vec<Row>> {
    board.run(since + bound + AFTER)?;
    let outputs = subject.outputs();
    let mut rows = vec![off_within(
        board,
        &outputs,
        case,
        "in mid-move",
        since,
        bound,
    )];
    rows.push(starts_with(subject, board, case, expected)?);
    Ok(rows)
}

/// Row of the start that a new host is told.
fn starts_with(
    subject: &Subject,
    board: &mut Board,
    case: &'static str,
    expected: &str,
) -> Result<Row> {
    let mut host = subject.host(board)?;
    let now = board.now();
    host.run(board, now + 30 * MS)?;
    let start = host
        .client()
        .identity()
        .map(|identity| identity.board.start);
    let start = start.map_or("none".into(), |start| format!("{start:?}"));
    let kind = start
        .split([' ', '('])
        .next()
        .unwrap_or_default()
        .to_owned();
    Ok(fact(case, "start in the identity", kind, expected))
}

/// A panic of the image that is made to fail.
pub(super) fn panic(subject: &Subject) -> Result<Vec<Row>> {
    let Some(image) = &subject.panicking else {
        return Ok(Vec::new());
    };
    let mut board = subject.switch_on_with(image, subject.kind.crystal(), OSCILLATOR_HZ[0])?;
    let mut host = subject.host(&mut board)?;
    // The host enables the machine, and the 50th tick panics.
    while board.resets.len() < 2 {
        let now = board.now();
        anyhow::ensure!(now < 1000 * MS, "no panic within a second");
        host.run(&mut board, now + MS)?;
    }
    let outputs = subject.outputs();
    let reset = board.resets.last().map_or(0, |(time, _)| *time);
    let failed_at = board
        .last_begin(crate::chip::SYS_TICK)
        .context("no tick before the panic")?;
    let was_on = outputs
        .iter()
        .any(|output| output.was_on(board.trace(), failed_at - 2 * MS));
    board.run(reset + AFTER)?;
    Ok(vec![
        fact(
            "panic",
            "drives on in the tick that panics",
            was_on.to_string(),
            "true",
        ),
        off_within(
            &board,
            &outputs,
            "panic",
            "from that tick",
            failed_at,
            FAILS_WITHIN,
        ),
        starts_with(subject, &mut board, "panic", "Panic")?,
    ])
}

/// A jump to where nothing is, in the flashed image.
pub(super) fn hard_fault(subject: &Subject) -> Result<Vec<Row>> {
    let (mut board, _) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    let since = board.now();
    board.jump(0x6000_0000)?;
    failed(
        subject,
        &mut board,
        "hard-fault",
        since,
        FAILS_WITHIN,
        "HardFault",
    )
}

/// A tick and a background that do not go on, with the oscillator of the watchdog slow and fast.
pub(super) fn watchdog(subject: &Subject) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    type Failure = fn(&mut Board);
    let failures: [(&str, Failure); 2] = [
        ("tick hung", |board| board.hung = Some(Hang::Tick)),
        ("background hung", |board| {
            board.hung = Some(Hang::Background)
        }),
    ];
    for (what, fail) in failures {
        for oscillator_hz in OSCILLATOR_HZ {
            let (mut board, _) = subject.in_mid_job(oscillator_hz)?;
            let since = board.now();
            let bound = board.chip().watchdog.timeout();
            fail(&mut board);
            // Until it bites; the program that starts then goes on.
            while board.resets.len() < 2 && board.now() < since + 2 * bound {
                board.run(board.now() + MS)?;
            }
            board.hung = None;
            board.run(board.now() + AFTER)?;
            let what = format!("{what}, oscillator of {} kHz", oscillator_hz / 1000);
            // A tick may pass before the hang, and was fed.
            let outputs = subject.outputs();
            rows.push(off_within(
                &board, &outputs, "watchdog", &what, since, bound,
            ));
        }
    }
    let (mut board, _) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    board.hung = Some(Hang::Background);
    while board.resets.len() < 2 {
        board.run(board.now() + MS)?;
    }
    board.hung = None;
    board.run(board.now() + AFTER)?;
    rows.push(starts_with(subject, &mut board, "watchdog", "Watchdog")?);
    Ok(rows)
}

/// The crystal stops in mid-move: the clock security system ends the program, and the board starts without the crystal.
pub(super) fn clock(subject: &Subject) -> Result<Vec<Row>> {
    let (mut board, _) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    let since = board.now();
    board.chip().stop_crystal();
    let outputs = subject.outputs();
    if subject.has_usb {
        // Without the crystal no host hears what the board has to tell.
        board.run(since + FAILS_WITHIN + AFTER)?;
        let what = "in mid-move";
        let off = off_within(&board, &outputs, "clock", what, since, FAILS_WITHIN);
        return Ok(vec![off]);
    }
    let mut rows = failed(
        subject,
        &mut board,
        "clock",
        since,
        FAILS_WITHIN,
        "CrystalStopped",
    )?;
    let mut host = subject.host(&mut board)?;
    let now = board.now();
    host.run(&mut board, now + 30 * MS)?;
    let identity = host.client().identity();
    let clock = identity.map_or("none".into(), |identity| {
        format!("{:?}", identity.board.clock)
    });
    rows.push(fact("clock", "clock after the start", clock, "Internal"));
    let after = "after the crystal has stopped".into();
    rows.push(never_on(
        &board,
        &outputs,
        "clock",
        after,
        since + FAILS_WITHIN,
    ));
    Ok(rows)
}

/// The clock of the core becomes far slower in mid-move, and nothing tells so: every tick seems to be in time. The watchdog is fed by the count
/// of ticks, and bites.
pub(super) fn free_run(subject: &Subject) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    let [typical, fast, slow] = OSCILLATOR_HZ;
    for (part, oscillator_hz) in [(24, typical), (24, fast), (24, slow), (4, slow)] {
        let (mut board, _) = subject.in_mid_job(oscillator_hz)?;
        let since = board.now();
        let hz = SECOND / board.core_period() / part;
        board.chip().run_free(hz);
        // It may be fed once more, after ticks that were counted before.
        let bound = 2 * board.chip().watchdog.timeout();
        board.run(since + bound + AFTER)?;
        let outputs = subject.outputs();
        let kilohertz = oscillator_hz / 1000;
        let what = format!("core {part} times too slow, oscillator of {kilohertz} kHz");
        rows.push(off_within(
            &board, &outputs, "free-run", &what, since, bound,
        ));
        if part == 4 && !subject.has_usb {
            rows.push(starts_with(subject, &mut board, "free-run", "Watchdog")?);
        }
    }
    Ok(rows)
}

/// The supply sags at an instant of the start, and stays low: the board starts anew, and none runs at full speed.
pub(super) fn late_sag(subject: &Subject) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    while board.handled.is_empty() {
        board.run(board.now() + MS / 10)?;
    }
    let instants: Vec<Time> = (0..board.now() + MS).step_by(MS as usize / 10).collect();
    let (mut missed, mut longest) = (Vec::new(), 0);
    for at in &instants {
        let mut board = subject.switch_on()?;
        board.run(*at)?;
        board.chip().set_supply(2600);
        // The start waits 0.1 s for a supply that is there.
        while board.resets.len() < 2 && board.now() < at + 150 * MS {
            board.run(board.now() + MS)?;
        }
        match board.resets.get(1) {
            Some((reset, _)) => longest = longest.max(reset - at),
            None => missed.push(time(*at)),
        }
    }
    let what = format!(
        "{} instants of the start: the sag is not noticed at",
        instants.len()
    );
    let missed = if missed.is_empty() {
        "none".into()
    } else {
        missed.join(", ")
    };
    let row = fact("late-sag", &what, missed, "none");
    let noticed = Row {
        case: "late-sag",
        subject: "noticed after, at most".into(),
        measured: time(longest),
        bound: format!("≤ {}", time(120 * MS)),
        holds: longest <= 120 * MS,
    };
    Ok(vec![row, noticed])
}

/// The supply of the chip sags in mid-move, and stays low for a while: nothing is on until it is back, nor then.
pub(super) fn supply(subject: &Subject) -> Result<Vec<Row>> {
    let (mut board, _) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    let outputs = subject.outputs();
    let since = board.now();
    board.chip().set_supply(2600);
    board.run(since + AFTER)?;
    let low = board.resets.len();
    board.chip().set_supply(3300);
    // A host that says hello before the board is up waits for an answer longer than the case does.
    board.run(since + 2 * AFTER)?;
    let mut rows = failed(
        subject,
        &mut board,
        "supply",
        since,
        FAILS_WITHIN,
        "LowSupply",
    )?;
    rows.push(fact(
        "supply",
        "starts anew while the supply is low",
        (low > 2).to_string(),
        "true",
    ));
    let after = "with the supply low and back".into();
    rows.push(never_on(
        &board,
        &outputs,
        "supply",
        after,
        since + FAILS_WITHIN,
    ));
    Ok(rows)
}

/// A debugger holds the core in mid-move: outputs stay until the watchdog bites.
pub(super) fn halt(subject: &Subject) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for oscillator_hz in OSCILLATOR_HZ {
        let (mut board, _) = subject.in_mid_job(oscillator_hz)?;
        let since = board.now();
        let bound = board.chip().watchdog.timeout();
        board.halted = true;
        board.run(since + bound + AFTER)?;
        let what = format!(
            "core held by a debugger, oscillator of {} kHz",
            oscillator_hz / 1000
        );
        let outputs = subject.outputs();
        rows.push(off_within(&board, &outputs, "halt", &what, since, bound));
    }
    Ok(rows)
}

/// The cable is pulled: the machine comes to rest on its path, and the tool is off, as outputs of jobs are. Other spare outputs stay.
pub(super) fn cable(subject: &Subject) -> Result<Vec<Row>> {
    let (mut board, mut host) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    let service = &subject.scene.service;
    let tick = period(1_000_000) * (1e6 / subject.scene.tick_rate_hz) as u64;
    // The last request may have come any time before; the ramp follows, and a tick of the steppers.
    let bound = of_seconds(service.silence_timeout_s + service.hold_ramp_s) + 3 * tick;
    let since = board.now();
    host.cut(&mut board);
    let end = since + bound + 200 * MS;
    host.run(&mut board, end)?;
    let outputs = subject.outputs();
    let spare = subject.scene.spare_pins.outputs.iter();
    let staying: Vec<&str> = spare
        .zip(wiring::SPARE)
        .filter(|(output, _)| !output.job_only)
        .map(|(_, name)| name)
        .collect();
    // The drives hold the machine where it waits.
    let moving: Vec<_> = outputs
        .iter()
        .filter(|output| output.name != "drives" && output.name != "tool enable")
        .filter(|output| !staying.contains(&output.name))
        .copied()
        .collect();
    let mut rows = vec![off_within(
        &board,
        &moving,
        "cable",
        "cable pulled: steps and tool",
        since,
        bound,
    )];
    let was_on = |output: &&wiring::Output| output.was_on(board.trace(), since - MS);
    for output in outputs.iter().filter(was_on) {
        if staying.contains(&output.name) {
            let is_on = output.off_since(board.trace(), since).is_none();
            let what = format!("cable pulled: {} stays on", output.name);
            rows.push(fact("cable", &what, is_on.to_string(), "true"));
        }
    }
    if subject.has_usb {
        rows.extend(usb::plugged_in(subject, &mut board)?);
    }
    Ok(rows)
}

/// The emergency stop is pressed.
pub(super) fn stop(subject: &Subject) -> Result<Vec<Row>> {
    let Some(stop) = subject.scene.inputs.interlocks.emergency_stop else {
        return Ok(Vec::new());
    };
    let (mut board, _) = subject.in_mid_job(OSCILLATOR_HZ[0])?;
    let since = board.now();
    board.chip().drive(wiring::STOP, Some(true));
    let tick_us = 1e6 / subject.scene.tick_rate_hz;
    let ticks = |count: f64| (count * tick_us * crate::time::MS as f64 / 1000.0) as Time;
    let ramp = of_seconds(subject.scene.service.hold_ramp_s);
    // Debounce, a tick until it is read, the ramp, a tick of the steppers, the slot of the enable line.
    let bound = ticks(f64::from(stop.debounce_ticks) + 3.0) + ramp;
    board.run(since + bound + AFTER)?;
    let outputs = subject.outputs();
    let tool: Vec<_> = outputs
        .iter()
        .copied()
        .filter(|output| output.name == "tool")
        .collect();
    let spare: Vec<_> = outputs
        .iter()
        .copied()
        .filter(|output| wiring::SPARE.contains(&output.name))
        .collect();
    let at_once = ticks(f64::from(stop.debounce_ticks) + 1.0);
    let mut rows = vec![off_within(
        &board,
        &outputs,
        "stop",
        "emergency stop, category 1",
        since,
        bound,
    )];
    for (those, what) in [
        (tool, "emergency stop, tool"),
        (spare, "emergency stop, spare outputs"),
    ] {
        if !those.is_empty() {
            rows.push(off_within(&board, &those, "stop", what, since, at_once));
        }
    }
    Ok(rows)
}
