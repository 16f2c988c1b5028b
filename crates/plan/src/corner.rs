//! Rounding of corners: a smooth curve takes the place of two pieces' ends.

use crate::path::PathPiece;
use crate::piece::{Piece, PlaneCurve};
use nalgebra::Vector3;
use trirrr_core::setpoint::Pose;

/// Largest part of a piece that is cut off at one end.
const CUT_MAX: f64 = 0.5;
/// Smallest part of a piece that is left between two curves; less is what rounding leaves.
const LEFT_MIN: f64 = 1e-6;
/// Cosine of the sharpest turn that is rounded; a path that turns back stops.
const SHARPEST: f64 = -0.98;
/// Greatest slight turn, rad.
const SLIGHT: f64 = 0.45;
/// Shortest length that is cut off, m: less is the rounding of a place at which D stands.
const CUT_MIN_M: f64 = 1e-9;
/// Most of the length that a curve is to replace of a curved piece: its parameter is not the length.
const FASTER: f64 = 1.5;
/// Samples of a piece among which the nearest place is looked for.
const SAMPLES: u32 = 32;
/// Part of the tolerance that a curve may use where it is looked at.
const SAMPLED: f64 = 0.99;
/// Way between two places, in tolerances, that is not looked at.
const FINEST: f64 = 0.01;
/// Steps towards the nearest place.
const STEPS: u32 = 4;

/// Returns `pieces` with each corner rounded that can be: D stays within `tolerance_m` of the path, and so does the place where the tool's
/// setting changes along the path. A new piece takes feed, number and setting of the piece before; where the setting changes, there is one for
/// each half of the curve, and the second takes those of the piece behind.
pub fn round_corners(pieces: &[PathPiece], tolerance_m: f64) -> Vec<PathPiece> {
    let mut rounded = Vec::with_capacity(2 * pieces.len());
    let mut corners = CornerRounding::new(tolerance_m);
    for each in pieces {
        corners.push(*each, |piece| rounded.push(piece));
    }
    corners.finish(|piece| rounded.push(piece));
    rounded
}

/// Rounds the corners of a path as its pieces come, as [`round_corners`] does. It holds one piece back.
#[derive(Clone, Debug)]
pub struct CornerRounding {
    tolerance_m: f64,
    /// Last piece, whose end depends on the next one.
    held: Option<PathPiece>,
    /// Part of it that the corner before has cut off.
    begun: f64,
}

impl CornerRounding {
    /// Begins a path, with D within `tolerance_m` of it. 0: the pieces stay as they are.
    pub fn new(tolerance_m: f64) -> Self {
        Self {
            tolerance_m,
            held: None,
            begun: 0.0,
        }
    }

    /// Adds the next piece, and hands what is before it to `take`.
    pub fn push(&mut self, next: PathPiece, take: impl FnMut(PathPiece)) {
        if let Some(each) = self.held.replace(next) {
            // Where the motion stops anyway, the path is left as it is.
            let is_corner = self.tolerance_m > 0.0 && !next.stops && next.joint(&each).is_none();
            let changes = next.setting != each.setting;
            let longest_m = match changes {
                true => self.tolerance_m,
                false => f64::INFINITY,
            };
            let curve = match is_corner {
                true => curve(&each.piece, &next.piece, self.tolerance_m, longest_m),
                false => None,
            };
            self.release(
                &each,
                curve.map(|curve| (curve, changes.then_some(next))),
                take,
            );
        }
    }

    /// Ends the path, and hands its last piece to `take`.
    pub fn finish(mut self, take: impl FnMut(PathPiece)) {
        if let Some(last) = self.held.take() {
            self.release(&last, None, take);
        }
    }

    /// Hands out `each`, and the curve behind it, whose second half is as the other piece, if there is one.
    fn release(
        &mut self,
        each: &PathPiece,
        curve: Option<(Curve, Option<PathPiece>)>,
        mut take: impl FnMut(PathPiece),
    ) {
        let (end, next_begun) =
            curve.map_or((1.0, 0.0), |(curve, _)| (1.0 - curve.cut[0], curve.cut[1]));
        let begun = std::mem::replace(&mut self.begun, next_begun);
        // Two curves may leave nothing between them.
        if end - begun > LEFT_MIN {
            take(PathPiece {
                piece: match (begun, end) {
                    (0.0, 1.0) => each.piece,
                    _ => each.piece.part(begun, end),
                },
                stops: each.stops && begun == 0.0,
                ..*each
            });
        }
        let mut on_curve = |piece: Piece<f64>, like: &PathPiece| {
            take(PathPiece {
                piece,
                stops: false,
                ..*like
            });
        };
        match curve {
            Some((Curve { piece, .. }, None)) => on_curve(piece, each),
            Some((Curve { piece, .. }, Some(next))) => {
                on_curve(piece.part(0.0, 0.5), each);
                on_curve(piece.part(0.5, 1.0), &next);
            }
            None => {}
        }
    }
}

/// A curve around a corner.
#[derive(Clone, Copy)]
struct Curve {
    piece: Piece<f64>,
    /// Parts cut off from the end of the piece before and from the start of the one after.
    cut: [f64; 2],
}

fn speed(v: Vector3<f64>) -> f64 {
    libm::hypot(v.x, v.y)
}

/// The longest curve within the tolerance that replaces no more than `longest_m` of each piece. At a sharp turn it is a cubic whose inner control poses lie on the two
/// tangents, at the corner where both pieces are straight: its curvature is then zero at both ends. It deviates by a
/// quarter of the length cut off times the sine of half the turn. At a slight turn they lie at two thirds of the way: a
/// parabola, whose parameter is nearly the length, so that few cells plan it well. It deviates by half of that length.
fn curve(
    before: &Piece<f64>,
    after: &Piece<f64>,
    tolerance_m: f64,
    longest_m: f64,
) -> Option<Curve> {
    let (a, b) = (before.at(1.0).first, after.at(0.0).first);
    let (speed_a, speed_b) = (speed(a), speed(b));
    let (along, across) = (a.xy().dot(&b.xy()), a.xy().perp(&b.xy()));
    // A speed is 0 where D stands on one side.
    if !(along > SHARPEST * speed_a * speed_b) {
        return None;
    }
    let turn = libm::atan2(across.abs(), along);
    let half_sine = libm::sin(0.5 * turn);
    let slight = turn < SLIGHT;
    let straight = [before, after]
        .iter()
        .all(|piece| matches!(piece.curve, PlaneCurve::Line { .. }));
    let (reach, deviating) = match slight {
        false => (1.0, 0.25 * half_sine),
        true => (2.0 / 3.0, 0.5 * half_sine),
    };
    // Behind the end of a curved piece its parameter may go faster.
    let faster = if straight { 1.0 } else { FASTER };
    let mut length = (tolerance_m / deviating)
        .min(longest_m / faster)
        .min(CUT_MAX * speed_a)
        .min(CUT_MAX * speed_b);
    if !(length > CUT_MIN_M) {
        return None;
    }
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
        let rounding = Rounding {
            curve: &piece,
            before,
            after,
            cut,
        };
        let [corner, behind] = [before.at(1.0).pose, after.at(0.0).pose];
        let chords = [
            from.pose.displacement(&corner),
            behind.displacement(&to.pose),
        ];
        let is_near = chords
            .into_iter()
            .all(|chord| speed(chord) <= faster * length);
        if straight || is_near && rounding.stays(SAMPLED * tolerance_m) {
            return Some(Curve { piece, cut });
        }
        length *= 0.8;
    }
    None
}

/// A curve beside the pieces whose ends it replaces.
struct Rounding<'a> {
    curve: &'a Piece<f64>,
    before: &'a Piece<f64>,
    after: &'a Piece<f64>,
    cut: [f64; 2],
}

impl Rounding<'_> {
    /// Returns true if D stays within `most_m` of the path everywhere on the curve.
    fn stays(&self, most_m: f64) -> bool {
        let [a, b, c, d] = self.curve.controls();
        let legs = [(a, b), (b, c), (c, d)].map(|(from, to)| speed(from.displacement(&to)));
        let fastest = 3.0 * legs.into_iter().fold(0.0, f64::max);
        let [start, end] = [0.0, 1.0].map(|p| [p, self.distance(p)]);
        self.stays_between([start, end], fastest, most_m)
    }

    /// The same between two places, each with its distance: on a way of that length it grows by half of the way at most, beyond
    /// the mean of the two.
    fn stays_between(&self, [from, to]: [[f64; 2]; 2], fastest: f64, most_m: f64) -> bool {
        let way = fastest * (to[0] - from[0]);
        if !(from[1] <= most_m && to[1] <= most_m) {
            return false;
        }
        if from[1] + to[1] + way <= 2.0 * most_m || way <= FINEST * most_m {
            return true;
        }
        let p = 0.5 * (from[0] + to[0]);
        let middle = [p, self.distance(p)];
        let between = |ends| self.stays_between(ends, fastest, most_m);
        between([from, middle]) && between([middle, to])
    }

    /// Distance of the curve at `p` from the path.
    fn distance(&self, p: f64) -> f64 {
        let pose = self.curve.at(p).pose;
        let parts = || (0..=SAMPLES).map(|i| f64::from(i) / f64::from(SAMPLES));
        let before = parts().map(|part| 1.0 - self.cut[0] * part);
        let after = parts().map(|part| self.cut[1] * part);
        nearest(self.before, before, &pose).min(nearest(self.after, after, &pose))
    }
}

/// Distance of D at `pose` from the place `p` of `piece`.
fn distance(piece: &Piece<f64>, p: f64, pose: &Pose<f64>) -> f64 {
    speed(piece.at(p).pose.displacement(pose))
}

/// Distance of D at `pose` from the place of `piece` nearest to it, about the nearest one of `places`.
fn nearest(piece: &Piece<f64>, places: impl Iterator<Item = f64>, pose: &Pose<f64>) -> f64 {
    let begun = places.map(|p| (distance(piece, p, pose), p));
    let nearer = |a: (f64, f64), b: (f64, f64)| if b.0 < a.0 { b } else { a };
    let (mut least, mut p) = begun.fold((f64::INFINITY, 0.0), nearer);
    for _ in 0..STEPS {
        let point = piece.at(p);
        let off = point.pose.displacement(pose).xy();
        let along = point.first.xy();
        p = (p + off.dot(&along) / along.dot(&along)).clamp(0.0, 1.0);
        least = least.min(distance(piece, p, pose));
    }
    least
}
