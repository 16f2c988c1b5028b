//! Coefficients of homing.

use super::parameters::{Contact, HomingMotor, HomingParameters, HomingTimes};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;

/// The coefficients of homing: plain numbers, so that whoever builds an image can build them too
/// and write them as constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingCoefficients<N: Number> {
    /// Kind of contact that the motors meet.
    pub contact: Contact,
    /// An input has to be the same for so many ticks.
    pub debounce_ticks: u16,
    /// Length of a tick.
    pub period: N::Factor,
    /// Durations of the parts.
    pub times: HomingTimes,
    /// The motors.
    pub axes: [HomingAxis<N>; 3],
    /// Pose that homing leads to.
    pub start: Pose<N>,
}

/// Homing of one motor; signs are those of the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingAxis<N: Number> {
    /// When its turn is.
    pub stage: u8,
    /// The reference,
    pub contact: N::Angle,
    /// and where it stands when it is homed.
    pub park: N::Angle,
    /// From the reference to there,
    pub back: N,
    /// and from wherever a search may have ended to there.
    pub leave: N,
    /// Greatest travel of the search, positive.
    pub travel: N,
    /// Rate of the search, towards the reference,
    pub search: N,
    /// and of the second approach.
    pub latch: N,
    /// Acceleration, positive,
    pub acceleration: N,
    /// and the change of the rate in a tick.
    pub slope: N,
}

impl<N: Number> HomingCoefficients<N> {
    /// Builds the coefficients for ticks of `period`, in the unit of time that the rates are in.
    pub fn build(parameters: &HomingParameters, period: f64) -> Self {
        let [x, y, alpha] = parameters.start;
        Self {
            contact: parameters.contact,
            debounce_ticks: parameters.debounce_ticks,
            period: N::factor_from_f64(period),
            times: parameters.times,
            axes: parameters
                .motors
                .each_ref()
                .map(|motor| HomingAxis::build(motor, parameters, period)),
            start: Pose::from_f64(x, y, alpha),
        }
    }
}

impl<N: Number> HomingAxis<N> {
    fn build(motor: &HomingMotor, parameters: &HomingParameters, period: f64) -> Self {
        let sign = if motor.positive { 1.0 } else { -1.0 };
        let overrun = motor.overrun_rad(parameters.contact, parameters.debounce_ticks, period);
        Self {
            stage: motor.stage,
            contact: N::angle_from_f64(motor.angle_rad),
            park: N::angle_from_f64(motor.park_rad()),
            back: N::from_f64(-sign * motor.back_off_rad),
            leave: N::from_f64(-sign * (motor.back_off_rad + overrun)),
            travel: N::from_f64(motor.travel_max_rad),
            search: N::from_f64(sign * motor.search_rate_rad_s),
            latch: N::from_f64(sign * motor.latch_rate_rad_s),
            acceleration: N::from_f64(motor.acceleration_rad_s2),
            slope: N::from_f64(motor.acceleration_rad_s2 * period),
        }
    }
}
