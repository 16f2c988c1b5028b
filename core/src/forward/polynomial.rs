//! f(alpha), whose real roots are the orientations of the assembly modes: its value, and its
//! Bernstein coefficients on an arc with a bound on their error. [`super`] derives it.

use super::newton::Forward;
use crate::inverse::Rotation;
use crate::number::{Number, cross, dot, perpendicular};
use nalgebra::Vector2;

/// f for one set of elbows.
///
/// Lengths are divided by the greatest length that occurs, so that products of six of them stay in
/// the range of the number type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polynomial<N> {
    /// e_i = h_i - h_0, legs 1 and 2.
    e: [Vector2<N>; 2],
    /// b_i = B_i - B_0.
    b: [Vector2<N>; 2],
    /// l_i^2 - l_0^2.
    difference: [N; 2],
    l0_sq: N,
    /// (l_i + l_j)^2 and (l_i - l_j)^2 of the legs 0, 1; 0, 2; 1, 2: between them lie the squares of
    /// the distances at which their circles meet.
    meet: [[N; 2]; 3],
    /// |e_i| + |b_i|, roughly: where m_i is rounded.
    reach: [N; 2],
    /// Two roundings of it, times m_1 x m_2, bound what the rounding of the joints' places and of the
    /// lengths does to f where f is nearly zero.
    inputs: N,
}

/// (1 + t^2)^3 f on an arc.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnArc<N> {
    /// Bernstein coefficients: f lies between the least and the greatest.
    pub(super) coefficients: [N; 7],
    /// Bound of the rounding error of each.
    pub(super) rounding_bound: N,
}

/// A function a + b cos + c sin of an arc's angle, times 1 + t^2: its Bernstein coefficients times the
/// binomials 1, 2, 1, with bounds of their size and error.
#[derive(Clone, Copy)]
struct Quadratic<N> {
    scaled: [N; 3],
    size: N,
    error: N,
}

impl<N: Number> Quadratic<N> {
    /// `at` holds the coefficients of 1, t, t^2, for t in [-tau, tau].
    fn new(at: [N; 3], tau: N, error: N) -> Self {
        let [constant, slope, square] = [at[0], at[1] * tau, at[2] * (tau * tau)];
        let middle = constant - square;
        let (low, high) = (constant + square - slope, constant + square + slope);
        let size = greater(low.abs(), greater(middle.abs(), high.abs()));
        Self {
            scaled: [low, middle + middle, high],
            size: size + error,
            error,
        }
    }

    fn is_positive(&self) -> bool {
        let least = self.error + self.error;
        self.scaled.iter().all(|&c| c > least)
    }

    fn is_negative(&self) -> bool {
        let least = self.error + self.error;
        self.scaled.iter().all(|&c| c < -least)
    }
}

/// Products of polynomials in the scaled Bernstein basis are products of their coefficients.
fn times<N: Number, const A: usize, const B: usize, const C: usize>(
    a: &[N; A],
    b: &[N; B],
) -> [N; C] {
    let mut product = [N::ZERO; C];
    for (i, &x) in a.iter().enumerate() {
        for (j, &y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

pub(super) fn greater<N: Number>(a: N, b: N) -> N {
    if a > b { a } else { b }
}

/// |x| + |y|.
pub(super) fn extent<N: Number>(v: Vector2<N>) -> N {
    v.x.abs() + v.y.abs()
}

impl<N: Number> Polynomial<N> {
    pub(super) fn new(forward: &Forward<N>, elbows: &[Vector2<N>; 3]) -> Self {
        let [first, second, third] = &forward.legs;
        let e = [second.joint - first.joint, third.joint - first.joint];
        let b = [elbows[1] - elbows[0], elbows[2] - elbows[0]];
        let l = [first.l2, second.l2, third.l2];
        let greatest = e.iter().chain(&b).map(|v| extent(*v)).chain(l);
        let scale = N::ONE.div(greatest.fold(N::ZERO, greater));
        let (e, b) = (e.map(|v| v * scale), b.map(|v| v * scale));
        let [l0, l1, l2] = l.map(|l| l * scale);
        // An elbow is rounded as the sum of base and link, the link thrice before that, by sine and
        // product; the platform's joint once.
        let place = |leg: usize| {
            let leg = &forward.legs[leg];
            (N::HALF * (extent(leg.base) + extent(leg.joint)) + leg.l1 + leg.l1) * scale
        };
        // df = 2 (m_1 x m_2) ((p x m_2) (l_1 dl_1 - l_0 dl_0 - r2_1 . dm_1) + (m_1 x p) (...)), and
        // the products of p are at most l_0 l_i. A half more for the powers of 1 + t^2.
        let moved = place(0) + place(0) + place(1) + place(2) + l0 + l1 + l2;
        let inputs = (N::ONE + N::ONE + N::HALF) * (l0 * l1 * l2 * moved);
        let meet = |a: N, b: N| [(a + b) * (a + b), (a - b) * (a - b)];
        Self {
            meet: [meet(l0, l1), meet(l0, l2), meet(l1, l2)],
            e,
            b,
            difference: [(l1 - l0) * (l1 + l0), (l2 - l0) * (l2 + l0)],
            l0_sq: l0 * l0,
            inputs,
            reach: [extent(e[0]) + extent(b[0]), extent(e[1]) + extent(b[1])],
        }
    }

    /// R e_1 and R e_2.
    fn rotated(&self, alpha: N) -> [Vector2<N>; 2] {
        let rotation = Rotation::new(N::angle(alpha));
        self.e.map(|e| rotation.apply(e))
    }

    /// Returns `true` if f is positive at `alpha`, rad. It is where two of the circles miss each
    /// other, because the p of the linear equations then lies outside both.
    pub(super) fn is_positive(&self, alpha: N) -> bool {
        let [v1, v2] = self.rotated(alpha);
        let (m1, m2) = (v1 - self.b[0], v2 - self.b[1]);
        let centres = [m1, m2, m2 - m1];
        let misses = |(m, [far, near]): (Vector2<N>, [N; 2])| {
            let distance_sq = dot(m, m);
            distance_sq > far || distance_sq < near
        };
        centres.into_iter().zip(self.meet).any(misses) || self.value(alpha) >= N::ZERO
    }

    /// f at `alpha`, rad.
    pub(super) fn value(&self, alpha: N) -> N {
        let [v1, v2] = self.rotated(alpha);
        let (m1, m2) = (v1 - self.b[0], v2 - self.b[1]);
        let (m11, m22) = (dot(m1, m1), dot(m2, m2));
        let n1 = N::HALF * (self.difference[0] - m11);
        let n2 = N::HALF * (self.difference[1] - m22);
        let q = m2 * n1 - m1 * n2;
        let area = cross(m1, m2);
        dot(q, q) - self.l0_sq * (area * area)
    }

    /// f about `middle`, rad, for angles that differ from it by at most that with the half tangent
    /// `tau`; `half_width` is that angle.
    ///
    /// With v = R(middle) e and m = v - b the coefficients of 1, t, t^2 are
    ///
    /// ```text
    /// m_i . m_j     m_i.m_j    2 (m_i.E v_j + m_j.E v_i)    (v_i + b_i).(v_j + b_j)
    /// m_1 x m_2     m_1 x m_2  2 (m_1.v_2 - m_2.v_1)        (v_1 + b_1) x (v_2 + b_2)
    /// ```
    ///
    /// None of them is formed by subtracting larger numbers than m itself is.
    ///
    /// `None` where two of the circles do not meet anywhere on the arc: f may be small there, but
    /// it is not zero.
    pub(super) fn on_arc(&self, middle: N, half_width: N, tau: N) -> Option<OnArc<N>> {
        let two = N::ONE + N::ONE;
        // A component of m is rounded in the sine and cosine, two products and two sums. The test
        // below measures what is left between these constants and the errors that occur.
        let two_u = two * N::UNIT_ROUNDOFF;
        let four_u = two_u + two_u;

        let v = self.rotated(middle);
        let m = [v[0] - self.b[0], v[1] - self.b[1]];
        let opposite = [v[0] + self.b[0], v[1] + self.b[1]];
        // |m| on the arc, and what it is rounded at, bound the errors of all products of it.
        let size = |i: usize| extent(m[i]) + half_width * extent(v[i]);
        let sizes = [size(0), size(1)];
        let error = |i: usize, j: usize| {
            two_u * N::ab_plus_cd(sizes[i], self.reach[j], sizes[j], self.reach[i])
        };
        let product = |i: usize, j: usize| {
            let slope = dot(m[i], perpendicular(v[j])) + dot(m[j], perpendicular(v[i]));
            [
                dot(m[i], m[j]),
                slope + slope,
                dot(opposite[i], opposite[j]),
            ]
        };
        let difference = |i: usize, squared: &[N; 3]| {
            let at = [
                N::HALF * (self.difference[i] - squared[0]),
                -(N::HALF * squared[1]),
                N::HALF * (self.difference[i] - squared[2]),
            ];
            let rounded = self.difference[i].abs() + sizes[i] * sizes[i];
            Quadratic::new(at, tau, error(i, i) + two_u * rounded)
        };

        let (m11, m12, m22) = (product(0, 0), product(0, 1), product(1, 1));
        let between = [0, 1, 2].map(|i| m11[i] + m22[i] - (m12[i] + m12[i]));
        let error_between = error(0, 0) + error(1, 1) + error(0, 1) + error(0, 1);
        let pairs = [
            (m11, error(0, 0)),
            (m22, error(1, 1)),
            (between, error_between),
        ];
        for ((squared, error), [far, near]) in pairs.into_iter().zip(self.meet) {
            let less = |limit: N| {
                let at = [squared[0] - limit, squared[1], squared[2] - limit];
                Quadratic::new(at, tau, error + two_u * (squared[0] + limit))
            };
            if less(far).is_positive() || less(near).is_negative() {
                return None;
            }
        }
        let (n1, n2) = (difference(0, &m11), difference(1, &m22));
        let area_slope = dot(m[0], v[1]) - dot(m[1], v[0]);
        let area = [
            cross(m[0], m[1]),
            area_slope + area_slope,
            cross(opposite[0], opposite[1]),
        ];
        let area = Quadratic::new(area, tau, error(0, 1));
        let m11 = Quadratic::new(m11, tau, error(0, 0));
        let m12 = Quadratic::new(m12, tau, error(0, 1));
        let m22 = Quadratic::new(m22, tau, error(1, 1));
        let one = Quadratic::new([N::ONE, N::ZERO, N::ONE], tau, N::ZERO);

        // The four terms of f, each a product of three quadratics.
        let mut scaled = [N::ZERO; 7];
        let mut bound = N::ZERO;
        for (factor, a, b, c) in [
            (N::ONE, &n1, &n1, &m22),
            (N::ONE, &n2, &n2, &m11),
            (-two, &n1, &n2, &m12),
            (-self.l0_sq, &area, &area, &one),
        ] {
            let square: [N; 5] = times(&a.scaled, &b.scaled);
            let term: [N; 7] = times(&square, &c.scaled);
            for (sum, term) in scaled.iter_mut().zip(term) {
                *sum += factor * term;
            }
            let products = N::ab_plus_cd(a.error, b.size, a.size, b.error) * c.size
                + a.size * b.size * (c.error + four_u * c.size);
            bound += factor.abs() * products;
        }
        bound += two_u * (area.size * self.inputs);
        // Over the binomials 1, 6, 15, 20, 15, 6, 1.
        let over = |binomial: f64| N::from_f64(1.0 / binomial);
        let (sixth, fifteenth, twentieth) = (over(6.0), over(15.0), over(20.0));
        Some(OnArc {
            coefficients: [
                scaled[0],
                scaled[1] * sixth,
                scaled[2] * fifteenth,
                scaled[3] * twentieth,
                scaled[4] * fifteenth,
                scaled[5] * sixth,
                scaled[6],
            ],
            rounding_bound: bound,
        })
    }
}

impl<N: Number> OnArc<N> {
    /// f is not zero anywhere on the arc.
    pub(super) fn is_clear(&self) -> bool {
        self.coefficients.iter().all(|&c| c > self.rounding_bound)
            || self.coefficients.iter().all(|&c| c < -self.rounding_bound)
    }

    /// (1 + t^2)^3 f has no extremum on the arc: at most one root.
    pub(super) fn is_monotone(&self) -> bool {
        let least = self.rounding_bound + self.rounding_bound;
        let mut steps = self.coefficients.iter().zip(&self.coefficients[1..]);
        let (mut rises, mut falls) = (true, true);
        for (&from, &to) in &mut steps {
            rises &= to - from > least;
            falls &= to - from < -least;
        }
        rises || falls
    }

    /// Returns `true` if f stays below its rounding bound, so that its sign is unknown.
    pub(super) fn is_within_rounding(&self) -> bool {
        // Twice the bound: arcs at its edge would be halved without end.
        let two = self.rounding_bound + self.rounding_bound;
        !self.coefficients.iter().any(|&c| c.abs() > two)
    }
}

#[cfg(test)]
mod tests {
    use super::super::newton::ForwardLeg;
    use super::super::random::{any, deterministic};
    use super::*;
    use crate::machine::Geometry;
    use core::cell::Cell;

    /// The same machine in f32 and, exactly, in f64.
    fn both(case: &super::super::random::Closed) -> (Polynomial<f32>, Polynomial<f64>) {
        let geometry = Geometry::<f32>::build(&case.parameters).unwrap();
        let single = Forward::build(&case.parameters, &geometry);
        let elbows = single.elbows(&case.angles.map(|theta| theta as f32));
        let double = Forward {
            legs: single.legs.map(|leg| ForwardLeg {
                base: leg.base.map(f64::from),
                joint: leg.joint.map(f64::from),
                l1: f64::from(leg.l1),
                l2: f64::from(leg.l2),
            }),
            size: f64::from(single.size),
            greatest_det_a: f64::from(single.greatest_det_a),
            exact: single.exact,
        };
        let exact = elbows.map(|elbow| elbow.map(f64::from));
        (
            Polynomial::new(&single, &elbows),
            Polynomial::new(&double, &exact),
        )
    }

    #[test]
    fn errors_stay_within_the_bound() {
        let worst = Cell::new(0.0f64);
        deterministic(2000, any(), |case| {
            let (single, double) = both(&case);
            for (middle, half_width) in [(0.7f32, 0.39f32), (-2.3, 0.01), (3.1, 1e-5)] {
                let tau = (0.5 * half_width).tan();
                let Some(rounded) = single.on_arc(middle, half_width, tau) else {
                    continue;
                };
                let (middle, half_width) = (f64::from(middle), f64::from(half_width));
                let exact = double.on_arc(middle, half_width, f64::from(tau));
                let exact = exact.expect("circles that meet in f32 meet");
                for (rounded_at, at) in rounded.coefficients.iter().zip(exact.coefficients) {
                    let off =
                        (f64::from(*rounded_at) - at).abs() / f64::from(rounded.rounding_bound);
                    worst.set(worst.get().max(off));
                }
            }
        });
        // It is a bound, and not one that hides everything.
        assert!((0.05..1.0).contains(&worst.get()), "{worst:?}");
    }

    #[test]
    fn coefficients_on_an_arc_are_those_of_the_value() {
        deterministic(500, any(), |case| {
            let (_, f) = both(&case);
            let (middle, half_width) = (0.4, 0.3);
            let tau = f64::tan(0.5 * half_width);
            let Some(on_arc) = f.on_arc(middle, half_width, tau) else {
                return;
            };
            for part in [-1.0, -0.3, 0.0, 0.6, 1.0f64] {
                let alpha = middle + 2.0 * (part * tau).atan();
                // De Casteljau at part, from [-1, 1].
                let mut points = on_arc.coefficients;
                for degree in (1..7).rev() {
                    for i in 0..degree {
                        points[i] += (points[i + 1] - points[i]) * (0.5 + 0.5 * part);
                    }
                }
                let weight = (1.0 + (part * tau).powi(2)).powi(3);
                let off = points[0] - weight * f.value(alpha);
                assert!(
                    off.abs() < on_arc.rounding_bound,
                    "{off:e} {:e}",
                    on_arc.rounding_bound
                );
            }
        });
    }
}
