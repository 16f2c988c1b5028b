//! Images on a machine that plays power lists, and on one that does not: the same power at each place of D, at any pace.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;
use trirrr_client::local::{self, LocalService};
use trirrr_client::{Dialogue, JobClient, JobPlace, JobRest, JobWork, Patience, Turn, UserCommand};
use trirrr_host_sim::job_file::{DrawingArgs, ImageArgs, JobFileArgs, PitchArg, read_job};
use trirrr_protocol::message::{Message, State, Telemetry};
use trirrr_scene::{Scene, offer};

/// Columns and rows of the image.
const SIZE: [usize; 2] = [22, 4];

/// Length of a pixel, m: five times the way of a tick. Runs of fewer ticks share moves.
const PITCH_M: f64 = 5e-4;

const FEED_M_S: f64 = 0.1;

const ORIGIN_M: [f64; 2] = [0.23, 0.27];

fn tone(column: usize, row: usize) -> u8 {
    ((column * 97 + row * 41 + column * column * 13) % 256) as u8
}

/// An image of different greys as a BMP file with 24 bits.
fn bmp() -> Vec<u8> {
    let [columns, rows] = SIZE.map(|side| side as u32);
    let line = (3 * columns).next_multiple_of(4);
    let mut file = Vec::from(*b"BM");
    let bytes = line * rows;
    for word in [
        54 + bytes,
        0,
        54,
        40,
        columns,
        rows,
        0x18_0001,
        0,
        bytes,
        2835,
        2835,
        0,
        0,
    ] {
        file.extend(word.to_le_bytes());
    }
    for row in 0..SIZE[1] {
        let start = file.len();
        for column in 0..SIZE[0] {
            file.extend([tone(column, row); 3]);
        }
        file.resize(start + line as usize, 0);
    }
    file
}

/// The job on the machine of `scenes/paths/raster.toml`, with or without power lists.
fn job(folder: &Path, lists: bool) -> Scene {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let machine = fs::read_to_string(scenes.join("paths/raster.toml")).unwrap();
    let machine = match lists {
        true => machine,
        false => machine.replace("power_lists = 4096", "power_lists = 0"),
    };
    fs::copy(scenes.join("thesis.toml"), folder.join("thesis.toml")).unwrap();
    let machine = machine.replace("../thesis.toml", "thesis.toml");
    let file = |name: &str| -> PathBuf { folder.join(name) };
    fs::write(file("machine.toml"), machine).unwrap();
    fs::write(file("image.bmp"), bmp()).unwrap();
    let args = JobFileArgs {
        machine: Some(file("machine.toml")),
        origin: Some([1e3 * ORIGIN_M[0], 1e3 * ORIGIN_M[1], 0.0]),
        drawing: DrawingArgs {
            speed: Some(60e3 * FEED_M_S),
            ..DrawingArgs::default()
        },
        image: ImageArgs {
            pitch: Some(PitchArg::Millimetres(1e3 * PITCH_M)),
            overscan: Some(3.0),
            ..ImageArgs::default()
        },
        ..JobFileArgs::default()
    };
    read_job(&file("image.bmp"), &args).expect("a job")
}

/// End of a play: after so many ticks of the job, or with the job.
#[derive(Clone, Copy)]
struct Course<'a> {
    percent: u8,
    /// Ticks between a hold, its resume, and the next hold.
    holds: &'a [u32],
    stop: Option<u32>,
}

/// Plays the job in f32, and returns the samples of the path and the place at which the machine has left it.
fn play(
    machine: &mut dyn LocalService<f32>,
    scene: &Scene,
    work: JobWork<f32>,
    course: Course,
) -> (Vec<Telemetry<f32>>, Option<JobPlace>) {
    let hello = local::hello::<f32>(scene);
    let period = Duration::from_secs_f64(scene.period_s());
    let client = JobClient::new(work, hello, 1, Patience::default(), 7);
    let mut client = client.with_status_every(period).with_recovery(0.2);
    client.command(UserCommand::FeedOverride(course.percent));
    let (mut now, mut samples) = (Duration::ZERO, Vec::new());
    let (mut holds, mut next, mut held, mut ran) = (course.holds.iter(), None, false, 0_u32);
    loop {
        match client.poll(now) {
            Turn::Send(request) => {
                let reply = machine.answer(&request);
                while machine.step() {}
                let sequence = request.sequence;
                client.receive(&Message::Reply { sequence, reply }, now);
                continue;
            }
            Turn::Done(result) => {
                assert_eq!(result.is_ok(), course.stop.is_none(), "{result:?}");
                return (samples, client.interrupted());
            }
            Turn::Wait(_) => {}
            Turn::Reconnect => panic!("no answer"),
        }
        machine.tick();
        while machine.step() {}
        now += period;
        while let Some(message) = machine.outgoing() {
            match message {
                Message::Telemetry(sample) => {
                    if client.index(sample.number).is_some() && client.offered() > 0 {
                        samples.push(sample);
                    }
                }
                message => client.receive(&message, now),
            }
        }
        assert!(samples.len() < 2_000_000, "no end: {:?}", client.status());
        if machine.state() == State::Running || held {
            ran += 1;
            if next.is_none_or(|at| ran >= at) {
                if next.is_some() {
                    client.command(if held {
                        UserCommand::Resume
                    } else {
                        UserCommand::Hold
                    });
                    held = !held;
                }
                next = holds.next().map(|ticks| ran + ticks).or(Some(u32::MAX));
            }
            if course.stop == Some(ran) {
                client.command(UserCommand::Stop);
            }
        }
    }
}

/// Compares the power at each place with the pixels within the way of so many ticks, and counts the ticks in which each pixel is burnt.
fn check(samples: &[Telemetry<f32>], ticks: f64) -> Vec<[u32; SIZE[0]]> {
    let mut burnt = vec![[0; SIZE[0]]; SIZE[1]];
    for sample in samples {
        let setpoint = &sample.setpoint;
        let [x, y] = [setpoint.pose.position.x, setpoint.pose.position.y].map(f64::from);
        let speed = f64::from(setpoint.velocity.x).hypot(setpoint.velocity.y.into());
        let [column, row] = [(x - ORIGIN_M[0]) / PITCH_M, (y - ORIGIN_M[1]) / PITCH_M];
        let reach = ticks * FEED_M_S * 1e-3 / PITCH_M + 0.01;
        let inside = (-reach..SIZE[0] as f64 + reach).contains(&column);
        let on_row =
            inside && (row.fract() - 0.5).abs() < 0.01 && row > 0.0 && row < SIZE[1] as f64;
        let tool = f64::from(sample.tool);
        if !sample.state.is_running() || !on_row {
            assert_eq!(tool, 0.0, "{sample:?}");
            continue;
        }
        let pixel = |column: f64| (column.max(0.0) as usize).min(SIZE[0] - 1);
        let (from, to) = (pixel(column - reach), pixel(column + reach));
        let power = |column: usize| {
            let dark = 1.0 - f64::from(tone(column, row as usize)) / 255.0;
            dark * speed / FEED_M_S
        };
        let found = (from..=to).find(|&column| (power(column) - tool).abs() < 2e-4);
        let outside = tool == 0.0 && !(reach..SIZE[0] as f64 - reach).contains(&column);
        assert!(
            found.is_some() || outside,
            "{ticks}, {column} {row}: {tool}, {:?}",
            power(pixel(column))
        );
        if let Some(found) = found {
            burnt[row as usize][found] += 1;
        }
    }
    burnt
}

fn work(scene: &Scene) -> JobWork<f32> {
    let units = trirrr_scene::units::<f32>(scene).unwrap();
    JobWork::of(offer::moves::<f32>(scene, &units), &scene.job.levels)
}

#[test]
fn lists_and_runs_burn_the_same_picture_at_any_pace_and_across_holds() {
    let folder = TempDir::new().unwrap();
    let [lists, runs] = [true, false].map(|lists| job(folder.path(), lists));
    assert!(runs.job.levels.is_empty());
    assert!(!lists.job.levels.is_empty());
    // A row is a few moves in place of one a pixel.
    assert!(4 * lists.job.levels.ranges.len() < SIZE[0] * SIZE[1]);
    assert!(runs.job.moves.len() >= SIZE[0] * SIZE[1]);
    // Moves begin and end at ticks, which shifts the pixels of runs a little; lists follow the place.
    for (scene, within) in [(lists, 1.0), (runs, 2.0)] {
        for (percent, holds) in [
            (100, &[][..]),
            (37, &[]),
            (100, &[90, 200, 15, 120, 40, 130]),
        ] {
            let course = Course {
                percent,
                holds,
                stop: None,
            };
            let (samples, _) = local::with_machine_switched_on(&scene, |machine| {
                play(machine, &scene, work(&scene), course)
            })
            .unwrap();
            let burnt = check(&samples, within);
            let all = burnt.iter().enumerate().flat_map(|(row, columns)| {
                let columns = columns.iter().enumerate();
                columns.map(move |(column, ticks)| (column, row, *ticks))
            });
            let missed: Vec<_> = all
                .filter(|(column, row, ticks)| *ticks == 0 && tone(*column, *row) != 255)
                .collect();
            assert!(missed.is_empty(), "{within} {percent}: {missed:?}");
        }
    }
}

/// Stopped in the middle of a list and played on by another client: nothing is left out, and nothing is burnt twice but the pixel of the tick.
#[test]
fn a_stopped_list_goes_on_at_the_very_place() {
    let folder = TempDir::new().unwrap();
    let scene = job(folder.path(), true);
    let units = trirrr_scene::units::<f32>(&scene).unwrap();
    let moves = offer::moves::<f32>(&scene, &units);
    let course = |stop| Course {
        percent: 100,
        holds: &[],
        stop,
    };
    let whole = local::with_machine_switched_on(&scene, |machine| {
        play(machine, &scene, work(&scene), course(None)).0
    });
    let whole = check(&whole.unwrap(), 1.0);
    for stop in [120, 333, 501] {
        let parts = local::with_machine_switched_on(&scene, |machine| {
            let (mut samples, place) = play(machine, &scene, work(&scene), course(Some(stop)));
            let period = scene.period_s() as f32;
            let place = place.expect("a place on the path");
            // The tool is off on the ramp of a stop: the job goes on where the stop was heard.
            let at = samples
                .iter()
                .rev()
                .find(|sample| sample.state.is_running());
            let at = at.expect("it ran");
            let from = JobPlace {
                index: at.number,
                at: at.at + 1,
            };
            assert!(from.index <= place.index);
            let rest = JobRest::listed(&moves, &scene.job.levels, from, period);
            // The way back to the place has the tool off.
            let (rest, _) = play(machine, &scene, rest.work(), course(None));
            samples.extend(rest.into_iter().skip_while(|sample| sample.tool == 0.0));
            samples
        });
        let burnt = check(&parts.unwrap(), 1.0);
        for (found, expected) in burnt.as_flattened().iter().zip(whole.as_flattened()) {
            assert!(found.abs_diff(*expected) <= 1, "{stop}: {burnt:?}");
        }
    }
}
