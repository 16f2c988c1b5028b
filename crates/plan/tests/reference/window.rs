//! Paths that come piece by piece: nearly as fast as those that are known as a whole.

use crate::judge::excess;
use crate::problems::{machine, path, problems};
use core::f64::consts::FRAC_PI_2;
use nalgebra::Vector2;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::Parameters;
use trirrr_core::model::{Dynamic, Model};
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::{Pose, Quintics};
use trirrr_core::torque::links::{Horizontal, Massive, Massless};
use trirrr_core::torque::payload::Centred;
use trirrr_plan::piece::Piece;
use trirrr_plan::window::{Outlook, Window, WindowMove, WindowPiece, WindowSettings};
use trirrr_service::admission::{Admission, Enclose, Path};
use trirrr_service::paces::Ramp;

/// Moves of so many ticks of 1 ms at least.
const fn settings(ticks: u32) -> WindowSettings {
    WindowSettings {
        period_s: 1e-3,
        ticks,
        tolerance_m: 1e-5,
        tolerance_rad: 1e-4,
        lever_m: 0.0,
        hold_rate: 0.0,
    }
}

/// Played moves, and how many were refused.
struct Played<N: Number> {
    moves: Vec<WindowMove<N, usize>>,
    refused: usize,
}

/// Plays `pieces` through a window, which gets a piece as soon as it has room, with the admission as the judge.
fn play<M: Model<N: Enclose<Bound = M::N>>, const CELLS: usize>(
    parameters: &Parameters,
    limits: &LimitParameters,
    settings: WindowSettings,
    pieces: &[Piece<f64>],
    feed: Option<f64>,
) -> Played<M::N> {
    let limits = Limits::build(limits).expect("limits");
    let bounds = limits.map(<M::N as Enclose>::bound);
    let ramp = Ramp::within(100, None);
    let path = Path::<M>::build(parameters, bounds, ramp, settings.period_s).expect("a machine");
    let mut admission = Admission::<M, Quintics>::over(path);
    let pieces: Vec<Piece<M::N>> = pieces.iter().map(Piece::over).collect();
    let start = pieces[0].at(M::N::ZERO).pose;
    let mut window = Box::new(Window::<M::N, usize, 16, CELLS>::new(settings.planning()));
    window.stand(start);
    let mut played = Played {
        moves: Vec::new(),
        refused: 0,
    };
    let mut next = 0;
    while !window.is_done() || next < pieces.len() {
        while next < pieces.len() && window.room() > 0 {
            let piece = WindowPiece {
                piece: pieces[next],
                feed: feed.map(M::N::from_f64),
                tag: next,
                number: next as u32,
            };
            assert!(window.push(piece), "{:?}", window.refusal());
            next += 1;
        }
        if next == pieces.len() {
            window.close();
        }
        match window.step(&path) {
            Outlook::Working => {}
            Outlook::Waiting => assert!(next < pieces.len(), "{:?}", window.refusal()),
            Outlook::Move(each) => match excess(&mut admission, &each.ends, each.ticks) {
                None => {
                    played.moves.push(each);
                    window.keep();
                }
                Some(by) => {
                    played.refused += 1;
                    window.cut(&path, by);
                }
            },
        }
    }
    assert_eq!(window.refusal(), None);
    tags_change_where_pieces_meet(&played.moves, &pieces, settings);
    played
}

/// A move ends within a step of time, and what rounding adds, from where a piece with another tag begins.
fn tags_change_where_pieces_meet<N: Number>(
    moves: &[WindowMove<N, usize>],
    pieces: &[Piece<N>],
    settings: WindowSettings,
) {
    for pair in moves.windows(2) {
        let [before, here] = [&pair[0], &pair[1]];
        if here.tag != before.tag + 1 {
            continue;
        }
        let meet = pieces[here.tag].at(N::ZERO).pose;
        let off = meet.displacement(&before.ends.to);
        let velocity = before.ends.velocities[1];
        let length = |x: N, y: N| x.to_f64().hypot(y.to_f64());
        let step_s = settings.period_s * f64::from(settings.ticks);
        let most = 1.1 * length(velocity.x, velocity.y) * step_s + 1e-3;
        assert!(length(off.x, off.y) <= most, "piece {}: {off:?}", here.tag);
    }
}

type WithLinks<N> = Dynamic<N, Centred<N>, Massive<N, Horizontal>>;
type WithoutLinks<N> = Dynamic<N, Centred<N>, Massless>;

fn near_the_least_times<N: Enclose<Bound = N>, const CELLS: usize>(ticks: u32, most: f64) {
    for problem in problems() {
        let pieces = path(&problem.name);
        let parameters = machine(problem.links);
        let play = match problem.links {
            true => play::<WithLinks<N>, CELLS>,
            false => play::<WithoutLinks<N>, CELLS>,
        };
        let played = play(
            &parameters,
            &problem.limits,
            settings(ticks),
            &pieces,
            problem.feed_m_s,
        );
        let ticks: u32 = played.moves.iter().map(|each| each.ticks).sum();
        let time = f64::from(ticks) * 1e-3;
        println!(
            "{:20} reference {:.5} played {time:.3} in {} moves, {} refused: {:.4} of the reference",
            problem.name,
            problem.time_s,
            played.moves.len(),
            played.refused,
            time / problem.time_s
        );
        assert!(time >= problem.time_s * (1.0 - 3e-5), "{}", problem.name);
        assert!(time <= problem.time_s * most, "{}", problem.name);
    }
}

#[test]
fn a_window_comes_near_the_least_times() {
    near_the_least_times::<f64, 128>(2, 1.02);
}

#[test]
fn a_window_of_a_board_comes_near_the_least_times() {
    near_the_least_times::<f32, 64>(3, 1.9);
}

/// A straight line, and an arc, at feeds from one at which the window sees a few hundredths of a second to one that is never reached: the motion
/// does not stand before the end, and takes the time of its feed.
#[test]
fn no_motion_stands_within_a_line() {
    let parameters = machine(true);
    let limits = LimitParameters {
        torque_nm: Some([0.3; 3]),
        rate_rad_s: Some([5.0; 3]),
        ..LimitParameters::default()
    };
    let pose = Pose::from_f64;
    let start = pose(0.25, 0.245, 0.4);
    let line = Piece::line(start, pose(0.29, 0.245, 0.4));
    let arc = Piece::arc(start, Vector2::new(0.25, 0.265), FRAC_PI_2, 0.4);
    for feed_mm_min in [1.0, 20.0, 100.0, 300.0, 3000.0, 15000.0] {
        for (pieces, length) in [([line], 0.04), ([arc], 0.02 * FRAC_PI_2)] {
            if feed_mm_min < 20.0 && length > 0.035 {
                continue;
            }
            let feed = feed_mm_min / 60e3;
            let play = play::<WithLinks<f32>, 48>;
            let played = play(&parameters, &limits, settings(4), &pieces, Some(feed));
            let speed = |each: &WindowMove<f32, usize>| {
                let velocity = each.ends.velocities[1];
                f64::from(velocity.x).hypot(f64::from(velocity.y))
            };
            let (_, before) = played.moves.split_last().expect("moves");
            let stands = before
                .iter()
                .filter(|each| speed(each) < 0.01 * feed)
                .count();
            let ticks: u32 = played.moves.iter().map(|each| each.ticks).sum();
            let time = f64::from(ticks) * 1e-3;
            println!(
                "{feed_mm_min} mm/min, {length:.4} m: {stands} stands, {time} s in {} moves, {:.3} of the time at the feed",
                played.moves.len(),
                time / (length / feed)
            );
        }
    }
}
