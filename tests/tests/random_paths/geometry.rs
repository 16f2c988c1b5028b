//! Geometry of a drawn path, by formulas of its own: points of its pieces, and their text in a scene.

use crate::drawn::GivenEnds;
use core::fmt::Write as _;
use trirrr_plan::course::PathPiece;
use trirrr_tests::instant::Coordinates;
use trirrr_tests::scalar::solve;

/// A piece as a user writes it.
#[derive(Clone, Debug)]
pub(crate) enum Drawn {
    Line {
        to: Coordinates,
    },
    Arc {
        centre: [f64; 2],
        turn: f64,
        alpha: f64,
    },
    /// The last pose is the end.
    Bezier {
        controls: [Coordinates; 3],
    },
    Spline {
        through: Vec<Coordinates>,
    },
}

fn mix(a: Coordinates, b: Coordinates, part: f64) -> Coordinates {
    core::array::from_fn(|i| a[i] + (b[i] - a[i]) * part)
}

impl Drawn {
    /// The point at `part` of the piece from `from`, 0 to 1.
    pub(crate) fn at(&self, from: Coordinates, part: f64) -> Coordinates {
        match self {
            Self::Line { to } => mix(from, *to, part),
            Self::Arc {
                centre,
                turn,
                alpha,
            } => {
                let (sin, cos) = (turn * part).sin_cos();
                let arm = [from[0] - centre[0], from[1] - centre[1]];
                [
                    centre[0] + arm[0] * cos - arm[1] * sin,
                    centre[1] + arm[1] * cos + arm[0] * sin,
                    from[2] + (alpha - from[2]) * part,
                ]
            }
            Self::Bezier {
                controls: [a, b, c],
            } => {
                // De Casteljau.
                let (p, q, r) = (mix(from, *a, part), mix(*a, *b, part), mix(*b, *c, part));
                mix(mix(p, q, part), mix(q, r, part), part)
            }
            Self::Spline { through } => spline_at(from, through, part),
        }
    }

    pub(crate) fn end(&self, from: Coordinates) -> Coordinates {
        match self {
            Self::Line { to } => *to,
            Self::Bezier { controls } => controls[2],
            Self::Arc { .. } => self.at(from, 1.0),
            Self::Spline { through } => through[through.len() - 1],
        }
    }

    /// The table's lines in a scene.
    pub(crate) fn text(&self, free: Option<GivenEnds>) -> String {
        let angle = |alpha: f64| match free {
            Some(GivenEnds::None) => String::new(),
            _ => format!(", alpha_rad = {alpha:?}"),
        };
        let pose = |[x, y, alpha]: Coordinates| format!("x_m = {x:?}, y_m = {y:?}{}", angle(alpha));
        match self {
            Self::Line { to } => format!("line = {{ {} }}\n", pose(*to)),
            Self::Arc {
                centre,
                turn,
                alpha,
            } => format!(
                "arc = {{ centre_m = {centre:?}, turn_rad = {turn:?}{} }}\n",
                angle(*alpha)
            ),
            Self::Bezier {
                controls: [a, b, c],
            } => format!(
                "bezier = {{ controls_m = [[{:?}, {:?}], [{:?}, {:?}]], {}{} }}\n",
                a[0],
                a[1],
                b[0],
                b[1],
                match free {
                    Some(_) => String::new(),
                    None => format!("controls_alpha_rad = [{:?}, {:?}], ", a[2], b[2]),
                },
                pose(*c)
            ),
            Self::Spline { through } => {
                let mut text = String::from("spline = { through = [");
                for each in through {
                    let _ = write!(text, "{{ {} }}, ", pose(*each));
                }
                text + "] }\n"
            }
        }
    }
}

/// The place from 0 to 1 at which a convex function is least.
fn least_of_convex(of: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let third = (high - low) / 3.0;
        match of(low + third) < of(high - third) {
            true => high -= third,
            false => low += third,
        }
    }
    0.5 * (low + high)
}

/// The natural cubic spline over its chords, by the dense equations of its second derivatives.
fn spline_at(from: Coordinates, through: &[Coordinates], part: f64) -> Coordinates {
    let knots: Vec<_> = core::iter::once(from)
        .chain(through.iter().copied())
        .collect();
    let chords: Vec<f64> = knots
        .windows(2)
        .map(|pair| {
            (0..3)
                .map(|i| (pair[1][i] - pair[0][i]).powi(2))
                .sum::<f64>()
                .sqrt()
        })
        .collect();
    let count = knots.len();
    let place = part * (count - 1) as f64;
    let piece = (place as usize).min(count - 2);
    let t = place - piece as f64;
    core::array::from_fn(|axis| {
        let mut matrix = vec![vec![0.0; count]; count];
        let mut right = vec![0.0; count];
        matrix[0][0] = 1.0;
        matrix[count - 1][count - 1] = 1.0;
        for i in 1..count - 1 {
            let slope = |i: usize| (knots[i + 1][axis] - knots[i][axis]) / chords[i];
            matrix[i][i - 1] = chords[i - 1];
            matrix[i][i] = 2.0 * (chords[i - 1] + chords[i]);
            matrix[i][i + 1] = chords[i];
            right[i] = 6.0 * (slope(i) - slope(i - 1));
        }
        let seconds = solve(matrix, right);
        let (h, a, b) = (chords[piece], seconds[piece], seconds[piece + 1]);
        let (p, q) = (knots[piece][axis], knots[piece + 1][axis]);
        let bent = |x: f64| (x * x * x - x) * h * h / 6.0;
        p * (1.0 - t) + q * t + a * bent(1.0 - t) + b * bent(t)
    })
}

/// Points of a path, with enough of them to be told from its curves.
pub(crate) struct Polyline {
    points: Vec<Coordinates>,
    nearest: usize,
}

impl Polyline {
    /// `count` chords for each piece.
    pub(crate) fn of(start: Coordinates, pieces: &[Drawn], count: u32) -> Self {
        let mut points = vec![start];
        let mut from = start;
        for piece in pieces {
            let parts = (1..=count).map(|i| f64::from(i) / f64::from(count));
            points.extend(parts.map(|part| piece.at(from, part)));
            from = piece.end(from);
        }
        Self { points, nearest: 0 }
    }

    /// The path as it is planned, corners rounded.
    pub(crate) fn planned(pieces: &[PathPiece], count: u32) -> Self {
        let mut points = Vec::new();
        for each in pieces {
            let parts = (0..=count).map(|i| f64::from(i) / f64::from(count));
            points.extend(parts.map(|part| {
                let pose = each.piece.at(part).pose;
                [pose.position.x, pose.position.y, pose.angle]
            }));
        }
        Self { points, nearest: 0 }
    }

    /// Distance of D and of alpha from the path, in parts of `tolerances`, at the place where the larger of them is
    /// least. A motion is followed: the search begins where the one before has ended.
    pub(crate) fn deviation(&mut self, at: Coordinates, tolerances: [f64; 2]) -> f64 {
        let last = self.points.len() - 2;
        let of = |chord: usize| self.on_chord(chord, at, tolerances);
        let mut best = (of(self.nearest), self.nearest);
        // Ahead as long as it comes nearer, and a little beyond, as a corner may be in the way.
        for chord in self.nearest + 1..=last {
            let here = of(chord);
            if here < best.0 {
                best = (here, chord);
            } else if chord > best.1 + 64 {
                break;
            }
        }
        for chord in (self.nearest.saturating_sub(64)..self.nearest).rev() {
            let here = of(chord);
            if here < best.0 {
                best = (here, chord);
            }
        }
        if best.0 > 1.0 {
            // Anywhere: a piece may be so short that it is between two instants.
            let all = (0..=last).map(|chord| (of(chord), chord));
            best = all.fold(best, |best, here| if here.0 < best.0 { here } else { best });
        }
        self.nearest = best.1;
        best.0
    }

    fn on_chord(&self, chord: usize, at: Coordinates, [metres, radians]: [f64; 2]) -> f64 {
        let (a, b) = (self.points[chord], self.points[chord + 1]);
        let scale = [1.0 / metres, 1.0 / metres, 1.0 / radians];
        let along: Coordinates = core::array::from_fn(|i| (b[i] - a[i]) * scale[i]);
        let off: Coordinates = core::array::from_fn(|i| (at[i] - a[i]) * scale[i]);
        let dot = |u: Coordinates, v: Coordinates| (0..3).map(|i| u[i] * v[i]).sum::<f64>();
        let size = dot(along, along);
        let part = if size > 0.0 {
            (dot(off, along) / size).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let beside = |part: f64| {
            let rest: Coordinates = core::array::from_fn(|i| off[i] - along[i] * part);
            rest[0].hypot(rest[1]).max(rest[2].abs())
        };
        let near = beside(part);
        // The larger of the two is least elsewhere, nearer by the length of the chord at most; it is convex along it.
        match near > 0.9 && near - size.sqrt() <= 1.0 && size > 0.0 {
            true => near.min(beside(least_of_convex(beside))),
            false => near,
        }
    }
}
