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
//!
//! Near a stretched or folded leg, its two angles and alpha are the coordinates w instead: that leg
//! *leads*. The platform follows it by q' = J w', and q'' = J w'' + b, which carries the equations of
//! the platform and of the other legs to w. The leading leg's K1 and K2 are unit rows and its g1 and g2
//! are zero: nothing in these equations divides by its D, and the motion through D = 0 is smooth.

use crate::leg::{LegCoefficients, LegState, Platform, dot, product, turned};
use crate::mass_matrix::{add_symmetric, carried, solve};
use crate::refusal::Refusal;
use crate::scalar::Differentiable;
use nalgebra::Vector2;
use trirrr_core::machine::Parameters;
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
    /// The same of a push that acts now, without a potential.
    push: [f64; 3],
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
pub struct JointMoments<T = f64> {
    /// On the proximal link at A: motor or transmission, less friction.
    pub proximal: T,
    /// At the elbow B: against theta2' - theta1'.
    pub elbow: T,
    /// At the platform joint C: against alpha' - theta2'.
    pub platform: T,
}

/// Platform and legs at some coordinates and their rates.
#[derive(Clone, Copy, Debug)]
pub struct Configuration<T = f64> {
    /// The legs.
    pub legs: [LegState<T>; 3],
    pub(crate) platform: Platform<T>,
}

impl<T: Differentiable> Configuration<T> {
    /// x, y, alpha.
    pub fn pose(&self) -> [T; 3] {
        self.platform.pose
    }

    /// Their rates.
    pub fn rates(&self) -> [T; 3] {
        self.platform.rates
    }
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
            push: [0.0; 3],
        })
    }

    /// Lets a push (Wx, Wy, Walpha) at D act from now on, N and N m, besides the constant wrench.
    pub fn set_push(&mut self, push: [f64; 3]) {
        self.push = push;
    }

    /// Power of the push on a platform that moves with `rates`, W.
    #[inline(always)]
    pub(crate) fn push_power<T: Differentiable>(&self, [vx, vy, turning]: [T; 3]) -> T {
        let [x, y, moment] = self.push;
        vx * x + vy * y + turning * moment
    }

    /// Configuration at the coordinates `w` that move with `rates`: x, y and alpha, or the angles of
    /// the links of leg `leading` and alpha.
    ///
    /// # Errors
    /// [`Status::Unreachable`], or [`Status::SerialSingular`] where a leg that does not lead is exactly
    /// stretched.
    #[inline(always)]
    pub fn configuration<T: Differentiable>(
        &self,
        leading: Option<usize>,
        w: [T; 3],
        rates: [T; 3],
    ) -> Result<Configuration<T>, Status> {
        let (own, platform) = match leading {
            Some(leg) => {
                let (own, platform) = self.legs[leg].leading(w, rates);
                (Some((leg, own)), platform)
            }
            None => {
                let platform = Platform {
                    pose: w,
                    rates,
                    rotation: w[2].sin_cos(),
                    carrier: None,
                };
                (None, platform)
            }
        };
        let state = |leg: usize| match own {
            Some((leading, own)) if leading == leg => Ok(own),
            _ => self.legs[leg].state(leg, &platform),
        };
        Ok(Configuration {
            legs: [state(0)?, state(1)?, state(2)?],
            platform,
        })
    }

    /// Pose at the coordinates `w` and the squared sine between the links of each leg, also where legs
    /// do not reach it ([negative](LegCoefficients::sine_squared)).
    pub(crate) fn sines_squared(&self, leading: Option<usize>, w: [f64; 3]) -> [f64; 3] {
        let (pose, rotation) = match leading {
            Some(leg) => {
                let (_, platform) = self.legs[leg].leading(w, [0.0; 3]);
                (platform.pose, platform.rotation)
            }
            None => (w, w[2].sin_cos()),
        };
        [0, 1, 2].map(|leg| self.legs[leg].sine_squared(&pose, rotation))
    }

    /// Sine of the angle between the links of leg `index`, positive on its branch.
    pub(crate) fn sine(&self, index: usize, leg: &LegState) -> f64 {
        self.legs[index].sine(leg)
    }

    /// Coordinates and their rates for another `leading` leg.
    pub(crate) fn coordinates(
        &self,
        leading: Option<usize>,
        at: &Configuration,
    ) -> ([f64; 3], [f64; 3]) {
        let Platform { pose, rates, .. } = &at.platform;
        match leading {
            None => (*pose, *rates),
            Some(index) => {
                let leg = &at.legs[index];
                let coefficients = &self.legs[index];
                let angles = [
                    coefficients.motor_angle(leg),
                    coefficients.distal_angle(leg),
                ];
                (
                    [angles[0], angles[1], pose[2]],
                    [leg.rates[0], leg.rates[1], rates[2]],
                )
            }
        }
    }

    /// Returns `true` where leg `index` has inertia of its own: where it is stretched, its elbow
    /// passes on to the other branch. A leg without inertia stops the platform there.
    pub(crate) fn has_inertia(&self, index: usize) -> bool {
        self.legs[index].inertia > 0.0
            || self
                .links
                .as_ref()
                .is_some_and(|links| links[index].inertia > 0.0)
    }

    /// theta_i1 of leg `index`, in (-pi, pi].
    #[inline(always)]
    pub fn motor_angle<T: Differentiable>(&self, index: usize, leg: &LegState<T>) -> T {
        self.legs[index].motor_angle(leg)
    }

    /// Accelerations of the coordinates under the joints' moments.
    ///
    /// # Errors
    /// [`Refusal::NoInertia`] where the mass matrix is not positive definite.
    #[inline(always)]
    pub fn acceleration<T: Differentiable>(
        &self,
        at: &Configuration<T>,
        moments: &[JointMoments<T>; 3],
    ) -> Result<[T; 3], Refusal> {
        let Platform {
            rates, rotation, ..
        } = &at.platform;
        let spin = rates[2] * rates[2];
        let zero = T::from(0.0);
        // Upper triangle: xx, xy, xa, yy, ya, aa.
        let [mass, inertia] = [self.mass, self.inertia].map(T::from);
        let mut m = [mass, zero, zero, mass, zero, inertia];
        let mut right = [0, 1, 2].map(|axis| T::from(self.wrench[axis] + self.push[axis]));
        if let Some(centre) = self.centre {
            let s = turned(centre * self.mass, *rotation);
            m[2] = -s.y;
            m[4] = s.x;
            right[0] = right[0] + s.x * spin;
            right[1] = right[1] + s.y * spin;
            if let Some(g) = self.gravity {
                right[2] = right[2] + s.x * g.y - s.y * g.x;
            }
        }
        if let Some(g) = self.gravity {
            right[0] = right[0] + T::from(self.mass * g.x);
            right[1] = right[1] + T::from(self.mass * g.y);
        }
        if let Some(carrier) = &at.platform.carrier {
            (m, right) = carried(carrier, &m, right);
        }
        for index in 0..3 {
            let (leg, coefficients) = (&at.legs[index], &self.legs[index]);
            let moment = &moments[index];
            let [w1, w2] = leg.rates.map(|rate| rate * rate);
            let [g1, g2] = leg.drift;
            let mut h1 = g1 * coefficients.inertia - moment.proximal - moment.elbow;
            let mut h2 = moment.elbow - moment.platform;
            let mut row1 = leg.k1.map(|k| k * coefficients.inertia);
            if let Some(links) = &self.links {
                let links = &links[index];
                let mixed = leg.dot * links.coupling;
                let swing = leg.cross * links.coupling;
                h1 = h1 + mixed * g2 - swing * w2;
                h2 = h2 + g2 * links.inertia + mixed * g1 + swing * w1;
                if let Some(g) = self.gravity {
                    // g . E r = g x r turned: -gx ry + gy rx = r x g.
                    h1 = h1 - (leg.r1.x * g.y - leg.r1.y * g.x) * links.weight;
                    h2 = h2 - (leg.r2.x * g.y - leg.r2.y * g.x) * links.coupling;
                }
                let mut row2 = [zero; 3];
                for axis in 0..3 {
                    row1[axis] = row1[axis] + mixed * leg.k2[axis];
                    row2[axis] = leg.k2[axis] * links.inertia + mixed * leg.k1[axis];
                }
                add_symmetric(&mut m, &leg.k2, &row2);
            }
            add_symmetric(&mut m, &leg.k1, &row1);
            for (right, (k1, k2)) in right.iter_mut().zip(leg.k1.iter().zip(&leg.k2)) {
                *right = *right - (*k1 * h1 + *k2 * h2);
            }
            right[2] = right[2] - moment.platform;
        }
        solve(&m, right).ok_or(Refusal::NoInertia)
    }

    /// Kinetic energy of platform, links and rotors that sit on the joints, J. Body by body, not
    /// through the mass matrix.
    pub fn kinetic_energy(&self, at: &Configuration) -> f64 {
        let v = &at.platform.rates;
        let s = self.centre_of_mass(at);
        let (vx, vy) = (v[0] - v[2] * s.y, v[1] + v[2] * s.x);
        let central = self.inertia - self.mass * dot(s, s);
        let mut twice = self.mass * (vx * vx + vy * vy) + central * v[2] * v[2];
        for (index, leg) in at.legs.iter().enumerate() {
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
    pub fn potential_energy(&self, at: &Configuration) -> f64 {
        let q = &at.platform.pose;
        let mut energy = -product(&self.wrench, q);
        if let Some(g) = self.gravity {
            let s = self.centre_of_mass(at);
            energy -= self.mass * dot(g, Vector2::new(q[0], q[1]) + s);
            if let Some(links) = &self.links {
                for (leg, links) in at.legs.iter().zip(links) {
                    energy -= links.weight * dot(g, leg.r1) + links.coupling * dot(g, leg.r2);
                }
            }
        }
        energy
    }

    fn centre_of_mass(&self, at: &Configuration) -> Vector2<f64> {
        self.centre.map_or(Vector2::zeros(), |centre| {
            turned(centre, at.platform.rotation)
        })
    }

    /// Length of the longest leg, stretched, m: the machine's size.
    pub fn size(&self) -> f64 {
        self.legs
            .iter()
            .map(LegCoefficients::reach)
            .fold(0.0, f64::max)
    }
}
