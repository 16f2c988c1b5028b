//! Event functions of the plant, and the changes at their zeros.

use crate::friction::Region;
use crate::layout::RATES;
use crate::leg::{LegState, det_a};
use crate::model::{Control, Plant};
use crate::motor::{MotorModel, wrapped};
use crate::refusal::Refusal;
use crate::watch::{Cause, Ending, Watch};

/// A leg this close to its serial singularity, as the sine of the angle between its links, is
/// stretched or folded: its joint rates are a million times those of the platform.
const STRETCHED: f64 = 1e-6;
/// A singularity nearer than this is watched for from sample to sample.
const NEAR: f64 = 0.05;

impl<const N: usize> Plant<N> {
    /// Returns `true` if `watch` can occur before the next sample.
    pub(crate) fn is_watched(&self, watch: Watch) -> bool {
        match watch {
            Watch::Parallel | Watch::Serial(_) => self.near_singular,
            Watch::MoveEnd => match &self.control {
                Control::Continuous(continuous) => continuous.segment_end().is_some(),
                _ => false,
            },
            _ => true,
        }
    }

    /// Arms the watch for singularities until the next sample, if one is near.
    #[inline(always)]
    pub(crate) fn arm(&mut self, legs: &[LegState; 3]) {
        let parallel = (det_a(legs) * self.det_a_scale).abs();
        let serial = |leg: usize| (legs[leg].cross * self.cross_scale[leg]).abs();
        let least = serial(0).min(serial(1)).min(serial(2)).min(parallel);
        self.near_singular = least <= NEAR;
    }

    /// The value of every function; not a number where the state has none.
    pub(crate) fn watch_values(&self, t: f64, y: &[f64; N], values: &mut [f64]) {
        let Ok(legs) = self.legs(y) else {
            values.fill(f64::NAN);
            return;
        };
        let references = match self.references(t) {
            Some(Ok(references)) => Some(references),
            _ => None,
        };
        for (watch, value) in self.watches.iter().zip(values) {
            *value = match *watch {
                Watch::Parallel => det_a(&legs) * self.det_a_scale,
                Watch::Serial(leg) => (legs[leg].cross * self.cross_scale[leg]).abs() - STRETCHED,
                Watch::MoveEnd => match &self.control {
                    Control::Continuous(continuous) => {
                        continuous.segment_end().map_or(f64::NAN, |end| t - end)
                    }
                    _ => f64::NAN,
                },
                Watch::Stick { kind, leg, side } => {
                    let stick = self.joints.friction[kind].map_or(0.0, |joint| joint.stick);
                    self.joint_rate(kind, leg, &legs[leg], y) - side * stick
                }
                Watch::Slip(leg) => match &self.motors[leg] {
                    MotorModel::Stepper(field) => {
                        let angle = self.rotor(leg, &legs[leg], y).angle - self.start[leg];
                        field.slip_edge(self.held[leg], angle)
                    }
                    _ => f64::NAN,
                },
                Watch::Current(leg) | Watch::Voltage(leg) | Watch::FollowingError(leg) => {
                    match (&self.control, &references) {
                        (Control::Continuous(continuous), Some(references)) => {
                            let measured = self.rotor(leg, &legs[leg], y);
                            let reference = &references[leg];
                            match (*watch, &self.motors[leg]) {
                                (Watch::FollowingError(_), _) => {
                                    let limit = self.following_error.unwrap_or(f64::INFINITY);
                                    let angle = self.mechanics.motor_angle(leg, &legs[leg]);
                                    wrapped(reference.angle - angle).abs() - limit
                                }
                                (watch, MotorModel::Bldc(winding)) => {
                                    let margins =
                                        continuous.margins(leg, winding, reference, &measured);
                                    match watch {
                                        Watch::Current(_) => margins.current,
                                        _ => margins.voltage,
                                    }
                                }
                                _ => f64::NAN,
                            }
                        }
                        _ => f64::NAN,
                    }
                }
            };
        }
    }

    /// Rate of a joint of `kind` (0 motor, 1 elbow, 2 platform) of leg `leg`.
    fn joint_rate(&self, kind: usize, leg: usize, state: &LegState, y: &[f64; N]) -> f64 {
        let [rate1, rate2] = state.rates;
        match kind {
            0 => self.rotor(leg, state, y).rate,
            1 => rate2 - rate1,
            _ => y[RATES + 2] - rate2,
        }
    }

    /// Switches what `watch` switches at its zero. `true` where the run ends.
    pub(crate) fn meet(&mut self, watch: Watch, t: f64, y: &[f64; N]) -> Result<bool, Refusal> {
        let cause = match watch {
            Watch::Parallel => Some(Cause::Parallel),
            Watch::Serial(leg) => Some(Cause::Serial(leg)),
            Watch::FollowingError(leg) => Some(Cause::FollowingError {
                leg,
                limit: self.following_error.unwrap_or(f64::INFINITY),
            }),
            Watch::MoveEnd => {
                if let Control::Continuous(continuous) = &mut self.control {
                    continuous.next_segment();
                }
                None
            }
            Watch::Stick { kind, leg, side } => {
                let region = &mut self.joints.regions[kind][leg];
                let beyond = if side > 0.0 {
                    Region::Forward
                } else {
                    Region::Backward
                };
                *region = if *region == beyond {
                    Region::Stick
                } else {
                    beyond
                };
                None
            }
            Watch::Slip(leg) => {
                let legs = self.legs(y)?;
                self.note_slip(t, leg, &legs[leg], y);
                None
            }
            Watch::Current(leg) | Watch::Voltage(leg) => {
                self.switch_limit(watch, leg, t, y)?;
                None
            }
        };
        self.ending = cause.map(|cause| Ending { t, cause });
        Ok(cause.is_some())
    }

    fn switch_limit(
        &mut self,
        watch: Watch,
        leg: usize,
        t: f64,
        y: &[f64; N],
    ) -> Result<(), Refusal> {
        let legs = self.legs(y)?;
        let measured = self.rotor(leg, &legs[leg], y);
        let (Control::Continuous(continuous), MotorModel::Bldc(winding)) =
            (&mut self.control, &self.motors[leg])
        else {
            return Ok(());
        };
        let reference = continuous.references(t)?[leg];
        match watch {
            Watch::Current(_) => continuous.toggle_current(leg, &reference, &measured),
            _ => continuous.toggle_voltage(leg, winding, &reference, &measured),
        }
        let limited = continuous.limited[leg];
        let motor = &mut self.statistics.motors[leg];
        motor.current_limit.set(t, limited.current.is_some());
        motor.voltage_limit.set(t, limited.voltage.is_some());
        Ok(())
    }

    /// Counts the stable positions that the rotor of `leg` has fallen since it was last looked at.
    pub(crate) fn note_slip(&mut self, t: f64, leg: usize, state: &LegState, y: &[f64; N]) {
        let MotorModel::Stepper(field) = &self.motors[leg] else {
            return;
        };
        let angle = self.rotor(leg, state, y).angle - self.start[leg];
        let slips = field.slips(self.held[leg], angle);
        let change = slips.abs_diff(self.slips[leg]);
        if change > 0 {
            let motor = &mut self.statistics.motors[leg];
            motor.slips += change;
            motor.first_slip = motor.first_slip.or(Some(t));
            motor.lost_steps = 4 * slips;
            self.slips[leg] = slips;
        }
    }
}
