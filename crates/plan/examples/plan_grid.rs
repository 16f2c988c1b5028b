//! Plans three paths of the thesis machine on uniform grids: prints for each the time that planning takes, the duration and
//! its lower bound, and writes the limits at the marks of the grid for other planners. The argument is a folder.
//! `lab/toppra/compare.py` runs it.
//!
//! `cargo run --release -p trirrr-plan --example plan_grid -- /tmp/grids`

use nalgebra::{Vector2, Vector3};
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{LinkParameters, example};
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{Horizontal, Massive};
use trirrr_core::torque::payload::Centred;
use trirrr_plan::bound::least_time;
use trirrr_plan::cell::{Measured, Planner};
use trirrr_plan::passes::{controllable, duration, fastest};
use trirrr_plan::piece::Piece;

type Machine = Dynamic<f64, Centred<f64>, Massive<f64, Horizontal>>;

const RATE: f64 = 5.0;
const ACCELERATION: f64 = 60.0;
const TORQUE: f64 = 0.3;
const RUNS: usize = 21;

/// Seconds of a planning, the duration that it finds, and the bound.
fn planned(
    planner: &Planner<Machine>,
    piece: &Piece<f64>,
    count: usize,
) -> Result<[f64; 3], Box<dyn Error>> {
    let start = Instant::now();
    let models = piece.models();
    let mut side = None;
    let mark = |index: usize| index as f64 / count as f64;
    let measured = (0..count)
        .map(|index| planner.measure(&models, [mark(index), mark(index + 1)], None, &mut side))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|obstacle| format!("{obstacle:?}"))?;
    let cells: Vec<_> = measured.iter().map(Measured::cell).collect();
    let mut squares = vec![0.0; count + 1];
    controllable(&cells, 0.0, &mut squares);
    fastest(&cells, 0.0, &mut squares);
    let duration_s = duration(&cells, &squares);
    let seconds = start.elapsed().as_secs_f64();
    let (mut times, mut most) = (vec![0.0; count + 1], vec![0.0; count + 1]);
    let possible: Vec<_> = measured.iter().map(Measured::possible).collect();
    let least_s = least_time(&cells, &possible, [0.0, 0.0], &mut times, &mut most);
    Ok([seconds, duration_s, least_s])
}

/// At each mark, for each motor: rate, then acceleration and torque for a = 1, for x = 1 and at rest.
fn limits_at_marks(
    tick: &Tick<Machine>,
    piece: &Piece<f64>,
    count: usize,
) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    for index in 0..=count {
        let p = index as f64 / count as f64;
        let point = piece.at(p);
        let at = |velocity, acceleration| {
            tick.evaluate(&Setpoint {
                pose: point.pose,
                velocity,
                acceleration,
            })
            .map_err(|status| format!("{status:?}"))
        };
        let rest = Vector3::zeros();
        let (moving, starting) = (at(point.first, point.second)?, at(rest, point.first)?);
        let resting = at(rest, rest)?;
        let _ = write!(text, "{p}");
        for motor in 0..3 {
            let [m, s, r] = [&moving, &starting, &resting].map(|motion| motion.motors[motor]);
            let _ = write!(
                text,
                ",{:e},{:e},{:e},{:e},{:e}",
                m.rate,
                m.acceleration,
                s.torque - r.torque,
                m.torque - r.torque,
                r.torque
            );
        }
        text.push('\n');
    }
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map(PathBuf::from);
    let mut machine = example();
    for leg in &mut machine.legs {
        leg.proximal = LinkParameters::uniform_rod(0.05, leg.proximal_m);
        leg.distal = LinkParameters::uniform_rod(0.05, leg.distal_m);
    }
    let limits = LimitParameters {
        rate_rad_s: Some([RATE; 3]),
        acceleration_rad_s2: Some([ACCELERATION; 3]),
        torque_nm: Some([TORQUE; 3]),
        ..LimitParameters::default()
    };
    let planner = Planner::<Machine>::build(&machine, Limits::build(&limits)?, 0.0)?;
    let tick = Tick::<Machine>::build(&machine)?;
    let pose = Pose::from_f64;
    let paths = [
        (
            "line",
            Piece::line(pose(0.21, 0.22, 0.157), pose(0.28, 0.28, 0.209)),
        ),
        (
            "circle",
            Piece::arc(
                pose(0.3, 0.29, 0.4),
                Vector2::new(0.25, 0.29),
                core::f64::consts::TAU,
                0.4,
            ),
        ),
        (
            "bezier",
            Piece::bezier([
                pose(0.2, 0.25, 0.2),
                pose(0.2, 0.35, 0.2),
                pose(0.3, 0.2, 0.5),
                pose(0.3, 0.32, 0.5),
            ]),
        ),
    ];
    println!("path,cells,seconds,duration_s,least_s");
    for (name, piece) in &paths {
        for count in [50, 100, 500] {
            let mut runs = (0..RUNS)
                .map(|_| planned(&planner, piece, count))
                .collect::<Result<Vec<_>, _>>()?;
            runs.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let [seconds, duration_s, least_s] = runs[RUNS / 2];
            println!("{name},{count},{seconds:e},{duration_s:.6},{least_s:.6}");
            if let Some(folder) = &folder {
                fs::create_dir_all(folder)?;
                let file = folder.join(format!("{name}-{count}.csv"));
                fs::write(file, limits_at_marks(&tick, piece, count)?)?;
            }
        }
    }
    Ok(())
}
