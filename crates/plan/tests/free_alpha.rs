//! alpha chosen by the planner, compared with every constant alpha.

use nalgebra::Vector2;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_plan::alpha::{FreePath, Sampler, choose_alpha};
use trirrr_plan::cell::{Obstacle, Planner};
use trirrr_plan::course::{Effort, PathPiece, PathRefusal, plan};
use trirrr_plan::piece::Piece;

type Machine = Dynamic<f64>;

/// Length of a leg of the example, stretched.
const REACH_M: f64 = 0.4;

/// Rates and torques of the example, and distances from singularities.
fn limits([serial, parallel]: [f64; 2]) -> Limits<f64> {
    let parameters = LimitParameters {
        rate_rad_s: Some([5.0; 3]),
        torque_nm: Some([0.3; 3]),
        serial_distance_min: serial,
        parallel_distance_min: parallel,
        ..LimitParameters::default()
    };
    Limits::build(&parameters).expect("limits")
}

fn path_pieces(pieces: Vec<Piece<f64>>) -> Vec<PathPiece> {
    let piece = |(source, piece)| PathPiece {
        piece,
        feed_m_s: None,
        source,
        stops: false,
        setting: 0,
    };
    pieces.into_iter().enumerate().map(piece).collect()
}

fn line(from: [f64; 2], to: [f64; 2], alpha: f64) -> Piece<f64> {
    Piece::line(
        Pose::from_f64(from[0], from[1], alpha),
        Pose::from_f64(to[0], to[1], alpha),
    )
}

fn circle(alpha: f64) -> Piece<f64> {
    let start = Pose::from_f64(0.3, 0.29, alpha);
    Piece::arc(
        start,
        Vector2::new(0.25, 0.29),
        core::f64::consts::TAU,
        alpha,
    )
}

/// An L, an arc that goes on from it, and a Bezier curve behind a corner.
fn corners(alpha: f64) -> Vec<Piece<f64>> {
    let pose = |x, y| Pose::from_f64(x, y, alpha);
    let down = line([0.22, 0.25], [0.28, 0.25], alpha);
    let arc = Piece::arc(down.end(), Vector2::new(0.28, 0.28), 1.5, alpha);
    let curve = [pose(0.33, 0.3), pose(0.2, 0.33), pose(0.22, 0.27)];
    let curve = Piece::bezier([arc.end(), curve[0], curve[1], curve[2]]);
    vec![down, arc, curve]
}

fn chosen(
    pieces: &[PathPiece],
    ends: &[Option<f64>],
    limits: Limits<f64>,
) -> Result<Vec<PathPiece>, PathRefusal> {
    let planner = Planner::<Machine>::build(&example(), limits, 0.0).expect("a machine");
    let sampler = Sampler::<Machine>::build(&example(), limits, 0.0).expect("a machine");
    let path = FreePath::new(pieces, ends, None);
    choose_alpha(&planner, &sampler, &path, REACH_M)
}

/// Duration, and the number of runs.
fn planned(pieces: &[PathPiece], limits: Limits<f64>) -> Result<(f64, usize), PathRefusal> {
    let planner = Planner::<Machine>::build(&example(), limits, 0.0).expect("a machine");
    let plan = plan(&planner, pieces, Effort::default())?;
    Ok((plan.duration_s(), plan.runs.len()))
}

/// Plans are within half a percent of the optimum along their path, so that a faster one may look slower by that.
const GAP: f64 = 0.005;

#[test]
fn a_chosen_alpha_is_not_slower_than_any_constant_one() {
    let limits = limits([0.1, 0.2]);
    type Path = fn(f64) -> Vec<Piece<f64>>;
    let paths: [(&str, Path); 3] = [
        ("line", |alpha| {
            vec![line([0.21, 0.22], [0.28, 0.28], alpha)]
        }),
        ("circle", |alpha| vec![circle(alpha)]),
        ("corners", corners),
    ];
    for (name, path) in paths {
        let constant = |alpha: f64| {
            let time = planned(&path_pieces(path(alpha)), limits);
            time.map_or(f64::INFINITY, |(time, _)| time)
        };
        let alphas = (-10..=20).map(|step| 0.1 * f64::from(step));
        let best = alphas.min_by(|a, b| constant(*a).total_cmp(&constant(*b)));
        let best = best.expect("an alpha");
        for start in [best, 0.4] {
            let pieces = path_pieces(path(start));
            let free = chosen(&pieces, &vec![None; pieces.len()], limits).expect("a choice");
            assert_eq!(free[0].piece.angle, start);
            let (time, runs) = planned(&free, limits).expect("a plan");
            let (as_given, given_runs) = planned(&pieces, limits).expect("a plan");
            println!(
                "{name} from alpha {start:.1}: chosen {time:.5} s, constant {as_given:.5} s, best constant {:.5} s",
                constant(best)
            );
            assert!(time <= as_given * (1.0 + GAP), "{name} {start}");
            // alpha makes no corner of its own.
            assert_eq!(runs, given_runs, "{name}");
            for pair in free.windows(2) {
                let off = pair[0]
                    .piece
                    .end()
                    .displacement(&pair[1].piece.at(0.0).pose);
                assert!(off.amax() < 1e-12, "{name}: {off:?}");
            }
        }
    }
    // A path on which the platform's angle counts.
    let pieces = path_pieces(vec![line([0.21, 0.22], [0.28, 0.28], 0.4)]);
    let free = chosen(&pieces, &[None], limits).expect("a choice");
    let times = [&free, &pieces].map(|pieces| planned(pieces, limits).expect("a plan").0);
    assert!(times[0] < 0.9 * times[1], "{times:?}");
}

/// No constant alpha keeps the distances along the whole line; a changing one does.
#[test]
fn a_path_beyond_every_constant_alpha_is_planned() {
    let limits = limits([0.2, 0.3]);
    let path = |alpha| path_pieces(vec![line([0.104, 0.3], [0.396, 0.3], alpha)]);
    for step in -160..=160 {
        let alpha = 0.02 * f64::from(step);
        assert!(planned(&path(alpha), limits).is_err(), "alpha {alpha}");
    }
    let free = chosen(&path(-0.18), &[None], limits).expect("a choice");
    planned(&free, limits).expect("a plan");
}

#[test]
fn alpha_is_kept_where_it_is_given() {
    let limits = limits([0.1, 0.2]);
    let pieces = path_pieces(corners(0.4));
    let free = chosen(&pieces, &[None, Some(0.55), Some(0.2)], limits).expect("a choice");
    let at_end = |source| {
        let last = free.iter().rfind(|each| each.source == source);
        last.map(|each| each.piece.end().angle).expect("a piece")
    };
    assert!((at_end(1) - 0.55).abs() < 1e-12);
    assert!((at_end(2) - 0.2).abs() < 1e-12);
    // Where D stands alpha turns as given, from what is given.
    let turn = Piece::line(
        Pose::from_f64(0.28, 0.25, 0.4),
        Pose::from_f64(0.28, 0.25, 0.7),
    );
    let behind = line([0.28, 0.25], [0.28, 0.3], 0.7);
    let pieces = path_pieces(vec![line([0.22, 0.25], [0.28, 0.25], 0.4), turn, behind]);
    let free = chosen(&pieces, &[None, Some(0.7), None], limits).expect("a choice");
    let index = free
        .iter()
        .position(|each| each.source == 1)
        .expect("a turn");
    assert_eq!(free[index].piece, turn);
    assert!((free[index - 1].piece.end().angle - 0.4).abs() < 1e-12);
    assert_eq!(free[index + 1].piece.angle, 0.7);
    planned(&free, limits).expect("a plan");
}

#[test]
fn a_place_that_no_alpha_passes_is_named() {
    let pieces = path_pieces(vec![
        line([0.22, 0.25], [0.28, 0.25], 0.4),
        line([0.28, 0.25], [0.9, 0.25], 0.4),
    ]);
    let refusal = chosen(&pieces, &[None; 2], limits([0.1, 0.2])).expect_err("out of reach");
    assert_eq!(refusal.place.piece, 1);
    let x = refusal.pose.position.x;
    assert!(x > 0.3 && x < 0.9, "{refusal:?}");
    assert!(matches!(
        refusal.obstacle,
        Obstacle::Reach(_) | Obstacle::SerialDistance(_) | Obstacle::ParallelDistance
    ));
}
