//! A board without a host: its job at the press of a button, and what ends it.

use super::job::{self, FIRST_TICK};
use super::{OSCILLATOR_HZ, Row, Subject, fact, never_on, off_within, step_edges};
use crate::chip::SYS_TICK;
use crate::cpu::Board;
use crate::time::{MS, SECOND, Time, of_seconds};
use crate::trace::Level;
use crate::wiring::{self, DIRECTIONS, STEPS};
use anyhow::{Context, Result, ensure};
use trirrr_client::local::{self, LocalService};
use trirrr_client::runner::JobRunner;
use trirrr_protocol::message::Telemetry;
use trirrr_scene::{Scene, offer};

/// Time for which somebody presses.
const PRESS: Time = 60 * MS;

/// Most time from a failure to outputs that are off.
const FAILS_WITHIN: Time = 2 * MS;

impl Subject {
    fn hold_button(&self, board: &mut Board, is_pressed: bool) {
        let (pin, level) = wiring::button(self.kind);
        board.chip().drive(pin, Some(level == is_pressed));
    }

    /// Presses the button and lets it go. Returns the time of the press.
    fn press_button(&self, board: &mut Board) -> Result<Time> {
        let pressed = board.now();
        self.hold_button(board, true);
        board.run(pressed + PRESS)?;
        self.hold_button(board, false);
        board.run(pressed + 2 * PRESS)?;
        Ok(pressed)
    }

    /// Returns a board that was switched on with its button released.
    fn alone(&self) -> Result<Board> {
        let mut board = self.switch_on()?;
        self.hold_button(&mut board, false);
        board.run(300 * MS)?;
        Ok(board)
    }

    /// Returns a board in the middle of its job.
    fn alone_in_mid_job(&self) -> Result<Board> {
        let mut board = self.alone()?;
        self.press_button(&mut board)?;
        board.run(board.now() + 300 * MS)?;
        ensure!(step_edges(&board) > 100, "no motor has moved");
        Ok(board)
    }

    /// Ticks of the debounce time of the button.
    fn button_ticks(&self) -> Result<u32> {
        let button = self.scene.inputs.button.context("a button")?;
        Ok(button.debounce_ticks.into())
    }
}

/// Samples of a job with all its passes, as `trirrr run` plays it.
fn played_by_host(scene: &Scene) -> Result<Vec<Telemetry<f32>>> {
    let mut scene = scene.clone();
    scene.unroll();
    let units = trirrr_scene::units::<f32>(&scene)?;
    let moves = offer::moves::<f32>(&scene, &units);
    let hello = local::hello::<f32>(&scene);
    let rate = scene.tick_rate_hz;
    let play = |machine: &mut dyn LocalService<f32>| {
        let mut runner = JobRunner::new(machine, moves, hello, rate);
        let mut samples = Vec::new();
        loop {
            match runner.talk() {
                Some(Ok(())) => return Ok(samples),
                Some(Err(failure)) => anyhow::bail!("{}", runner.describe(&failure)),
                None => {}
            }
            runner.tick();
            samples.extend(runner.collect().map(|played| played.sample));
        }
    };
    local::with_machine::<f32, _>(&scene, play)?
}

/// The steps and the tool of the whole job, against what a host plays.
pub(super) fn job(subject: &Subject) -> Result<Vec<Row>> {
    let mut board = subject.alone()?;
    let since = board.now();
    let outputs = subject.outputs();
    let waits = never_on(&board, &outputs, "alone", "before the press".into(), 0);
    let pressed = subject.press_button(&mut board)?;
    let mut samples = played_by_host(&subject.scene)?;
    let longest = of_seconds(samples.len() as f64 / subject.scene.tick_rate_hz);
    board.run(since + longest + 300 * MS)?;
    // The tick in which the press counts, and one in which the drives go on.
    let ticks = board
        .handled
        .iter()
        .filter(|each| each.exception == SYS_TICK);
    let sees = ticks.take_while(|each| each.begin < pressed).count();
    let first = sees as u32 + subject.button_ticks()?;
    for (sample, tick) in samples.iter_mut().zip(FIRST_TICK + first..) {
        sample.tick = tick;
    }
    let mut rows = vec![waits];
    rows.extend(job::without_host(subject, &board, &samples)?);
    let edges = step_edges(&board);
    board.run(board.now() + SECOND)?;
    let more = step_edges(&board) - edges;
    rows.push(fact("alone", "steps after the job", more.to_string(), "0"));
    for row in &mut rows {
        row.case = "alone";
    }
    Ok(rows)
}

/// A button that is stuck when the board is switched on, and one that bounces.
pub(super) fn button(subject: &Subject) -> Result<Vec<Row>> {
    const CASE: &str = "alone-button";
    let outputs = subject.outputs();
    let mut board = subject.switch_on()?;
    subject.hold_button(&mut board, true);
    board.run(SECOND)?;
    let stuck = never_on(
        &board,
        &outputs,
        CASE,
        "stuck from the start, 1 s".into(),
        0,
    );
    // Half of its debounce time, over and over.
    subject.hold_button(&mut board, false);
    board.run(board.now() + 200 * MS)?;
    let half = of_seconds(f64::from(subject.button_ticks()?) / subject.scene.tick_rate_hz) / 2;
    for _ in 0..20 {
        for is_pressed in [true, false] {
            subject.hold_button(&mut board, is_pressed);
            board.run(board.now() + half - MS)?;
        }
    }
    let bounces = never_on(
        &board,
        &outputs,
        CASE,
        "presses of half the debounce time".into(),
        0,
    );
    subject.press_button(&mut board)?;
    board.run(board.now() + 300 * MS)?;
    let moves = (step_edges(&board) > 100).to_string();
    Ok(vec![
        stuck,
        bounces,
        fact(CASE, "then a press moves it", moves, "true"),
    ])
}

/// The emergency stop, and what a press does behind it.
pub(super) fn stop(subject: &Subject) -> Result<Vec<Row>> {
    const CASE: &str = "alone-stop";
    let Some(stop) = subject.scene.inputs.interlocks.emergency_stop else {
        return Ok(Vec::new());
    };
    let mut board = subject.alone_in_mid_job()?;
    let since = board.now();
    board.chip().drive(wiring::STOP, Some(true));
    let ticks = |count: f64| of_seconds(count / subject.scene.tick_rate_hz);
    let ramp = of_seconds(subject.scene.service.hold_ramp_s);
    let bound = ticks(f64::from(stop.debounce_ticks) + 3.0) + ramp;
    board.run(since + bound + 100 * MS)?;
    let outputs = subject.outputs();
    let off = off_within(
        &board,
        &outputs,
        CASE,
        "emergency stop, category 1",
        since,
        bound,
    );
    let later = board.now();
    subject.press_button(&mut board)?;
    board.chip().drive(wiring::STOP, Some(false));
    board.run(board.now() + 200 * MS)?;
    for _ in 0..3 {
        subject.press_button(&mut board)?;
        board.run(board.now() + 200 * MS)?;
    }
    let stays = never_on(
        &board,
        &outputs,
        CASE,
        "pressed, released, pressed again".into(),
        later,
    );
    Ok(vec![off, stays])
}

/// The door holds the job; closed, it goes on at the button, and ends where it began.
pub(super) fn door(subject: &Subject) -> Result<Vec<Row>> {
    const CASE: &str = "alone-door";
    let Some(door) = subject.scene.inputs.interlocks.door else {
        return Ok(Vec::new());
    };
    let mut board = subject.alone_in_mid_job()?;
    let since = board.now();
    board.chip().drive(wiring::DOOR, Some(true));
    let ticks = |count: f64| of_seconds(count / subject.scene.tick_rate_hz);
    let ramp = of_seconds(subject.scene.service.hold_ramp_s);
    board.run(since + ticks(f64::from(door.debounce_ticks) + 3.0) + ramp)?;
    let outputs = subject.outputs();
    let tool: Vec<_> = outputs
        .iter()
        .copied()
        .filter(|output| output.name == "tool")
        .collect();
    let at_once = ticks(f64::from(door.debounce_ticks) + 1.0);
    let off = off_within(&board, &tool, CASE, "door, tool", since, at_once);
    let stands = step_edges(&board);
    subject.press_button(&mut board)?;
    board.chip().drive(wiring::DOOR, Some(false));
    board.run(board.now() + 500 * MS)?;
    let more = step_edges(&board) - stands;
    let waits = fact(
        CASE,
        "steps while it is open, and once it is closed",
        more.to_string(),
        "0",
    );
    subject.press_button(&mut board)?;
    board.run(board.now() + 2 * subject.longest())?;
    let places = [0, 1, 2].map(|motor| place(&board, motor).to_string());
    let ends = fact(
        CASE,
        "microsteps from the start at the end",
        places.join(", "),
        "0, 0, 0",
    );
    let goes_on = (step_edges(&board) > stands + 100).to_string();
    Ok(vec![
        off,
        waits,
        fact(CASE, "goes on at a press", goes_on, "true"),
        ends,
    ])
}

/// Microsteps of a motor from where it began.
fn place(board: &Board, motor: usize) -> i32 {
    let directions = board.trace().edges(DIRECTIONS[motor]);
    let steps = board.trace().edges(STEPS[motor]).iter();
    let rises = steps.filter(|edge| edge.level == Level::High);
    let ways = rises.map(|edge| {
        let turned = directions.partition_point(|turn| turn.time <= edge.time);
        let turned = turned.checked_sub(1).and_then(|last| directions.get(last));
        match turned.is_some_and(|turn| turn.level == Level::High) {
            true => 1,
            false => -1,
        }
    });
    ways.sum()
}

/// A panic of the image that is made to fail: a fault behind the reset, which no press leads out of.
pub(super) fn panic(subject: &Subject) -> Result<Vec<Row>> {
    const CASE: &str = "alone-panic";
    let Some(image) = &subject.panicking else {
        return Ok(Vec::new());
    };
    let mut board = subject.switch_on_with(image, subject.kind.crystal(), OSCILLATOR_HZ[0])?;
    subject.hold_button(&mut board, false);
    let ticks = |board: &Board| {
        board
            .handled
            .iter()
            .filter(|each| each.exception == SYS_TICK)
            .count()
    };
    // The 50th tick panics: the machine moves by then.
    let released = subject.button_ticks()? as usize + 2;
    while board.resets.len() < 2 {
        ensure!(board.now() < SECOND, "no panic within a second");
        let is_pressed = ticks(&board) >= released;
        subject.hold_button(&mut board, is_pressed);
        board.run(board.now() + MS / 4)?;
    }
    let outputs = subject.outputs();
    let reset = board.resets.last().map_or(0, |(time, _)| *time);
    let failed_at = board
        .last_begin(SYS_TICK)
        .context("no tick before the panic")?;
    let was_on = outputs
        .iter()
        .any(|output| output.was_on(board.trace(), failed_at - 2 * MS));
    subject.hold_button(&mut board, false);
    board.run(reset + 200 * MS)?;
    let off = off_within(
        &board,
        &outputs,
        CASE,
        "from the panic",
        failed_at,
        FAILS_WITHIN,
    );
    let later = board.now();
    subject.press_button(&mut board)?;
    let stays = never_on(
        &board,
        &outputs,
        CASE,
        "pressed behind the reset".into(),
        later,
    );
    let moved = fact(
        CASE,
        "drives on in the tick that panics",
        was_on.to_string(),
        "true",
    );
    Ok(vec![moved, off, stays])
}
