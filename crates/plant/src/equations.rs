//! The plant's differential equations: from state and time to the state's derivatives.

use crate::control::{Continuous, Measured};
use crate::layout::{RATES, ROTOR_RATES, ROTORS, three};
use crate::leg::LegState;
use crate::mechanics::JointMoments;
use crate::model::{Control, Plant};
use crate::motor::{MotorModel, wrapped};
use crate::refusal::Refusal;

impl<const N: usize> Plant<N> {
    #[inline(always)]
    pub(crate) fn legs(&self, y: &[f64; N]) -> Result<[LegState; 3], Refusal> {
        Ok(self.mechanics.legs(three(y, 0), three(y, RATES))?)
    }

    /// Joint angle of leg `leg`, unwrapped.
    #[inline]
    pub(crate) fn joint_angle(&self, leg: usize, state: &LegState) -> f64 {
        let angle = self.mechanics.motor_angle(leg, state);
        self.near[leg] + wrapped(angle - self.near[leg])
    }

    /// Angle at the rotor's side of the transmission, unwrapped, and its rate.
    #[inline(always)]
    pub(crate) fn rotor(&self, leg: usize, state: &LegState, y: &[f64; N]) -> Measured {
        if Self::ELASTIC {
            Measured {
                angle: y[ROTORS + leg],
                rate: y[ROTOR_RATES + leg],
            }
        } else {
            Measured {
                angle: self.joint_angle(leg, state),
                rate: state.rates[0],
            }
        }
    }

    #[inline(always)]
    pub(crate) fn current(y: &[f64; N], leg: usize) -> f64 {
        if Self::CURRENTS {
            y[Self::LAYOUT.current() + leg]
        } else {
            0.0
        }
    }

    /// Commands of the motors at `t` seconds.
    #[inline(always)]
    pub(crate) fn told(
        &self,
        t: f64,
        legs: &[LegState; 3],
        y: &[f64; N],
    ) -> Result<[f64; 3], Refusal> {
        match &self.control {
            Control::Continuous(continuous) => self.told_by(continuous, t, legs, y),
            Control::Held | Control::Sampled { .. } => Ok(self.held),
        }
    }

    #[inline(never)]
    fn told_by(
        &self,
        continuous: &Continuous,
        t: f64,
        legs: &[LegState; 3],
        y: &[f64; N],
    ) -> Result<[f64; 3], Refusal> {
        let references = continuous.references(t)?;
        Ok([0, 1, 2].map(|leg| {
            let measured = self.rotor(leg, &legs[leg], y);
            continuous.command(leg, &self.motors[leg], &references[leg], &measured)
        }))
    }

    /// Torque of motor `leg` at the joint.
    #[inline(always)]
    pub(crate) fn motor_torque(
        &self,
        leg: usize,
        told: f64,
        state: &LegState,
        y: &[f64; N],
        rate: f64,
    ) -> f64 {
        match &self.motors[leg] {
            MotorModel::Ideal => told,
            MotorModel::Bldc(winding) => winding.torque_constant * Self::current(y, leg),
            MotorModel::Stepper(field) => {
                let angle = self.rotor(leg, state, y).angle - self.start[leg];
                field.torque(told, angle, rate)
            }
        }
    }

    #[inline(always)]
    fn friction(&self, kind: usize, leg: usize, rate: f64) -> f64 {
        match &self.joints.friction[kind] {
            Some(friction) => friction.moment(rate, self.joints.regions[kind][leg]),
            None => 0.0,
        }
    }

    /// y' at `t`.
    #[inline(always)]
    pub(crate) fn slope(&self, t: f64, y: &[f64; N], dy: &mut [f64; N]) -> Result<(), Refusal> {
        let legs = self.legs(y)?;
        let told = self.told(t, &legs, y)?;
        self.slope_under(&told, &legs, y, dy)
    }

    /// y' with the motors told `told`.
    #[inline(always)]
    pub(crate) fn slope_under(
        &self,
        told: &[f64; 3],
        legs: &[LegState; 3],
        y: &[f64; N],
        dy: &mut [f64; N],
    ) -> Result<(), Refusal> {
        let (q, v) = (three(y, 0), three(y, RATES));
        let mut moments = [JointMoments::default(); 3];
        let (mut work, mut loss) = (0.0, 0.0);
        for leg in 0..3 {
            let state = &legs[leg];
            let [rate1, rate2] = state.rates;
            let rate = if Self::ELASTIC {
                y[ROTOR_RATES + leg]
            } else {
                rate1
            };
            let torque = self.motor_torque(leg, told[leg], state, y, rate);
            if let MotorModel::Bldc(winding) = &self.motors[leg] {
                let current = Self::current(y, leg);
                if Self::CURRENTS {
                    dy[Self::LAYOUT.current() + leg] =
                        winding.current_rate(told[leg], current, rate);
                }
                work += told[leg] * current;
                loss += winding.loss(current, rate);
            } else {
                if Self::CURRENTS {
                    dy[Self::LAYOUT.current() + leg] = 0.0;
                }
                work += torque * rate;
            }
            let rubbing = self.friction(0, leg, rate);
            loss += rubbing * rate;
            let moment = &mut moments[leg];
            if Self::ELASTIC {
                let spring = &self.transmission[leg];
                let twist = wrapped(y[ROTORS + leg] - self.mechanics.motor_angle(leg, state));
                let slip = rate - rate1;
                let damping = spring.damping_nm_s_rad * slip;
                moment.proximal = spring.stiffness_nm_rad * twist + damping;
                loss += damping * slip;
                dy[ROTORS + leg] = rate;
                dy[ROTOR_RATES + leg] = (torque - rubbing - moment.proximal) / self.rotors[leg];
            } else {
                moment.proximal = torque - rubbing;
            }
            let (bend, tilt) = (rate2 - rate1, v[2] - rate2);
            moment.elbow = self.friction(1, leg, bend);
            moment.platform = self.friction(2, leg, tilt);
            loss += moment.elbow * bend + moment.platform * tilt;
        }
        let acceleration = self.mechanics.acceleration(q, v, legs, &moments)?;
        dy[..3].copy_from_slice(&v);
        dy[RATES..RATES + 3].copy_from_slice(&acceleration);
        dy[N - 2] = work;
        dy[N - 1] = loss;
        Ok(())
    }

    /// (x'', y'', alpha'') at `t`.
    ///
    /// # Errors
    /// As the plant's equations.
    pub fn accelerations(&self, t: f64, y: &[f64; N]) -> Result<[f64; 3], Refusal> {
        let mut dy = [0.0; N];
        self.slope(t, y, &mut dy)?;
        Ok(three(&dy, RATES))
    }
}
