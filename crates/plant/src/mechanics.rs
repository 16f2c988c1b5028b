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

use super::refusal::Refusal;
use nalgebra::Vector2;
use trirrr_core::dyad::{OutOfReach, Rrr};
use trirrr_core::machine::Parameters;
use trirrr_core::number::{Arithmetic, WideArithmetic};
use trirrr_core::status::Status;

/// The machine's coefficients. What it has not is `None` and takes no part in its equations.
#[derive(Clone, Debug)]
pub struct Mechanics {
    legs: [LegCoefficients; 3],
    mass: f64,
    /// About D.
    inertia: f64,
    /// Centre of mass of the platform, in its own frame, where it is not D.
    centre: Option<Vector2<f64>>,
    links: Option<[Links; 3]>,
    gravity: Option<Vector2<f64>>,
    /// (Wx, Wy, Walpha) at D.
    wrench: [f64; 3],
}

#[derive(Clone, Debug)]
struct LegCoefficients {
    base: Vector2<f64>,
    /// Platform joint in the platform's frame.
    joint: Vector2<f64>,
    dyad: Rrr<f64>,
    l1_sq: f64,
    l2_sq: f64,
    l1: f64,
    /// J1.
    inertia: f64,
}

/// What a leg's links add to the inertia about its motor.
#[derive(Clone, Debug)]
struct Links {
    /// J2.
    inertia: f64,
    /// k = m2 c2 / l2.
    coupling: f64,
    /// w1 = m1 c1 / l1 + m2.
    weight: f64,
}

/// One leg at one pose and velocity.
#[derive(Clone, Copy, Debug)]
pub struct LegState {
    /// D -> C.
    pub c: Vector2<f64>,
    /// A -> B.
    pub r1: Vector2<f64>,
    /// B -> C.
    pub r2: Vector2<f64>,
    /// D = r1 x r2.
    pub cross: f64,
    /// 1 / D.
    pub inverse: f64,
    /// r1 . r2.
    pub dot: f64,
    /// K1: theta1' = K1 v.
    pub k1: [f64; 3],
    /// K2: theta2' = K2 v.
    pub k2: [f64; 3],
    /// theta1', theta2'.
    pub rates: [f64; 2],
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

/// `a b`, summed over three.
#[inline(always)]
fn product(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

#[inline(always)]
fn dot(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.x + a.y * b.y
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
            let (sin, cos) = <f64 as Arithmetic>::sin_cos(leg.joint_angle_rad);
            let (l1, l2) = (leg.proximal_m, leg.distal_m);
            let (m1, c1) = (leg.proximal.mass_kg, leg.proximal.com_m);
            let rotor = if rotors { leg.rotor_inertia_kgm2 } else { 0.0 };
            LegCoefficients {
                base: leg.base_m,
                joint: Vector2::new(cos, sin) * leg.joint_radius_m,
                dyad: Rrr::new(l1, l2, leg.elbow.sign()),
                l1_sq: l1 * l1,
                l2_sq: l2 * l2,
                l1,
                inertia: m1 * c1 * c1
                    + leg.proximal.inertia_kgm2
                    + leg.distal.mass_kg * l1 * l1
                    + rotor,
            }
        });
        let links = (!parameters.links_are_massless()).then(|| {
            parameters.legs.map(|leg| {
                let (m2, c2) = (leg.distal.mass_kg, leg.distal.com_m);
                Links {
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
            self.leg(0, q, v, rotation)?,
            self.leg(1, q, v, rotation)?,
            self.leg(2, q, v, rotation)?,
        ])
    }

    /// One leg; `rotation` is the sine and cosine of alpha.
    #[inline(always)]
    fn leg(
        &self,
        index: usize,
        q: [f64; 3],
        v: [f64; 3],
        (sin, cos): (f64, f64),
    ) -> Result<LegState, Status> {
        let leg = &self.legs[index];
        let c = Vector2::new(
            leg.joint.x * cos - leg.joint.y * sin,
            leg.joint.y * cos + leg.joint.x * sin,
        );
        let d = (Vector2::new(q[0], q[1]) - leg.base) + c;
        let links = leg.dyad.position(d).map_err(|reason| match reason {
            OutOfReach::Unreachable => Status::Unreachable { leg: index },
            OutOfReach::Singular => Status::SerialSingular { leg: index },
        })?;
        let (r1, r2) = (links.r1, links.r2);
        let inverse = 1.0 / links.r1_cross_r2;
        let (b, a) = (r2 * inverse, r1 * -inverse);
        let k1 = [b.x, b.y, cross(c, b)];
        let k2 = [a.x, a.y, cross(c, a)];
        Ok(LegState {
            c,
            r1,
            r2,
            cross: links.r1_cross_r2,
            inverse,
            dot: leg.dyad.r1_dot_r2(&links),
            k1,
            k2,
            rates: [product(&k1, &v), product(&k2, &v)],
        })
    }

    /// theta_i1 of leg `index`, in (-pi, pi].
    #[inline(always)]
    pub fn motor_angle(&self, index: usize, leg: &LegState) -> f64 {
        <f64 as WideArithmetic>::direction(leg.r1.x, leg.r1.y, &self.legs[index].l1)
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
        let reach = |leg: &LegCoefficients| leg.l1 + leg.l2_sq.sqrt();
        self.legs.iter().map(reach).fold(0.0, f64::max)
    }
}

/// det A, rows \[r2x, r2y, c x r2\].
#[inline(always)]
pub fn det_a(legs: &[LegState; 3]) -> f64 {
    let [d1, d2, d3] = [legs[0].r2, legs[1].r2, legs[2].r2];
    let (arm2, arm3) = (legs[1].c - legs[0].c, legs[2].c - legs[0].c);
    cross(d1, d2) * cross(arm3, d3) + cross(d3, d1) * cross(arm2, d2)
}

#[inline(always)]
fn turned(v: Vector2<f64>, sin: f64, cos: f64) -> Vector2<f64> {
    Vector2::new(v.x * cos - v.y * sin, v.y * cos + v.x * sin)
}

/// Adds the upper triangle of `a^T b`, which is part of a symmetric sum.
#[inline(always)]
fn add_symmetric(m: &mut [f64; 6], a: &[f64; 3], b: &[f64; 3]) {
    m[0] += a[0] * b[0];
    m[1] += a[0] * b[1];
    m[2] += a[0] * b[2];
    m[3] += a[1] * b[1];
    m[4] += a[1] * b[2];
    m[5] += a[2] * b[2];
}

/// Solves M a = right by Cholesky's factors without roots; `None` where M is not positive
/// definite to within rounding.
#[inline(always)]
fn solve(m: &[f64; 6], right: [f64; 3]) -> Option<[f64; 3]> {
    let [xx, xy, xa, yy, ya, aa] = *m;
    let least = 16.0 * f64::EPSILON;
    let inverse_x = 1.0 / xx;
    let (l_yx, l_ax) = (xy * inverse_x, xa * inverse_x);
    let pivot_y = yy - l_yx * xy;
    let inverse_y = 1.0 / pivot_y;
    let rest = ya - l_ax * xy;
    let l_ay = rest * inverse_y;
    let pivot_a = aa - l_ax * xa - l_ay * rest;
    if !(xx > 0.0 && pivot_y > least * yy && pivot_a > least * aa) {
        return None;
    }
    let y = right[1] - l_yx * right[0];
    let a = (right[2] - l_ax * right[0] - l_ay * y) / pivot_a;
    let y = y * inverse_y - l_ay * a;
    Some([right[0] * inverse_x - l_yx * y - l_ax * a, y, a])
}
