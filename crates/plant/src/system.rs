//! The plant as the integrators see it.

use super::control::Measured;
use crate::layout::ROTORS;
use crate::model::{Control, Plant};
use crate::motor::{Motor, wrapped};
use crate::refusal::Refusal;
use crate::watch::{Cause, Ending, Watch};
use trirrr_drives::bldc::DriveLimit;
use trirrr_integrate::{Action, Direction, System};

impl<const N: usize> System<N> for Plant<N> {
    type Refusal = Refusal;

    #[inline]
    fn derivative(&self, t: f64, y: &[f64; N], dy: &mut [f64; N]) -> Result<(), Refusal> {
        self.slope(t, y, dy)
    }

    fn scales(&self) -> [f64; N] {
        let mut scales = [1.0; N];
        let size = self.mechanics.size();
        for axis in [0, 1, 3, 4] {
            scales[axis] = size;
        }
        if Self::LAYOUT.currents {
            for (leg, motor) in self.motors.iter().enumerate() {
                if let Motor::Bldc(winding) = motor {
                    // What the supply could drive through the winding: currents jump towards it with
                    // every sample, and a motion integrates them twice.
                    scales[Self::LAYOUT.current() + leg] = winding.supply / winding.resistance;
                }
            }
        }
        // Recorded only.
        scales[N - 2] = f64::INFINITY;
        scales[N - 1] = f64::INFINITY;
        scales
    }

    fn positions(&self) -> &[(usize, usize)] {
        Self::LAYOUT.positions()
    }

    fn events(&self) -> usize {
        self.watches.len()
    }

    fn event_name(&self, event: usize) -> String {
        self.watch_name(self.watches[event])
    }

    fn direction(&self, event: usize) -> Option<Direction> {
        let watch = self.watches[event];
        self.is_watched(watch).then_some(match watch {
            Watch::Serial(_) => Direction::Falling,
            Watch::MoveEnd | Watch::FollowingError(_) => Direction::Rising,
            _ => Direction::Either,
        })
    }

    fn event_values(&self, t: f64, y: &[f64; N], values: &mut [f64]) {
        self.watch_values(t, y, values);
    }

    fn at_event(&mut self, event: usize, t: f64, y: &mut [f64; N]) -> Result<Action, Refusal> {
        let ends = self.meet(self.watches[event], t, y)?;
        Ok(match self.watches[event] {
            _ if ends => Action::Stop,
            // The field is a sine: nothing changes in the equations.
            Watch::Slip(_) => Action::Continue,
            _ => Action::Switch,
        })
    }

    fn sample_rate(&self) -> Option<f64> {
        match &self.control {
            Control::Sampled { rate_hz, .. } => Some(*rate_hz),
            _ => None,
        }
    }

    fn sample(&mut self, tick: u64, t: f64, y: &mut [f64; N]) -> Result<Action, Refusal> {
        let legs = self.legs(y)?;
        self.arm(&legs);
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
        let Control::Sampled { controller, .. } = &mut self.control else {
            return Ok(Action::Continue);
        };
        self.commands = controller.sample(tick, &measured)?;
        self.held = self.commands.held;

        let commands = &self.commands;
        for leg in 0..3 {
            let error = wrapped(commands.angle[leg] - angles[leg]);
            let current = if Self::LAYOUT.currents {
                y[Self::LAYOUT.current() + leg]
            } else {
                0.0
            };
            let torque = match &self.motors[leg] {
                Motor::Ideal => commands.held[leg],
                Motor::Bldc(winding) => winding.torque_constant * current,
                Motor::Stepper(field) => {
                    let angle = if Self::LAYOUT.elastic {
                        y[ROTORS + leg]
                    } else {
                        angles[leg]
                    };
                    field.torque(
                        commands.held[leg],
                        angle - self.start[leg],
                        rotor_rates[leg],
                    )
                }
            };
            let motor = &mut self.statistics.motors[leg];
            motor.error.push(t, error);
            motor.torque.push(t, torque);
            motor.current.push(t, current);
            motor.power.push(t, torque * rotor_rates[leg]);
            let limited = commands.limited[leg];
            motor
                .current_limit
                .set(t, limited == Some(DriveLimit::Current));
            motor
                .voltage_limit
                .set(t, limited == Some(DriveLimit::Voltage));
            if self
                .following_error
                .is_some_and(|limit| error.abs() > limit)
            {
                self.ending = Some(Ending {
                    t,
                    cause: Cause::FollowingError {
                        leg,
                        limit: self.following_error.unwrap_or(f64::INFINITY),
                    },
                });
            }
        }
        for (leg, state) in legs.iter().enumerate() {
            // A step of the field may carry it past the middle.
            self.note_slip(t, leg, state, y);
        }
        Ok(match self.ending {
            Some(_) => Action::Stop,
            None => Action::Switch,
        })
    }
}

impl<const N: usize> Plant<N> {
    /// What the encoders make of the rotors' angles and rates: whole counts, and their differences
    /// from sample to sample.
    fn quantise(&mut self, measured: &mut [Measured; 3]) {
        let (Some(per_radian), Control::Sampled { rate_hz, .. }) =
            (&self.counts_per_radian, &self.control)
        else {
            return;
        };
        let counts = [0, 1, 2].map(|leg| (measured[leg].angle * per_radian[leg]).round());
        // At the first sample nothing is known of the rate: the machine stands.
        let before = self.last_counts.unwrap_or(counts);
        for leg in 0..3 {
            measured[leg].angle = counts[leg] / per_radian[leg];
            measured[leg].rate = (counts[leg] - before[leg]) / per_radian[leg] * rate_hz;
        }
        self.last_counts = Some(counts);
    }
}
