//! A group solved by Newton-Raphson on its constraint equations, from the poses that its links
//! have in the states handed over.

#[cfg(test)]
mod comparison;

use super::constraint::{Equation, equations};
use super::description::Linkage;
use super::factors::Factors;
use super::groups::Group;
use super::state::{LinkState, Reason, Solved};
use nalgebra::{DMatrix, Vector2};

const ITERATIONS: u32 = 60;
/// Longest step of one iteration, in rad and in sizes of the linkage: farther the linear
/// model means nothing.
const LONGEST_STEP: f64 = 0.5;
/// Below this, a step that does not get smaller any more is rounding.
const ROUNDING: f64 = 1e-9;

/// Solves `group` at the time `t`: poses, rates and accelerations of its links in `states`.
pub(super) fn solve(
    linkage: &Linkage,
    group: &Group,
    states: &mut [LinkState],
    t: f64,
) -> Result<Solved, Reason> {
    let size = linkage.size();
    let scaled = Scaled { group, size };
    let mut last_step = f64::INFINITY;
    for iterations in 1..=ITERATIONS {
        let at = equations(linkage, group, states, t);
        let factors = scaled.factor(&at).ok_or(Reason::Singular)?;
        let mut step = scaled.solve(&factors, &at, |e| -e.residual);
        let length = step
            .iter()
            .fold(0.0, |longest, s| f64::max(longest, s.abs()));
        if !length.is_finite() {
            return Err(Reason::Diverged);
        }
        if length > LONGEST_STEP {
            step.iter_mut().for_each(|s| *s *= LONGEST_STEP / length);
        }
        for (link, moved, turned) in scaled.parts(&step) {
            let [x, y, angle] = states[link].pose();
            states[link].move_to([x + moved.x, y + moved.y, angle + turned]);
        }
        let settled = length < ROUNDING && length >= 0.5 * last_step;
        if length <= f64::EPSILON || settled {
            return scaled.motions(linkage, states, t, iterations);
        }
        last_step = length;
    }
    Err(Reason::Diverged)
}

/// The group's equations with lengths in units of `size`: without dimension, like the angles.
struct Scaled<'a> {
    group: &'a Group,
    size: f64,
}

impl Scaled<'_> {
    fn row(&self, equation: &Equation) -> f64 {
        if equation.angular {
            1.0
        } else {
            1.0 / self.size
        }
    }

    fn factor(&self, equations: &[Equation]) -> Option<Factors> {
        let unknowns = 3 * self.group.links.len();
        if equations.len() != unknowns {
            return None;
        }
        let mut matrix = DMatrix::zeros(unknowns, unknowns);
        for (row, equation) in equations.iter().enumerate() {
            let scale = self.row(equation);
            for (link, [x, y, angle]) in equation.by {
                if let Some(index) = self.group.links.iter().position(|&own| own == link) {
                    matrix[(row, 3 * index)] += scale * x * self.size;
                    matrix[(row, 3 * index + 1)] += scale * y * self.size;
                    matrix[(row, 3 * index + 2)] += scale * angle;
                }
            }
        }
        Factors::new(matrix)
    }

    /// The unknowns for which the equations have the `right` side, without dimension.
    fn solve(
        &self,
        factors: &Factors,
        equations: &[Equation],
        right: impl Fn(&Equation) -> f64,
    ) -> Vec<f64> {
        factors.solve(equations.iter().map(|e| self.row(e) * right(e)).collect())
    }

    /// The part of each link in a solution: of its origin, with dimension, and of its angle.
    fn parts(&self, solution: &[f64]) -> impl Iterator<Item = (usize, Vector2<f64>, f64)> {
        let parts = self.group.links.iter().zip(solution.chunks_exact(3));
        parts.map(|(&link, v)| (link, Vector2::new(v[0], v[1]) * self.size, v[2]))
    }

    /// Rates and accelerations at poses that satisfy the equations.
    fn motions(
        &self,
        linkage: &Linkage,
        states: &mut [LinkState],
        t: f64,
        iterations: u32,
    ) -> Result<Solved, Reason> {
        for &link in &self.group.links {
            let motion = &mut states[link].motion;
            (motion.rate, motion.acceleration) = (0.0, 0.0);
            motion.origin.velocity = Vector2::zeros();
            motion.origin.acceleration = Vector2::zeros();
        }
        let at = equations(linkage, self.group, states, t);
        let factors = self.factor(&at).ok_or(Reason::Singular)?;
        let rates = self.solve(&factors, &at, |e| e.drive[0] - known(e, states, velocity));
        for (link, velocity, rate) in self.parts(&rates) {
            let motion = &mut states[link].motion;
            (motion.origin.velocity, motion.rate) = (velocity, rate);
        }
        // Again, for the squares of the rates.
        let at = equations(linkage, self.group, states, t);
        let accelerations = self.solve(&factors, &at, |e| {
            e.drive[1] - e.squares - known(e, states, acceleration)
        });
        for (link, of_origin, acceleration) in self.parts(&accelerations) {
            let motion = &mut states[link].motion;
            (motion.origin.acceleration, motion.acceleration) = (of_origin, acceleration);
            if !motion.is_finite() {
                return Err(Reason::Singular);
            }
        }
        Ok(Solved {
            iterations,
            distance: factors.reciprocal_condition(),
            positive: factors.is_positive(),
        })
    }
}

/// Returns the part of the solved links in an equation's derivative. The links of the group have
/// no motion yet.
fn known(equation: &Equation, states: &[LinkState], of: fn(&LinkState) -> [f64; 3]) -> f64 {
    let parts = equation.by.iter().map(|(link, by)| {
        let moved = of(&states[*link]);
        by.iter()
            .zip(moved)
            .map(|(by, moved)| by * moved)
            .sum::<f64>()
    });
    parts.sum()
}

fn velocity(state: &LinkState) -> [f64; 3] {
    let motion = &state.motion;
    let v = motion.origin.velocity;
    [v.x, v.y, motion.rate]
}

fn acceleration(state: &LinkState) -> [f64; 3] {
    let motion = &state.motion;
    let a = motion.origin.acceleration;
    [a.x, a.y, motion.acceleration]
}
