//! Plans a drawing of short lines, as a slicer or an engraver writes them: arcs cut into chords of 0.1 to 1 mm, corners
//! rounded by 10 um, with the dynamics of all seven bodies and limits of rate, acceleration and torque. Prints lines a
//! second on one core, and how near the plan comes to its bound. Then the same lines go through a window of 256 cells, which makes
//! the moves, too, and holds 64 pieces at a time. The arguments are the number of
//! lines, 1000 by default, and the gap between plan and bound, 0.005 by default.
//!
//! `cargo run --release -p trirrr-plan --example plan_segments -- 10000`

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{LinkParameters, Parameters, example};
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_core::torque::links::{Horizontal, Massive};
use trirrr_core::torque::payload::Centred;
use trirrr_plan::cell::Planner;
use trirrr_plan::corner::round_corners;
use trirrr_plan::course::{Effort, PathPiece, plan};
use trirrr_plan::piece::Piece;
use trirrr_plan::window::{Outlook, Window, WindowPiece, WindowSettings};
use trirrr_service::admission::Path;
use trirrr_service::paces::Ramp;

const LINES: usize = 1000;
const CORNER_M: f64 = 1e-5;
/// A hold takes a minute: the room for it is small.
const RAMP: f64 = 1.0 / 60.0;

type Machine = Dynamic<f64, Centred<f64>, Massive<f64, Horizontal>>;

/// The thesis machine with rods of 0.05 kg.
fn machine() -> Parameters {
    let mut parameters = example();
    for leg in &mut parameters.legs {
        leg.proximal = LinkParameters::uniform_rod(0.05, leg.proximal_m);
        leg.distal = LinkParameters::uniform_rod(0.05, leg.distal_m);
    }
    parameters
}

/// Chords of a curve that winds about the middle of the workspace; their lengths have no pattern.
fn drawing(lines: usize) -> Vec<PathPiece> {
    let at = |s: f64| {
        // Two turning arms: loops of 2 to 12 mm on a circle of 30 mm.
        let (slow, fast) = (s / 0.03, s / 0.0015);
        let arm = 0.004 + 0.002 * (0.37 * slow).sin();
        let x = 0.25 + 0.03 * slow.cos() + arm * fast.cos();
        let y = 0.28 + 0.03 * slow.sin() + arm * fast.sin();
        Pose::from_f64(x, y, 0.3)
    };
    let mut s = 0.0;
    let mut from: Pose<f64> = at(s);
    let line = |source: usize| {
        let part = (source as f64 * 0.618_033_988_7).fract();
        let ahead = from.displacement(&at(s + 1e-7));
        let speed = ahead.x.hypot(ahead.y) / 1e-7;
        s += 1e-4 * 10f64.powf(part) / speed;
        let to = at(s);
        let piece = Piece::line(from, to);
        from = to;
        PathPiece {
            piece,
            feed_m_s: Some(0.25),
            source,
            stops: false,
            setting: 0,
        }
    };
    (0..lines).map(line).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let lines = match std::env::args().nth(1) {
        Some(number) => number.parse()?,
        None => LINES,
    };
    let gap = match std::env::args().nth(2) {
        Some(number) => number.parse()?,
        None => Effort::default().gap,
    };
    let limits = LimitParameters {
        rate_rad_s: Some([5.0; 3]),
        acceleration_rad_s2: Some([100.0; 3]),
        torque_nm: Some([0.3; 3]),
        ..LimitParameters::default()
    };
    let planner = Planner::<Machine>::build(&machine(), Limits::build(&limits)?, RAMP)?;
    let drawing = drawing(lines);
    let lengths = || drawing.iter().map(|each| each.piece.length_m());
    let start = Instant::now();
    let pieces = round_corners(&drawing, CORNER_M);
    let rounded_s = start.elapsed().as_secs_f64();
    let effort = Effort {
        gap,
        ..Effort::default()
    };
    let plan = plan(&planner, &pieces, effort).map_err(|refusal| format!("{refusal:?}"))?;
    let seconds = start.elapsed().as_secs_f64();
    black_box(&plan);
    let cells: usize = plan.runs.iter().map(|run| run.cells.len()).sum();
    println!(
        "{lines} lines of {:.2} to {:.2} mm, {} pieces with rounded corners, {} stops, {cells} cells",
        1e3 * lengths().fold(f64::INFINITY, f64::min),
        1e3 * lengths().fold(0.0, f64::max),
        pieces.len(),
        plan.runs.len() - 1,
    );
    println!(
        "plan {:.4} s of motion, bound {:.4} s; computed in {seconds:.3} s, of which corners {rounded_s:.3} s: {:.0} lines a second",
        plan.duration_s(),
        plan.least_s(),
        lines as f64 / seconds,
    );
    let path = Path::<Machine>::build(
        &machine(),
        Limits::build(&limits)?,
        Ramp::within(100, None),
        1e-3,
    )?;
    let start = Instant::now();
    let (moves, motion_s) = through_window(&path, &pieces)?;
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "window: {motion_s:.4} s of motion in {moves} moves; computed in {seconds:.3} s: {:.0} lines a second",
        lines as f64 / seconds,
    );
    Ok(())
}

/// Number of the moves that a window makes of `pieces`, and their duration.
fn through_window(
    path: &Path<Machine>,
    pieces: &[PathPiece],
) -> Result<(usize, f64), Box<dyn Error>> {
    let settings = WindowSettings {
        period_s: 1e-3,
        ticks: 2,
        tolerance_m: CORNER_M,
        tolerance_rad: 1e-4,
        lever_m: 0.1,
        hold_rate: 0.0,
    };
    let start = pieces[0].piece.at(0.0).pose;
    let mut window = Box::new(Window::<f64, (), 64, 256>::new(settings.planning()));
    window.stand(start);
    let mut waiting = pieces.iter().peekable();
    let (mut moves, mut ticks) = (0, 0);
    while !window.is_done() || waiting.peek().is_some() {
        while window.room() > 0
            && let Some(each) = waiting.next()
        {
            let taken = window.push(WindowPiece {
                piece: each.piece,
                feed: each.feed_m_s,
                tag: (),
                number: 0,
            });
            if !taken {
                return Err(format!("{:?}", window.refusal()).into());
            }
        }
        if waiting.peek().is_none() {
            window.close();
        }
        match window.step(path) {
            Outlook::Working => {}
            Outlook::Waiting if window.room() > 0 => {}
            Outlook::Waiting => return Err(format!("stuck {moves}: {:?}", window.refusal()).into()),
            Outlook::Move(each) => {
                moves += 1;
                ticks += each.ticks;
                window.keep();
            }
        }
    }
    Ok((moves, f64::from(ticks) * settings.period_s))
}
