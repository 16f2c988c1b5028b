//! Samples of the plant: what its drives measure, and what their commands change.

use crate::control::{Commands, Measured};
use crate::layout::ROTORS;
use crate::leg::LegState;
use crate::model::{Control, Plant};
use crate::motor::{MotorModel, wrapped};
use crate::power_stage::DriveLimit;
use crate::refusal::Refusal;
use crate::watch::{Cause, Ending};

/// The plant at the instant of a sample.
pub(crate) struct Sensed {
    legs: [LegState; 3],
    /// Joint angles, unwrapped, rad.
    angles: [f64; 3],
    /// True rates on the rotors' side of the transmissions, rad/s.
    rotor_rates: [f64; 3],
    /// Measurements of the drives: encoder counts where there are encoders.
    pub(crate) measured: [Measured; 3],
}

impl<const N: usize> Plant<N> {
    /// Measures the plant in the state `y`.
    ///
    /// # Errors
    /// [`Refusal::Pose`].
    #[inline]
    pub(crate) fn measure(&mut self, y: &[f64; N]) -> Result<Sensed, Refusal> {
        let legs = self.configuration(y)?.legs;
        let mut measured = [Measured::default(); 3];
        let mut angles = [0.0; 3];
        for leg in 0..3 {
            angles[leg] = self.joint_angle(leg, &legs[leg]);
            self.near[leg] = angles[leg];
            measured[leg] = if Self::LAYOUT.elastic {
                self.rotor(leg, &legs[leg], y)
            } else {
                Measured {
                    angle: angles[leg],
                    rate: legs[leg].rates[0],
                }
            };
        }
        let rotor_rates = measured.map(|measured| measured.rate);
        self.quantise(&mut measured);
        for measured in &mut measured {
            measured.angle = wrapped(measured.angle);
        }
        Ok(Sensed {
            legs,
            angles,
            rotor_rates,
            measured,
        })
    }

    /// Holds `commands` from `t` on, which the drives made of `sensed`. Returns `true` where the
    /// run ends.
    #[inline]
    pub(crate) fn command(
        &mut self,
        t: f64,
        y: &[f64; N],
        sensed: &Sensed,
        commands: Commands,
    ) -> bool {
        self.commands = commands;
        self.held = commands.held;
        for leg in 0..3 {
            let error = wrapped(commands.angle[leg] - sensed.angles[leg]);
            let current = if Self::LAYOUT.currents {
                y[Self::LAYOUT.current() + leg]
            } else {
                0.0
            };
            let rate = sensed.rotor_rates[leg];
            let torque = match &self.motors[leg] {
                MotorModel::Ideal => commands.held[leg],
                MotorModel::Bldc(winding) => winding.torque_constant * current,
                MotorModel::Stepper(field) => {
                    let angle = if Self::LAYOUT.elastic {
                        y[ROTORS + leg]
                    } else {
                        sensed.angles[leg]
                    };
                    field.torque(commands.held[leg], angle - self.start[leg], rate)
                }
            };
            let motor = &mut self.statistics.motors[leg];
            motor.error.push(t, error);
            motor.torque.push(t, torque);
            motor.current.push(t, current);
            motor.power.push(t, torque * rate);
            let limited = commands.limited[leg];
            let (by_current, by_voltage) = (DriveLimit::Current, DriveLimit::Voltage);
            motor.current_limit.set(t, limited == Some(by_current));
            motor.voltage_limit.set(t, limited == Some(by_voltage));
            if let Some(limit) = self.following_error
                && error.abs() > limit
            {
                let cause = Cause::FollowingError { leg, limit };
                self.ending = Some(Ending { t, cause });
            }
        }
        for (leg, state) in sensed.legs.iter().enumerate() {
            // A step of the field may carry it past the middle.
            self.note_slip(t, leg, state, y);
        }
        self.ending.is_some()
    }

    /// Replaces angles and rates of the rotors by what encoders make of them: whole counts, and
    /// their differences from sample to sample.
    fn quantise(&mut self, measured: &mut [Measured; 3]) {
        let (Some(per_radian), Control::Sampled { rate_hz }) =
            (&self.counts_per_radian, &self.control)
        else {
            return;
        };
        let counts = [0, 1, 2].map(|leg| (measured[leg].angle * per_radian[leg]).round());
        // At the first sample the machine stands: there is no count before.
        let before = self.last_counts.unwrap_or(counts);
        for leg in 0..3 {
            measured[leg].angle = counts[leg] / per_radian[leg];
            measured[leg].rate = (counts[leg] - before[leg]) / per_radian[leg] * rate_hz;
        }
        self.last_counts = Some(counts);
    }
}
