//! Curves of entities, placed in the drawing.

use super::place::Affine;
use crate::drawing::StrokeCurve;
use std::f64::consts::{PI, TAU};

/// Largest part of an ellipse for a cubic curve, rad: the curve is off by 6e-8 of the long half axis.
const PART: f64 = PI / 8.0;

/// Outline of curves under construction: points come in the frame of the entity.
pub(super) struct Outline<'p> {
    pub(super) place: &'p Affine,
    /// Start, in the drawing.
    pub(super) start: [f64; 2],
    pub(super) curves: Vec<StrokeCurve>,
    /// End, in the frame of the entity.
    at: [f64; 2],
}

impl<'p> Outline<'p> {
    pub(super) fn new(place: &'p Affine, start: [f64; 2]) -> Self {
        Self {
            place,
            start: place.point(start),
            curves: Vec::new(),
            at: start,
        }
    }

    pub(super) fn line(&mut self, to: [f64; 2]) {
        if to != self.at {
            self.curves.push(StrokeCurve::Line(self.place.point(to)));
            self.at = to;
        }
    }

    pub(super) fn bezier(&mut self, controls: [[f64; 2]; 3]) {
        let placed = controls.map(|point| self.place.point(point));
        self.curves.push(StrokeCurve::Bezier(placed));
        self.at = controls[2];
    }

    /// Arc about `centre` by `turn`, rad, counter-clockwise positive.
    pub(super) fn arc(&mut self, centre: [f64; 2], turn: f64) {
        let along = [self.at[0] - centre[0], self.at[1] - centre[1]];
        let across = [-along[1], along[0]];
        match self.place.circle_sense() {
            Some(sense) => {
                let to = at_angle(centre, along, across, turn);
                self.curves.push(StrokeCurve::Arc {
                    centre: self.place.point(centre),
                    turn: sense * turn,
                    to: self.place.point(to),
                });
                self.at = to;
            }
            None => self.ellipse(centre, [along, across], [0.0, turn]),
        }
    }

    /// Part of an ellipse with the half axes `axes`, between two parameters, rad.
    pub(super) fn ellipse(&mut self, centre: [f64; 2], axes: [[f64; 2]; 2], ends: [f64; 2]) {
        let [along, across] = axes;
        let sweep = ends[1] - ends[0];
        let parts = (sweep.abs() / PART).ceil().max(1.0);
        let step = sweep / parts;
        let reach = 4.0 / 3.0 * libm::tan(0.25 * step);
        let back = [0, 1].map(|i| -along[i]);
        for index in 0..parts as u32 {
            let from = ends[0] + step * f64::from(index);
            let point = |t: f64| at_angle(centre, along, across, t);
            // The derivative of a point on it: the point a quarter further, about the zero point.
            let slope = |t: f64| at_angle([0.0; 2], across, back, t);
            let (first, last) = (point(from), point(from + step));
            let (leave, arrive) = (slope(from), slope(from + step));
            self.bezier([
                [0, 1].map(|i| first[i] + reach * leave[i]),
                [0, 1].map(|i| last[i] - reach * arrive[i]),
                last,
            ]);
        }
    }

    /// Way of a polyline to its next vertex: `bulge` is the tangent of a quarter of the arc's angle, 0 for a line.
    pub(super) fn bulged(&mut self, bulge: f64, to: [f64; 2]) {
        if bulge == 0.0 || to == self.at {
            return self.line(to);
        }
        let from = self.at;
        let chord = [to[0] - from[0], to[1] - from[1]];
        let height = (1.0 - bulge * bulge) / (4.0 * bulge);
        let centre = [
            0.5 * (from[0] + to[0]) - height * chord[1],
            0.5 * (from[1] + to[1]) + height * chord[0],
        ];
        self.arc(centre, 4.0 * bulge.atan());
        // Exactly the vertex of the file, without the rounding of the angle.
        let placed = self.place.point(to);
        if let Some(StrokeCurve::Arc { to: end, .. } | StrokeCurve::Bezier([_, _, end])) =
            self.curves.last_mut()
        {
            *end = placed;
        }
        self.at = to;
    }
}

fn at_angle(centre: [f64; 2], along: [f64; 2], across: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [0, 1].map(|i| centre[i] + cos * along[i] + sin * across[i])
}

/// Angle from `from` counter-clockwise to `to`, above 0 and at most a whole turn.
pub(super) fn sweep(from: f64, to: f64) -> f64 {
    let sweep = (to - from).rem_euclid(TAU);
    match sweep < 1e-12 {
        true => TAU,
        false => sweep,
    }
}
