//! The scene's job on the pins: steps against the angles of telemetry, pulses of the tool against its power.

use super::{Row, Subject, fact, slots, time};
use crate::chip::{SYS_TICK, TIM7};
use crate::cpu::{Board, CYCLES_PER_INSTRUCTION};
use crate::time::{MS, SECOND, Time, seconds};
use crate::trace::Level;
use crate::wiring::{self, DIRECTIONS, ENABLE, SIGNALS, STEPS};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::fs::File;
use std::io::{BufWriter, Write};
use trirrr_drives::stepper::{MICROSTEP, StepMotor, StepsPerTurn};
use trirrr_protocol::message::Telemetry;
use trirrr_scene::{DriveKind, ToolKind};

/// Number that telemetry gives the first tick after the start.
pub(super) const FIRST_TICK: u32 = 1;

/// Microsteps that a pulse may be away from the straight line between the positions of two ticks.
const MOST_OFF: f64 = 1.0;

/// Least cycles from one slot to the next: an image refuses fewer (`firmware/boards/stm32/drives/stepper.rs`).
const SLOT_CYCLES: Time = 800;

/// Share of the core's time that slots may take.
const SLOT_SHARE: f64 = 0.5;

pub(super) fn run(subject: &Subject) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    let mut host = subject.host(&mut board)?;
    host.play(&mut board, subject.longest())?;
    board.run(board.now() + 20 * MS)?;
    if let Some(file) = &subject.dump {
        let mut to =
            BufWriter::new(File::create(file).with_context(|| file.display().to_string())?);
        board.trace().write_vcd(&SIGNALS, &mut to)?;
        to.flush()?;
    }
    let played = Played::of(subject, &board, &host.samples)?;
    let lost = board.chip().line().lost;
    // A slice of admission may outlast a tick, and the line is nearly full.
    let most_missing = played.ticks.len() / 500;
    let mut rows = vec![
        Row {
            case: "job",
            subject: format!(
                "samples of {} ticks that the board has dropped",
                played.ticks.len()
            ),
            measured: played.missing.to_string(),
            bound: format!("≤ {most_missing}"),
            holds: played.missing as usize <= most_missing,
        },
        fact("job", "bytes lost by the receiver", lost.to_string(), "0"),
    ];
    rows.extend(steps(subject, &board, &played)?);
    rows.extend(tool(subject, &board, &played)?);
    let (instructions, longest) = board.work();
    let block = Time::from(longest) * CYCLES_PER_INSTRUCTION * board.core_period();
    rows.push(Row {
        case: "job",
        subject: format!(
            "{:.1} s, {} million instructions, the longest block",
            seconds(board.now()),
            instructions / 1_000_000
        ),
        measured: time(block),
        bound: format!("≤ {}", time(BLOCK_MAX)),
        holds: block <= BLOCK_MAX,
    });
    Ok(rows)
}

/// Rows of the pins along a job without a host, whose ticks play `samples`.
pub(super) fn without_host(
    subject: &Subject,
    board: &Board,
    samples: &[Telemetry<f32>],
) -> Result<Vec<Row>> {
    let played = Played::of(subject, board, samples)?;
    let mut rows = steps(subject, board, &played)?;
    rows.extend(tool(subject, board, &played)?);
    Ok(rows)
}

/// Longest block of code that an image may have: the stamp of a single edge is off by one block at most.
const BLOCK_MAX: Time = 7 * MS / 2000;

/// Ticks of a job, each with its sample and the time of its handler.
///
/// Before a host says what it wants, the board sends all that a sample can hold, more than the line takes. So samples are missing
/// at first. The job begins later.
struct Played {
    ticks: Vec<PlayedTick>,
    /// Samples that are missing since the first step.
    missing: u32,
    /// Beginnings of the slots,
    slots: Vec<Time>,
    /// the longest run of one, and the mean.
    longest_slot: Time,
    mean_slot: f64,
    /// Slots of a tick.
    per_tick: u32,
    /// Angles of the motors at rest: from here on the drive counts.
    origin: [f32; 3],
}

struct PlayedTick {
    begin: Time,
    end: Time,
    sample: Telemetry<f32>,
    /// The sample has come.
    is_known: bool,
}

/// Returns a sample of `tick` in the middle of two others.
fn between(before: &Telemetry<f32>, after: &Telemetry<f32>, tick: u32) -> Telemetry<f32> {
    let mut sample = Telemetry { tick, ..*after };
    for (angle, before) in sample.angles.iter_mut().zip(before.angles) {
        *angle = f32::midpoint(*angle, before);
    }
    sample
}

impl Played {
    fn of(subject: &Subject, board: &Board, samples: &[Telemetry<f32>]) -> Result<Self> {
        let of = |exception: u16| {
            let handled = board.handled.iter();
            handled.filter(move |handled| handled.exception == exception)
        };
        let handlers: Vec<_> = of(SYS_TICK).collect();
        let edges = STEPS.map(|pin| board.trace().edges(pin).get(1).map(|edge| edge.time));
        let first_step = edges.into_iter().flatten().min().unwrap_or(Time::MAX);
        let mut ticks: Vec<PlayedTick> = Vec::new();
        let mut missing = 0;
        for sample in samples {
            let index = sample.tick.wrapping_sub(FIRST_TICK) as usize;
            let handler = handlers.get(index);
            let handler = handler.context("a sample of a tick that did not run")?;
            let next = ticks.last().map(|last| last.sample.tick.wrapping_add(1));
            match next {
                Some(next) if next != sample.tick && handler.begin < first_step => ticks.clear(),
                // The board has dropped it: pulses beside it are not judged.
                Some(next) => {
                    for tick in next..sample.tick {
                        missing += 1;
                        let handler = handlers[(tick - FIRST_TICK) as usize];
                        let before = ticks.last().map_or(*sample, |last| last.sample);
                        ticks.push(PlayedTick {
                            begin: handler.begin,
                            end: handler.end,
                            sample: between(&before, sample, tick),
                            is_known: false,
                        });
                    }
                }
                None => {}
            }
            ticks.push(PlayedTick {
                begin: handler.begin,
                end: handler.end,
                sample: *sample,
                is_known: true,
            });
        }
        ensure!(ticks.len() > 100, "{} samples of a job", ticks.len());
        let origin = samples
            .first()
            .map(|sample| sample.angles)
            .context("a sample")?;
        let runs = of(16 + TIM7).map(|slot| slot.end - slot.begin);
        let (longest_slot, total): (Time, Time) = runs.fold((0, 0), |(longest, total), run| {
            (longest.max(run), total + run)
        });
        let mut slots: Vec<Time> = of(16 + TIM7).map(|slot| slot.begin).collect();
        // Recorded by their ends: a slot never preempts another.
        slots.sort_unstable();
        Ok(Self {
            ticks,
            longest_slot,
            mean_slot: total as f64 / slots.len().max(1) as f64,
            slots,
            missing,
            per_tick: per_tick(subject)?,
            origin,
        })
    }
}

/// Returns the slots over which the pulses of a tick are spread: two for each that the fastest driver takes, and one.
fn per_tick(subject: &Subject) -> Result<u32> {
    let drives = subject.scene.drives.as_ref().context("drives")?;
    let rates = drives.iter().filter_map(|drive| match &drive.kind {
        DriveKind::Stepper(stepper) => stepper.step_rate_limit_hz,
        _ => None,
    });
    let most = rates.fold(0.0, f64::max) / subject.scene.tick_rate_hz;
    Ok(2 * most as u32 + 1)
}

/// Position of a motor over time, from its pulses.
struct Pulses {
    /// Times of rising edges, and positions from them on.
    rises: Vec<(Time, i32)>,
    /// Shortest times: pulse high, pulse low, direction before a step, direction after a step.
    high: Time,
    low: Time,
    set_up: Time,
    hold: Time,
}

/// Reads the pulses of a motor off its pins.
fn pulses(board: &Board, motor: usize, reversed: bool) -> Pulses {
    let trace = board.trace();
    let directions = trace.edges(DIRECTIONS[motor]);
    let steps = trace.edges(STEPS[motor]);
    let mut pulses = Pulses {
        rises: Vec::new(),
        high: Time::MAX,
        low: Time::MAX,
        set_up: Time::MAX,
        hold: Time::MAX,
    };
    let mut position = 0;
    let mut fallen = None;
    let mut risen: Option<Time> = None;
    for edge in steps {
        match edge.level {
            Level::High => {
                let before = directions.partition_point(|turn| turn.time <= edge.time);
                let turned = before.checked_sub(1).and_then(|last| directions.get(last));
                let forward = turned.is_some_and(|turn| turn.level == Level::High) != reversed;
                position += if forward { 1 } else { -1 };
                if let Some(turned) = turned {
                    pulses.set_up = pulses.set_up.min(edge.time - turned.time);
                }
                if let Some(next) = directions.get(before) {
                    pulses.hold = pulses.hold.min(next.time - edge.time);
                }
                if let Some(fallen) = fallen {
                    pulses.low = pulses.low.min(edge.time - fallen);
                }
                risen = Some(edge.time);
                pulses.rises.push((edge.time, position));
            }
            Level::Low | Level::Floating => {
                if let Some(risen) = risen {
                    pulses.high = pulses.high.min(edge.time - risen);
                }
                fallen = Some(edge.time);
            }
        }
    }
    pulses
}

fn steps(subject: &Subject, board: &Board, played: &Played) -> Result<Vec<Row>> {
    let drives = subject.scene.drives.as_ref().context("drives")?;
    let mut rows = Vec::new();
    let mut shortest = Time::MAX;
    let mut first_step = Time::MAX;
    let slot = slot_time(&played.slots)?;
    for (motor, drive) in drives.iter().enumerate() {
        let DriveKind::Stepper(stepper) = &drive.kind else {
            return Ok(Vec::new());
        };
        let per_turn = f64::from(stepper.steps_per_rev * stepper.microsteps) * drive.gear_ratio;
        let per_rad = per_turn / std::f64::consts::TAU;
        let pulses = pulses(board, motor, drive.reversed);
        let origin = played.origin[motor];
        let angles = unwrapped(&played.ticks, f64::from(origin), motor);
        // The very rounding of the image, whose result may differ by one where an angle lies between two microsteps.
        let turn = StepsPerTurn::new(stepper.steps_per_rev * stepper.microsteps, drive.gear_ratio);
        let mut counter = StepMotor::<f32>::new(turn, u32::MAX, origin);
        let mut wanted = Vec::with_capacity(angles.len());
        // With the fractions: the slots draw straight lines between them.
        let mut places = Vec::with_capacity(angles.len());
        let mut rounding: f64 = 0.0;
        for (tick, angle) in played.ticks.iter().zip(&angles) {
            let moved = counter.move_to(tick.sample.angles[motor]);
            moved.map_err(|refused| anyhow!("motor {}: {refused}", motor + 1))?;
            let exact = (angle - f64::from(origin)) * per_rad;
            rounding = rounding.max((f64::from(counter.position()) - exact).abs());
            wanted.push(counter.position());
            places.push(f64::from(counter.place()) / f64::from(MICROSTEP));
        }
        rows.push(Row {
            case: "job",
            subject: format!(
                "motor {}: positions of ticks off the angle by at most",
                motor + 1
            ),
            measured: format!("{rounding:.3} microsteps"),
            bound: "≤ 0.567".into(),
            holds: rounding <= 0.567,
        });
        let last = pulses.rises.last().map_or(0, |(_, position)| *position);
        let before = [0].into_iter().chain(wanted.iter().copied());
        let travel: u32 = before
            .zip(&wanted)
            .map(|(from, to)| to.abs_diff(from))
            .sum();
        ensure!(
            travel > 100,
            "motor {} does not move in this job",
            motor + 1
        );
        let count = pulses.rises.len().to_string();
        let subject = format!(
            "motor {}: pulses, against the microsteps of the angles",
            motor + 1
        );
        rows.push(fact("job", &subject, count, &travel.to_string()));
        let at_end = wanted.last().map_or(0, |wanted| last - wanted).to_string();
        let subject = format!("motor {}: position at the end, off by", motor + 1);
        rows.push(fact("job", &subject, at_end, "0"));
        let off = most_off(&pulses, &places, played);
        rows.push(Row {
            case: "job",
            subject: format!(
                "motor {}: off the commanded angle at any pulse by at most",
                motor + 1
            ),
            measured: format!("{off:.2} microsteps"),
            bound: format!("≤ {MOST_OFF}"),
            holds: off <= MOST_OFF,
        });
        for time in [pulses.high, pulses.low, pulses.set_up, pulses.hold] {
            shortest = shortest.min(time);
        }
        if let Some((first, _)) = pulses.rises.first() {
            let on = board
                .trace()
                .edges(ENABLE)
                .iter()
                .rfind(|edge| edge.time <= *first);
            first_step = first_step.min(on.map_or(0, |on| first - on.time));
        }
    }
    // A slot begins late by the block that its interrupt waits for, or by what USB masks, and the pins follow within it: as the build
    // has it for the times of a driver.
    let bound = slot - slots::late_cycles(subject) * board.core_period();
    rows.push(Row {
        case: "job",
        subject: format!(
            "shortest of pulse high, low, set-up and hold of the direction, slots of {}",
            time(slot)
        ),
        measured: time(shortest),
        bound: format!("≥ {}", time(bound)),
        holds: shortest >= bound,
    });
    rows.push(Row {
        case: "job",
        subject: "enable line before the first step".into(),
        measured: time(first_step),
        bound: format!("≥ {}", time(bound)),
        holds: first_step >= bound,
    });
    for (what, measured, bound) in [
        (
            "an edge late by at most",
            slot.saturating_sub(shortest),
            slots::late_cycles(subject),
        ),
        ("the longest run", played.longest_slot, SLOT_CYCLES),
    ] {
        let cycles = measured.div_ceil(board.core_period());
        rows.push(Row {
            case: "job",
            subject: format!("slots: {what}"),
            measured: format!("{cycles} cycles"),
            bound: format!("≤ {bound} cycles"),
            holds: cycles <= bound,
        });
    }
    let share = played.mean_slot / slot as f64;
    rows.push(Row {
        case: "job",
        subject: format!(
            "slots: share of the core's time, {:.0} cycles for each",
            played.mean_slot / board.core_period() as f64
        ),
        measured: format!("{:.1} %", share * 100.0),
        bound: format!("≤ {:.0} %", SLOT_SHARE * 100.0),
        holds: share <= SLOT_SHARE,
    });
    Ok(rows)
}

/// Returns the mean time between two slots.
fn slot_time(slots: &[Time]) -> Result<Time> {
    match slots {
        [first, .., last] => Ok((last - first) / (slots.len() as Time - 1)),
        _ => bail!("no slots of the steppers ran"),
    }
}

/// Returns the angles of a motor in all ticks without the jumps of whole turns.
fn unwrapped(ticks: &[PlayedTick], origin: f64, motor: usize) -> Vec<f64> {
    let mut before = origin;
    let angles = ticks.iter().map(|tick| {
        let angle = f64::from(tick.sample.angles[motor]);
        let turn = std::f64::consts::TAU;
        before = angle + ((before - angle) / turn).round() * turn;
        before
    });
    angles.collect()
}

/// Returns the greatest distance of the pulses from the straight lines between the positions of the ticks, in microsteps.
///
/// A tick hands its positions to the slots between the begin and the end of its handler. The lines of both are
/// bounds.
fn most_off(pulses: &Pulses, places: &[f64], played: &Played) -> f64 {
    let mut most: f64 = 0.0;
    for (index, (rise, position)) in pulses.rises.iter().enumerate() {
        let around = played.ticks.partition_point(|tick| tick.begin <= *rise);
        let beside = around.saturating_sub(3)..(around + 2).min(played.ticks.len());
        if played.ticks[beside].iter().any(|tick| !tick.is_known) {
            continue;
        }
        let before = index.checked_sub(1).map_or(0, |last| pulses.rises[last].1);
        let slot = played
            .slots
            .partition_point(|slot| *slot <= *rise)
            .saturating_sub(1);
        // In the slot before the pulse, and in its own.
        for (slot, position) in [(slot.saturating_sub(1), before), (slot, *position)] {
            let line = |at: fn(&PlayedTick) -> Time| line_at(slot, places, played, at);
            let (early, late) = (line(|tick| tick.begin), line(|tick| tick.end));
            let position = f64::from(position);
            most = most
                .max(early.min(late) - position)
                .max(position - early.max(late));
        }
    }
    most
}

/// Returns the position of the straight line in the slot `now`, if rounds begin in the first slot after `at` of each tick.
fn line_at(now: usize, places: &[f64], played: &Played, at: fn(&PlayedTick) -> Time) -> f64 {
    let slots = &played.slots;
    let begun = played.ticks.partition_point(|tick| {
        let first = slots.partition_point(|slot| *slot <= at(tick));
        first <= now
    });
    let Some(index) = begun.checked_sub(1) else {
        return 0.0;
    };
    let first = slots.partition_point(|slot| *slot <= at(&played.ticks[index]));
    let from = index.checked_sub(1).map_or(0.0, |before| places[before]);
    let to = places[index];
    let part = ((now - first + 1) as f64 / f64::from(played.per_tick)).min(1.0);
    from + (to - from) * part
}

/// Pulses of a PWM tool against the power of the ticks.
fn tool(subject: &Subject, board: &Board, played: &Played) -> Result<Vec<Row>> {
    let Some(tool) = &subject.scene.tool else {
        return Ok(Vec::new());
    };
    let ToolKind::Pwm {
        frequency_hz,
        duty: [least, most],
        ..
    } = tool.kind
    else {
        return Ok(Vec::new());
    };
    let period = SECOND / Time::from(frequency_hz);
    let edges = board.trace().edges(wiring::tool(subject.kind));
    let on = Level::of(!tool.inverted);
    let (mut compared, mut off, mut stray) = (0, 0.0_f64, 0);
    for pair in edges.windows(2) {
        let [begin, end] = pair else { continue };
        if begin.level != on {
            continue;
        }
        // The tick whose power counts: pulses that a tick falls into belong to two.
        let index = played.ticks.partition_point(|tick| tick.end <= begin.time);
        let next = played.ticks.get(index).map_or(Time::MAX, |tick| tick.begin);
        // Before the first sample that is kept.
        let Some(of) = index.checked_sub(1 + tool.delay_ticks as usize) else {
            continue;
        };
        let power = f64::from(played.ticks[of].sample.tool);
        if end.time >= next || !played.ticks[of].is_known {
            continue;
        }
        if power == 0.0 {
            stray += 1;
            continue;
        }
        let expected = least + (most - least) * power;
        let found = (end.time - begin.time) as f64 / period as f64;
        // A full duty has no edge within a period.
        off = off.max((found - expected).abs());
        compared += 1;
    }
    let bound = 2.0 / 1000.0;
    Ok(vec![
        Row {
            case: "job",
            subject: format!("tool: duty of {compared} pulses off the power by at most"),
            measured: format!("{:.3} %", off * 100.0),
            bound: format!("≤ {:.1} %", bound * 100.0),
            holds: compared > 100 && off <= bound,
        },
        fact(
            "job",
            "tool: pulses in ticks without power",
            stray.to_string(),
            "0",
        ),
    ])
}
