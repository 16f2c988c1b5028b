//! Loop closure, places of the bodies, and their energies, as functions of the coordinates.

use super::LagrangeMachine;
use crate::scalar::{Plane, Scalar, difference, dot, scaled, solve, sum, turned};
use crate::tangent::Tangent;
use trirrr_core::machine::{LegParameters, LinkParameters};

/// Newton steps after a start in f64: the first doubles 16 digits, each doubles the order of the derivatives that are right.
const STEPS: usize = 4;

/// A body: where its centre of mass is, and how far it has turned.
struct LagrangeBody<S> {
    mass: f64,
    inertia: f64,
    centre: Plane<S>,
    angle: S,
}

fn along<S: Scalar>(length: f64, angle: S) -> Plane<S> {
    turned([S::constant(length), S::constant(0.0)], angle)
}

/// Angles of both links by which A + l1 e(theta1) + l2 e(theta2) = C. `d` is A -> C.
///
/// Returns `None` where the leg does not reach, or is stretched or folded.
pub fn closed<S: Scalar>(leg: &LegParameters, d: Plane<S>) -> Option<[S; 2]> {
    let (x, y) = (d[0].value(), d[1].value());
    let (l1, l2, span) = (leg.proximal_m, leg.distal_m, x.hypot(y));
    let cosine = (l1 * l1 + span * span - l2 * l2) / (2.0 * l1 * span);
    if cosine.is_nan() || cosine.abs() >= 1.0 {
        return None;
    }
    let first = y.atan2(x) + leg.elbow.sign() * cosine.acos();
    let second = (y - l1 * first.sin()).atan2(x - l1 * first.cos());
    let mut angles = [S::constant(first), S::constant(second)];
    for _ in 0..STEPS {
        let (r1, r2) = (along(l1, angles[0]), along(l2, angles[1]));
        let gap = difference(d, sum(r1, r2));
        let matrix = vec![vec![-r1[1], -r2[1]], vec![r1[0], r2[0]]];
        let step = solve(matrix, gap.to_vec());
        angles = [angles[0] + step[0], angles[1] + step[1]];
    }
    Some(angles)
}

impl LagrangeMachine {
    /// Legs with a slider, in order: slider k is coordinate 3 + k.
    pub fn slider_legs(&self) -> Vec<usize> {
        let legs = 0..self.legs.len();
        legs.filter(|&leg| self.sliders[leg].is_some()).collect()
    }

    /// A and C of a leg.
    fn ends<S: Scalar>(&self, index: usize, q: &[S]) -> [Plane<S>; 2] {
        let leg = &self.legs[index];
        let mut a = [leg.base_m.x, leg.base_m.y].map(S::constant);
        if let Some(slider) = &self.sliders[index] {
            let number = self.slider_legs().iter().position(|&it| it == index);
            let position = number.map_or(S::constant(0.0), |number| q[3 + number]);
            let guide = along(1.0, S::constant(slider.direction_rad));
            a = sum(a, scaled(guide, position));
        }
        let joint = along(leg.joint_radius_m, q[2] + S::constant(leg.joint_angle_rad));
        [a, sum([q[0], q[1]], joint)]
    }

    /// Angles of the links of each leg at the coordinates `q`.
    ///
    /// Returns `None` where a leg has none.
    pub fn angles<S: Scalar>(&self, q: &[S]) -> Option<Vec<[S; 2]>> {
        let legs = self.legs.iter().enumerate();
        legs.map(|(index, leg)| {
            let [a, c] = self.ends(index, q);
            closed(leg, difference(c, a))
        })
        .collect()
    }

    fn bodies<S: Scalar>(&self, q: &[S]) -> Option<Vec<LagrangeBody<S>>> {
        let com = [self.platform.com_m.x, self.platform.com_m.y].map(S::constant);
        let mut bodies = vec![LagrangeBody {
            mass: self.platform.mass_kg,
            inertia: self.platform.inertia_kgm2,
            centre: sum([q[0], q[1]], turned(com, q[2])),
            angle: q[2],
        }];
        let angles = self.angles(q)?;
        for (index, (leg, [first, second])) in self.legs.iter().zip(angles).enumerate() {
            let [a, _] = self.ends(index, q);
            if let Some(slider) = &self.sliders[index] {
                bodies.push(LagrangeBody {
                    mass: slider.mass_kg,
                    inertia: 0.0,
                    centre: a,
                    angle: S::constant(0.0),
                });
            }
            let link = |link: &LinkParameters, from, angle: S, rotor: f64| LagrangeBody {
                mass: link.mass_kg,
                inertia: link.inertia_kgm2 + rotor,
                centre: sum(from, along(link.com_m, angle)),
                angle,
            };
            bodies.push(link(&leg.proximal, a, first, leg.rotor_inertia_kgm2));
            let b = sum(a, along(leg.proximal_m, first));
            bodies.push(link(&leg.distal, b, second, 0.0));
        }
        Some(bodies)
    }

    /// Lagrangian T - V at the coordinates `q` and their rates. Each body's velocity is the derivative of its place along
    /// the rates.
    ///
    /// Returns `None` where a leg does not reach.
    pub fn lagrangian<S: Scalar>(&self, q: &[S], rates: &[S]) -> Option<S> {
        let pairs = q.iter().zip(rates);
        let moving: Vec<Tangent<S>> = pairs
            .map(|(&value, &slope)| Tangent { value, slope })
            .collect();
        let gravity = self.gravity.map(S::constant);
        let mut sum = S::constant(0.0);
        for body in self.bodies(&moving)? {
            let v = body.centre.map(|part| part.slope);
            let place = body.centre.map(|part| part.value);
            let half = S::constant(0.5);
            let (mass, inertia) = (S::constant(body.mass), S::constant(body.inertia));
            if body.mass != 0.0 {
                sum = sum + mass * (half * dot(v, v) + dot(gravity, place));
            }
            if body.inertia != 0.0 {
                sum = sum + half * inertia * body.angle.slope * body.angle.slope;
            }
        }
        Some(sum)
    }
}
