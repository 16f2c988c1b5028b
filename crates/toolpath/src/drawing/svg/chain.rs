//! Chains of curves: parts of a path that are drawn without a break.

use super::curve::{PathCurve, distance, map_point};
use crate::drawing::{Rgb, Stroke};
use kurbo::Affine;

/// Chain of curves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CurveChain {
    pub(super) start: [f64; 2],
    pub(super) curves: Vec<PathCurve>,
    /// The path is closed here, be it in a point.
    pub(super) closed: bool,
}

impl CurveChain {
    /// Chain that begins in a point.
    pub(super) fn new(start: [f64; 2]) -> Self {
        Self {
            start,
            curves: Vec::new(),
            closed: false,
        }
    }

    pub(super) fn end(&self) -> [f64; 2] {
        self.curves.last().map_or(self.start, PathCurve::end)
    }

    /// Goes straight to a point, if that is not where the chain is.
    pub(super) fn line(&mut self, to: [f64; 2]) {
        if self.end() != to {
            self.curves.push(PathCurve::Line(to));
        }
    }

    /// Goes back to the start.
    pub(super) fn close(&mut self) {
        self.line(self.start);
        self.closed = true;
    }

    /// Curves with their starts.
    pub(super) fn curves(&self) -> impl Iterator<Item = ([f64; 2], &PathCurve)> {
        let mut at = self.start;
        self.curves
            .iter()
            .map(move |curve| (std::mem::replace(&mut at, curve.end()), curve))
    }

    pub(super) fn mapped(&self, map: &Affine) -> Self {
        Self {
            start: map_point(map, self.start),
            curves: self.curves.iter().map(|curve| curve.mapped(map)).collect(),
            closed: self.closed,
        }
    }

    /// Length of the chain.
    pub(super) fn length(&self) -> f64 {
        let ends = self.curves().map(|(from, curve)| curve.lengths(from));
        ends.filter_map(|ends| ends.last().copied()).sum()
    }

    /// Points along the chain whose chords are at most `flatness` off it.
    pub(super) fn points(&self, flatness: f64) -> Vec<[f64; 2]> {
        let mut points = vec![self.start];
        for (from, curve) in self.curves() {
            let chords = curve.chords(from, flatness);
            let inner = (1..chords).map(|chord| f64::from(chord) / f64::from(chords));
            points.extend(inner.map(|t| curve.at(from, t)));
            points.push(curve.end());
        }
        points
    }

    /// Points whose hull holds the chain.
    pub(super) fn hull(&self) -> impl Iterator<Item = [f64; 2]> {
        let points = self.curves.iter().flat_map(|curve| match *curve {
            PathCurve::Line(to) => vec![to],
            PathCurve::Bezier(points) => points.to_vec(),
            PathCurve::Arc { centre, axes, .. } => {
                let corner =
                    |a: f64, b: f64| [0, 1].map(|i| centre[i] + a * axes[0][i] + b * axes[1][i]);
                let sides = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
                sides.map(|(a, b)| corner(a, b)).to_vec()
            }
        });
        std::iter::once(self.start).chain(points)
    }

    /// Returns true if the chain surrounds an area: its points are on no line.
    pub(super) fn has_area(&self) -> bool {
        if self.curves.iter().any(
            |curve| matches!(curve, PathCurve::Arc { axes: [a, b], .. } if a[0] * b[1] != a[1] * b[0]),
        ) {
            return true;
        }
        let far = self
            .hull()
            .max_by(|a, b| distance(self.start, *a).total_cmp(&distance(self.start, *b)));
        let Some(far) = far.filter(|far| *far != self.start) else {
            return false;
        };
        let along = [far[0] - self.start[0], far[1] - self.start[1]];
        let size = libm::hypot(along[0], along[1]);
        self.hull().any(|point| {
            let side = [point[0] - self.start[0], point[1] - self.start[1]];
            (along[0] * side[1] - along[1] * side[0]).abs() > 1e-9 * size * size
        })
    }

    /// The chain as a stroke of a shape.
    pub(super) fn stroke(&self, shape: usize, colour: Option<Rgb>) -> Stroke {
        let mut curves = Vec::new();
        for curve in &self.curves {
            curve.add_to(&mut curves);
        }
        Stroke {
            shape,
            colour,
            start: self.start,
            curves,
        }
    }
}
