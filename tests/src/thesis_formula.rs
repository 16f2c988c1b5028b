//! The thesis's own formulas, errors included, for the tests that show what they give. Nothing of
//! this is in the core. Numbers in brackets are the thesis's equations; where its program differs
//! from the printed text, the program's form is the one here, and the printed one has a name.

use trirrr_core::machine::{LegParameters, Parameters};
use trirrr_core::setpoint::Setpoint;

/// One leg as the thesis computes it.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// C (3.2).
    pub joint: [f64; 2],
    /// theta_AC by the program's atan2.
    pub theta_ac: f64,
    /// theta_AC by the printed arctangent of a quotient (3.4).
    pub theta_ac_printed: f64,
    /// theta_i1 (3.8) and theta_i2 (3.9).
    pub angles: [f64; 2],
    /// Their rates, J^-1 (xdot_C, ydot_C), as the program solves (3.12).
    pub rates: [f64; 2],
    /// Their rates as printed in (3.14).
    pub rates_printed: [f64; 2],
    /// Their accelerations (3.21), with Z_i2 in the centripetal term of link 2.
    pub accelerations: [f64; 2],
    /// The same with the printed Z_i1 in that term.
    pub accelerations_printed: [f64; 2],
}

/// Computes one leg.
pub fn leg(leg: &LegParameters, setpoint: &Setpoint<f64>) -> Leg {
    let pose = &setpoint.pose;
    let (z1, z2, base) = (leg.proximal_m, leg.distal_m, leg.base_m);
    let (sin, cos) = (pose.angle + leg.joint_angle_rad).sin_cos();
    let (xh, yh) = (leg.joint_radius_m * cos, leg.joint_radius_m * sin);
    let (xc, yc) = (pose.position.x + xh, pose.position.y + yh);
    let (dx, dy) = (xc - base.x, yc - base.y);
    let z_ac = (dx * dx + dy * dy).sqrt();
    let theta_ac = dy.atan2(dx);
    let gamma = ((z1 * z1 + z_ac * z_ac - z2 * z2) / (2.0 * z1 * z_ac)).acos();
    let mu = ((z2 * z2 + z_ac * z_ac - z1 * z1) / (2.0 * z2 * z_ac)).acos();
    let angles = [theta_ac + gamma, theta_ac - mu + core::f64::consts::PI];

    let [(sin1, cos1), (sin2, cos2)] = angles.map(f64::sin_cos);
    let det = z1 * z2 * (cos1 * sin2 - sin1 * cos2);
    let inverse = |[x, y]: [f64; 2]| {
        [
            (z2 * cos2 * x + z2 * sin2 * y) / det,
            (-z1 * cos1 * x - z1 * sin1 * y) / det,
        ]
    };
    let (v, a) = (setpoint.velocity, setpoint.acceleration);
    let rates = inverse([v.x - yh * v.z, v.y + xh * v.z]);
    let a_c = [
        a.x - yh * a.z - xh * v.z * v.z,
        a.y + xh * a.z - yh * v.z * v.z,
    ];
    let [w1, w2] = rates.map(|rate| rate * rate);
    let accelerations = |z2_in_x: f64| {
        inverse([
            a_c[0] + z1 * cos1 * w1 + z2_in_x * cos2 * w2,
            a_c[1] + z1 * sin1 * w1 + z2 * sin2 * w2,
        ])
    };
    Leg {
        joint: [xc, yc],
        theta_ac,
        theta_ac_printed: (dy / dx).atan(),
        angles,
        rates,
        rates_printed: rates.map(|rate| -rate),
        accelerations: accelerations(z2),
        accelerations_printed: accelerations(z1),
    }
}

/// The "torques" C_i (4.18) to (4.20): C = -F . k with F the platform's inertial force and
/// k = Xdot / thetadot_i1 (4.15) to (4.17).
pub fn torques(parameters: &Parameters, setpoint: &Setpoint<f64>) -> [f64; 3] {
    let (v, a) = (setpoint.velocity, setpoint.acceleration);
    let platform = &parameters.platform;
    let force = [
        -platform.mass_kg * a.x,
        -platform.mass_kg * a.y,
        -platform.inertia_kgm2 * a.z,
    ];
    parameters.legs.map(|parameters| {
        let rate = leg(&parameters, setpoint).rates[0];
        let k = [v.x / rate, v.y / rate, v.z / rate];
        -force[0] * k[0] - force[1] * k[1] - force[2] * k[2]
    })
}

/// Coefficients of the cubic (5.4) to (5.7) and its value, velocity and acceleration at `t` as the
/// program evaluates them.
pub fn cubic(from: f64, to: f64, duration: f64, t: f64) -> [f64; 3] {
    let h = to - from;
    let a2 = 3.0 * h / (duration * duration);
    let a3 = -2.0 * h / (duration * duration * duration);
    [
        from + a2 * (t * t) + a3 * (t * t * t),
        2.0 * a2 * t + 3.0 * a3 * (t * t),
        2.0 * a2 + 6.0 * a3 * t,
    ]
}

/// Force (x, y) and moment of (4.6) as printed, for a link of mass `m` and inertia `i` with its
/// centre of mass at `s` from a joint that accelerates with `joint`.
pub fn inertial_load_printed(
    [m, i, s]: [f64; 3],
    joint: [f64; 2],
    [angle, rate, acceleration]: [f64; 3],
) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [
        m * (joint[0] - acceleration * s * sin - rate * rate * s * cos),
        m * (joint[1] - acceleration * s * cos - rate * rate * s * sin),
        m * s * (joint[0] * sin + joint[1] * cos + i * acceleration),
    ]
}

/// The same, corrected: + in F_y, - before x'', the inertia outside the bracket and about the
/// joint.
pub fn inertial_load(
    [m, i, s]: [f64; 3],
    joint: [f64; 2],
    [angle, rate, acceleration]: [f64; 3],
) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [
        m * (joint[0] - acceleration * s * sin - rate * rate * s * cos),
        m * (joint[1] + acceleration * s * cos - rate * rate * s * sin),
        m * s * (joint[1] * cos - joint[0] * sin) + (i + m * s * s) * acceleration,
    ]
}
