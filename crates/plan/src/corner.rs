//! Rounding of corners: a smooth curve takes the place of two pieces' ends.

use crate::course::{PathPiece, joint};
use crate::piece::{Piece, PlaneCurve};
use nalgebra::Vector3;

/// Largest part of a piece that is cut off at one end.
const CUT_MAX: f64 = 0.5;
/// Smallest part of a piece that is left between two curves; less is what rounding leaves.
const LEFT_MIN: f64 = 1e-6;
/// Cosine of the sharpest turn that is rounded; a path that turns back stops.
const SHARPEST: f64 = -0.98;
/// Greatest slight turn, rad.
const SLIGHT: f64 = 0.45;
/// Samples that a curve is compared with its corner by.
const SAMPLES: u32 = 32;

/// Returns `pieces` with each corner rounded that can be: D stays within `tolerance_m` of the path. The new pieces
/// take the feed and the number of the piece before.
pub fn round_corners(pieces: &[PathPiece], tolerance_m: f64) -> Vec<PathPiece> {
    let mut rounded: Vec<PathPiece> = Vec::with_capacity(2 * pieces.len());
    // Part of the next piece that the corner before has cut off.
    let mut begun = 0.0;
    for (index, each) in pieces.iter().enumerate() {
        let next = pieces.get(index + 1);
        let corner = next.filter(|next| joint(&each.piece, &next.piece).is_none());
        let curve = corner.and_then(|next| curve(&each.piece, &next.piece, tolerance_m));
        let (end, next_begun) =
            curve.map_or((1.0, 0.0), |curve| (1.0 - curve.cut[0], curve.cut[1]));
        // Two curves may leave nothing between them.
        if end - begun > LEFT_MIN {
            rounded.push(PathPiece {
                piece: match (begun, end) {
                    (0.0, 1.0) => each.piece,
                    _ => each.piece.part(begun, end),
                },
                ..*each
            });
        }
        rounded.extend(curve.map(|curve| PathPiece {
            piece: curve.piece,
            ..*each
        }));
        begun = next_begun;
    }
    rounded
}

/// A curve around a corner.
#[derive(Clone, Copy)]
struct Curve {
    piece: Piece<f64>,
    /// Parts cut off from the end of the piece before and from the start of the one after.
    cut: [f64; 2],
}

fn speed(v: Vector3<f64>) -> f64 {
    v.x.hypot(v.y)
}

/// The longest curve within the tolerance. At a sharp turn it is a cubic whose inner control poses lie on the two
/// tangents, at the corner where both pieces are straight: its curvature is then zero at both ends. It deviates by a
/// quarter of the length cut off times the sine of half the turn. At a slight turn they lie at two thirds of the way: a
/// parabola, whose parameter is nearly the length, so that few cells plan it well. It deviates by half of that length.
fn curve(before: &Piece<f64>, after: &Piece<f64>, tolerance_m: f64) -> Option<Curve> {
    let (a, b) = (before.at(1.0).first, after.at(0.0).first);
    let (speed_a, speed_b) = (speed(a), speed(b));
    let (along, across) = (a.xy().dot(&b.xy()), a.xy().perp(&b.xy()));
    // A speed is 0 where D stands on one side.
    if !(along > SHARPEST * speed_a * speed_b) {
        return None;
    }
    let turn = across.abs().atan2(along);
    let half_sine = (0.5 * turn).sin();
    let slight = turn < SLIGHT;
    let straight = [before, after]
        .iter()
        .all(|piece| matches!(piece.curve, PlaneCurve::Line { .. }));
    let (reach, deviating) = match slight {
        false => (1.0, 0.25 * half_sine),
        true => (2.0 / 3.0, 0.5 * half_sine),
    };
    let mut length = (tolerance_m / deviating)
        .min(CUT_MAX * speed_a)
        .min(CUT_MAX * speed_b);
    for _ in 0..32 {
        let cut = [length / speed_a, length / speed_b];
        let (from, to) = (before.at(1.0 - cut[0]), after.at(cut[1]));
        let piece = Piece::bezier([
            from.pose,
            from.pose.displaced(from.first * (reach * cut[0])),
            to.pose.displaced(-(to.first * (reach * cut[1]))),
            to.pose,
        ]);
        // Between straight pieces the length is exact.
        if straight || deviation(&piece, before, after, cut) <= tolerance_m {
            return Some(Curve { piece, cut });
        }
        length *= 0.8;
    }
    None
}

/// Greatest distance of `curve` from the ends that it replaces, by samples.
fn deviation(curve: &Piece<f64>, before: &Piece<f64>, after: &Piece<f64>, cut: [f64; 2]) -> f64 {
    let parts = || (0..=SAMPLES).map(|i| f64::from(i) / f64::from(SAMPLES));
    let replaced: Vec<_> = parts()
        .map(|part| before.at(1.0 - cut[0] * (1.0 - part)))
        .chain(parts().map(|part| after.at(cut[1] * part)))
        .collect();
    let farthest = parts().map(|part| {
        let pose = curve.at(part).pose;
        let distances = replaced.iter().map(|point| {
            let off = point.pose.displacement(&pose);
            // Between two samples: the distance from the tangent.
            let along = point.first.xy() / speed(point.first);
            let reach = 2.0 * cut[0].max(cut[1]) * speed(point.first) / f64::from(SAMPLES);
            match off.xy().dot(&along).abs() <= reach {
                true => off.xy().perp(&along).abs(),
                false => speed(off),
            }
        });
        distances.fold(f64::INFINITY, f64::min)
    });
    farthest.fold(0.0, f64::max)
}
