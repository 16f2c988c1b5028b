//! Balance of the platform, and distribution of the torques over the motors.

use super::machine::RedundantMachine;
use super::qr::Qr;
use trirrr_core::inverse::LegPosition;
use trirrr_core::number::{Number, cross};
use trirrr_core::torque::demand::Demand;

impl<N: Number, const LEGS: usize> RedundantMachine<N, LEGS> {
    /// Factors the matrix with rows [r2x, r2y, (c - c1) x r2 / arm].
    pub(super) fn balance(&self, position: &[LegPosition<N>; LEGS]) -> Qr<N, LEGS> {
        let c1 = position[0].platform_joint;
        let mut columns = [[N::ZERO; LEGS]; LEGS];
        for (index, leg) in position.iter().enumerate() {
            let r2 = leg.links.r2;
            columns[0][index] = r2.x;
            columns[1][index] = r2.y;
            columns[2][index] = cross(leg.platform_joint - c1, r2).div(self.arm);
        }
        Qr::new(columns, 3)
    }

    pub(super) fn parallel(&self, balance: &Qr<N, LEGS>) -> N {
        if self.greatest > N::ZERO {
            (balance.volume() * self.arm).div(self.greatest)
        } else {
            N::ZERO
        }
    }

    /// Returns the forces along the distal links over l2 that hold `demand` with the motor torques
    /// nearest to `wanted`.
    pub(super) fn distribute_torques(
        &self,
        balance: &Qr<N, LEGS>,
        demand: &Demand<N>,
        position: &[LegPosition<N>; LEGS],
        at_motor: &[N; LEGS],
        wanted: &[N; LEGS],
    ) -> [N; LEGS] {
        let mut w = [N::ZERO; LEGS];
        w[0] = demand.force.x;
        w[1] = demand.force.y;
        w[2] = demand.moment.div(self.arm);
        let mut forces = balance.least_norm(&w);
        let spare = LEGS - 3;
        if spare == 0 {
            return forces;
        }
        // Forces that hold each other, and the torques that they take.
        let held = |index: usize| {
            let mut unit = [N::ZERO; LEGS];
            unit[3 + index] = N::ONE;
            balance.of_q(unit)
        };
        let torques = |forces: &[N; LEGS]| -> [N; LEGS] {
            core::array::from_fn(|leg| position[leg].links.r1_cross_r2 * forces[leg])
        };
        let mut taken = [[N::ZERO; LEGS]; LEGS];
        for (index, column) in taken.iter_mut().enumerate().take(spare) {
            *column = torques(&held(index));
        }
        let base = torques(&forces);
        let missing = core::array::from_fn(|leg| wanted[leg] - at_motor[leg] - base[leg]);
        let z = Qr::new(taken, spare).least_squares(missing);
        for (index, &z) in z.iter().enumerate().take(spare) {
            for (force, held) in forces.iter_mut().zip(held(index)) {
                *force += held * z;
            }
        }
        forces
    }
}
