//! One leg of the mechanics: joints, links and rates at a pose.

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
    pub(crate) dyad: Rrr<f64>,
    pub(crate) l1_sq: f64,
    pub(crate) l2_sq: f64,
    pub(crate) l1: f64,
    /// J1.
    pub(crate) inertia: f64,
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
            l1_sq: l1 * l1,
            l2_sq: l2 * l2,
            l1,
            inertia: m1 * c1 * c1
                + leg.proximal.inertia_kgm2
                + leg.distal.mass_kg * l1 * l1
                + rotor,
        }
    }

    /// State of this leg, number `index`, of a platform at `q` that moves with `v`; `sin` and `cos`
    /// are those of alpha.
    ///
    /// # Errors
    /// [`Status::Unreachable`], or [`Status::SerialSingular`] for a leg that is exactly stretched.
    #[inline(always)]
    pub(crate) fn state(
        &self,
        index: usize,
        q: [f64; 3],
        v: [f64; 3],
        (sin, cos): (f64, f64),
    ) -> Result<LegState, Status> {
        let c = Vector2::new(
            self.joint.x * cos - self.joint.y * sin,
            self.joint.y * cos + self.joint.x * sin,
        );
        let d = (Vector2::new(q[0], q[1]) - self.base) + c;
        let links = self.dyad.position(d).map_err(|reason| match reason {
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
            dot: links.r1_dot_r2,
            k1,
            k2,
            rates: [product(&k1, &v), product(&k2, &v)],
        })
    }

    /// theta_i1 of the leg in `state`, in (-pi, pi].
    #[inline(always)]
    pub(crate) fn motor_angle(&self, state: &LegState) -> f64 {
        <f64 as WideArithmetic>::direction(state.r1.x, state.r1.y, &self.l1)
    }

    /// Length of the leg, stretched, m.
    pub(crate) fn reach(&self) -> f64 {
        self.l1 + self.l2_sq.sqrt()
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
pub(crate) fn product(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

#[inline(always)]
pub(crate) fn dot(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.x + a.y * b.y
}

#[inline(always)]
pub(crate) fn turned(v: Vector2<f64>, sin: f64, cos: f64) -> Vector2<f64> {
    Vector2::new(v.x * cos - v.y * sin, v.y * cos + v.x * sin)
}
