//! alpha as a smooth curve over the pieces of a stretch.

use super::knots::{Knot, Stretch};
use crate::natural::natural_spline;
use crate::path::{PathPiece, PathPlace};

/// alpha between two knots: a cubic of the part of the distance between them.
#[derive(Clone, Copy)]
struct Span {
    start: f64,
    length: f64,
    angle: f64,
    turning: [f64; 3],
}

/// The pieces of `stretch` with alpha a natural spline through `angles` at `knots`; it may bend where the motion
/// stops. A piece is cut where a knot lies on it.
pub(crate) fn lay(stretch: &Stretch<'_>, knots: &[Knot], angles: &[f64]) -> Vec<PathPiece> {
    let spans = spans(knots, angles);
    let mut laid = Vec::with_capacity(stretch.pieces.len() + knots.len());
    let mut next = 0;
    for (index, each) in stretch.pieces.iter().enumerate() {
        let mut from = 0.0;
        loop {
            let knot = &knots[next + 1];
            let to = match knot.piece == index {
                true => knot.p,
                false => 1.0,
            };
            let [start, scale] = stretch.distance(index, from);
            let piece = match (from, to) {
                (0.0, 1.0) => each.piece,
                _ => each.piece.part(from, to),
            };
            let (angle, turning) = spans[next].part(start, scale * (to - from));
            laid.push(PathPiece {
                piece: piece.with_alpha(angle, turning),
                stops: each.stops && from == 0.0,
                ..*each
            });
            if knot.piece == index && next + 2 < knots.len() {
                next += 1;
            }
            if to == 1.0 {
                break;
            }
            from = to;
        }
    }
    laid
}

/// Place on the pieces of a stretch of a place on those that [`lay`] has cut at `knots`.
pub(crate) fn original(knots: &[Knot], laid: PathPlace) -> PathPlace {
    // A knot within a piece makes one more of it.
    let mut cuts = knots[1..]
        .iter()
        .filter(|knot| knot.p < 1.0)
        .enumerate()
        .map(|(before, knot)| (knot.piece + before, knot.p));
    let behind: Vec<_> = cuts
        .by_ref()
        .take_while(|(index, _)| *index < laid.piece)
        .collect();
    let from = match behind.last() {
        Some((index, p)) if index + 1 == laid.piece => *p,
        _ => 0.0,
    };
    let piece = laid.piece - behind.len();
    let next = knots[1..]
        .iter()
        .find(|knot| knot.piece == piece && knot.p > from);
    let to = next.map_or(1.0, |knot| knot.p);
    PathPlace {
        piece,
        p: from + (to - from) * laid.p,
    }
}

impl Span {
    /// alpha at the distance `start`, and its coefficients over the `length` from there.
    fn part(&self, start: f64, length: f64) -> (f64, [f64; 3]) {
        let p = (start - self.start) / self.length;
        let span = length / self.length;
        let [c1, c2, c3] = self.turning;
        let first = c1 + (2.0 * c2 + 3.0 * c3 * p) * p;
        let half_second = c2 + 3.0 * c3 * p;
        (
            self.angle + (c1 + (c2 + c3 * p) * p) * p,
            [
                first * span,
                half_second * span * span,
                c3 * span * span * span,
            ],
        )
    }
}

fn spans(knots: &[Knot], angles: &[f64]) -> Vec<Span> {
    let mut spans = Vec::with_capacity(knots.len());
    let mut first = 0;
    for last in 1..knots.len() {
        if !knots[last].breaks {
            continue;
        }
        let section = &knots[first..=last];
        let lengths: Vec<f64> = section
            .windows(2)
            .map(|pair| pair[1].distance - pair[0].distance)
            .collect();
        let turnings = natural_spline(&lengths, &angles[first..=last]);
        for (index, turning) in turnings.into_iter().enumerate() {
            spans.push(Span {
                start: section[index].distance,
                length: lengths[index],
                angle: angles[first + index],
                turning,
            });
        }
        first = last;
    }
    spans
}
