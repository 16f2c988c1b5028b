//! One stroke: a chain of lines and curves.

use super::Rgb;

/// Most chords of a curve.
const CHORDS_MAX: f64 = 1000.0;

/// Chain of lines and curves that is drawn without a break.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Number of its shape in the file, from 0.
    pub shape: usize,
    /// Colour. None: none that a pen could be chosen by (a gradient, a pattern).
    pub colour: Option<Rgb>,
    /// First point, m.
    pub start: [f64; 2],
    /// Lines and curves, each from where the last one ends.
    pub curves: Vec<StrokeCurve>,
}

/// Part of a stroke: its points behind the first, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StrokeCurve {
    /// Straight line to a point.
    Line([f64; 2]),
    /// Arc of a circle.
    Arc {
        /// Centre.
        centre: [f64; 2],
        /// Angle of the arc, rad, counter-clockwise positive, at most a whole turn.
        turn: f64,
        /// End.
        to: [f64; 2],
    },
    /// Cubic Bezier curve: two inner control points, and the end.
    Bezier([[f64; 2]; 3]),
}

impl StrokeCurve {
    /// Last point, m.
    pub fn end(&self) -> [f64; 2] {
        match *self {
            Self::Line(to) | Self::Bezier([_, _, to]) | Self::Arc { to, .. } => to,
        }
    }
}

impl Stroke {
    /// Last point, m.
    pub fn end(&self) -> [f64; 2] {
        self.curves.last().map_or(self.start, StrokeCurve::end)
    }

    /// The same stroke, drawn from its end to its start.
    pub fn reversed(self) -> Self {
        let mut froms = vec![self.start];
        froms.extend(self.curves.iter().map(StrokeCurve::end));
        let start = froms.pop().unwrap_or(self.start);
        let pairs = self.curves.into_iter().zip(froms).rev();
        let curves = pairs.map(|(curve, from)| match curve {
            StrokeCurve::Line(_) => StrokeCurve::Line(from),
            StrokeCurve::Arc { centre, turn, .. } => StrokeCurve::Arc {
                centre,
                turn: -turn,
                to: from,
            },
            StrokeCurve::Bezier([first, second, _]) => StrokeCurve::Bezier([second, first, from]),
        });
        Self {
            start,
            curves: curves.collect(),
            ..self
        }
    }

    /// Returns true if every point that makes the stroke is a number, and at most `largest_m` from each axis.
    #[cfg(feature = "dxf")]
    pub(super) fn is_within(&self, largest_m: f64) -> bool {
        let within = |point: &[f64; 2]| point.iter().all(|value| value.abs() <= largest_m);
        let curve = |curve: &StrokeCurve| match curve {
            StrokeCurve::Line(to) => within(to),
            StrokeCurve::Arc { centre, turn, to } => {
                within(centre) && turn.is_finite() && within(to)
            }
            StrokeCurve::Bezier(points) => points.iter().all(within),
        };
        within(&self.start) && self.curves.iter().all(curve)
    }

    /// Points along the stroke whose chords are at most `flatness_m` off it.
    pub fn points(&self, flatness_m: f64) -> Vec<[f64; 2]> {
        let mut at = self.start;
        let mut points = vec![at];
        for curve in &self.curves {
            match *curve {
                StrokeCurve::Line(_) => {}
                StrokeCurve::Arc { centre, turn, .. } => {
                    let from = [at[0] - centre[0], at[1] - centre[1]];
                    let chords = chords_of_arc(libm::hypot(from[0], from[1]), turn, flatness_m);
                    for chord in 1..chords {
                        let angle = turn * f64::from(chord) / f64::from(chords);
                        let (sin, cos) = libm::sincos(angle);
                        points.push([
                            centre[0] + cos * from[0] - sin * from[1],
                            centre[1] + sin * from[0] + cos * from[1],
                        ]);
                    }
                }
                StrokeCurve::Bezier([first, second, to]) => {
                    let chords = chords_of_bezier([at, first, second, to], flatness_m);
                    for chord in 1..chords {
                        let p = f64::from(chord) / f64::from(chords);
                        points.push(at_parameter([at, first, second, to], p));
                    }
                }
            }
            at = curve.end();
            points.push(at);
        }
        points
    }
}

/// Chords of an arc that keep a distance: one over the angle a is off by at most a^2 / 8 of the radius.
pub(super) fn chords_of_arc(radius: f64, turn: f64, flatness_m: f64) -> u32 {
    let chords = turn.abs() * (radius / (8.0 * flatness_m)).sqrt();
    chords.ceil().clamp(3.0, CHORDS_MAX) as u32
}

/// Chords that keep a distance: a chord over a part h is off by at most h^2 / 8 of the greatest second derivative.
pub(super) fn chords_of_bezier([from, first, second, to]: [[f64; 2]; 4], flatness_m: f64) -> u32 {
    let bend = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        6.0 * libm::hypot(a[0] - 2.0 * b[0] + c[0], a[1] - 2.0 * b[1] + c[1])
    };
    let most = bend(from, first, second).max(bend(first, second, to));
    (most / (8.0 * flatness_m))
        .sqrt()
        .ceil()
        .clamp(1.0, CHORDS_MAX) as u32
}

/// Point of a curve that begins at `from`, at a part of it.
pub(super) fn point_at(from: [f64; 2], curve: &StrokeCurve, p: f64) -> [f64; 2] {
    match *curve {
        StrokeCurve::Line(to) => [0, 1].map(|axis| from[axis] + p * (to[axis] - from[axis])),
        StrokeCurve::Arc { centre, turn, .. } => {
            let [x, y] = [0, 1].map(|axis| from[axis] - centre[axis]);
            let (sin, cos) = libm::sincos(p * turn);
            [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y]
        }
        StrokeCurve::Bezier([first, second, to]) => at_parameter([from, first, second, to], p),
    }
}

pub(super) fn at_parameter([a, b, c, d]: [[f64; 2]; 4], p: f64) -> [f64; 2] {
    let q = 1.0 - p;
    let weights = [q * q * q, 3.0 * q * q * p, 3.0 * q * p * p, p * p * p];
    [0, 1].map(|axis| {
        weights[0] * a[axis] + weights[1] * b[axis] + weights[2] * c[axis] + weights[3] * d[axis]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quarter() -> Stroke {
        // Quarter of the unit circle to 3e-4, by the usual control points.
        let k = 0.5522847498;
        Stroke {
            shape: 0,
            colour: None,
            start: [1.0, 0.0],
            curves: vec![
                StrokeCurve::Bezier([[1.0, k], [k, 1.0], [0.0, 1.0]]),
                StrokeCurve::Line([0.0, 2.0]),
            ],
        }
    }

    #[test]
    fn a_reversed_stroke_has_the_same_points() {
        let stroke = quarter();
        let mut points = stroke.points(1e-3);
        let back = stroke.clone().reversed();
        assert_eq!([back.start, back.end()], [stroke.end(), stroke.start]);
        points.reverse();
        for (one, other) in points.iter().zip(back.points(1e-3)) {
            assert!((one[0] - other[0]).abs() < 1e-12 && (one[1] - other[1]).abs() < 1e-12);
        }
        assert_eq!(back.reversed(), stroke);
    }

    #[test]
    fn chords_keep_their_distance() {
        for flatness in [1e-2, 1e-3, 1e-4] {
            let points = quarter().points(flatness);
            let round = &points[..points.len() - 1];
            for pair in round.windows(2) {
                let middle = [0, 1].map(|axis| 0.5 * (pair[0][axis] + pair[1][axis]));
                let off = (libm::hypot(middle[0], middle[1]) - 1.0).abs();
                assert!(off <= flatness + 3e-4, "{off} at {flatness}");
            }
        }
    }
}
