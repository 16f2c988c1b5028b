//! The tick's formulas as plain `f64` expressions whose functions are handed in: what an error of a
//! sine, a cosine or a square root does to the results. They use the identities that the core
//! uses, such as |r2| = l2, which wrong functions break.

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

fn left(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// Results of the motors with the functions as they are, and det A; `None` where a leg does not reach.
pub fn motors(
    parameters: &Parameters,
    setpoint: &Setpoint<f64>,
    functions: &Functions,
) -> Option<(Motors, f64)> {
    let turned = |v: Vector2<f64>| {
        let Functions { sin, cos, .. } = *functions;
        Vector2::new(v.x * cos - v.y * sin, v.y * cos + v.x * sin)
    };
    let (v, w) = (setpoint.velocity.xy(), setpoint.velocity.z);
    let (a, alpha2) = (setpoint.acceleration.xy(), setpoint.acceleration.z);
    let gravity = parameters.gravity_m_s2;

    // The platform's inertia, weight and wrench, moments about D.
    let platform = &parameters.platform;
    let s = turned(platform.com_m);
    let inertial = (a + left(s) * alpha2 - s * (w * w) - gravity) * platform.mass_kg;
    let mut force = inertial - parameters.wrench_force_n;
    let mut moment =
        platform.inertia_kgm2 * alpha2 + s.perp(&inertial) - parameters.wrench_torque_nm;

    let mut results = [[0.0; 4]; 3];
    let (mut arms, mut distals) = ([Vector2::zeros(); 3], [Vector2::zeros(); 3]);
    let mut crosses = [0.0; 3];
    for (index, leg) in parameters.legs.iter().enumerate() {
        let (l1, l2) = (leg.proximal_m, leg.distal_m);
        let (sin, cos) = leg.joint_angle_rad.sin_cos();
        let c = turned(Vector2::new(cos, sin) * leg.joint_radius_m);
        let d = setpoint.pose.position + c - leg.base_m;
        let square = d.dot(&d);
        let area = ((l1 + l2).powi(2) - square) * (square - (l1 - l2).powi(2)) / 4.0;
        if area <= 0.0 {
            return None;
        }
        let root = leg.elbow.sign() * area.sqrt() * functions.roots[index];
        let along = (square + l1 * l1 - l2 * l2) / 2.0;
        let r1 = (d * along + left(d) * root) / square;
        let r2 = d - r1;
        let cross = -root;
        let dot = (square - l1 * l1 - l2 * l2) / 2.0;

        let joint = v + left(c) * w;
        let (rate1, rate2) = (r2.dot(&joint) / cross, -r1.dot(&joint) / cross);
        let b = a + left(c) * alpha2 - c * (w * w);
        let (w1, w2) = (rate1 * rate1, rate2 * rate2);
        let acc1 = (r2.dot(&b) + w1 * dot + w2 * l2 * l2) / cross;
        let acc2 = -(r1.dot(&b) + w1 * l1 * l1 + w2 * dot) / cross;

        let (p, q) = (&leg.proximal, &leg.distal);
        // m2 l1 c2 times cosine and sine of the angle between the links.
        let coupling = q.mass_kg * q.com_m / l2;
        let (cosine, sine) = (coupling * dot, coupling * cross);
        let weight1 = (p.mass_kg * p.com_m / l1 + q.mass_kg) * gravity.dot(&left(r1));
        let weight2 = coupling * gravity.dot(&left(r2));
        let q1 = (p.mass_kg * p.com_m.powi(2) + p.inertia_kgm2 + q.mass_kg * l1 * l1) * acc1
            + cosine * acc2
            - sine * w2
            - weight1;
        let q2 = (q.mass_kg * q.com_m.powi(2) + q.inertia_kgm2) * acc2 + cosine * acc1 + sine * w1
            - weight2;
        // Across the distal link it pushes the platform by q E r2; the core's form of K2.
        let q = q2 / (l2 * l2);
        force += left(r2) * q;
        moment += c.dot(&r2) * q;
        arms[index] = c;
        distals[index] = r2;
        crosses[index] = cross;
        results[index] = [
            r1.y.atan2(r1.x),
            rate1,
            acc1,
            q1 - q * dot + leg.rotor_inertia_kgm2 * acc1,
        ];
    }
    // Moments about C1 and forces across leg 1 give f2 and f3; along leg 1, whose length is known,
    // what is left gives f1.
    let [d1, d2, d3] = distals;
    let moment = moment - arms[0].perp(&force);
    let [moment2, moment3] = [1, 2].map(|leg| (arms[leg] - arms[0]).perp(&distals[leg]));
    let det = d1.perp(&d2) * moment3 + d3.perp(&d1) * moment2;
    let across = d1.perp(&force);
    let f2 = (across * moment3 + d3.perp(&d1) * moment) / det;
    let f3 = (d1.perp(&d2) * moment - moment2 * across) / det;
    let f1 = d1.dot(&(force - d2 * f2 - d3 * f3)) / parameters.legs[0].distal_m.powi(2);
    for (leg, along) in [f1, f2, f3].into_iter().enumerate() {
        results[leg][3] += crosses[leg] * along;
    }
    Some((results, det))
}
