//! Forward dynamics of the machine in its minimal coordinates q = (x, y, alpha): what the joints'
//! torques do to the platform.
//!
//! The loops stay closed by construction: the legs follow from q by the core's dyads. With the
//! rows K1_i, K2_i that give the links' rates, theta1' = K1 v and theta2' = K2 v, where
//!
//! ```text
//! K1 = [r2x, r2y, c x r2] / D,   K2 = -[r1x, r1y, c x r1] / D,   D = r1 x r2
//! theta1'' = K1 a + g1,          theta2'' = K2 a + g2
//! ```
//! the leg's equations in its two angles (the core's `torque::links`) are carried to q:
//!
//! ```text
//! M a = W + sum_i K1^T (tau_i - h1_i) - K2^T h2_i,
//! M   = M_platform + sum_i [K1; K2]^T [J1, k r1.r2; k r1.r2, J2] [K1; K2]
//! h1  = J1 g1 + k (r1.r2 g2 - D theta2'^2) - w1 g.E r1
//! h2  = J2 g2 + k (r1.r2 g1 + D theta1'^2 - g.E r2)
//! ```
//! with J1 = m1 c1^2 + I1 + m2 l1^2 (+ N^2 J_r where the rotor sits rigidly on the joint),
//! J2 = m2 c2^2 + I2, k = m2 c2 / l2 and w1 = m1 c1 / l1 + m2. M is positive definite at every
//! pose but a stretched or folded leg's, a parallel singularity's included: there the platform is
//! loose, but it has its mass.

use crate::leg::{LegCoefficients, LegState, cross, dot, product, turned};
use crate::mass_matrix::{add_symmetric, solve};
use crate::refusal::Refusal;
use nalgebra::Vector2;
use trirrr_core::machine::Parameters;
use trirrr_core::number::Arithmetic;
use trirrr_core::status::Status;

/// The machine's coefficients. Absent masses and forces are `None` and take no part in the equations.
#[derive(Clone, Debug)]
pub struct Mechanics {
    legs: [LegCoefficients; 3],
    mass: f64,
    /// About D.
    inertia: f64,
    /// Centre of mass of the platform, in its own frame, where it is not D.
    centre: Option<Vector2<f64>>,
    links: Option<[LegInertias; 3]>,
    gravity: Option<Vector2<f64>>,
    /// (Wx, Wy, Walpha) at D.
    wrench: [f64; 3],
}

/// Inertias of a leg's links.
#[derive(Clone, Debug)]
struct LegInertias {
    /// J2.
    inertia: f64,
    /// k = m2 c2 / l2.
    coupling: f64,
    /// w1 = m1 c1 / l1 + m2.
    weight: f64,
}

/// Moments in the joints of a leg, each what its friction does against its motion.
#[derive(Clone, Copy, Debug, Default)]
pub struct JointMoments {
    /// On the proximal link at A: motor or transmission, less friction.
    pub proximal: f64,
    /// At the elbow B: against theta2' - theta1'.
    pub elbow: f64,
    /// At the platform joint C: against alpha' - theta2'.
    pub platform: f64,
}

impl Mechanics {
    /// Builds the coefficients. `rotors` says whether the rotors' inertia sits on the joints; with
    /// an elastic transmission in between it does not.
    ///
    /// # Errors
    /// The first quantity that the core refuses, or a platform without mass or inertia whose
    /// links have none either, so that nothing resists.
    pub fn build(parameters: &Parameters, rotors: bool) -> Result<Self, Refusal> {
        // The machine's own check, whatever the number type of the scene.
        trirrr_core::machine::Geometry::<f64>::build(parameters)
            .map_err(|error| Refusal::Machine(error.to_string()))?;
        let legs = parameters.legs.map(|leg| {
            let rotor = if rotors { leg.rotor_inertia_kgm2 } else { 0.0 };
            LegCoefficients::build(&leg, rotor)
        });
        let links = (!parameters.links_are_massless()).then(|| {
            parameters.legs.map(|leg| {
                let (m2, c2) = (leg.distal.mass_kg, leg.distal.com_m);
                LegInertias {
                    inertia: m2 * c2 * c2 + leg.distal.inertia_kgm2,
                    coupling: m2 * c2 / leg.distal_m,
                    weight: leg.proximal.mass_kg * leg.proximal.com_m / leg.proximal_m + m2,
                }
            })
        });
        let platform = parameters.platform;
        let centre = platform.com_m;
        let gravity = parameters.gravity_m_s2;
        let force = parameters.wrench_force_n;
        Ok(Self {
            legs,
            mass: platform.mass_kg,
            inertia: platform.inertia_kgm2 + platform.mass_kg * dot(centre, centre),
            centre: (centre != Vector2::zeros()).then_some(centre),
            links,
            gravity: (gravity != Vector2::zeros()).then_some(gravity),
            wrench: [force.x, force.y, parameters.wrench_torque_nm],
        })
    }

    /// The legs at the pose `q` = (x, y, alpha), moving with `v`.
    ///
    /// # Errors
    /// [`Status::Unreachable`], or [`Status::SerialSingular`] where a leg is exactly stretched.
    #[inline(always)]
    pub fn legs(&self, q: [f64; 3], v: [f64; 3]) -> Result<[LegState; 3], Status> {
        let rotation = <f64 as Arithmetic>::sin_cos(q[2]);
        Ok([
            self.legs[0].state(0, q, v, rotation)?,
            self.legs[1].state(1, q, v, rotation)?,
            self.legs[2].state(2, q, v, rotation)?,
        ])
    }

    /// theta_i1 of leg `index`, in (-pi, pi].
    #[inline(always)]
    pub fn motor_angle(&self, index: usize, leg: &LegState) -> f64 {
        self.legs[index].motor_angle(leg)
    }

    /// (x'', y'', alpha'') under the joints' moments.
    ///
    /// # Errors
    /// [`Refusal::NoInertia`] where the mass matrix is not positive definite.
    #[inline(always)]
    pub fn acceleration(
        &self,
        q: [f64; 3],
        v: [f64; 3],
        legs: &[LegState; 3],
        moments: &[JointMoments; 3],
    ) -> Result<[f64; 3], Refusal> {
        let spin = v[2] * v[2];
        // Upper triangle: xx, xy, xa, yy, ya, aa.
        let mut m = [self.mass, 0.0, 0.0, self.mass, 0.0, self.inertia];
        let mut right = self.wrench;
        if let Some(centre) = self.centre {
            let (sin, cos) = <f64 as Arithmetic>::sin_cos(q[2]);
            let s = turned(centre, sin, cos) * self.mass;
            m[2] = -s.y;
            m[4] = s.x;
            right[0] += s.x * spin;
            right[1] += s.y * spin;
            if let Some(g) = self.gravity {
                right[2] += cross(s, g);
            }
        }
        if let Some(g) = self.gravity {
            right[0] += self.mass * g.x;
            right[1] += self.mass * g.y;
        }
        for index in 0..3 {
            let (leg, coefficients, moment) = (&legs[index], &self.legs[index], &moments[index]);
            let inverse = leg.inverse;
            let [w1, w2] = [leg.rates[0] * leg.rates[0], leg.rates[1] * leg.rates[1]];
            let g1 = (w1 * leg.dot + w2 * coefficients.l2_sq - spin * dot(leg.r2, leg.c)) * inverse;
            let mut h1 = coefficients.inertia * g1 - moment.proximal - moment.elbow;
            let mut h2 = moment.elbow - moment.platform;
            let mut row1 = leg.k1.map(|k| coefficients.inertia * k);
            if let Some(links) = &self.links {
                let links = &links[index];
                let g2 =
                    (spin * dot(leg.r1, leg.c) - w1 * coefficients.l1_sq - w2 * leg.dot) * inverse;
                let mixed = links.coupling * leg.dot;
                let swing = links.coupling * leg.cross;
                h1 += mixed * g2 - swing * w2;
                h2 += links.inertia * g2 + mixed * g1 + swing * w1;
                if let Some(g) = self.gravity {
                    // g . E r = g x r turned: -gx ry + gy rx = r x g.
                    h1 -= links.weight * cross(leg.r1, g);
                    h2 -= links.coupling * cross(leg.r2, g);
                }
                let mut row2 = [0.0; 3];
                for axis in 0..3 {
                    row1[axis] += mixed * leg.k2[axis];
                    row2[axis] = links.inertia * leg.k2[axis] + mixed * leg.k1[axis];
                }
                add_symmetric(&mut m, &leg.k2, &row2);
            }
            add_symmetric(&mut m, &leg.k1, &row1);
            for (right, (k1, k2)) in right.iter_mut().zip(leg.k1.iter().zip(&leg.k2)) {
                *right -= k1 * h1 + k2 * h2;
            }
            right[2] -= moment.platform;
        }
        solve(&m, right).ok_or(Refusal::NoInertia)
    }

    /// Kinetic energy of platform, links and rotors that sit on the joints, J. Body by body, not
    /// through the mass matrix.
    pub fn kinetic_energy(&self, q: [f64; 3], v: [f64; 3], legs: &[LegState; 3]) -> f64 {
        let s = self.centre_of_mass(q[2]);
        let (vx, vy) = (v[0] - v[2] * s.y, v[1] + v[2] * s.x);
        let central = self.inertia - self.mass * dot(s, s);
        let mut twice = self.mass * (vx * vx + vy * vy) + central * v[2] * v[2];
        for (index, leg) in legs.iter().enumerate() {
            let [w1, w2] = leg.rates;
            twice += self.legs[index].inertia * w1 * w1;
            if let Some(links) = &self.links {
                let links = &links[index];
                twice += links.inertia * w2 * w2 + 2.0 * links.coupling * leg.dot * w1 * w2;
            }
        }
        0.5 * twice
    }

    /// Potential energy in gravity and in the constant wrench, J, up to a constant.
    pub fn potential_energy(&self, q: [f64; 3], legs: &[LegState; 3]) -> f64 {
        let mut energy = -product(&self.wrench, &q);
        if let Some(g) = self.gravity {
            let s = self.centre_of_mass(q[2]);
            energy -= self.mass * dot(g, Vector2::new(q[0], q[1]) + s);
            if let Some(links) = &self.links {
                for (leg, links) in legs.iter().zip(links) {
                    energy -= links.weight * dot(g, leg.r1) + links.coupling * dot(g, leg.r2);
                }
            }
        }
        energy
    }

    fn centre_of_mass(&self, alpha: f64) -> Vector2<f64> {
        let (sin, cos) = <f64 as Arithmetic>::sin_cos(alpha);
        self.centre
            .map_or(Vector2::zeros(), |centre| turned(centre, sin, cos))
    }

    /// Length of the longest leg, stretched, m: the machine's size.
    pub fn size(&self) -> f64 {
        self.legs
            .iter()
            .map(LegCoefficients::reach)
            .fold(0.0, f64::max)
    }
}
