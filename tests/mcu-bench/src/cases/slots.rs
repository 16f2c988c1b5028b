//! Begins of the slots against an even beat: what masks their interrupt makes them late.

use super::{Row, Subject};
use crate::chip::{Kind, TIM7};
use crate::cpu::Board;
use crate::time::Time;
use anyhow::{Context, Result, ensure};

/// Cycles of the core by which an edge may come late, against the next one at its driver: the build checks the times of a board file
/// with them (`firmware/image/src/board/clock.rs`).
const LATE_CYCLES: Time = 440;

/// More of them where the line is USB, whose driver masks the slots.
const fn usb_cycles(kind: Kind) -> Time {
    match kind {
        Kind::Stm32f405 => 2500,
        Kind::Stm32g474 => 1000,
    }
}

/// Returns the cycles by which an edge of the subject's image may come late.
pub(super) fn late_cycles(subject: &Subject) -> Time {
    let masked = if subject.has_usb {
        usb_cycles(subject.kind)
    } else {
        0
    };
    LATE_CYCLES + masked
}

/// Row of the longest time for which the slots were masked.
pub(super) fn masked(subject: &Subject, board: &Board, case: &'static str, when: &str) -> Row {
    let most = usb_cycles(subject.kind);
    let cycles = board.longest_mask() / board.core_period();
    Row {
        case,
        subject: format!("{when}: all interrupts masked for at most"),
        measured: format!("{cycles} cycles"),
        bound: format!("≤ {most} cycles"),
        // None at all: nothing was measured.
        holds: (1..=most).contains(&cycles),
    }
}

/// Row of the latest begin of a slot from `since` on, against the earliest one. Exact to a block.
pub(super) fn late(
    subject: &Subject,
    board: &mut Board,
    case: &'static str,
    when: &str,
    since: Time,
) -> Result<Row> {
    let most = late_cycles(subject);
    let period = board.chip().slot_period().context("a timer of slots")?;
    let begins = board
        .handled
        .iter()
        .filter(|handled| handled.exception == 16 + TIM7 && handled.begin >= since)
        .map(|handled| handled.begin);
    let begins: Vec<Time> = begins.collect();
    ensure!(begins.len() > 1000, "{} slots", begins.len());
    let (first, last) = (begins[0], begins[begins.len() - 1]);
    let missed = (last - first + period / 2) / period + 1 - begins.len() as Time;
    // The beat comes behind the longest time within a period in which no slot has begun.
    let mut phases: Vec<Time> = begins.iter().map(|begin| begin % period).collect();
    phases.sort_unstable();
    let next = phases.iter().skip(1).copied().chain([phases[0] + period]);
    let gaps = phases.iter().zip(next).map(|(phase, next)| next - phase);
    let cycles = (period - gaps.max().unwrap_or(0)) / board.core_period();
    Ok(Row {
        case,
        subject: format!("{when}: a slot begins late by at most"),
        measured: format!("{cycles} cycles, {missed} missed"),
        bound: format!("≤ {most} cycles, 0 missed"),
        holds: cycles <= most && missed == 0,
    })
}
