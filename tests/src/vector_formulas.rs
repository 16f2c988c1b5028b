//! The tick's formulas as plain `f64` expressions whose functions and roundings are handed in: what
//! an error of a sine, a cosine or a square root does to the results, and what the rounding of any
//! value on the way does. They use the identities that the core uses, such as |r2| = l2, which wrong
//! functions break.

use crate::motors::Motors;
use nalgebra::Vector2;
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::Setpoint;

/// What the functions give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Functions {
    /// Sine of the platform's angle.
    pub sin: f64,
    /// Its cosine.
    pub cos: f64,
    /// The square root of each leg over the true one.
    pub roots: [f64; 3],
}

impl Functions {
    /// The true ones.
    pub fn exact(setpoint: &Setpoint<f64>) -> Self {
        let (sin, cos) = setpoint.pose.angle.sin_cos();
        Self {
            sin,
            cos,
            roots: [1.0; 3],
        }
    }
}

/// Exponents of length, time and mass.
pub type Dimension = [i32; 3];

const NUMBER: Dimension = [0, 0, 0];
const LENGTH: Dimension = [1, 0, 0];
const AREA: Dimension = [2, 0, 0];
const DET: Dimension = [4, 0, 0];
const VELOCITY: Dimension = [1, -1, 0];
const ACCELERATION: Dimension = [1, -2, 0];
const RATE: Dimension = [0, -1, 0];
const PER_TIME_SQUARED: Dimension = [0, -2, 0];
const REACTION: Dimension = [2, -2, 0];
const MASS: Dimension = [0, 0, 1];
const INERTIA: Dimension = [2, 0, 1];
const MASS_PER_AREA: Dimension = [-2, 0, 1];
const FORCE: Dimension = [1, -2, 1];
const FORCE_PER_LENGTH: Dimension = [0, -2, 1];
const MOMENT: Dimension = [2, -2, 1];

fn left(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// Results of the motors with the functions as they are, and det A; `None` where a leg does not
/// reach. Every value that a number type holds on the way goes through `round`, in a fixed order.
pub fn motors(
    parameters: &Parameters,
    setpoint: &Setpoint<f64>,
    functions: &Functions,
    mut round: impl FnMut(Dimension, f64) -> f64,
) -> Option<(Motors, f64)> {
    let (sin, cos) = (round(NUMBER, functions.sin), round(NUMBER, functions.cos));
    let turned = |v: Vector2<f64>| Vector2::new(v.x * cos - v.y * sin, v.y * cos + v.x * sin);
    let mut pair = |dimension, v: Vector2<f64>| v.map(|part| round(dimension, part));
    let position = pair(LENGTH, setpoint.pose.position);
    let (v, a) = (
        pair(VELOCITY, setpoint.velocity.xy()),
        pair(ACCELERATION, setpoint.acceleration.xy()),
    );
    let gravity = pair(ACCELERATION, parameters.gravity_m_s2);

    // The platform's inertia, weight and wrench, moments about D.
    let platform = &parameters.platform;
    let com = pair(LENGTH, platform.com_m);
    let s = pair(LENGTH, turned(com));
    let (w, alpha2) = (
        round(RATE, setpoint.velocity.z),
        round(PER_TIME_SQUARED, setpoint.acceleration.z),
    );
    let w_squared = round(PER_TIME_SQUARED, w * w);
    let mut pair = |dimension, v: Vector2<f64>| v.map(|part| round(dimension, part));
    let at_centre = pair(ACCELERATION, a + left(s) * alpha2 - s * w_squared - gravity);
    let inertial = pair(FORCE, at_centre * platform.mass_kg);
    let mut force = inertial - pair(FORCE, parameters.wrench_force_n);
    let mut moment = round(MOMENT, platform.inertia_kgm2 * alpha2)
        + round(MOMENT, s.perp(&inertial))
        - round(MOMENT, parameters.wrench_torque_nm);

    let mut results = [[0.0; 4]; 3];
    let (mut arms, mut distals) = ([Vector2::zeros(); 3], [Vector2::zeros(); 3]);
    let mut crosses = [0.0; 3];
    for (index, leg) in parameters.legs.iter().enumerate() {
        let (l1, l2) = (leg.proximal_m, leg.distal_m);
        let (sin, cos) = leg.joint_angle_rad.sin_cos();
        let mut pair = |dimension, v: Vector2<f64>| v.map(|part| round(dimension, part));
        let joint = pair(LENGTH, Vector2::new(cos, sin) * leg.joint_radius_m);
        let c = pair(LENGTH, turned(joint));
        let d = position + c - pair(LENGTH, leg.base_m);
        let square = d.dot(&d);
        let area = ((l1 + l2).powi(2) - square) * (square - (l1 - l2).powi(2)) / 4.0;
        if area <= 0.0 {
            return None;
        }
        let root = leg.elbow.sign() * area.sqrt() * functions.roots[index];
        let along = (square + l1 * l1 - l2 * l2) / 2.0;
        let r1 = pair(LENGTH, (d * along + left(d) * root) / square);
        let r2 = d - r1;
        let v_joint = pair(VELOCITY, v + left(c) * w);
        let b = pair(ACCELERATION, a + left(c) * alpha2 - c * w_squared);
        let (inverse, cross) = (-1.0 / root, round(AREA, -root));
        let [l1_sq, l2_sq] = [l1 * l1, l2 * l2].map(|square| round(AREA, square));
        let dot = round(AREA, (square - l1 * l1 - l2 * l2) / 2.0);

        let rate1 = round(RATE, r2.dot(&v_joint) * inverse);
        let rate2 = round(RATE, -r1.dot(&v_joint) * inverse);
        let [w1, w2] = [rate1, rate2].map(|rate| round(PER_TIME_SQUARED, rate * rate));
        let acc1 = (r2.dot(&b) + w1 * dot + w2 * l2_sq) * inverse;
        let acc2 = -(r1.dot(&b) + w1 * l1_sq + w2 * dot) * inverse;
        let [acc1, acc2] = [acc1, acc2].map(|acc| round(PER_TIME_SQUARED, acc));

        let (p, q) = (&leg.proximal, &leg.distal);
        let j1 = p.mass_kg * p.com_m.powi(2) + p.inertia_kgm2 + q.mass_kg * l1 * l1;
        let j1 = round(INERTIA, j1 + leg.rotor_inertia_kgm2);
        let j2 = round(
            MASS,
            (q.mass_kg * q.com_m.powi(2) + q.inertia_kgm2) / (l2 * l2),
        );
        let coupling = round(MASS, q.mass_kg * q.com_m / l2);
        let coupling2 = round(MASS_PER_AREA, q.mass_kg * q.com_m / l2.powi(3));
        let weight = round(MASS, p.mass_kg * p.com_m / l1 + q.mass_kg);
        let [across1, across2] = [r1, r2].map(|r| round(REACTION, gravity.dot(&left(r))));
        let reaction1 = round(REACTION, dot * acc2 - cross * w2);
        let reaction2 = round(REACTION, dot * acc1 + cross * w1 - across2);
        let q = round(FORCE_PER_LENGTH, j2 * acc2 + coupling2 * reaction2);
        let q1 = j1 * acc1 + coupling * reaction1 - weight * across1;
        let at_motor = round(MOMENT, q1 - q * dot);
        // Across the distal link it pushes the platform by q E r2; the core's form of K2.
        force += left(r2) * q;
        moment += c.dot(&r2) * q;
        arms[index] = c;
        distals[index] = r2;
        crosses[index] = cross;
        results[index] = [r1.y.atan2(r1.x), rate1, acc1, at_motor];
    }
    // Moments about C1 and forces across leg 1 give f2 and f3; along leg 1, whose length is known,
    // what is left gives f1.
    let [d1, d2, d3] = distals;
    let force = force.map(|part| round(FORCE, part));
    let moment = round(MOMENT, moment - arms[0].perp(&force));
    let [moment2, moment3] =
        [1, 2].map(|leg: usize| round(AREA, (arms[leg] - arms[0]).perp(&distals[leg])));
    let (d1_x_d2, d3_x_d1) = (round(AREA, d1.perp(&d2)), round(AREA, d3.perp(&d1)));
    let det = round(DET, d1_x_d2 * moment3 + d3_x_d1 * moment2);
    let across = round(MOMENT, d1.perp(&force));
    let f2 = round(
        FORCE_PER_LENGTH,
        (across * moment3 + d3_x_d1 * moment) / det,
    );
    let f3 = round(
        FORCE_PER_LENGTH,
        (d1_x_d2 * moment - moment2 * across) / det,
    );
    let rest = (force - d2 * f2 - d3 * f3).map(|part| round(FORCE, part));
    let f1 = round(
        FORCE_PER_LENGTH,
        d1.dot(&rest) / parameters.legs[0].distal_m.powi(2),
    );
    for (leg, along) in [f1, f2, f3].into_iter().enumerate() {
        results[leg][3] = round(MOMENT, results[leg][3] + crosses[leg] * along);
    }
    Some((results, det))
}
