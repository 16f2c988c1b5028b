//! The machine computed a second time, by other means than the core's: kinematics by angles, the
//! dynamics as the 21 equations of Newton and Euler for seven rigid bodies, in any [`Scalar`].
//!
//! Nothing here knows virtual work, so that an error in the core's derivation shows.

use crate::inputs::{Inputs, LegInputs};
use crate::scalar::{Plane, Scalar, cross, difference, dot, scaled, solve, sum, turned};

/// One leg in motion.
#[derive(Clone, Copy, Debug)]
pub struct LegMotion<S> {
    /// Joints B and C.
    pub joints: [Plane<S>; 2],
    /// A -> B and B -> C.
    pub links: [Plane<S>; 2],
    /// theta_i1 and theta_i2 (B -> C); not wrapped.
    pub angles: [S; 2],
    /// Their rates.
    pub rates: [S; 2],
    /// Their accelerations.
    pub accelerations: [S; 2],
    /// r1 x r2.
    pub cross: S,
}

/// The machine in motion.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics<S> {
    /// The legs.
    pub legs: [LegMotion<S>; 3],
    /// det of the rows [r2x, r2y, c x r2].
    pub det_a: S,
}

/// Torques and forces that hold and drive the machine.
#[derive(Clone, Copy, Debug)]
pub struct Dynamics<S> {
    /// Motor torques.
    pub torques: [S; 3],
    /// Forces in the joints A, B, C of each leg, each on the outer body.
    pub forces: [[Plane<S>; 3]; 3],
}

/// A body: mass, central inertia, centre of mass, its acceleration, angular acceleration.
struct Body<S> {
    mass: S,
    inertia: S,
    centre: Plane<S>,
    acceleration: Plane<S>,
    angle_acceleration: S,
}

fn left<S: Scalar>(v: Plane<S>) -> Plane<S> {
    [-v[1], v[0]]
}

/// Acceleration of the end of `r` relative to its start.
fn of_radius<S: Scalar>(r: Plane<S>, rate: S, acceleration: S) -> Plane<S> {
    difference(scaled(left(r), acceleration), scaled(r, rate * rate))
}

impl<S: Scalar> Inputs<S> {
    /// D -> C of leg `index`.
    fn platform_joint(&self, index: usize) -> Plane<S> {
        let leg = &self.legs[index];
        turned([leg.h, S::constant(0.0)], self.angle + leg.lambda)
    }

    /// Centre of mass of the platform relative to D.
    fn platform_centre(&self) -> Plane<S> {
        turned(self.com, self.angle)
    }

    /// Positions, rates and accelerations.
    pub fn kinematics(&self) -> Kinematics<S> {
        let legs = [0, 1, 2].map(|index| self.leg_motion(index));
        let row = |index: usize| {
            let r2 = legs[index].links[1];
            [r2[0], r2[1], cross(self.platform_joint(index), r2)]
        };
        let [a, b, c] = [row(0), row(1), row(2)];
        let det_a = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        Kinematics { legs, det_a }
    }

    fn leg_motion(&self, index: usize) -> LegMotion<S> {
        let LegInputs {
            base,
            l1,
            l2,
            elbow,
            ..
        } = self.legs[index];
        let c = self.platform_joint(index);
        let joint = sum(self.position, c);
        let d = difference(joint, base);
        // Law of cosines at A, with the sine from the triangle's area: no arccosine, which loses
        // digits at a stretched leg.
        let half = S::constant(0.5);
        let square = dot(d, d);
        let cosine = half * (square + (l1 - l2) * (l1 + l2));
        let sine = half
            * (((l1 + l2) * (l1 + l2) - square) * (square - (l1 - l2) * (l1 - l2))).sqrt()
            * S::constant(elbow);
        let angle = S::atan2(d[1], d[0]) + S::atan2(sine, cosine);
        let r1 = turned([l1, S::constant(0.0)], angle);
        let r2 = difference(d, r1);

        let v = sum(self.velocity, scaled(left(c), self.angle_rate));
        let a = sum(
            self.acceleration,
            of_radius(c, self.angle_rate, self.angle_acceleration),
        );
        // v = rate1 E r1 + rate2 E r2, and the same for what the centripetal parts leave of a.
        let matrix = || {
            let (e1, e2) = (left(r1), left(r2));
            vec![vec![e1[0], e2[0]], vec![e1[1], e2[1]]]
        };
        let rates = solve(matrix(), v.to_vec());
        let centripetal = sum(
            scaled(r1, rates[0] * rates[0]),
            scaled(r2, rates[1] * rates[1]),
        );
        let accelerations = solve(matrix(), sum(a, centripetal).to_vec());
        LegMotion {
            joints: [sum(base, r1), joint],
            links: [r1, r2],
            angles: [angle, S::atan2(r2[1], r2[0])],
            rates: [rates[0], rates[1]],
            accelerations: [accelerations[0], accelerations[1]],
            cross: cross(r1, r2),
        }
    }

    fn bodies(&self, leg: &LegInputs<S>, motion: &LegMotion<S>) -> [Body<S>; 2] {
        let [r1, r2] = motion.links;
        let [acc1, acc2] = motion.accelerations;
        let relative1 = of_radius(r1, motion.rates[0], acc1);
        let relative2 = of_radius(r2, motion.rates[1], acc2);
        let (share1, share2) = (leg.c1 / leg.l1, leg.c2 / leg.l2);
        [
            Body {
                mass: leg.m1,
                inertia: leg.i1,
                centre: sum(leg.base, scaled(r1, share1)),
                acceleration: scaled(relative1, share1),
                angle_acceleration: acc1,
            },
            Body {
                mass: leg.m2,
                inertia: leg.i2,
                centre: sum(motion.joints[0], scaled(r2, share2)),
                acceleration: sum(relative1, scaled(relative2, share2)),
                angle_acceleration: acc2,
            },
        ]
    }

    /// Torques and joint forces from the balance of each body.
    pub fn dynamics(&self, kinematics: &Kinematics<S>) -> Dynamics<S> {
        let mut system = ForceEquations::new();
        for (index, (leg, motion)) in self.legs.iter().zip(&kinematics.legs).enumerate() {
            let [proximal, distal] = self.bodies(leg, motion);
            let [b, c] = motion.joints;
            let unknown = 7 * index;
            let (at_a, at_b, at_c, torque) = (unknown, unknown + 2, unknown + 4, unknown + 6);
            // The rotor turns with the proximal link; the motor's torque moves both.
            let rotor = leg.rotor * motion.accelerations[0];
            system.balance(
                self,
                &proximal,
                &[(at_a, leg.base, 1.0), (at_b, b, -1.0)],
                rotor,
            );
            system.add_to_last(torque, S::constant(1.0));
            let zero = S::constant(0.0);
            system.balance(self, &distal, &[(at_b, b, 1.0), (at_c, c, -1.0)], zero);
        }
        let s = self.platform_centre();
        let platform = Body {
            mass: self.mass,
            inertia: self.inertia,
            centre: sum(self.position, s),
            acceleration: sum(
                self.acceleration,
                of_radius(s, self.angle_rate, self.angle_acceleration),
            ),
            angle_acceleration: self.angle_acceleration,
        };
        let joint = |index: usize| (7 * index + 4, kinematics.legs[index].joints[1], 1.0);
        // The wrench acts at D, which lies at -s from the centre of mass.
        let known_moment = -(self.moment - cross(s, self.force));
        system.balance(
            self,
            &platform,
            &[joint(0), joint(1), joint(2)],
            known_moment,
        );
        system.add_to_forces_of_last(self.force);

        let x = solve(system.matrix, system.right);
        let force = |at: usize| [x[at], x[at + 1]];
        Dynamics {
            torques: [x[6], x[13], x[20]],
            forces: [0, 7, 14].map(|at| [force(at), force(at + 2), force(at + 4)]),
        }
    }

    /// Kinetic plus potential energy.
    pub fn energy(&self, kinematics: &Kinematics<S>) -> S {
        let half = S::constant(0.5);
        let of_body = |mass: S, inertia: S, centre: Plane<S>, v: Plane<S>, rate: S| {
            half * (mass * dot(v, v) + inertia * rate * rate) - mass * dot(self.gravity, centre)
        };
        let s = self.platform_centre();
        let v = sum(self.velocity, scaled(left(s), self.angle_rate));
        let platform = of_body(
            self.mass,
            self.inertia,
            sum(self.position, s),
            v,
            self.angle_rate,
        );
        self.legs
            .iter()
            .zip(&kinematics.legs)
            .fold(platform, |energy, (leg, motion)| {
                let [proximal, distal] = self.bodies(leg, motion);
                let [rate1, rate2] = motion.rates;
                let v1 = scaled(left(motion.links[0]), rate1);
                let v2 = scaled(left(motion.links[1]), rate2);
                let (share1, share2) = (leg.c1 / leg.l1, leg.c2 / leg.l2);
                let at_distal = sum(v1, scaled(v2, share2));
                energy
                    + of_body(leg.m1, leg.i1, proximal.centre, scaled(v1, share1), rate1)
                    + of_body(leg.m2, leg.i2, distal.centre, at_distal, rate2)
                    + half * leg.rotor * rate1 * rate1
            })
    }

    /// Power of the wrench.
    pub fn wrench_power(&self) -> S {
        dot(self.force, self.velocity) + self.moment * self.angle_rate
    }
}

/// The 21 equations in 18 force components and 3 torques.
struct ForceEquations<S> {
    matrix: Vec<Vec<S>>,
    right: Vec<S>,
}

impl<S: Scalar> ForceEquations<S> {
    fn new() -> Self {
        Self {
            matrix: Vec::with_capacity(21),
            right: Vec::with_capacity(21),
        }
    }

    /// Three equations: forces in x and y, moments about the centre of mass. `joints` are
    /// (unknown, place, sign) of the forces on the body; `moment` joins the inertial moment.
    fn balance(
        &mut self,
        inputs: &Inputs<S>,
        body: &Body<S>,
        joints: &[(usize, Plane<S>, f64)],
        moment: S,
    ) {
        let mut rows = vec![vec![S::constant(0.0); 21]; 3];
        for &(unknown, place, sign) in joints {
            let sign = S::constant(sign);
            let arm = difference(place, body.centre);
            rows[0][unknown] = sign;
            rows[1][unknown + 1] = sign;
            rows[2][unknown] = -(arm[1] * sign);
            rows[2][unknown + 1] = arm[0] * sign;
        }
        self.matrix.append(&mut rows);
        let force = scaled(difference(body.acceleration, inputs.gravity), body.mass);
        self.right.extend(force);
        self.right
            .push(body.inertia * body.angle_acceleration + moment);
    }

    fn add_to_last(&mut self, unknown: usize, coefficient: S) {
        self.matrix.last_mut().expect("an equation")[unknown] = coefficient;
    }

    /// A known force on the body balanced last.
    fn add_to_forces_of_last(&mut self, force: Plane<S>) {
        let equation = self.right.len() - 3;
        for (axis, component) in force.into_iter().enumerate() {
            self.right[equation + axis] = self.right[equation + axis] - component;
        }
    }
}
