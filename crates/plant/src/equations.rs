//! The plant's differential equations: from state and time to the state's derivatives.

use crate::control::{Continuous, Measured};
use crate::layout::{RATES, ROTOR_RATES, ROTORS, three};
use crate::leg::LegState;
use crate::mechanics::{Configuration, JointMoments};
use crate::model::{Control, Plant};
use crate::motor::{MotorModel, wrapped};
use crate::refusal::Refusal;
use crate::scalar::{Differentiable, Dual};
use trirrr_integrate::Matrix;

impl<const N: usize> Plant<N> {
    /// Platform and legs in the state `y`.
    ///
    /// # Errors
    /// [`Refusal::Pose`].
    #[inline(always)]
    pub fn configuration<T: Differentiable>(
        &self,
        y: &[T; N],
    ) -> Result<Configuration<T>, Refusal> {
        let (w, rates) = (three(y, 0), three(y, RATES));
        Ok(self.mechanics.configuration(self.leading, w, rates)?)
    }

    /// Joint angle of leg `leg`, unwrapped.
    #[inline]
    pub(crate) fn joint_angle<T: Differentiable>(&self, leg: usize, state: &LegState<T>) -> T {
        let near = T::from(self.near[leg]);
        near + wrapped(self.mechanics.motor_angle(leg, state) - near)
    }

    /// Angle at the rotor's side of the transmission, unwrapped, and its rate.
    #[inline(always)]
    pub(crate) fn rotor<T: Differentiable>(
        &self,
        leg: usize,
        state: &LegState<T>,
        y: &[T; N],
    ) -> Measured<T> {
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
    pub(crate) fn current<T: Differentiable>(y: &[T; N], leg: usize) -> T {
        if Self::CURRENTS {
            y[Self::LAYOUT.current() + leg]
        } else {
            T::from(0.0)
        }
    }

    /// Commands of the motors at `t` seconds.
    #[inline(always)]
    pub(crate) fn told<T: Differentiable>(
        &self,
        t: f64,
        legs: &[LegState<T>; 3],
        y: &[T; N],
    ) -> Result<[T; 3], Refusal> {
        match &self.control {
            Control::Continuous(continuous) => self.told_by(continuous, t, legs, y),
            Control::Held | Control::Sampled { .. } => Ok(self.held.map(T::from)),
        }
    }

    #[inline(never)]
    fn told_by<T: Differentiable>(
        &self,
        continuous: &Continuous,
        t: f64,
        legs: &[LegState<T>; 3],
        y: &[T; N],
    ) -> Result<[T; 3], Refusal> {
        let references = continuous.references(t)?;
        Ok([0, 1, 2].map(|leg| {
            let measured = self.rotor(leg, &legs[leg], y);
            continuous.command(leg, &self.motors[leg], &references[leg], &measured)
        }))
    }

    /// Torque of motor `leg` at the joint.
    #[inline(always)]
    pub(crate) fn motor_torque<T: Differentiable>(
        &self,
        leg: usize,
        told: T,
        state: &LegState<T>,
        y: &[T; N],
        rate: T,
    ) -> T {
        match &self.motors[leg] {
            MotorModel::Ideal => told,
            MotorModel::Bldc(winding) => Self::current(y, leg) * winding.torque_constant,
            MotorModel::Stepper(field) => {
                let angle = self.rotor(leg, state, y).angle - T::from(self.start[leg]);
                field.torque(told, angle, rate)
            }
        }
    }

    #[inline(always)]
    fn friction<T: Differentiable>(&self, kind: usize, leg: usize, rate: T) -> T {
        match &self.joints.friction[kind] {
            Some(friction) => friction.moment(rate, self.joints.regions[kind][leg]),
            None => T::from(0.0),
        }
    }

    /// y' at `t`.
    #[inline(always)]
    pub(crate) fn slope<T: Differentiable>(
        &self,
        t: f64,
        y: &[T; N],
        dy: &mut [T; N],
    ) -> Result<(), Refusal> {
        let at = self.configuration(y)?;
        let told = self.told(t, &at.legs, y)?;
        self.slope_under(&told, &at, y, dy)
    }

    /// y' with the motors told `told`.
    #[inline(always)]
    pub(crate) fn slope_under<T: Differentiable>(
        &self,
        told: &[T; 3],
        at: &Configuration<T>,
        y: &[T; N],
        dy: &mut [T; N],
    ) -> Result<(), Refusal> {
        let spin = at.rates()[2];
        let mut moments = [JointMoments::default(); 3];
        let (mut work, mut loss) = (T::from(0.0), T::from(0.0));
        for leg in 0..3 {
            let state = &at.legs[leg];
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
                work = work + told[leg] * current;
                loss = loss + winding.loss(current, rate);
            } else {
                if Self::CURRENTS {
                    dy[Self::LAYOUT.current() + leg] = T::from(0.0);
                }
                work = work + torque * rate;
            }
            let rubbing = self.friction(0, leg, rate);
            loss = loss + rubbing * rate;
            let moment = &mut moments[leg];
            if Self::ELASTIC {
                let spring = &self.transmission[leg];
                let twist = wrapped(y[ROTORS + leg] - self.mechanics.motor_angle(leg, state));
                let slip = rate - rate1;
                let damping = slip * spring.damping_nm_s_rad;
                moment.proximal = twist * spring.stiffness_nm_rad + damping;
                loss = loss + damping * slip;
                dy[ROTORS + leg] = rate;
                dy[ROTOR_RATES + leg] =
                    (torque - rubbing - moment.proximal) * (1.0 / self.rotors[leg]);
            } else {
                moment.proximal = torque - rubbing;
            }
            let (bend, tilt) = (rate2 - rate1, spin - rate2);
            moment.elbow = self.friction(1, leg, bend);
            moment.platform = self.friction(2, leg, tilt);
            loss = loss + moment.elbow * bend + moment.platform * tilt;
        }
        work = work + self.mechanics.push_power(at.rates());
        let acceleration = self.mechanics.acceleration(at, &moments)?;
        dy[..3].copy_from_slice(&y[RATES..RATES + 3]);
        dy[RATES..RATES + 3].copy_from_slice(&acceleration);
        dy[N - 2] = work;
        dy[N - 1] = loss;
        Ok(())
    }

    /// Derivatives of y' by y: the equations in dual numbers.
    pub(crate) fn slope_jacobian(
        &self,
        t: f64,
        y: &[f64; N],
        jacobian: &mut Matrix<N>,
    ) -> Result<(), Refusal> {
        let mut slopes = [Dual::from(0.0); N];
        self.slope(t, &Dual::variables(y), &mut slopes)?;
        *jacobian = slopes.map(|slope| slope.slopes);
        Ok(())
    }

    /// Accelerations of the coordinates at `t`: x'', y'', alpha'' where no leg is
    /// [leading](Self::leading).
    ///
    /// # Errors
    /// As the plant's equations.
    pub fn accelerations(&self, t: f64, y: &[f64; N]) -> Result<[f64; 3], Refusal> {
        let mut dy = [0.0; N];
        self.slope(t, y, &mut dy)?;
        Ok(three(&dy, RATES))
    }
}
