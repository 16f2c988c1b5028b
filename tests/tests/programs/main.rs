//! Programs of G-code as the trajectory tests of LinuxCNC have them (lines and arcs that meet in every way, at every feed and
//! tolerance), written anew: 13 kinds with 13 parameters each. Each is read and planned as `trirrr run` does, and judged by the
//! independent model: every limit at several instants of every tick, the feed, the place, the length.

mod families;
mod program;

use families::{KINDS, PARAMETERS, program};
use program::Program;
use std::fs;
use std::path::Path;
use trirrr_core::setpoint::Pose;
use trirrr_host_sim::job_file::{JobFileArgs, read_job};
use trirrr_scene::{JobMove, Scene};
use trirrr_tests::instant::{Instant, QuinticEnds, State};

/// Zero point of the programs, mm.
const ORIGIN_MM: [f64; 2] = [250.0, 300.0];

/// Largest parts of limits and of the feed that a program takes, and its duration, s.
struct Worst {
    limit: f64,
    feed: f64,
    seconds: f64,
    /// Expectations that do not hold.
    faults: Vec<String>,
}

fn scene_of(text: &str, name: &str) -> Result<Scene, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("programs");
    fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join(format!("{name}.ngc"));
    fs::write(&file, text).expect("a file");
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/engraving.toml");
    let args = JobFileArgs {
        machine: Some(machine),
        origin: Some([ORIGIN_MM[0], ORIGIN_MM[1], 0.0]),
        ..JobFileArgs::default()
    };
    read_job(&file, &args).map_err(|error| format!("{error}\n{text}"))
}

/// Ends of a move in the numbers that a service in binary32 gets.
fn ends(each: &JobMove, period_s: f64) -> QuinticEnds {
    let rounded = |value: f64| f64::from(value as f32);
    let pose = |pose: &Pose<f64>| [pose.position.x, pose.position.y, pose.angle].map(rounded);
    let [start, end] = each.accelerations.expect("a planned move");
    let state = |pose, velocity: [f64; 3], acceleration: [f64; 3]| State {
        pose,
        velocity: velocity.map(rounded),
        acceleration: acceleration.map(rounded),
    };
    QuinticEnds {
        states: [
            state(pose(&each.from), each.start_velocity.into(), start.into()),
            state(pose(&each.to), each.end_velocity.into(), end.into()),
        ],
        duration_s: f64::from(each.duration_ticks) * period_s,
    }
}

/// Judges a program at so many instants of each tick.
fn judge(program: &Program, name: &str, instants: u32) -> Worst {
    let mut worst = Worst {
        limit: 0.0,
        feed: 0.0,
        seconds: 0.0,
        faults: Vec::new(),
    };
    let scene = match scene_of(&program.text, name) {
        Ok(scene) => scene,
        Err(refused) => {
            worst.faults.push(refused);
            return worst;
        }
    };
    let period_s = scene.period_s();
    let moves = &scene.job.moves;
    let at_rest = State {
        pose: ends(&moves[0], period_s).states[0].pose,
        ..State::default()
    };
    let side = Instant::kinematics(&scene.parameters, &at_rest).side;
    let mut length_m = 0.0;
    let works = |each: &JobMove| each.tool.is_some_and(|tool| tool.power > 0.0);
    for (index, each) in moves.iter().enumerate() {
        let ends = ends(each, period_s);
        let count = instants * each.duration_ticks;
        // The tool changes within half a tick of the place: there the machine may come from a rapid.
        let is_near = |other: Option<usize>| {
            other
                .and_then(|other| moves.get(other))
                .is_some_and(|other| !works(other))
        };
        let first = if is_near(index.checked_sub(1)) {
            instants
        } else {
            0
        };
        let last = if is_near(Some(index + 1)) {
            count.saturating_sub(instants)
        } else {
            count
        };
        for instant in 0..=count {
            let state = ends.at(f64::from(instant) / f64::from(count));
            let found = Instant::of(&scene.parameters, &state);
            worst.limit = worst.limit.max(found.part_of(&scene.limits, side));
            let speed = state.velocity[0].hypot(state.velocity[1]);
            if works(each) {
                if (first..=last).contains(&instant) {
                    worst.feed = worst.feed.max(speed / program.fastest_m_s);
                }
                let share = if instant == 0 || instant == count {
                    0.5
                } else {
                    1.0
                };
                length_m += share * speed * ends.duration_s / f64::from(count);
            }
        }
        worst.seconds += ends.duration_s;
    }
    let last = moves[moves.len() - 1].to;
    let place = [0, 1].map(|axis| 1e-3 * (ORIGIN_MM[axis] + program.at[axis]));
    let off = (last.position.x - place[0]).hypot(last.position.y - place[1]);
    let turned = last.angle - scene.job.start.angle - program.turned_deg.to_radians();
    // Corners are rounded: by as much as is asked for at each, at most.
    let least = 1e-3 * program.cut_mm - program.rounded_m;
    let most = 1e-3 * program.cut_mm * (1.0 + 1e-4) + 1e-5;
    let seconds = worst.seconds;
    let mut expect = |holds: bool, what: String| {
        if !holds {
            worst
                .faults
                .push(format!("{name}: {what}\n{}", program.text));
        }
    };
    expect(off < 1e-6, format!("ends {off} m off"));
    expect(
        turned.abs() < 1e-5,
        format!("has turned {turned} rad too far"),
    );
    expect(
        (least..most).contains(&length_m),
        format!("{length_m} m are worked, not {least} to {most}"),
    );
    expect(
        seconds >= program.least_s * (1.0 - 1e-3) - 0.02,
        format!("takes {seconds} s, at the feeds {}", program.least_s),
    );
    worst
}

fn study(numbers: impl Iterator<Item = usize> + Send, instants: u32) {
    let numbers: Vec<usize> = numbers.collect();
    let halves: Vec<_> = numbers.chunks(numbers.len().div_ceil(2)).collect();
    let found: Vec<(usize, Worst)> = std::thread::scope(|scope| {
        let halves: Vec<_> = halves
            .into_iter()
            .map(|half| {
                scope.spawn(move || -> Vec<_> {
                    let judged = half.iter().map(|&number| {
                        let (kind, parameter) = (number / PARAMETERS, number % PARAMETERS);
                        let name = format!("{}-{parameter}", KINDS[kind]);
                        (number, judge(&program(kind, parameter), &name, instants))
                    });
                    judged.collect()
                })
            })
            .collect();
        halves
            .into_iter()
            .flat_map(|half| half.join().expect("no panic"))
            .collect()
    });
    println!("| kind | programs | motion, s | largest part of a limit | of the feed |");
    println!("|---|---:|---:|---:|---:|");
    for (kind, name) in KINDS.iter().enumerate() {
        let own: Vec<&Worst> = found
            .iter()
            .filter(|(number, _)| number / PARAMETERS == kind)
            .map(|(_, worst)| worst)
            .collect();
        if own.is_empty() {
            continue;
        }
        let most = |of: fn(&Worst) -> f64| own.iter().map(|worst| of(worst)).fold(0.0, f64::max);
        println!(
            "| {name} | {} | {:.1} | {:.6} | {:.6} |",
            own.len(),
            own.iter().map(|worst| worst.seconds).sum::<f64>(),
            most(|worst| worst.limit),
            most(|worst| worst.feed),
        );
    }
    let faults: Vec<&String> = found.iter().flat_map(|(_, worst)| &worst.faults).collect();
    for fault in &faults {
        println!("{fault}");
    }
    assert!(faults.is_empty(), "{} do not hold", faults.len());
    for (number, worst) in &found {
        assert!(worst.limit <= 1.0, "{number}: {}", worst.limit);
        assert!(worst.feed <= 1.0 + 1e-6, "{number}: {}", worst.feed);
    }
}

#[test]
fn a_share_of_the_programs_keeps_limits_feeds_and_places() {
    study((0..KINDS.len() * PARAMETERS).step_by(9), 2);
}

/// `cargo test --release -p trirrr-tests --test programs -- --ignored --nocapture`
#[test]
#[ignore = "long: part of `cargo xtask nightly`"]
fn all_programs_keep_limits_feeds_and_places() {
    study(0..KINDS.len() * PARAMETERS, 8);
}
