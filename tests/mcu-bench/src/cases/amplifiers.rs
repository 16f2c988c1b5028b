//! Amplifiers with encoders whose rotors are blocked: set values of PWM before, during and after the attempt to move.

use super::{Row, Subject, fact, never_on, off_within, time};
use crate::cpu::Board;
use crate::time::{MS, SECOND, Time, of_seconds};
use crate::trace::Level;
use crate::wiring::{self, ENABLE, SET_VALUES};
use anyhow::{Context, Result, ensure};
use trirrr_scene::{Bldc, DriveKind};

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
        "amplifiers",
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
        case: "amplifiers",
        subject: "rotors blocked: the client is told".into(),
        holds: told.contains("rad from its command"),
        measured: told,
        bound: "rad from its command".into(),
    });
    rows.push(off_within(
        &board,
        &outputs,
        "amplifiers",
        "rotors blocked, from the end of the job",
        end,
        0,
    ));
    let edges = board.trace().edges(ENABLE);
    let was_on = outputs
        .iter()
        .any(|output| output.was_on(board.trace(), greeted));
    rows.push(fact(
        "amplifiers",
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
        case: "amplifiers",
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
