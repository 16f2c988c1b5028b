//! Amplifiers with encoders: the job with the machine behind them, rotors that are blocked, an encoder whose wire breaks.

use super::{Row, Subject, can, fact, never_on, off_within, time};
use crate::cpu::Board;
use crate::host::Host;
use crate::rotors::Rotors;
use crate::time::{MS, SECOND, Time, micros, of_seconds};
use crate::trace::Level;
use crate::wiring::{self, ENABLE, SET_VALUES};
use anyhow::{Context, Result, ensure};
use std::f64::consts::PI;
use trirrr_scene::{Bldc, DriveKind, EnableLevel};

/// Largest error of a duty, parts: a count of the timer, and the rounding of a time.
const DUTY_ERROR: f64 = 1.0 / 4000.0;

/// A pulse of a set value.
struct Pulse {
    begin: Time,
    duty: f64,
}

/// Reads the pulses of an amplifier off its pin, and their mean period.
fn pulses(board: &Board, motor: usize) -> Result<(Vec<Pulse>, Time)> {
    let edges = board.trace().edges(SET_VALUES[motor]);
    let first = edges.iter().position(|edge| edge.level == Level::High);
    let edges = first.and_then(|first| edges.get(first..)).unwrap_or(&[]);
    let rises: Vec<Time> = edges.iter().step_by(2).map(|edge| edge.time).collect();
    ensure!(
        rises.len() > 100,
        "motor {}: {} pulses of its set value",
        motor + 1,
        rises.len()
    );
    let period = (rises[rises.len() - 1] - rises[0]) / (rises.len() as Time - 1);
    let of = |pair: &[crate::trace::Edge]| Pulse {
        begin: pair[0].time,
        duty: (pair[1].time - pair[0].time) as f64 / period as f64,
    };
    Ok((edges.chunks_exact(2).map(of).collect(), period))
}

/// Time between looks at the machine.
const LOOK: Time = MS / 4;

/// Returns a board whose amplifiers move the machine, and its host.
fn with_machine(subject: &Subject) -> Result<(Board, Host)> {
    let mut board = subject.switch_on()?;
    for (pin, healthy) in wiring::healthy(&subject.scene) {
        board.chip().drive(pin, Some(healthy));
    }
    let drives = subject.scene.drives.as_ref().context("drives")?;
    let DriveKind::Bldc(first) = &drives[0].kind else {
        anyhow::bail!("the drives are no amplifiers");
    };
    let on = first.enable == EnableLevel::High;
    board.chip().rotors = Some((Rotors::of_scene(&subject.scene)?, on));
    let host = subject.host(&mut board)?;
    Ok((board, host))
}

fn rotors(board: &mut Board) -> Result<&mut Rotors> {
    let chip = board.chip();
    chip.advance_rotors();
    let rotors = chip.rotors.as_mut().map(|(rotors, _)| rotors);
    rotors.context("a machine behind the amplifiers")
}

/// The job with the machine behind the amplifiers: its joints against the commands.
pub(super) fn moving(subject: &Subject) -> Result<Vec<Row>> {
    let (mut board, mut host) = with_machine(subject)?;
    let end = board.now() + subject.longest();
    let mut path: Vec<(Time, [f64; 3])> = Vec::new();
    while host.ended.is_none() && board.now() < end {
        let now = board.now();
        host.run(&mut board, now + LOOK)?;
        path.push((board.now(), rotors(&mut board)?.angles()));
    }
    let told = match (&rotors(&mut board)?.broken, &host.ended) {
        (Some(broken), _) => broken.clone(),
        (_, Some(Ok(()))) => "played".into(),
        (_, Some(Err(why))) => why.clone(),
        _ => "no end".into(),
    };
    let mut rows = vec![fact("amplifiers", "the job", told, "played")];
    rows.extend(filtered(&mut board));
    rows.extend(can::following(subject, &board, &host, &path)?);
    Ok(rows)
}

/// Rows of the levels at the inputs of encoders that are too short to count. The build takes 0.43 us for long enough.
fn filtered(board: &mut Board) -> Vec<Row> {
    let times = board.chip().shortest_levels();
    let row = |(index, shortest): (usize, Time)| Row {
        case: "amplifiers",
        subject: format!("encoder {}: the shortest level that counts", index + 1),
        measured: format!("{:.2} µs", micros(shortest)),
        bound: "0.15 to 0.43 µs".into(),
        holds: (0.15..=0.43).contains(&micros(shortest)),
    };
    times.into_iter().enumerate().map(row).collect()
}

/// The wire of an encoder breaks in mid-move: the machine says so and switches off.
pub(super) fn broken_wire(subject: &Subject) -> Result<Vec<Row>> {
    let (mut board, mut host) = with_machine(subject)?;
    let start = rotors(&mut board)?.angles();
    loop {
        let now = board.now();
        ensure!(now < 6 * SECOND, "no joint has moved within 6 s");
        host.run(&mut board, now + LOOK)?;
        let angles = rotors(&mut board)?.angles();
        if angles
            .iter()
            .zip(start)
            .any(|(now, start)| (now - start).abs() > 0.1)
        {
            break;
        }
    }
    let since = board.now();
    rotors(&mut board)?.broken_wire[0] = true;
    let stands = commanded(&host)?;
    let feedback = subject.scene.feedback.unwrap_or_default();
    // The board sees a joint that stands. Its command goes on until the error is one, then for the time of the watch.
    let (mut error_at, mut most) = (None, 0.0_f64);
    while board.now() < since + SECOND {
        let now = board.now();
        match host.ended {
            None => host.run(&mut board, now + LOOK)?,
            Some(_) => board.run(now + LOOK)?,
        }
        let command = commanded(&host)?;
        if (command - stands).abs() > feedback.following_moving_rad && error_at.is_none() {
            error_at = Some(board.now());
        }
        most = most.max((rotors(&mut board)?.angles()[0] - command).abs());
    }
    let error_at = error_at.context("the job moves joint 1 too little")?;
    let told = match &host.ended {
        Some(Err(told)) => told.clone(),
        Some(Ok(())) => "the job was played".into(),
        None => "nothing".into(),
    };
    let outputs = subject.outputs();
    let ticks = 3.0 / subject.scene.tick_rate_hz;
    let bound = error_at - since + of_seconds(feedback.following_time_s + ticks);
    Ok(vec![
        Row {
            case: "encoder",
            subject: "wire of encoder 1 broken: the client is told".into(),
            holds: told.contains("joint 1"),
            measured: told,
            bound: "joint 1".into(),
        },
        off_within(
            &board,
            &outputs,
            "encoder",
            "wire of encoder 1 broken",
            since,
            bound,
        ),
        Row {
            case: "encoder",
            subject: "wire of encoder 1 broken: joint off its command by at most".into(),
            measured: format!("{most:.2} rad"),
            bound: format!("≤ {PI:.2} rad"),
            holds: most <= PI,
        },
    ])
}

/// Returns the angle of joint 1 in the newest sample.
fn commanded(host: &Host) -> Result<f64> {
    let newest = host.samples.last().context("a sample")?;
    Ok(newest.angles[0].into())
}

/// The job begins, no rotor turns: the machine says so and switches off, and no set value was beyond its bounds.
pub(super) fn blocked(subject: &Subject) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    let outputs = subject.outputs();
    let mut board = subject.switch_on()?;
    // No amplifier reports a failure.
    for (pin, healthy) in wiring::healthy(&subject.scene) {
        board.chip().drive(pin, Some(healthy));
    }
    let mut host = subject.host(&mut board)?;
    rows.push(never_on(
        &board,
        &outputs,
        "blocked",
        "before a host".into(),
        0,
    ));
    let greeted = board.now();
    host.run(&mut board, greeted + 2 * SECOND)?;
    let end = board.now();
    board.run(end + 50 * MS)?;
    let told = match &host.ended {
        Some(Err(told)) => told.clone(),
        Some(Ok(())) => "the job was played".into(),
        None => "nothing".into(),
    };
    rows.push(Row {
        case: "blocked",
        subject: "rotors blocked: the client is told".into(),
        holds: told.contains("rad from its command"),
        measured: told,
        bound: "rad from its command".into(),
    });
    rows.push(off_within(
        &board,
        &outputs,
        "blocked",
        "rotors blocked, from the end of the job",
        end,
        0,
    ));
    let edges = board.trace().edges(ENABLE);
    let was_on = outputs
        .iter()
        .any(|output| output.was_on(board.trace(), greeted));
    rows.push(fact(
        "blocked",
        "rotors blocked: the drives were on",
        was_on.to_string(),
        "true",
    ));
    let off = edges.last().map_or(0, |edge| edge.time);
    let drives = subject.scene.drives.as_ref().context("drives")?;
    for (motor, drive) in drives.iter().enumerate() {
        let DriveKind::Bldc(bldc) = &drive.kind else {
            continue;
        };
        rows.extend(set_values(&board, motor, bldc, off)?);
    }
    Ok(rows)
}

/// Rows of a motor's set values; its drive was off from `off` on.
fn set_values(board: &Board, motor: usize, bldc: &Bldc, off: Time) -> Result<Vec<Row>> {
    let (pulses, period) = pulses(board, motor)?;
    let [low, high] = bldc.command_duty;
    let (middle, half) = ((low + high) / 2.0, (high - low).abs() / 2.0);
    let most = half * (bldc.current_limit_a / bldc.full_scale_a).min(1.0);
    let expected = of_seconds(1.0 / bldc.command_hz);
    let motor = motor + 1;
    let on = board
        .trace()
        .edges(ENABLE)
        .get(1)
        .map_or(off, |edge| edge.time);
    let idle = pulses
        .iter()
        .filter(|pulse| pulse.begin < on || pulse.begin > off + 2 * period);
    let idle = idle
        .map(|pulse| (pulse.duty - middle).abs())
        .fold(0.0, f64::max);
    let reached = pulses
        .iter()
        .map(|pulse| (pulse.duty - middle).abs())
        .fold(0.0, f64::max);
    let row = |subject: String, measured: String, bound: String, holds: bool| Row {
        case: "blocked",
        subject,
        measured,
        bound,
        holds,
    };
    let parts = |value: f64| format!("{:.2} %", value * 100.0);
    Ok(vec![
        row(
            format!("motor {motor}: period of the set value"),
            time(period),
            time(expected),
            period.abs_diff(expected) <= expected / 1000,
        ),
        row(
            format!("motor {motor}: set value off none while the drive is off, at most"),
            parts(idle),
            format!("≤ {}", parts(DUTY_ERROR)),
            idle <= DUTY_ERROR,
        ),
        row(
            format!("motor {motor}: largest set value, from none"),
            parts(reached),
            format!("≤ {}", parts(most)),
            reached <= most + DUTY_ERROR && reached > 10.0 * DUTY_ERROR,
        ),
    ])
}
