//! Derivatives of the Lagrangian, and the torques and forces that they leave.

use super::{LagrangeLoads, LagrangeMachine, LagrangeState};
use crate::double_double::DoubleDouble;
use crate::scalar::{Scalar, solve};
use crate::tangent::Tangent;

type Once = Tangent<DoubleDouble>;
type Twice = Tangent<Once>;

/// Coordinates of a machine, their rates and accelerations.
struct Coordinates {
    q: Vec<DoubleDouble>,
    rates: Vec<DoubleDouble>,
    accelerations: Vec<DoubleDouble>,
}

impl Coordinates {
    fn new(machine: &LagrangeMachine, state: &LagrangeState) -> Self {
        let sliders = machine.slider_legs().into_iter();
        let sliders = sliders.map(|leg| state.sliders[leg]);
        let [q, rates, accelerations] = [0, 1, 2].map(|order: usize| {
            let all = state.platform.into_iter().chain(sliders.clone());
            all.map(|it| DoubleDouble::new(it[order])).collect()
        });
        Self {
            q,
            rates,
            accelerations,
        }
    }

    fn count(&self) -> usize {
        self.q.len()
    }

    /// The values with a derivative of 1 by number `index`.
    fn seeded(values: &[DoubleDouble], index: Option<usize>) -> Vec<Once> {
        let seed = |(number, &value): (usize, &DoubleDouble)| Tangent {
            value,
            slope: DoubleDouble::new(f64::from(u8::from(index == Some(number)))),
        };
        values.iter().enumerate().map(seed).collect()
    }

    /// dL/dq_k.
    fn by_coordinate(&self, machine: &LagrangeMachine, k: usize) -> Option<DoubleDouble> {
        let q = Self::seeded(&self.q, Some(k));
        let rates = Self::seeded(&self.rates, None);
        Some(machine.lagrangian(&q, &rates)?.slope)
    }

    /// d/dt dL/dq'_k: along the motion, q changes by q' and q' by q''.
    fn momentum_rate(&self, machine: &LagrangeMachine, k: usize) -> Option<DoubleDouble> {
        let moving = |values: Vec<Once>, slopes: &[DoubleDouble]| -> Vec<Twice> {
            let pairs = values.into_iter().zip(slopes);
            pairs
                .map(|(value, &slope)| Tangent {
                    value,
                    slope: Tangent::still(slope),
                })
                .collect()
        };
        let q = moving(Self::seeded(&self.q, None), &self.rates);
        let rates = moving(Self::seeded(&self.rates, Some(k)), &self.accelerations);
        Some(machine.lagrangian(&q, &rates)?.slope.slope)
    }

    /// dtheta_i/dq_k of each motor.
    fn turns(&self, machine: &LagrangeMachine, k: usize) -> Option<Vec<DoubleDouble>> {
        let angles = machine.angles(&Self::seeded(&self.q, Some(k)))?;
        Some(angles.iter().map(|[first, _]| first.slope).collect())
    }
}

impl LagrangeMachine {
    /// Torques and forces at `state`. Of the torques that more than three motors may have, those nearest to `wanted` (N m)
    /// are taken.
    ///
    /// Returns `None` where the machine has no motion: a leg does not reach, or is stretched or folded.
    ///
    /// # Panics
    /// At a parallel singularity.
    pub fn loads(&self, state: &LagrangeState, wanted: &[f64]) -> Option<LagrangeLoads> {
        let at = Coordinates::new(self, state);
        let wrench = [self.force[0], self.force[1], self.moment];
        let mut demand = Vec::with_capacity(at.count());
        let mut turns = Vec::with_capacity(at.count());
        for k in 0..at.count() {
            let own = at.momentum_rate(self, k)? - at.by_coordinate(self, k)?;
            let wrench = wrench.get(k).copied().unwrap_or(0.0);
            demand.push(own - DoubleDouble::new(wrench));
            turns.push(at.turns(self, k)?);
        }
        let torques = nearest(&turns[..3], &demand[..3], wanted);
        let mut sliders = vec![None; self.legs.len()];
        for (number, leg) in self.slider_legs().into_iter().enumerate() {
            let k = 3 + number;
            let of_motors = product(&turns[k], &torques);
            sliders[leg] = Some(demand[k] - of_motors);
        }
        Some(LagrangeLoads { torques, sliders })
    }
}

fn product(a: &[DoubleDouble], b: &[DoubleDouble]) -> DoubleDouble {
    let pairs = a.iter().zip(b);
    pairs.fold(DoubleDouble::new(0.0), |sum, (&a, &b)| sum + a * b)
}

/// The torques nearest to `wanted` with `rows` tau = `demand`: tau = wanted + R^T (R R^T)^-1 (demand - R wanted).
fn nearest(
    rows: &[Vec<DoubleDouble>],
    demand: &[DoubleDouble],
    wanted: &[f64],
) -> Vec<DoubleDouble> {
    let wanted: Vec<DoubleDouble> = wanted
        .iter()
        .map(|&it| DoubleDouble::constant(it))
        .collect();
    let gram = rows
        .iter()
        .map(|a| rows.iter().map(|b| product(a, b)).collect());
    let missing = rows.iter().zip(demand);
    let missing = missing.map(|(row, &demand)| demand - product(row, &wanted));
    let factors = solve(gram.collect(), missing.collect());
    let torque = |(motor, &wanted): (usize, &DoubleDouble)| {
        let column = rows.iter().map(|row| row[motor]);
        let pairs = column.zip(&factors);
        pairs.fold(wanted, |sum, (entry, &factor)| sum + entry * factor)
    };
    wanted.iter().enumerate().map(torque).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_core::machine::example;

    /// The thesis's machine and move at its begin: the values of the reference files, to the digits of a textbook.
    #[test]
    fn a_platform_alone_needs_the_torques_of_its_mass() {
        let mut machine = LagrangeMachine::from(&example());
        let state = LagrangeState {
            platform: [[0.21, 0.0, 0.42], [0.22, 0.0, 0.36], [0.157, 0.0, 0.314]],
            sliders: vec![[0.0; 3]; 3],
        };
        // At rest the power of the first instant is that of the platform's momentum, whatever the direction.
        let loads = machine.loads(&state, &[0.0; 3]).unwrap();
        let at = Coordinates::new(&machine, &state);
        let (mass, inertia) = (machine.platform.mass_kg, machine.platform.inertia_kgm2);
        for (k, expected) in [mass * 0.42, mass * 0.36, inertia * 0.314]
            .into_iter()
            .enumerate()
        {
            let turns = at.turns(&machine, k).unwrap();
            let found = product(&turns, &loads.torques).value();
            assert!((found - expected).abs() < 1e-16, "{found} {expected}");
        }
        machine.legs[0].proximal_m = 0.01;
        assert!(machine.loads(&state, &[0.0; 3]).is_none());
    }
}
