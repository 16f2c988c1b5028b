//! One leg of the mechanics: joints, links and rates at a pose.

use crate::scalar::Differentiable;
use nalgebra::Vector2;
use trirrr_core::dyad::{OutOfReach, Rrr};
use trirrr_core::machine::LegParameters;
use trirrr_core::number::{Arithmetic, WideArithmetic};
use trirrr_core::status::Status;

/// Geometry of a leg, and the inertia about its motor.
#[derive(Clone, Debug)]
pub(crate) struct LegCoefficients {
    pub(crate) base: Vector2<f64>,
    /// Platform joint in the platform's frame.
    pub(crate) joint: Vector2<f64>,
    dyad: Rrr<f64>,
    /// Sign of r1 x r2 on the leg's branch.
    side: f64,
    l1_sq: f64,
    l2_sq: f64,
    pub(crate) l1: f64,
    pub(crate) l2: f64,
    /// J1.
    pub(crate) inertia: f64,
}

/// Platform's place and motion that a leg follows: pose, and what its changes are in the coordinates
/// of the state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Platform<T> {
    /// x, y, alpha.
    pub(crate) pose: [T; 3],
    /// Their rates.
    pub(crate) rates: [T; 3],
    /// sin alpha, cos alpha.
    pub(crate) rotation: (T, T),
    /// None where x, y and alpha are the coordinates.
    pub(crate) carrier: Option<Carrier<T>>,
}

/// (x, y)'' = `rows` w' + `bias`, w being the rates of the coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carrier<T> {
    pub(crate) rows: [[T; 3]; 2],
    pub(crate) bias: [T; 2],
}

/// One leg at one configuration and velocity.
#[derive(Clone, Copy, Debug)]
pub struct LegState<T = f64> {
    /// D -> C.
    pub c: Vector2<T>,
    /// A -> B.
    pub r1: Vector2<T>,
    /// B -> C.
    pub r2: Vector2<T>,
    /// D = r1 x r2.
    pub cross: T,
    /// r1 . r2.
    pub dot: T,
    /// K1: theta1' = K1 w, with the rates w of the coordinates.
    pub k1: [T; 3],
    /// K2: theta2' = K2 w.
    pub k2: [T; 3],
    /// theta1', theta2'.
    pub rates: [T; 2],
    /// g1, g2: theta1'' = K1 w' + g1.
    pub drift: [T; 2],
}

impl LegCoefficients {
    /// Builds the coefficients of `leg`, whose rotor adds `rotor` kg m^2 to its motor joint.
    pub(crate) fn build(leg: &LegParameters, rotor: f64) -> Self {
        let (sin, cos) = <f64 as Arithmetic>::sin_cos(leg.joint_angle_rad);
        let (l1, l2) = (leg.proximal_m, leg.distal_m);
        let (m1, c1) = (leg.proximal.mass_kg, leg.proximal.com_m);
        Self {
            base: leg.base_m,
            joint: Vector2::new(cos, sin) * leg.joint_radius_m,
            dyad: Rrr::new(l1, l2, leg.elbow.sign()),
            side: -leg.elbow.sign(),
            l1_sq: l1 * l1,
            l2_sq: l2 * l2,
            l1,
            l2,
            inertia: m1 * c1 * c1
                + leg.proximal.inertia_kgm2
                + leg.distal.mass_kg * l1 * l1
                + rotor,
        }
    }

    /// D -> C of a platform turned by sine and cosine of alpha.
    #[inline(always)]
    pub(crate) fn arm<T: Differentiable>(&self, rotation: (T, T)) -> Vector2<T> {
        turned(self.joint, rotation)
    }

    /// A -> C for the platform's `pose`.
    #[inline(always)]
    fn span<T: Differentiable>(&self, pose: &[T; 3], c: Vector2<T>) -> Vector2<T> {
        Vector2::new(
            (pose[0] - T::from(self.base.x)) + c.x,
            (pose[1] - T::from(self.base.y)) + c.y,
        )
    }

    /// State of this leg, number `index`, on its branch.
    ///
    /// # Errors
    /// [`Status::Unreachable`], or [`Status::SerialSingular`] for a leg that is exactly stretched.
    #[inline(always)]
    pub(crate) fn state<T: Differentiable>(
        &self,
        index: usize,
        platform: &Platform<T>,
    ) -> Result<LegState<T>, Status> {
        let c = self.arm(platform.rotation);
        let d = self.span(&platform.pose, c);
        let at = Vector2::new(d.x.value(), d.y.value());
        let links = self.dyad.position(at).map_err(|reason| match reason {
            OutOfReach::Unreachable => Status::Unreachable { leg: index },
            OutOfReach::Singular => Status::SerialSingular { leg: index },
        })?;
        // Derivatives by d: those of theta1 are r2 / D, those of theta2 -r1 / D.
        let inverse = 1.0 / links.r1_cross_r2;
        let (one, two) = (links.r2 * inverse, links.r1 * -inverse);
        let of_d = |value: f64, by: Vector2<f64>| T::function(value, [(by.x, d.x), (by.y, d.y)]);
        let r1 = Vector2::new(
            of_d(links.r1.x, one * -links.r1.y),
            of_d(links.r1.y, one * links.r1.x),
        );
        let r2 = Vector2::new(
            of_d(links.r2.x, two * -links.r2.y),
            of_d(links.r2.y, two * links.r2.x),
        );
        let along = links.r1_dot_r2;
        let dot_links = of_d(along, at);
        let crossed = of_d(links.r1_cross_r2, (two - one) * along);
        let inverse = T::from(1.0) / crossed;
        let (b, a) = (scaled(r2, inverse), scaled(r1, -inverse));
        let mut k1 = [b.x, b.y, cross(c, b)];
        let mut k2 = [a.x, a.y, cross(c, a)];
        let rates = [product(&k1, &platform.rates), product(&k2, &platform.rates)];
        let spin = platform.rates[2] * platform.rates[2];
        let [w1, w2] = [rates[0] * rates[0], rates[1] * rates[1]];
        let mut drift = [
            (w1 * dot_links + w2 * self.l2_sq - spin * dot(r2, c)) * inverse,
            (spin * dot(r1, c) - w1 * self.l1_sq - w2 * dot_links) * inverse,
        ];
        if let Some(carrier) = &platform.carrier {
            for (k, drift) in [&mut k1, &mut k2].into_iter().zip(&mut drift) {
                *drift = *drift + k[0] * carrier.bias[0] + k[1] * carrier.bias[1];
                *k = carrier.carried(k);
            }
        }
        Ok(LegState {
            c,
            r1,
            r2,
            cross: crossed,
            dot: dot_links,
            k1,
            k2,
            rates,
            drift,
        })
    }

    /// State of this leg where its own angles are the first two coordinates, alpha the third, and
    /// the platform that it carries. It has one at every angle, stretched and folded ones too.
    #[inline(always)]
    pub(crate) fn leading<T: Differentiable>(
        &self,
        [theta1, theta2, alpha]: [T; 3],
        rates: [T; 3],
    ) -> (LegState<T>, Platform<T>) {
        let (unit1, unit2) = (theta1.sin_cos(), theta2.sin_cos());
        let rotation = alpha.sin_cos();
        let r1 = Vector2::new(unit1.1 * self.l1, unit1.0 * self.l1);
        let r2 = Vector2::new(unit2.1 * self.l2, unit2.0 * self.l2);
        let c = self.arm(rotation);
        let rows = [[-r1.y, -r2.y, c.y], [r1.x, r2.x, -c.x]];
        let [w1, w2, spin] = rates.map(|rate| rate * rate);
        let carrier = Carrier {
            rows,
            bias: [
                spin * c.x - w1 * r1.x - w2 * r2.x,
                spin * c.y - w1 * r1.y - w2 * r2.y,
            ],
        };
        let platform = Platform {
            pose: [
                r1.x + r2.x - c.x + T::from(self.base.x),
                r1.y + r2.y - c.y + T::from(self.base.y),
                alpha,
            ],
            rates: [
                product(&rows[0], &rates),
                product(&rows[1], &rates),
                rates[2],
            ],
            rotation,
            carrier: Some(carrier),
        };
        let unit =
            |axis: usize| std::array::from_fn(|i| T::from(if i == axis { 1.0 } else { 0.0 }));
        let leg = LegState {
            c,
            r1,
            r2,
            cross: cross(r1, r2),
            dot: dot(r1, r2),
            k1: unit(0),
            k2: unit(1),
            rates: [rates[0], rates[1]],
            drift: [T::from(0.0); 2],
        };
        (leg, platform)
    }

    /// theta_i1 of the leg in `state`, in (-pi, pi].
    #[inline(always)]
    pub(crate) fn motor_angle<T: Differentiable>(&self, state: &LegState<T>) -> T {
        let (x, y) = (state.r1.x, state.r1.y);
        let length = f64::length_from_f64(self.l1);
        let angle = f64::direction(x.value(), y.value(), &length);
        let by = 1.0 / self.l1_sq;
        T::function(angle, [(-y.value() * by, x), (x.value() * by, y)])
    }

    /// theta_i2 of the leg in `state`, in (-pi, pi].
    pub(crate) fn distal_angle(&self, state: &LegState) -> f64 {
        f64::direction(state.r2.x, state.r2.y, &f64::length_from_f64(self.l2))
    }

    /// Sine of the angle between the links, positive on the leg's branch.
    pub(crate) fn sine(&self, state: &LegState) -> f64 {
        state.cross * self.side / (self.l1 * self.l2)
    }

    /// Square of that sine where the platform is at `pose`, by the margins to the leg's longest and
    /// shortest reach: negative beyond them, where the leg has no state.
    pub(crate) fn sine_squared(&self, pose: &[f64; 3], rotation: (f64, f64)) -> f64 {
        let d = self.span(pose, self.arm(rotation));
        let reach = d.x.hypot(d.y);
        let (longest, shortest) = (self.l1 + self.l2, (self.l1 - self.l2).abs());
        (longest - reach) * (longest + reach) * (reach - shortest) * (reach + shortest)
            / (4.0 * self.l1_sq * self.l2_sq)
    }

    /// Length of the leg, stretched, m.
    pub(crate) fn reach(&self) -> f64 {
        self.l1 + self.l2
    }
}

impl<T: Differentiable> Carrier<T> {
    /// `row`, of the rates of x, y and alpha, as one of the rates of the coordinates.
    #[inline(always)]
    pub(crate) fn carried(&self, row: &[T; 3]) -> [T; 3] {
        let [x, y] = &self.rows;
        std::array::from_fn(|i| {
            let own = row[0] * x[i] + row[1] * y[i];
            if i == 2 { own + row[2] } else { own }
        })
    }
}

/// det A, rows \[r2x, r2y, c x r2\].
#[inline(always)]
pub fn det_a(legs: &[LegState; 3]) -> f64 {
    let [d1, d2, d3] = [legs[0].r2, legs[1].r2, legs[2].r2];
    let (arm2, arm3) = (legs[1].c - legs[0].c, legs[2].c - legs[0].c);
    cross(d1, d2) * cross(arm3, d3) + cross(d3, d1) * cross(arm2, d2)
}

/// `a b`, summed over three.
#[inline(always)]
pub(crate) fn product<T: Differentiable>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross<T: Differentiable>(a: Vector2<T>, b: Vector2<T>) -> T {
    a.x * b.y - a.y * b.x
}

#[inline(always)]
pub(crate) fn dot<T: Differentiable>(a: Vector2<T>, b: Vector2<T>) -> T {
    a.x * b.x + a.y * b.y
}

#[inline(always)]
fn scaled<T: Differentiable>(v: Vector2<T>, factor: T) -> Vector2<T> {
    Vector2::new(v.x * factor, v.y * factor)
}

/// `v` turned by an angle of this sine and cosine.
#[inline(always)]
pub(crate) fn turned<T: Differentiable>(v: Vector2<f64>, (sin, cos): (T, T)) -> Vector2<T> {
    Vector2::new(cos * v.x - sin * v.y, cos * v.y + sin * v.x)
}
