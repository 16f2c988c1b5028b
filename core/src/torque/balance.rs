//! The balance of platform and legs: three forces along the distal links, then three torques.

use super::demand::Demand;
use super::lines::DistalLines;
use super::links::LegLoad;
use crate::inverse::LegMotion;
use crate::machine::Parameters;
use crate::number::{Number, cross, dot, perpendicular, sum_cross, sum_dot};
use crate::status::Status;
use crate::to_source;
use nalgebra::Vector2;

/// Coefficients of the balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<N: Number> {
    /// 1 / l2^2 of leg 1.
    inverse_l2_sq: N::Factor,
    /// Below this size det A is rounding noise.
    least_det_a: N,
}

to_source!([N: Number] Balance [N] in trirrr_core::torque::balance {
    inverse_l2_sq: N::Factor,
    least_det_a: N,
});

/// The solution of the balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces<N> {
    /// f_i: force along distal link i on the platform, divided by l2_i; positive pushes.
    pub along: [N; 3],
    /// Determinant of the rows [r2x, r2y, c x r2].
    pub det_a: N,
}

impl<N: Number> Balance<N> {
    /// Builds the coefficients from checked parameters.
    pub fn build(parameters: &Parameters) -> Self {
        let l2 = parameters.legs[0].distal_m;
        // The rows of A are rounded at the size of the links, so det A carries an error of a few
        // unit roundoffs of its largest possible value.
        let noise = 2.0 * N::UNIT_ROUNDOFF.to_f64();
        Self {
            inverse_l2_sq: N::factor_from_f64(1.0 / (l2 * l2)),
            least_det_a: N::from_f64(noise * parameters.greatest_det_a()),
        }
    }

    /// Returns `true` if `det_a` is rounding noise or not a number.
    #[inline(always)]
    pub fn is_singular(&self, det_a: N) -> bool {
        !(det_a.abs() > self.least_det_a)
    }

    /// Solves for the forces along the distal links, whose `lines` it forms where none are given.
    ///
    /// Moments are taken about C_1, so that leg 1 drops out of them, and forces across leg 1, so
    /// that two equations in f_2 and f_3 are left. det A is the same about every point.
    ///
    /// Where the number type [propagates](crate::number::Arithmetic::PROPAGATES_NON_FINITE) what is not
    /// finite, the caller asks whether the pose [is singular](Self::is_singular), and looks at the torques.
    ///
    /// # Errors
    /// [`Status::ParallelSingular`], [`Status::OutOfRange`].
    #[inline(always)]
    pub fn forces(
        &self,
        lines: Option<&DistalLines<N>>,
        legs: &[LegMotion<N>; 3],
        demand: &Demand<N>,
        loads: &[LegLoad<N>; 3],
    ) -> Result<Forces<N>, Status> {
        let [leg1, leg2, leg3] = legs;
        let positions = [&leg1.position, &leg2.position, &leg3.position];
        let d = |leg: usize| positions[leg].links.r2;
        let (d1, d2, d3) = (d(0), d(1), d(2));
        let c1 = leg1.position.platform_joint;
        let arms = match lines {
            Some(lines) => [lines.arm2, lines.arm3],
            None => DistalLines::arms(positions),
        };

        let mut moment = demand.moment.widen() - sum_cross(c1, demand.force);
        let across = |load: &LegLoad<N>| load.distal_over_l2_sq.is_some();
        let force = if loads.iter().any(across) {
            let mut force = demand.force.map(N::widen);
            add_across(&loads[0], d1, None, &mut force, &mut moment);
            add_across(&loads[1], d2, Some(arms[0]), &mut force, &mut moment);
            add_across(&loads[2], d3, Some(arms[1]), &mut force, &mut moment);
            force.map(N::round)
        } else {
            // Nothing to add: neither widened nor rounded.
            demand.force
        };
        let moment = N::round(moment);
        // Not before: what is formed early waits in registers.
        let formed;
        let lines = match lines {
            Some(lines) => lines,
            None => {
                formed = DistalLines::with_arms(positions, arms);
                &formed
            }
        };
        let &DistalLines {
            moment2,
            moment3,
            det_a,
            ..
        } = lines;
        if !N::PROPAGATES_NON_FINITE && self.is_singular(det_a) {
            return Err(Status::ParallelSingular);
        }
        let across = cross(d1, force);
        let products = [
            N::sum_ab_plus_cd(across, moment3, lines.d3_x_d1, moment),
            N::sum_ab_minus_cd(lines.d1_x_d2, moment, moment2, across),
        ];
        let [f2, f3] = N::round_scaled_pair(products, det_a.reciprocal());
        let left = Vector2::new(
            N::round(force.x.widen() - N::sum_ab_plus_cd(f2, d2.x, f3, d3.x)),
            N::round(force.y.widen() - N::sum_ab_plus_cd(f2, d2.y, f3, d3.y)),
        );
        let f1 = N::round_scaled(sum_dot(d1, left), self.inverse_l2_sq);
        let loads_fit = N::in_range([force.x, force.y, moment, moment2, moment3, across]);
        if !(loads_fit && N::in_range([f1, f2, f3, left.x, left.y])) {
            return Err(Status::OutOfRange);
        }
        Ok(Forces {
            along: [f1, f2, f3],
            det_a,
        })
    }
}

/// The force across a distal link, -q E r2, is known: it goes to the other side, with its moment
/// about C_1 if it has an `arm`. Inlined, so that of links without mass nothing is left.
#[inline(always)]
fn add_across<N: Number>(
    load: &LegLoad<N>,
    distal: Vector2<N>,
    arm: Option<Vector2<N>>,
    force: &mut Vector2<N::Sum>,
    moment: &mut N::Sum,
) {
    let Some(q) = load.distal_over_l2_sq else {
        return;
    };
    let across = perpendicular(distal);
    *force = Vector2::new(
        force.x + N::product(across.x, q),
        force.y + N::product(across.y, q),
    );
    if let Some(arm) = arm {
        *moment = *moment + N::product(dot(arm, distal), q);
    }
}

impl<N: Number> Forces<N> {
    /// tau_i = D_i f_i + (Q1_i - q_i (r1_i . r2_i)).
    #[inline(always)]
    pub fn torques(&self, legs: &[LegMotion<N>; 3], loads: &[LegLoad<N>; 3]) -> [N; 3] {
        [
            self.torque(0, &legs[0], &loads[0]),
            self.torque(1, &legs[1], &loads[1]),
            self.torque(2, &legs[2], &loads[2]),
        ]
    }

    #[inline(always)]
    fn torque(&self, index: usize, leg: &LegMotion<N>, load: &LegLoad<N>) -> N {
        let torque = N::product(leg.position.links.r1_cross_r2, self.along[index]);
        N::round(match load.at_motor {
            Some(at_motor) => torque + at_motor.widen(),
            None => torque,
        })
    }
}
