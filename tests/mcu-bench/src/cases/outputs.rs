//! Spare outputs that the scene's job switches: each edge in the tick in which its move begins, and none besides.

use super::job::FIRST_TICK;
use super::{Row, Subject, fact, time};
use crate::chip::SYS_TICK;
use crate::cpu::{Board, Handled};
use crate::host::Host;
use crate::time::{MS, Time};
use crate::trace::Level;
use crate::wiring::{self, STEPS};
use anyhow::{Context, Result};
use trirrr_protocol::message::State;

const CASE: &str = "outputs";

pub(super) fn run(subject: &Subject) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    let mut host = subject.host(&mut board)?;
    host.play(&mut board, subject.longest())?;
    board.run(board.now() + 20 * MS)?;
    let ticks: Vec<Handled> = board
        .handled
        .iter()
        .filter(|handled| handled.exception == SYS_TICK)
        .copied()
        .collect();
    let start = start_of(subject, &host)?;
    let mut rows = Vec::new();
    for (index, (output, pin)) in subject.spare_outputs().enumerate() {
        let mut wanted = subject.changes_of(index);
        // An output of jobs falls with the job.
        let was_on = wanted.last().is_some_and(|(_, on)| *on);
        let edges = edges_of(&board, pin);
        let expected = wanted.len() + usize::from(was_on && output.job_only);
        rows.push(fact(
            CASE,
            &format!("{}: edges along the job", output.name),
            edges.len().to_string(),
            &expected.to_string(),
        ));
        for ((edge, on), (number, wanted_on)) in edges.iter().zip(wanted.drain(..)) {
            let begin = start + ticks_before(subject, number);
            let tick = ticks
                .get(begin as usize)
                .with_context(|| format!("no tick {begin} ran"))?;
            let level = if wanted_on { "on" } else { "off" };
            let what = format!("{}: {level} with move {}", output.name, number + 1);
            let is_within = tick.begin <= *edge && *edge <= tick.end;
            let late = edge.saturating_sub(tick.begin);
            rows.push(Row {
                case: CASE,
                subject: format!(
                    "{what}: in its tick of {}, after",
                    time(tick.end - tick.begin)
                ),
                measured: match *edge < tick.begin {
                    true => format!("{} too early", time(tick.begin - edge)),
                    false => time(late),
                },
                bound: "within the tick".into(),
                holds: is_within && *on == wanted_on,
            });
            // The steps of a tick go out in the slots behind it: all of the move follow the output.
            let early = first_step(&board, tick.begin).map(|step| (step, step > *edge));
            rows.push(Row {
                case: CASE,
                subject: format!("{what}: before the first step of the move by"),
                measured: early.map_or("no step".into(), |(step, _)| {
                    time(step.saturating_sub(*edge))
                }),
                bound: "> 0".into(),
                holds: early.is_none_or(|(_, is_early)| is_early),
            });
        }
    }
    Ok(rows)
}

/// Changes of the level of a pin once the program drives it low, with the level from then on.
fn edges_of(board: &Board, pin: crate::trace::Pin) -> Vec<(Time, bool)> {
    let edges = board.trace().edges(pin).iter();
    let driven = edges.skip_while(|edge| edge.level == Level::Floating);
    driven
        .skip(1)
        .map(|edge| (edge.time, edge.level == Level::High))
        .collect()
}

/// Returns the index of the tick in which the job begins, by any sample of it: the board may drop some. It is played at normal speed.
fn start_of(subject: &Subject, host: &Host) -> Result<u32> {
    let mut samples = host.samples.iter();
    let sample = samples.find(|sample| sample.state == State::Running);
    let sample = sample.context("no sample of the job")?;
    let number = host.client().index(sample.number);
    let before = ticks_before(subject, number.context("a sample of another job")?);
    Ok(sample.tick - FIRST_TICK - before - sample.at)
}

/// Returns the ticks of the moves before the one of index `number`.
fn ticks_before(subject: &Subject, number: u32) -> u32 {
    let moves = subject.scene.job.moves.iter().take(number as usize);
    moves.map(|each| each.duration_ticks).sum()
}

/// Returns the first step of any motor from `since` on.
fn first_step(board: &Board, since: Time) -> Option<Time> {
    let first = |pin| {
        let mut edges = board.trace().edges(pin).iter();
        let step = edges.find(|edge| edge.time >= since && edge.level == Level::High);
        step.map(|edge| edge.time)
    };
    STEPS.into_iter().filter_map(first).min()
}

impl Subject {
    /// Returns the spare outputs of the scene with their pins.
    fn spare_outputs(
        &self,
    ) -> impl Iterator<Item = (&trirrr_scene::SpareOutput, crate::trace::Pin)> {
        let pins = wiring::spare_outputs(self.kind);
        self.scene.spare_pins.outputs.iter().zip(pins)
    }

    /// Returns the changes of an output along the job: the index of the move, and the level from its begin on.
    fn changes_of(&self, output: usize) -> Vec<(u32, bool)> {
        let mut changes: Vec<(u32, bool)> = Vec::new();
        for (number, bits) in self.scene.job.outputs.changes() {
            let was_on = changes.last().is_some_and(|(_, on)| *on);
            let is_on = (was_on && bits.off >> output & 1 == 0) || bits.on >> output & 1 != 0;
            if is_on != was_on {
                changes.push((*number, is_on));
            }
        }
        changes
    }
}
