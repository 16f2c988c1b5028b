//! Random programs in binary32, which `trirrr check` calls good, played to their end: as a sender writes them to `trirrr grbl`, and as
//! `trirrr stream --path` sends them. The machine proves every move that it plans, and drops a job by ALARM:2 where it cannot.

use super::bench::{Bench, Random, planned, with_bench};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::sync::Mutex;
use std::time::Duration;
use trirrr_client::local::{self, with_machine_switched_on};
use trirrr_client::{Dialogue, JobClient, JobFailure, JobWork, Patience, Turn};
use trirrr_protocol::message::Message;
use trirrr_scene::{Scene, offer};

/// Number type of the scenes.
type N = f32;

/// Ticks in which a program ends: the slowest takes half an hour.
const LONGEST: usize = 2_000_000;

/// Programs that one machine plays.
const IN_ONE: u32 = 25;

/// A scene whose board plans paths.
fn scene() -> Scene {
    let text = include_str!("../../../scenes/paths/onboard.toml");
    Scene::parse(text, "onboard.toml").expect("a scene")
}

impl Random {
    /// Number from `from` to `to`, as far from the next in proportion everywhere.
    fn size(&mut self, from: f64, to: f64) -> f64 {
        let part = self.below(1 << 20) as f64 / f64::from(1 << 20);
        from * (to / from).powf(part)
    }
}

/// Lines within 20 mm around the middle of the drawing: long and short ones, chords of a curve, arcs, to and fro, on a grid, slow ones.
fn program(random: &mut Random) -> String {
    let mut text = "G21 G90\n".to_owned();
    let kind = random.below(7);
    let size = match kind {
        // Down to what binary32 hardly tells apart.
        0 => random.size(2e-4, 0.1),
        _ => random.size(0.1, 10.0),
    };
    let feed = |random: &mut Random| match kind {
        1 => random.size(20.0, 200.0) * size.max(0.1),
        _ => random.size(120.0, 20e3),
    };
    let mut heading = TAU * random.size(0.1, 1.0);
    let (mut x, mut y) = (250.0, 245.0);
    let count = 4 + random.below(36);
    let first = feed(random);
    let _ = writeln!(text, "M4 S{} F{first:.3}", random.below(1000));
    for index in 0..count {
        if random.below(10) == 0 {
            let _ = writeln!(text, "F{:.3}", feed(random));
        }
        if random.below(6) == 0 {
            let _ = writeln!(text, "M{} S{}", 3 + random.below(3), random.below(1000));
        }
        let turn = match kind {
            2 => 0.2 * (random.size(0.1, 1.0) - 0.4),
            3 => TAU / 2.0,
            4 => TAU / 4.0 * random.below(4) as f64,
            _ => TAU * random.size(0.01, 1.0),
        };
        heading += turn;
        let length = match kind {
            3 => size * random.size(0.3, 1.0),
            _ => size,
        };
        let (sin, cos) = heading.sin_cos();
        let (to_x, to_y) = (x + length * cos, y + length * sin);
        // Back to the middle rather than out of the drawing.
        let is_far = (to_x - 250.0).hypot(to_y - 245.0) > 20.0;
        let (to_x, to_y) = if is_far { (250.0, 245.0) } else { (to_x, to_y) };
        let word = match (kind, random.below(6)) {
            (_, 0) => "G0",
            (5 | 6, 1..4) if !is_far => {
                let way = 2 + index % 2;
                let (dx, dy) = ((to_x - x) / 2.0, (to_y - y) / 2.0);
                let _ = writeln!(text, "G{way} X{to_x:.4} Y{to_y:.4} I{dx:.4} J{dy:.4}");
                (x, y) = (to_x, to_y);
                continue;
            }
            _ => "G1",
        };
        let _ = writeln!(text, "{word} X{to_x:.4} Y{to_y:.4}");
        (x, y) = (to_x, to_y);
    }
    text + "M5\n"
}

/// Plays `text` as a sender writes it: a line behind each answer, some ahead. Returns the machine to the middle. Returns false if the machine
/// has dropped the job.
fn is_played_by_grbl(bench: &mut Bench<'_, N>, text: &str) -> bool {
    bench.said.clear();
    let lines: Vec<&str> = text.lines().chain(["G0 X250 Y245"]).collect();
    for (sent, line) in lines.iter().enumerate() {
        bench.until(LONGEST, |bench| bench.answers() + 8 > sent);
        bench.send(line.as_bytes());
        bench.send(b"\n");
    }
    bench.until(LONGEST, |bench| bench.answers() >= lines.len());
    bench.until(LONGEST, |bench| {
        matches!(bench.state().as_str(), "Idle" | "Alarm")
    });
    let errors = bench.said.matches("error:").count();
    let alarms = bench.said.matches("ALARM").count();
    assert_eq!(
        alarms,
        bench.said.matches("ALARM:2").count(),
        "{}",
        bench.told()
    );
    if alarms == 0 {
        assert_eq!(errors, 0, "{}", bench.told());
        return true;
    }
    bench.send(b"$X\nG90 G0 X250 Y245\n");
    bench.until(LONGEST, |bench| bench.answers() >= lines.len() + 2);
    bench.until(LONGEST, |bench| bench.state() == "Idle");
    false
}

/// Plays the path of `job` as `trirrr stream --path` sends it. Returns the failure of a job that is not played whole.
fn failure_of_stream(job: &Scene) -> Option<JobFailure<N>> {
    let units = trirrr_scene::units::<N>(job).expect("units");
    let work = JobWork::Path {
        start: offer::pose::<N>(&units.pose(&job.job.start)),
        pieces: offer::pieces(job, &units).expect("a path"),
    };
    let mut client = JobClient::new(work, local::hello::<N>(job), 0, Patience::default(), 1);
    let end = with_machine_switched_on::<N, _>(job, |machine| {
        for tick in 0..LONGEST as u64 {
            let now = Duration::from_millis(tick);
            loop {
                match client.poll(now) {
                    Turn::Send(request) => {
                        let sequence = request.sequence;
                        let reply = machine.answer(&request);
                        client.receive(&Message::Reply { sequence, reply }, now);
                    }
                    Turn::Wait(_) => break,
                    Turn::Reconnect => panic!("the machine answers"),
                    Turn::Done(result) => return result,
                }
            }
            let _ = (0..400).all(|_| machine.step());
            machine.tick();
            while let Some(message) = machine.outgoing() {
                client.receive(&message, now);
            }
        }
        panic!("no end: {:?}", client.status());
    });
    end.expect("a machine").err()
}

/// Figures of programs.
#[derive(Debug, Default)]
struct Figures {
    /// Programs that `trirrr check` calls good.
    good: u32,
    /// Of those, what a machine has dropped, and how.
    dropped: Vec<String>,
}

fn play(seed: u64, programs: u32, figures: &Mutex<Figures>) {
    let mut random = Random(seed);
    with_bench::<N, _>(&scene(), seed, |bench| {
        for _ in 0..programs {
            let text = program(&mut random);
            let Some(job) = planned(scene(), [0.25, 0.245], &text) else {
                continue;
            };
            let by_grbl = is_played_by_grbl(bench, &text);
            let by_stream = failure_of_stream(&job);
            let mut figures = figures.lock().expect("figures");
            figures.good += 1;
            if !by_grbl {
                figures
                    .dropped
                    .push(format!("grbl, seed {seed:#x}: ALARM:2\n{text}"));
            }
            if let Some(failure) = by_stream {
                let failed = format!("stream --path, seed {seed:#x}: {failure:?}\n{text}");
                figures.dropped.push(failed);
            }
        }
    });
}

/// Plays until so many `wanted` programs were good.
fn check(wanted: u32) {
    let figures = Mutex::default();
    let machines = wanted.div_ceil(IN_ONE);
    let next = Mutex::new(0..machines);
    let lanes = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..lanes.min(machines as usize) {
            scope.spawn(|| {
                while let Some(machine) = { next.lock().expect("numbers").next() } {
                    let seed = 0x7472_6972_7272_0000 + u64::from(machine);
                    play(seed, IN_ONE.min(wanted), &figures);
                }
            });
        }
    });
    let figures = figures.into_inner().expect("figures");
    println!(
        "{} programs that check calls good, each by grbl and by stream --path: {} dropped",
        figures.good,
        figures.dropped.len()
    );
    assert!(figures.dropped.is_empty(), "{}", figures.dropped.join("\n"));
    assert!(figures.good > wanted * 4 / 5, "{}", figures.good);
}

/// A machine that slows down over 2 s begins with more moves than a sender waits for.
#[test]
fn a_start_that_comes_too_early_is_made_again_with_more_of_the_path() {
    let text = include_str!("../../../scenes/paths/onboard.toml");
    let slow = text.replacen("hold_ramp_s = 0.1", "hold_ramp_s = 2", 1);
    assert_ne!(slow, text);
    let scene = Scene::parse(&slow, "onboard.toml").expect("a scene");
    let side = |x: f64| format!("G1 X{x} F1200\nG1 Y250\nG1 X250\nG1 Y245\n");
    let program: String = (0..8).map(|turn| side(255.0 + f64::from(turn))).collect();
    with_bench::<N, _>(&scene, 1, |bench| {
        assert!(is_played_by_grbl(bench, &program))
    });
}

#[test]
fn programs_that_are_good_are_played_by_grbl_and_by_stream() {
    check(4);
}

#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn two_thousand_programs_that_are_good_are_played() {
    check(2300);
}
