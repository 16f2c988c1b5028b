//! Curves of a path: lines, cubic curves and parts of ellipses. Affine maps make the same kinds of them.

use crate::drawing::StrokeCurve;
use crate::drawing::stroke::{chords_of_arc, chords_of_bezier};
use kurbo::{Affine, Point};
use std::f64::consts::PI;

/// Largest part of an ellipse for a cubic curve, rad: the curve is off by 6e-8 of the long half axis.
const PART: f64 = PI / 8.0;

/// Panels in which a length is summed.
const PANELS: u32 = 32;

/// Places and weights of Gauss's sum of five.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189),
    (-0.538_469_310_105_683, 0.478_628_670_499_366),
    (0.0, 0.568_888_888_888_889),
    (0.538_469_310_105_683, 0.478_628_670_499_366),
    (0.906_179_845_938_664, 0.236_926_885_056_189),
];

/// Curve from where the last one ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PathCurve {
    Line([f64; 2]),
    Bezier([[f64; 2]; 3]),
    /// Part of an ellipse: its half axes, and the parameters of its ends, rad.
    Arc {
        centre: [f64; 2],
        axes: [[f64; 2]; 2],
        ends: [f64; 2],
    },
}

pub(super) fn map_point(map: &Affine, [x, y]: [f64; 2]) -> [f64; 2] {
    let Point { x, y } = *map * Point::new(x, y);
    [x, y]
}

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}

fn mix(a: [f64; 2], b: [f64; 2], t: f64) -> [f64; 2] {
    [0, 1].map(|i| a[i] + t * (b[i] - a[i]))
}

fn on_ellipse(centre: [f64; 2], axes: [[f64; 2]; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [0, 1].map(|i| centre[i] + cos * axes[0][i] + sin * axes[1][i])
}

impl PathCurve {
    pub(super) fn end(&self) -> [f64; 2] {
        match *self {
            Self::Line(to) | Self::Bezier([_, _, to]) => to,
            Self::Arc { centre, axes, ends } => on_ellipse(centre, axes, ends[1]),
        }
    }

    pub(super) fn mapped(&self, map: &Affine) -> Self {
        match *self {
            Self::Line(to) => Self::Line(map_point(map, to)),
            Self::Bezier(points) => Self::Bezier(points.map(|point| map_point(map, point))),
            Self::Arc { centre, axes, ends } => {
                let zero = map_point(map, [0.0; 2]);
                let axis = |axis| {
                    let image = map_point(map, axis);
                    [0, 1].map(|i| image[i] - zero[i])
                };
                Self::Arc {
                    centre: map_point(map, centre),
                    axes: axes.map(axis),
                    ends,
                }
            }
        }
    }

    /// Point at a parameter from 0 to 1 of the curve that begins in `from`.
    pub(super) fn at(&self, from: [f64; 2], t: f64) -> [f64; 2] {
        match *self {
            Self::Line(to) => mix(from, to, t),
            Self::Bezier(_) => self.part(from, [0.0, t]).1.end(),
            Self::Arc { centre, axes, ends } => {
                on_ellipse(centre, axes, ends[0] + t * (ends[1] - ends[0]))
            }
        }
    }

    /// Part between two parameters: its start, and the curve.
    pub(super) fn part(&self, from: [f64; 2], [t0, t1]: [f64; 2]) -> ([f64; 2], Self) {
        match *self {
            Self::Line(to) => (mix(from, to, t0), Self::Line(mix(from, to, t1))),
            Self::Bezier([b, c, d]) => {
                // The polar form: control points of a part are the form at mixed parameters.
                let polar = |r: f64, s: f64, t: f64| {
                    let first = [mix(from, b, r), mix(b, c, r), mix(c, d, r)];
                    let second = [mix(first[0], first[1], s), mix(first[1], first[2], s)];
                    mix(second[0], second[1], t)
                };
                let inner = [polar(t0, t0, t1), polar(t0, t1, t1), polar(t1, t1, t1)];
                (polar(t0, t0, t0), Self::Bezier(inner))
            }
            Self::Arc { centre, axes, ends } => {
                let [low, high] = [t0, t1].map(|t| ends[0] + t * (ends[1] - ends[0]));
                let ends = [low, high];
                let start = on_ellipse(centre, axes, low);
                (start, Self::Arc { centre, axes, ends })
            }
        }
    }

    /// Speed at a parameter: length by parameter.
    fn speed(&self, from: [f64; 2], t: f64) -> f64 {
        match *self {
            Self::Line(to) => distance(from, to),
            Self::Bezier([b, c, d]) => {
                let side = |a: [f64; 2], b: [f64; 2]| [b[0] - a[0], b[1] - a[1]];
                let (first, second, third) = (side(from, b), side(b, c), side(c, d));
                let slope = mix(mix(first, second, t), mix(second, third, t), t);
                3.0 * libm::hypot(slope[0], slope[1])
            }
            Self::Arc { axes, ends, .. } => {
                let turn = ends[1] - ends[0];
                let (sin, cos) = libm::sincos(ends[0] + t * turn);
                let slope = [0, 1].map(|i| cos * axes[1][i] - sin * axes[0][i]);
                turn.abs() * libm::hypot(slope[0], slope[1])
            }
        }
    }

    fn length_between(&self, from: [f64; 2], [t0, t1]: [f64; 2]) -> f64 {
        let half = 0.5 * (t1 - t0);
        let at = |place: f64| self.speed(from, t0 + half * (1.0 + place));
        let parts = GAUSS.iter().map(|(place, weight)| weight * at(*place));
        half * parts.sum::<f64>()
    }

    /// Lengths from the start to the end of each panel.
    pub(super) fn lengths(&self, from: [f64; 2]) -> Vec<f64> {
        let panels = match self {
            Self::Line(_) => 1,
            _ => PANELS,
        };
        let mut sum = 0.0;
        let part = |index: u32| f64::from(index) / f64::from(panels);
        let ends = (0..panels).map(|index| {
            sum += self.length_between(from, [part(index), part(index + 1)]);
            sum
        });
        ends.collect()
    }

    /// Parameter at a length from the start, by the [lengths](Self::lengths) of its panels.
    pub(super) fn at_length(&self, from: [f64; 2], lengths: &[f64], length: f64) -> f64 {
        let panel = lengths.partition_point(|end| *end < length);
        let Some(&end) = lengths.get(panel) else {
            return 1.0;
        };
        let before = panel.checked_sub(1).map_or(0.0, |index| lengths[index]);
        let count = lengths.len() as f64;
        let low = panel as f64 / count;
        let mut t = low + (length - before) / (end - before).max(f64::MIN_POSITIVE) / count;
        for _ in 0..8 {
            let speed = self.speed(from, t);
            if speed <= 0.0 {
                break;
            }
            let off = before + self.length_between(from, [low, t]) - length;
            t = (t - off / speed).clamp(low, low + 1.0 / count);
        }
        t
    }

    /// Chords that keep a distance from the curve.
    pub(super) fn chords(&self, from: [f64; 2], flatness: f64) -> u32 {
        match *self {
            Self::Line(_) => 1,
            Self::Bezier([b, c, d]) => chords_of_bezier([from, b, c, d], flatness),
            Self::Arc { axes, ends, .. } => {
                let radius = axes.map(|axis| libm::hypot(axis[0], axis[1]));
                chords_of_arc(radius[0].max(radius[1]), ends[1] - ends[0], flatness)
            }
        }
    }

    /// Adds the curve to those of a stroke. Arcs of circles stay arcs.
    pub(super) fn add_to(&self, curves: &mut Vec<StrokeCurve>) {
        match *self {
            Self::Line(to) => curves.push(StrokeCurve::Line(to)),
            Self::Bezier(points) => curves.push(StrokeCurve::Bezier(points)),
            Self::Arc { centre, axes, ends } => {
                let [along, across] = axes;
                let turn = ends[1] - ends[0];
                let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
                let size = dot(along, along);
                let near = |value: f64| value.abs() <= 1e-12 * size;
                if near(dot(along, across)) && near(dot(across, across) - size) {
                    let sense = along[0] * across[1] - along[1] * across[0];
                    curves.push(StrokeCurve::Arc {
                        centre,
                        turn: turn.copysign(turn * sense),
                        to: self.end(),
                    });
                    return;
                }
                let parts = (turn.abs() / PART).ceil().max(1.0);
                let step = turn / parts;
                let reach = 4.0 / 3.0 * libm::tan(0.25 * step);
                let back = along.map(|value| -value);
                for index in 0..parts as u32 {
                    let low = ends[0] + step * f64::from(index);
                    let [first, last] = [low, low + step].map(|t| on_ellipse(centre, axes, t));
                    // The derivative of a point: the point a quarter further, about the zero point.
                    let [leave, arrive] =
                        [low, low + step].map(|t| on_ellipse([0.0; 2], [across, back], t));
                    curves.push(StrokeCurve::Bezier([
                        [0, 1].map(|i| first[i] + reach * leave[i]),
                        [0, 1].map(|i| last[i] - reach * arrive[i]),
                        last,
                    ]));
                }
            }
        }
    }
}
