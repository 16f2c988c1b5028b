//! Arcs of G2 and G3 in the plane: centres, angles, and ends that fit.
//!
//! A program rounds its numbers, so the end lies beside the circle through the start. The centre moves to where both
//! lie on one circle. Where the arc is nearly closed, that would move the centre far; there the arc is cut in halves,
//! with the mean radius between them. Tangents then bend by about the ratio of the difference to the radius.
use std::f64::consts::{PI, TAU};

/// Radii at start and end may always differ by so much, m. Figure of GRBL and of LinuxCNC.
const RADIUS_SLACK_M: f64 = 5e-6;
/// Radii may never differ by more, m. Figure of GRBL.
const RADIUS_MOST_M: f64 = 0.5e-3;
/// Between the two: greatest ratio of the difference to the radius. Figure of GRBL and of LinuxCNC.
const RADIUS_RATIO: f64 = 1e-3;
/// Smallest radius, m. An arc with a smaller one is the straight line to its end.
const SMALLEST_M: f64 = 1e-6;
/// An arc that is so short is a whole turn, rad. Figure of GRBL.
const CLOSED_RAD: f64 = 5e-7;
/// Ends at such a distance are one point, m.
const ONE_POINT_M: f64 = 1e-12;
/// A centre that moves less, in radii, has not moved.
const STILL: f64 = 1e-9;

/// Direction of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Clockwise,
    Counterclockwise,
}

impl Direction {
    /// 1 for counter-clockwise, -1 for clockwise.
    fn sign(self) -> f64 {
        match self {
            Self::Clockwise => -1.0,
            Self::Counterclockwise => 1.0,
        }
    }
}

/// Part of an arc, consistent: start, turned about the centre, is the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ArcPart {
    pub(super) centre: [f64; 2],
    /// Counter-clockwise positive, rad.
    pub(super) turn: f64,
    pub(super) to: [f64; 2],
    /// Part of the whole way that lies behind the end, 1 for the last part.
    pub(super) done: f64,
}

/// Refusal of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ArcFault {
    /// Radii at the start and at the end, m.
    RadiiDiffer(f64, f64),
    /// Two radii are shorter than the distance, m.
    TooFar(f64),
    /// The radius form needs two points.
    OnePoint,
}

/// Turns from which on an arc is long.
const LONG_TURNS: f64 = 4.0;

/// Cuts long arcs, the first of which begins at `start`, into whole turns and a rest below two: a long arc counts as many motions.
pub(super) fn in_turns(start: [f64; 2], arcs: Vec<ArcPart>) -> Vec<ArcPart> {
    let mut parts = Vec::with_capacity(arcs.len());
    let (mut from, mut before) = (start, 0.0);
    for arc in arcs {
        let whole = TAU.copysign(arc.turn);
        let turns = arc.turn / whole;
        let count = match turns >= LONG_TURNS {
            true => turns.floor() as u32 - 1,
            false => 0,
        };
        for index in 1..=count {
            let part = f64::from(index) * whole / arc.turn;
            parts.push(ArcPart {
                turn: whole,
                to: from,
                done: before + part * (arc.done - before),
                ..arc
            });
        }
        parts.push(ArcPart {
            turn: arc.turn - f64::from(count) * whole,
            ..arc
        });
        (from, before) = (arc.to, arc.done);
    }
    parts
}

/// Arc about a centre, going round `whole_turns` more times. Without parts, if it has no radius.
pub(super) fn about(
    start: [f64; 2],
    end: [f64; 2],
    centre: [f64; 2],
    direction: Direction,
    whole_turns: f64,
) -> Result<Vec<ArcPart>, ArcFault> {
    let (from, to) = (minus(start, centre), minus(end, centre));
    let (r0, r1) = (length(from), length(to));
    let difference = (r0 - r1).abs();
    if difference > RADIUS_MOST_M || difference > RADIUS_SLACK_M.max(RADIUS_RATIO * r0.max(r1)) {
        return Err(ArcFault::RadiiDiffer(r0, r1));
    }
    if r0.min(r1) < SMALLEST_M {
        return Ok(Vec::new());
    }
    let sign = direction.sign();
    let rounds = sign * TAU * whole_turns;
    if distance(start, end) < ONE_POINT_M {
        return Ok(vec![ArcPart {
            centre,
            turn: rounds + sign * TAU,
            to: end,
            done: 1.0,
        }]);
    }
    let first = libm::atan2(from[1], from[0]);
    let mut sweep = (sign * (libm::atan2(to[1], to[0]) - first)).rem_euclid(TAU);
    if sweep <= CLOSED_RAD {
        sweep += TAU;
    }
    let (fitted, moved) = fit(start, end, centre, sign);
    if moved <= STILL * r0 {
        // Turns of a whole round more: the fit has one between 0 and a whole turn, and so has the sweep but for the
        // arcs that count as closed.
        let closed = if sweep > TAU { sign * TAU } else { 0.0 };
        return Ok(vec![ArcPart {
            turn: fitted.turn + rounds + closed,
            ..fitted
        }]);
    }
    Ok(spiral(
        start,
        end,
        centre,
        Spiral {
            first,
            sweep,
            sign,
            radii: [r0, r1],
            rounds,
        },
    ))
}

/// Arc with a radius, m; a negative one takes the long way. Without parts, if it has no radius.
pub(super) fn with_radius(
    start: [f64; 2],
    end: [f64; 2],
    radius: f64,
    direction: Direction,
    whole_turns: f64,
) -> Result<Vec<ArcPart>, ArcFault> {
    let chord = minus(end, start);
    let half = 0.5 * length(chord);
    if 2.0 * half < ONE_POINT_M {
        return Err(ArcFault::OnePoint);
    }
    let short = half - radius.abs();
    if short > RADIUS_MOST_M || short > RADIUS_SLACK_M.max(RADIUS_RATIO * half) {
        return Err(ArcFault::TooFar(2.0 * half));
    }
    if radius.abs() < SMALLEST_M {
        return Ok(Vec::new());
    }
    // Product of sum and difference: no square is lost where the chord is nearly a diameter.
    let height = ((radius.abs() + half) * (radius.abs() - half))
        .max(0.0)
        .sqrt();
    let sign = direction.sign();
    // The centre of a short counter-clockwise arc is to the left.
    let left = if radius > 0.0 {
        sign * height
    } else {
        -sign * height
    };
    let middle = [0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])];
    let unit = [chord[0] / (2.0 * half), chord[1] / (2.0 * half)];
    let centre = [middle[0] - left * unit[1], middle[1] + left * unit[0]];
    let turn = sign * (2.0 * libm::atan2(half, sign * left) + TAU * whole_turns);
    Ok(vec![ArcPart {
        centre,
        turn,
        to: end,
        done: 1.0,
    }])
}

/// Arc with ends at two radii.
struct Spiral {
    /// Angle at the start.
    first: f64,
    /// Angle of the last round, positive.
    sweep: f64,
    sign: f64,
    radii: [f64; 2],
    /// Whole turns before, with sign, rad.
    rounds: f64,
}

/// Whole turns at the radius of the start, then the arc, in halves if it is nearly closed.
fn spiral(start: [f64; 2], end: [f64; 2], centre: [f64; 2], spiral: Spiral) -> Vec<ArcPart> {
    let Spiral {
        first,
        sweep,
        sign,
        radii: [r0, r1],
        rounds,
    } = spiral;
    let whole = rounds.abs() + sweep;
    let mut parts = Vec::with_capacity(3);
    if rounds != 0.0 {
        parts.push(ArcPart {
            centre,
            turn: rounds,
            to: start,
            done: rounds.abs() / whole,
        });
    }
    let mut from = start;
    if sweep > 1.5 * PI {
        let (sin, cos) = libm::sincos(first + sign * 0.5 * sweep);
        let radius = 0.5 * (r0 + r1);
        let middle = [centre[0] + radius * cos, centre[1] + radius * sin];
        let done = (rounds.abs() + 0.5 * sweep) / whole;
        parts.push(ArcPart {
            done,
            ..fit(from, middle, centre, sign).0
        });
        from = middle;
    }
    parts.push(fit(from, end, centre, sign).0);
    parts
}

/// Arc below a whole turn through both ends about the nearest centre there is, and the way that the centre moved.
fn fit(start: [f64; 2], end: [f64; 2], centre: [f64; 2], sign: f64) -> (ArcPart, f64) {
    let chord = minus(end, start);
    let whole = length(chord);
    let unit = [chord[0] / whole, chord[1] / whole];
    let middle = [0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])];
    let offset = minus(centre, middle);
    let along = offset[0] * unit[0] + offset[1] * unit[1];
    let left = unit[0] * offset[1] - unit[1] * offset[0];
    let centre = [middle[0] - left * unit[1], middle[1] + left * unit[0]];
    let turn = sign * 2.0 * libm::atan2(0.5 * whole, sign * left);
    (
        ArcPart {
            centre,
            turn,
            to: end,
            done: 1.0,
        },
        along.abs(),
    )
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// Length of all parts, m.
pub(super) fn way(parts: &[ArcPart]) -> f64 {
    parts
        .iter()
        .map(|part| part.turn.abs() * distance(part.to, part.centre))
        .sum()
}

/// Distance of two points.
pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    length(minus(a, b))
}

fn length(v: [f64; 2]) -> f64 {
    libm::hypot(v[0], v[1])
}
