//! Event functions of the plant, and the changes at their zeros.

use crate::friction::Region;
use crate::layout::{RATES, three};
use crate::leg::{LegState, det_a};
use crate::model::{Control, Plant};
use crate::motor::{MotorModel, wrapped};
use crate::refusal::Refusal;
use crate::watch::{Cause, Ending, Watch};

/// A leg leads below this sine of the angle between its links.
const LEADS: f64 = 0.2;
/// It leads no longer above this one.
const RELEASED: f64 = 0.3;
/// Another leg leads instead where its sine is this part of the leading leg's.
const TAKES_OVER: f64 = 0.5;
/// A method that no step takes nearer to a leg's stretch than this sine has arrived.
const STRETCHED: f64 = 1e-4;

impl<const N: usize> Plant<N> {
    /// Returns `true` if `watch` can occur before the next sample.
    pub(crate) fn is_watched(&self, watch: Watch) -> bool {
        match watch {
            Watch::Lead(leg) => self.leading != Some(leg),
            Watch::Release => self.leading.is_some(),
            Watch::MoveEnd => match &self.control {
                Control::Continuous(continuous) => continuous.segment_end().is_some(),
                _ => false,
            },
            _ => true,
        }
    }

    /// The leg whose two angles are the first coordinates of the state; `None` where x and y are. The
    /// third is alpha.
    pub fn leading(&self) -> Option<usize> {
        self.leading
    }

    /// Changes the coordinates of the state `y` to those that suit it. Near a stretched leg,
    /// the equations in x and y are of no use: rates of links divide by its distance.
    ///
    /// # Errors
    /// [`Refusal::Pose`].
    pub fn choose_coordinates(&mut self, y: &mut [f64; N]) -> Result<(), Refusal> {
        let at = self.configuration(y)?;
        let sine = |leg: usize| self.mechanics.sine(leg, &at.legs[leg]);
        let nearest = (0..3)
            .filter(|&leg| self.mechanics.has_inertia(leg))
            .min_by(|&one, &other| sine(one).total_cmp(&sine(other)));
        // Events come to these limits up to rounding.
        let below = |leg: usize, limit: f64| sine(leg) <= limit * (1.0 + 1e-6);
        let suits = match (nearest, self.leading) {
            (Some(leg), None) if below(leg, LEADS) => Some(leg),
            (Some(leg), Some(leading)) if below(leg, TAKES_OVER * sine(leading)) => Some(leg),
            (_, Some(leading)) if sine(leading) < RELEASED * (1.0 - 1e-6) => Some(leading),
            _ => None,
        };
        if suits != self.leading {
            let (w, rates) = self.mechanics.coordinates(suits, &at);
            y[..3].copy_from_slice(&w);
            y[RATES..RATES + 3].copy_from_slice(&rates);
            self.leading = suits;
        }
        Ok(())
    }

    /// The leg at whose stretch or fold a method has arrived in the state `y`.
    pub(crate) fn stretched(&self, y: &[f64; N]) -> Option<usize> {
        let sines = self.mechanics.sines_squared(self.leading, three(y, 0));
        (0..3).find(|&leg| sines[leg] <= STRETCHED * STRETCHED)
    }

    /// Square of the sine below which another leg leads.
    fn leads_below(&self, sine: impl Fn(usize) -> f64) -> f64 {
        let limit = self
            .leading
            .map_or(LEADS, |leading| TAKES_OVER * sine(leading));
        limit * limit
    }

    /// The values of the functions that are defined beyond the reach of a leg, too: by the margins of
    /// all legs to their reach. Not a number for the others.
    fn watch_reach(&self, y: &[f64; N], values: &mut [f64]) {
        let sines = self.mechanics.sines_squared(self.leading, three(y, 0));
        for (watch, value) in self.watches.iter().zip(values) {
            *value = match *watch {
                Watch::Serial(leg) if self.leading != Some(leg) => sines[leg],
                Watch::Lead(leg) => sines[leg] - self.leads_below(|leg| sines[leg].max(0.0).sqrt()),
                _ => f64::NAN,
            };
        }
    }

    /// The value of every function.
    pub(crate) fn watch_values(&self, t: f64, y: &[f64; N], values: &mut [f64]) {
        let at = match self.configuration(y) {
            Ok(at) => at,
            Err(_) => {
                self.watch_reach(y, values);
                return;
            }
        };
        let legs = at.legs;
        let sine = |leg: usize| self.mechanics.sine(leg, &legs[leg]);
        let references = match self.references(t) {
            Some(Ok(references)) => Some(references),
            _ => None,
        };
        for (watch, value) in self.watches.iter().zip(values) {
            *value = match *watch {
                Watch::Parallel => det_a(&legs) * self.det_a_scale,
                Watch::Serial(leg) if self.leading == Some(leg) => sine(leg),
                Watch::Serial(leg) => sine(leg) * sine(leg),
                Watch::Lead(leg) => sine(leg) * sine(leg) - self.leads_below(sine),
                Watch::Release => self.leading.map_or(f64::NAN, sine) - RELEASED,
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
    pub(crate) fn meet(&mut self, watch: Watch, t: f64, y: &mut [f64; N]) -> Result<bool, Refusal> {
        let cause = match watch {
            Watch::Lead(_) | Watch::Release => {
                self.choose_coordinates(y)?;
                None
            }
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
                let legs = self.configuration(y)?.legs;
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
        let legs = self.configuration(y)?.legs;
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
