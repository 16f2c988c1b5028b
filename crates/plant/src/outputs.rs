//! Quantities of the plant besides its state: angles, torques, currents, energies.

use crate::layout::{RATES, ROTOR_RATES, ROTORS, three};
use crate::leg::LegState;
use crate::model::Plant;
use crate::motor::{MotorModel, wrapped};
use crate::refusal::Refusal;

/// Everything of the plant at one instant that is not in its state.
#[derive(Clone, Copy, Debug)]
pub struct Outputs {
    /// The legs.
    pub legs: [LegState; 3],
    /// Joint angles theta_i1, in (-pi, pi].
    pub angles: [f64; 3],
    /// Angles at the rotors' side of the transmissions.
    pub rotor_angles: [f64; 3],
    /// Rates there.
    pub rotor_rates: [f64; 3],
    /// Command of each motor.
    pub told: [f64; 3],
    /// Torque of each motor at the joint, N m.
    pub torques: [f64; 3],
    /// Current of each winding, A; 0 without.
    pub currents: [f64; 3],
}

impl<const N: usize> Plant<N> {
    /// Quantities of the plant at `t` seconds in the state `y`.
    ///
    /// # Errors
    /// As the plant's equations.
    pub fn outputs(&self, t: f64, y: &[f64; N]) -> Result<Outputs, Refusal> {
        let legs = self.legs(y)?;
        let told = self.told(t, &legs, y)?;
        let rotors = [0, 1, 2].map(|leg| self.rotor(leg, &legs[leg], y));
        Ok(Outputs {
            angles: [0, 1, 2].map(|leg| self.mechanics.motor_angle(leg, &legs[leg])),
            rotor_angles: rotors.map(|rotor| rotor.angle),
            rotor_rates: rotors.map(|rotor| rotor.rate),
            told,
            torques: [0, 1, 2]
                .map(|leg| self.motor_torque(leg, told[leg], &legs[leg], y, rotors[leg].rate)),
            currents: [0, 1, 2].map(|leg| Self::current(y, leg)),
            legs,
        })
    }

    /// Kinetic, potential, magnetic and elastic energy together, J.
    ///
    /// # Errors
    /// [`Refusal::Pose`].
    pub fn energy(&self, y: &[f64; N]) -> Result<f64, Refusal> {
        let (q, v) = (three(y, 0), three(y, RATES));
        let legs = self.mechanics.legs(q, v)?;
        let mut energy =
            self.mechanics.kinetic_energy(q, v, &legs) + self.mechanics.potential_energy(q, &legs);
        for leg in 0..3 {
            if Self::ELASTIC {
                let rate = y[ROTOR_RATES + leg];
                let angle = self.mechanics.motor_angle(leg, &legs[leg]);
                let twist = wrapped(y[ROTORS + leg] - angle);
                let stiffness = self.transmission[leg].stiffness_nm_rad;
                energy += 0.5 * (self.rotors[leg] * rate * rate + stiffness * twist * twist);
            }
            if let MotorModel::Bldc(winding) = &self.motors[leg] {
                let current = Self::current(y, leg);
                energy += 0.5 * winding.inductance * current * current;
            }
        }
        Ok(energy)
    }

    /// Looks at the energies, for the size of what flows.
    pub(crate) fn note_energy(&mut self, y: &[f64; N]) -> Result<(), Refusal> {
        let (q, v) = (three(y, 0), three(y, RATES));
        let legs = self.mechanics.legs(q, v)?;
        let kinetic = self.mechanics.kinetic_energy(q, v, &legs);
        self.kinetic_peak = self.kinetic_peak.max(kinetic);
        Ok(())
    }
}
