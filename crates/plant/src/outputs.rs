//! Quantities of the plant besides its state: angles, torques, currents, energies.

use crate::layout::{RATES, ROTOR_RATES, ROTORS};
use crate::leg::LegState;
use crate::model::Plant;
use crate::motor::{MotorModel, wrapped};
use crate::refusal::Refusal;
use trirrr_integrate::System;

/// Everything of the plant at one instant that is not in its state.
#[derive(Clone, Copy, Debug)]
pub struct Outputs {
    /// x, y, alpha.
    pub pose: [f64; 3],
    /// Their rates.
    pub rates: [f64; 3],
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
        let at = self.configuration(y)?;
        let legs = at.legs;
        let told = self.told(t, &legs, y)?;
        let rotors = [0, 1, 2].map(|leg| self.rotor(leg, &legs[leg], y));
        Ok(Outputs {
            pose: at.pose(),
            rates: at.rates(),
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
        Ok(self.energies(y)?.stored)
    }

    /// Kinetic energy, in J, of the machine at `y` with rates as large as their scales: what
    /// tolerances are relative to.
    ///
    /// # Errors
    /// [`Refusal::Pose`].
    pub(crate) fn energy_unit(&self, y: &[f64; N]) -> Result<f64, Refusal> {
        let scales = self.scales();
        let mut unit = 0.0;
        for rate in RATES..RATES + 3 {
            let mut moving = *y;
            moving[rate] = scales[rate];
            unit += self.energies(&moving)?.kinetic;
        }
        Ok(unit)
    }

    /// The energies in the state `y`.
    ///
    /// # Errors
    /// [`Refusal::Pose`].
    pub(crate) fn energies(&self, y: &[f64; N]) -> Result<Energies, Refusal> {
        let at = self.configuration(y)?;
        let kinetic = self.mechanics.kinetic_energy(&at);
        let mut stored = kinetic + self.mechanics.potential_energy(&at);
        for leg in 0..3 {
            if Self::ELASTIC {
                let rate = y[ROTOR_RATES + leg];
                let angle = self.mechanics.motor_angle(leg, &at.legs[leg]);
                let twist = wrapped(y[ROTORS + leg] - angle);
                let stiffness = self.transmission[leg].stiffness_nm_rad;
                stored += 0.5 * (self.rotors[leg] * rate * rate + stiffness * twist * twist);
            }
            if let MotorModel::Bldc(winding) = &self.motors[leg] {
                let current = Self::current(y, leg);
                stored += 0.5 * winding.inductance * current * current;
            }
        }
        Ok(Energies {
            rates: at
                .legs
                .map(|leg| leg.rates[0].abs().max(leg.rates[1].abs())),
            kinetic,
            stored,
            work: y[N - 2],
            losses: y[N - 1],
        })
    }
}

/// Energies of a plant at one instant, J.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Energies {
    /// The faster link of each leg, rad/s.
    pub(crate) rates: [f64; 3],
    /// Of platform, links and rotors that sit on the joints.
    pub(crate) kinetic: f64,
    /// Kinetic, potential, magnetic and elastic.
    pub(crate) stored: f64,
    /// Work of the motors' supply since the start.
    pub(crate) work: f64,
    /// Losses since then.
    pub(crate) losses: f64,
}
