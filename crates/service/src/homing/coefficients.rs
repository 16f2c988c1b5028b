//! Coefficients of homing.

use super::Plan;
use super::parameters::{Contact, HomingMotor, HomingParameters, HomingTimes};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, shorter_way};
use trirrr_core::to_source;

/// The coefficients of homing: plain numbers, so that whoever builds an image can build them too
/// and write them as constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingCoefficients<N: Number> {
    /// Kind of contact that the motors meet.
    pub(crate) contact: Contact,
    /// An input has to be the same for so many ticks.
    pub(crate) debounce_ticks: u16,
    /// A stall outside homing is a fault.
    pub(crate) stall_is_fault: bool,
    /// Length of a tick.
    pub(crate) period: N::Factor,
    /// Durations of the parts.
    pub(crate) times: HomingTimes,
    /// The motors.
    pub(crate) axes: [HomingAxis<N>; 3],
    /// Pose that homing leads to.
    pub(crate) start: Pose<N>,
}

to_source!([N: Number] HomingCoefficients [N] in trirrr_service::coefficients {
    contact: Contact,
    debounce_ticks: u16,
    stall_is_fault: bool,
    period: N::Factor,
    times: HomingTimes,
    axes: [HomingAxis<N>; 3],
    start: Pose<N>,
});

/// Homing of one motor; signs are those of the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingAxis<N: Number> {
    /// When its turn is.
    pub(crate) stage: u8,
    /// The reference,
    pub(crate) contact: N::Angle,
    /// and where it stands when it is homed.
    pub(crate) park: N::Angle,
    /// From the reference to there,
    pub(crate) back: N,
    /// and from wherever a search may have ended to there.
    pub(crate) leave: N,
    /// Greatest travel of the search, positive.
    pub(crate) travel: N,
    /// Rate of the search, towards the reference,
    pub(crate) search: N,
    /// and of the second approach.
    pub(crate) latch: N,
    /// Torque from which on it presses against a stop, towards the reference.
    pub(crate) stall_torque: N,
    /// Acceleration, positive,
    pub(crate) acceleration: N,
    /// and the change of the rate in a tick.
    pub(crate) slope: N,
}

to_source!([N: Number] HomingAxis [N] in trirrr_service::features {
    stage: u8,
    contact: N::Angle,
    park: N::Angle,
    back: N,
    leave: N,
    travel: N,
    search: N,
    latch: N,
    stall_torque: N,
    acceleration: N,
    slope: N,
});

impl<N: Number> HomingCoefficients<N> {
    /// Builds the coefficients for ticks of `period`, in the unit of time that the rates are in.
    pub fn build(parameters: &HomingParameters, period: f64) -> Self {
        let [x, y, alpha] = parameters.start;
        Self {
            contact: parameters.contact,
            debounce_ticks: parameters.debounce_ticks,
            stall_is_fault: parameters.stall_is_fault,
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

impl<N: Number> HomingCoefficients<N> {
    /// Returns the plan of the homing.
    pub(crate) fn plan(&self) -> Plan<N> {
        let axes = self.axes.each_ref();
        Plan {
            from: axes.map(|axis| axis.park),
            to: self.start,
            ticks: self.times.to_start,
            rates: axes.map(|axis| axis.search),
            accelerations: axes.map(|axis| axis.acceleration),
        }
    }

    /// Returns true if motor `motor`, 0 to 2, at `angle` has reached its reference, or has run over it
    /// in the direction of the search.
    pub fn is_at_reference(&self, motor: usize, angle: N::Angle) -> bool {
        let axis = &self.axes[motor];
        let beyond = shorter_way::<N>(angle - axis.contact);
        match axis.search > N::ZERO {
            true => beyond >= N::ZERO,
            false => beyond <= N::ZERO,
        }
    }
}

impl<N: Number> HomingAxis<N> {
    fn build(motor: &HomingMotor, parameters: &HomingParameters, period: f64) -> Self {
        let sign = motor.sign();
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
            stall_torque: N::from_f64(sign * motor.stall_torque_nm),
            acceleration: N::from_f64(motor.acceleration_rad_s2),
            slope: N::from_f64(motor.acceleration_rad_s2 * period),
        }
    }
}
