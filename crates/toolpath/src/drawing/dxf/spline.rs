//! Splines of DXF: rational B-splines of any degree, as cubic curves.

use super::curves::Outline;
use super::fault;
use crate::PathFault;

/// Largest distance of a cubic curve from the spline at the places that are compared, in parts of the spline's size.
const NEAR: f64 = 1e-7;

/// Most halvings of a span.
const HALVINGS: u32 = 12;

/// Highest degree.
const DEGREE_MAX: usize = 25;

/// A rational B-spline: control points as weight * x, weight * y, weight.
pub(super) struct Nurbs<'s> {
    degree: usize,
    knots: &'s [f64],
    points: Vec<[f64; 3]>,
}

impl<'s> Nurbs<'s> {
    /// Takes the numbers of a spline of the file at `line`.
    ///
    /// # Errors
    /// Numbers that make no spline.
    pub(super) fn new(spline: &'s dxf::entities::Spline, line: u32) -> Result<Self, PathFault> {
        let (knots, count) = (&spline.knot_values, spline.control_points.len());
        let refused = |reason| Err(fault(line, "SPLINE", reason));
        let degree = usize::try_from(spline.degree_of_curve).unwrap_or(0);
        if !(1..=DEGREE_MAX).contains(&degree) || count <= degree {
            return refused("degree and number of control points make no spline");
        }
        if knots.len() != count + degree + 1 || !knots.is_sorted() {
            return refused("its knots are not in ascending order, or too many or too few");
        }
        if knots[degree] >= knots[count] {
            return refused("its knots leave no way between them");
        }
        let weights = &spline.weight_values;
        if !(weights.is_empty() || weights.len() == count)
            || !weights.iter().all(|weight| *weight > 0.0)
        {
            return refused("it needs a weight above 0 for each control point, or none at all");
        }
        let weight = |index: usize| weights.get(index).copied().unwrap_or(1.0);
        let points = spline.control_points.iter().enumerate();
        let points = points.map(|(index, point)| {
            let weight = weight(index);
            [weight * point.x, weight * point.y, weight]
        });
        Ok(Self {
            degree,
            knots,
            points: points.collect(),
        })
    }

    /// Start of the spline.
    pub(super) fn start(&self) -> [f64; 2] {
        self.at(self.degree, self.knots[self.degree])[0]
    }

    /// Adds the spline to a chain that ends at its start.
    pub(super) fn add_to(&self, chain: &mut Outline) {
        let size = self.size();
        for span in self.degree..self.points.len() {
            let (from, to) = (self.knots[span], self.knots[span + 1]);
            if from < to {
                self.add_span(chain, span, [from, to], NEAR * size, HALVINGS);
            }
        }
    }

    fn size(&self) -> f64 {
        let first = self.points[0];
        let size = |axis: usize| {
            let offs = self
                .points
                .iter()
                .map(|point| (point[axis] / point[2] - first[axis] / first[2]).abs());
            offs.fold(0.0, f64::max)
        };
        size(0).max(size(1))
    }

    /// Adds the part of a span between two parameters.
    fn add_span(
        &self,
        chain: &mut Outline,
        span: usize,
        [from, to]: [f64; 2],
        near: f64,
        halvings: u32,
    ) {
        let third = (to - from) / 3.0;
        let ([start, leave], [end, arrive]) = (self.at(span, from), self.at(span, to));
        let controls = [
            start,
            [0, 1].map(|i| start[i] + third * leave[i]),
            [0, 1].map(|i| end[i] - third * arrive[i]),
            end,
        ];
        let is_near = [0.25, 0.5, 0.75].iter().all(|p| {
            let point = self.at(span, from + p * (to - from))[0];
            let q = 1.0 - p;
            let weights = [q * q * q, 3.0 * q * q * p, 3.0 * q * p * p, p * p * p];
            let cubic = [0, 1].map(|i| (0..4).map(|k| weights[k] * controls[k][i]).sum::<f64>());
            libm::hypot(point[0] - cubic[0], point[1] - cubic[1]) <= near
        });
        if is_near || halvings == 0 {
            let [_, first, second, end] = controls;
            return chain.bezier([first, second, end]);
        }
        let middle = 0.5 * (from + to);
        self.add_span(chain, span, [from, middle], near, halvings - 1);
        self.add_span(chain, span, [middle, to], near, halvings - 1);
    }

    /// Point and its derivative at parameter `u` of a span (de Boor).
    fn at(&self, span: usize, u: f64) -> [[f64; 2]; 2] {
        let degree = self.degree;
        let mut points: Vec<[f64; 3]> = self.points[span - degree..=span].to_vec();
        let mut slope = [0.0; 3];
        for round in 1..=degree {
            for index in (round..=degree).rev() {
                let low = self.knots[span - degree + index];
                let high = self.knots[span + 1 + index - round];
                let (before, this) = (points[index - 1], points[index]);
                if round == degree {
                    let rate = degree as f64 / (high - low);
                    slope = [0, 1, 2].map(|i| rate * (this[i] - before[i]));
                }
                let part = (u - low) / (high - low);
                points[index] = [0, 1, 2].map(|i| (1.0 - part) * before[i] + part * this[i]);
            }
        }
        let [x, y, weight] = points[degree];
        let point = [x / weight, y / weight];
        let slope = [0, 1].map(|i| (slope[i] - slope[2] * point[i]) / weight);
        [point, slope]
    }
}
