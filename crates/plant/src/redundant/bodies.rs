//! Energies of the bodies of a redundant machine, body by body and not through the mass matrix.

use super::dynamics::{Coordinates, Dynamics, Joints};
use nalgebra::Vector2;
use trirrr_linkage::redundant::RedundantParameters;

/// Turns `v` by a quarter and scales it: velocity of the end of `v` at the angular rate `rate`.
fn turning(v: Vector2<f64>, rate: f64) -> Vector2<f64> {
    Vector2::new(-v.y, v.x) * rate
}

/// Kinetic energy, and potential energy in gravity, J, of the machine at `q` with the rates `v`.
pub(super) fn energy<const LEGS: usize>(
    parameters: &RedundantParameters<LEGS>,
    dynamics: &Dynamics<LEGS>,
    joints: &Joints<LEGS>,
    q: &Coordinates,
    v: &Coordinates,
) -> f64 {
    let gravity = parameters.gravity_m_s2;
    let body = |mass: f64, inertia: f64, at: Vector2<f64>, velocity: Vector2<f64>, rate: f64| {
        0.5 * (mass * velocity.dot(&velocity) + inertia * rate * rate) - mass * gravity.dot(&at)
    };
    let platform = &parameters.platform;
    let (sin, cos) = q[2].sin_cos();
    let com = platform.com_m;
    let s = Vector2::new(com.x * cos - com.y * sin, com.x * sin + com.y * cos);
    let mut energy = body(
        platform.mass_kg,
        platform.inertia_kgm2,
        Vector2::new(q[0], q[1]) + s,
        Vector2::new(v[0], v[1]) + turning(s, v[2]),
        v[2],
    );
    for (index, leg) in parameters.legs.iter().enumerate() {
        let (mut at, mut velocity) = (leg.base_m, Vector2::zeros());
        let number = dynamics.sliders.iter().position(|&it| it == index);
        if let (Some(slider), Some(number)) = (&parameters.sliders[index], number) {
            let (sin, cos) = slider.direction_rad.sin_cos();
            at += Vector2::new(cos, sin) * q[3 + number];
            velocity = Vector2::new(cos, sin) * v[3 + number];
            energy += body(slider.mass_kg, 0.0, at, velocity, 0.0);
        }
        let motion = &joints.motion.legs[index];
        let (links, rates) = (&motion.position.links, &motion.rates);
        let (proximal, distal) = (&leg.proximal, &leg.distal);
        let com = links.r1 * (proximal.com_m / leg.proximal_m);
        energy += body(
            proximal.mass_kg,
            proximal.inertia_kgm2 + leg.rotor_inertia_kgm2,
            at + com,
            velocity + turning(com, rates.proximal),
            rates.proximal,
        );
        at += links.r1;
        velocity += turning(links.r1, rates.proximal);
        let com = links.r2 * (distal.com_m / leg.distal_m);
        energy += body(
            distal.mass_kg,
            distal.inertia_kgm2,
            at + com,
            velocity + turning(com, rates.distal),
            rates.distal,
        );
    }
    energy
}
