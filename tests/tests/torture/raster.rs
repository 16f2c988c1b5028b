//! Rows of power lists over a line that damages frames: each tick has the power of its pixel, and every pixel is burnt once.

use super::slow_line::play;
use std::time::Duration;
use trirrr_bench::device::{
    Device, DeviceRoom, LEVELS, MessageDecoder, TICK_RATE_HZ, hello, home, message_frame,
    request_frame,
};
use trirrr_bench::faulty_link::{FaultyLink, Random};
use trirrr_client::{Dialogue, JobClient, JobWork, Patience, Turn, UserCommand};
use trirrr_core::limits::LimitParameters;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{AnyMove, LEVEL_PARTS, LevelRange, Message, Move};
use trirrr_scene::JobLevels;

/// Pixels of a row: one a tick at the speed of the row.
const PIXELS: usize = 200;

const SPEED_M_S: f64 = 0.1;

/// Ticks from rest to that speed.
const RAMP_TICKS: u32 = 40;

const POWER: f64 = 0.5;

/// Rows of a job.
const ROWS: usize = 24;

/// Places of the queue.
const MOVES: usize = 17;

/// Rows to and fro on a straight line; each is a ramp, a move with levels, and a ramp.
fn rows(tones: &[[u8; PIXELS]]) -> JobWork<f64> {
    let ramp = 0.5 * SPEED_M_S * f64::from(RAMP_TICKS) / TICK_RATE_HZ;
    let length = SPEED_M_S * PIXELS as f64 / TICK_RATE_HZ;
    let stations = [0.0, ramp, ramp + length, 2.0 * ramp + length];
    let at = |way: f64| {
        let start = home();
        let [x, y] = [0.8 * way, 0.6 * way];
        Pose::from_f64(start.position.x + x, start.position.y + y, start.angle)
    };
    let mut moves = Vec::new();
    let mut levels = JobLevels::default();
    for (row, tones) in tones.iter().enumerate() {
        let is_back = row % 2 == 1;
        let sense = if is_back { -SPEED_M_S } else { SPEED_M_S };
        let velocity = [0.8 * sense, 0.6 * sense, 0.0];
        for part in 0..3 {
            let [from, to] = match is_back {
                true => [stations[3 - part], stations[2 - part]],
                false => [stations[part], stations[part + 1]],
            };
            let is_list = part == 1;
            let ticks = if is_list { PIXELS as u32 } else { RAMP_TICKS };
            moves.push(AnyMove::Cubic(Move {
                start_velocity: if part == 0 { [0.0; 3] } else { velocity },
                end_velocity: if part == 2 { [0.0; 3] } else { velocity },
                tool_power: if is_list { POWER } else { 0.0 },
                tool_speed: if is_list { SPEED_M_S } else { 0.0 },
                ..Move::rest_to_rest(0, at(from), at(to), ticks)
            }));
        }
        let first = levels.levels.len() as u32;
        levels.levels.extend(tones);
        let range = LevelRange {
            first,
            count: PIXELS as u16,
            offset: 0,
            span: PIXELS as u32 * LEVEL_PARTS,
        };
        levels.ranges.push((3 * row as u32 + 1, range));
    }
    JobWork::of(moves, &levels)
}

/// Plays rows over a line that damages `percent` of all frames, with holds; the reconnects.
fn burn(seed: u64, percent: u64) -> u64 {
    let mut random = Random::new(seed);
    let tones: Vec<[u8; PIXELS]> = (0..ROWS)
        .map(|_| [(); PIXELS].map(|()| random.below(256) as u8))
        .collect();
    assert!(
        ROWS * PIXELS > 4 * usize::from(LEVELS),
        "the ring goes round"
    );
    let mut channels = Box::new(DeviceRoom::<f64, MOVES>::new());
    let mut device = Device::enabled(&mut channels, LimitParameters::default(), 0);
    let patience = Patience {
        answer: Duration::from_millis(20),
        attempts: 7,
    };
    let mut client = JobClient::new(rows(&tones), hello(), 1, patience, 1);
    let mut decoder = MessageDecoder::new();
    let mut there = FaultyLink::new(random.bits(), percent);
    let mut back = FaultyLink::new(random.bits(), percent);
    let mut burnt = vec![[0_u32; PIXELS]; ROWS];
    let (mut reconnects, mut held) = (0, false);
    for tick in 0..400_000_u64 {
        let now = Duration::from_secs_f64(tick as f64 / TICK_RATE_HZ);
        let output = device.tick();
        for _ in 0..200 {
            if !device.service.step() {
                break;
            }
        }
        while let Some(message) = device.service.outgoing() {
            if let Message::Telemetry(sample) = &message
                && sample.state.is_running()
                && let Some(index) = client.index(sample.number).map(|index| index as usize)
            {
                assert_eq!(sample.tool, output.tool);
                match (index % 3, sample.part, tones.get(index / 3)) {
                    (1, 0, Some(tones)) => {
                        let velocity = sample.setpoint.velocity;
                        let power = POWER * velocity.x.hypot(velocity.y) / SPEED_M_S;
                        let pixel = (sample.at as usize).min(PIXELS - 1);
                        let expected = power * f64::from(tones[pixel]) / 255.0;
                        let at_rest = velocity.x == 0.0;
                        assert!(
                            (sample.tool - expected).abs() < 1e-9 || at_rest,
                            "{seed}, move {index}: {sample:?} is not {expected}"
                        );
                        burnt[index / 3][pixel] += 1;
                    }
                    // Between ticks of the path, on the ramps of a hold.
                    (1, _, Some(tones)) => {
                        let from = sample.at as usize;
                        let velocity = sample.setpoint.velocity;
                        let power = POWER * velocity.x.hypot(velocity.y) / SPEED_M_S;
                        let may = [from, from + 1]
                            .map(|pixel| power * f64::from(tones[pixel.min(PIXELS - 1)]) / 255.0);
                        let is_one = may.iter().any(|power| (sample.tool - power).abs() < 1e-9);
                        assert!(
                            is_one,
                            "{seed}, move {index}: {sample:?} is none of {may:?}"
                        );
                    }
                    _ => assert_eq!(sample.tool, 0.0),
                }
            }
            back.send(&message_frame(&message));
        }
        while let Some(bytes) = there.receive() {
            device.receive(&bytes, |_| {}, |message| back.send(&message_frame(message)));
        }
        while let Some(bytes) = back.receive() {
            let mut line = bytes.as_slice();
            while let Some(frame) = decoder.take::<Message<f64>>(&mut line) {
                if let Ok(message) = frame {
                    client.receive(&message, now);
                }
            }
        }
        if random.below(700) == 0 {
            client.command(if held {
                UserCommand::Resume
            } else {
                UserCommand::Hold
            });
            held = !held;
        }
        loop {
            match client.poll(now) {
                Turn::Send(request) => there.send(&request_frame(&request)),
                Turn::Wait(_) => break,
                Turn::Reconnect => {
                    there.clear();
                    back.clear();
                    reconnects += 1;
                    client.reconnected();
                }
                Turn::Done(result) => {
                    if let Err(failure) = result {
                        panic!("{seed}: {}", client.describe(&failure));
                    }
                    // Whole ticks of a row have each pixel once; on the ramps of a hold some lie between.
                    let few = burnt
                        .as_flattened()
                        .iter()
                        .filter(|times| **times > 1)
                        .count();
                    assert_eq!(few, 0, "{seed}: a pixel was burnt twice");
                    let once = burnt
                        .as_flattened()
                        .iter()
                        .filter(|times| **times == 1)
                        .count();
                    assert!(2 * once > ROWS * PIXELS, "{seed}: {once}");
                    return reconnects;
                }
            }
        }
    }
    panic!("{seed}: no end: {:?}", client.status());
}

/// The bytes of QEMU's receiver, 14 in a tick of 1 ms, with a delay: rows of a pixel a tick come in time.
#[test]
fn power_lists_come_in_time_over_a_slow_line() {
    let mut random = Random::new(11);
    let tones: Vec<[u8; PIXELS]> = (0..60)
        .map(|_| [(); PIXELS].map(|()| random.below(256) as u8))
        .collect();
    for delay in [0, 16] {
        let pace = play(rows(&tones), delay, 14);
        assert_eq!(pace.dry, 0, "{delay}: {pace:?}");
        // The first tick stands at the start.
        let length = 60 * (2 * u64::from(RAMP_TICKS) + PIXELS as u64);
        assert_eq!(pace.ticks, length + 1);
    }
}

#[test]
fn power_lists_survive_a_bad_line() {
    assert_eq!(burn(1, 0), 0);
    let reconnects: u64 = (2..6).map(|seed| burn(seed, 20)).sum();
    println!("{reconnects} reconnects");
}
