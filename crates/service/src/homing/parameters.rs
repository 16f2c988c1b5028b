//! Parameters of homing that a scene gives.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{shorter_way, wrapped};
use trirrr_core::to_source;

/// Kind of reference that a motor meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Contact {
    /// A switch, which it may run over.
    Switch,
    /// A hard stop, and its drive says that it stalls.
    Stall,
    /// A hard stop, and the torque of its drive, which tells it, rises.
    Torque,
    /// A hard stop, and nobody says anything: after the largest travel it is there.
    Unfelt,
}

to_source!(pub Contact in trirrr_service::features: Switch, Stall, Torque, Unfelt);

/// Homing of one motor. Angles in rad, rates and accelerations in the machine's unit of time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct HomingMotor {
    /// Joint angle at which the switch closes or the stop lies.
    pub angle_rad: f64,
    /// True if the motor turns counter-clockwise towards its reference.
    pub positive: bool,
    /// Rate of the search, positive.
    pub search_rate_rad_s: f64,
    /// Rate of the second approach, which finds the reference; positive, at most that of the search.
    pub latch_rate_rad_s: f64,
    /// Acceleration of either, positive.
    pub acceleration_rad_s2: f64,
    /// Angle by which the motor moves back from the reference, positive.
    pub back_off_rad: f64,
    /// Largest angle that the motor may search over, positive.
    pub travel_max_rad: f64,
    /// Torque towards a hard stop from which on the motor is taken to press against it, N m at the joint, positive; any with
    /// another [contact](Contact).
    pub stall_torque_nm: f64,
    /// Stages follow one another from 0 to 2; motors of the same one move together.
    pub stage: u8,
}

/// Homing of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct HomingParameters {
    /// Kind of reference that the motors meet.
    pub contact: Contact,
    /// The motors.
    pub motors: [HomingMotor; 3],
    /// An input has to be the same for so many ticks; positive.
    pub debounce_ticks: u16,
    /// A drive that signals a stall while its motor moves is a fault, at any time; with [`Contact::Stall`].
    pub stall_is_fault: bool,
    /// Pose that homing leads to: x, y in the machine's unit of length, alpha in rad.
    pub start: [f64; 3],
    /// Durations of the parts of homing.
    pub times: HomingTimes,
}

/// Durations of the parts of homing, ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct HomingTimes {
    /// The search at most, and the whole of a run against a stop that nobody feels.
    pub search: [u32; 3],
    /// The second approach at most: twice the way back.
    pub latch: [u32; 3],
    /// A way back.
    pub back_off: u32,
    /// The way to the start pose.
    pub to_start: u32,
}

to_source!(pub [] HomingTimes [] in trirrr_service::features { search, latch, back_off, to_start });

impl HomingTimes {
    /// The times for these motors in ticks of `period`, in the unit of time that their rates are
    /// in. A way back, and the way to where the motors stand at the start pose (`start_rad`), are as
    /// fast as the search rate and the acceleration allow, with a ramp of `ramp_ticks` of a stop on
    /// it. For building scenes: the times of an image are constants.
    pub fn new(
        contact: Contact,
        motors: &[HomingMotor; 3],
        debounce_ticks: u16,
        start_rad: [f64; 3],
        period: f64,
        ramp_ticks: u16,
    ) -> Self {
        let wait = f64::from(debounce_ticks) + 1.0;
        let run = |motor: &HomingMotor, way: f64, rate: f64| {
            // On the ramp up half of the way is lost.
            let time = way / rate + rate / (2.0 * motor.acceleration_rad_s2);
            ticks(time / period + wait)
        };
        let mut back_off = 1.0f64;
        let mut to_start = 1.0f64;
        for (motor, start) in motors.iter().zip(start_rad) {
            let (rate, acceleration) = (motor.search_rate_rad_s, motor.acceleration_rad_s2);
            let overrun = motor.overrun_rad(contact, debounce_ticks, period);
            // A cubic from rest to rest: rate 3 h / (2 T) half way, acceleration 6 h / T^2 at its
            // ends.
            let time = |way: f64, ramp: f64| {
                let by_rate = 1.5 * way / rate;
                let of_ramp = 1.5 * way * ramp;
                let root = Arithmetic::sqrt(of_ramp * of_ramp + 24.0 * way * acceleration);
                let by_acceleration = (of_ramp + root) / (2.0 * acceleration);
                if by_rate > by_acceleration {
                    by_rate
                } else {
                    by_acceleration
                }
            };
            let most = |a: f64, b: f64| if b > a { b } else { a };
            back_off = most(back_off, time(motor.back_off_rad + overrun, 0.0) / period);
            let way = shorter_way::<f64>(start - motor.park_rad());
            let ramp = 1.0 / (f64::from(ramp_ticks) * period);
            to_start = most(to_start, time(Arithmetic::abs(way), ramp) / period);
        }
        let [a, b, c] = motors;
        Self {
            search: [a, b, c].map(|m| run(m, m.travel_max_rad, m.search_rate_rad_s)),
            latch: [a, b, c].map(|m| run(m, 2.0 * m.back_off_rad, m.latch_rate_rad_s)),
            back_off: ticks(back_off),
            to_start: ticks(to_start),
        }
    }
}

/// The next whole number, with one more against rounding.
fn ticks(time: f64) -> u32 {
    // From float to integer the cast cuts and saturates.
    (time as u32).saturating_add(2)
}

impl HomingMotor {
    /// Sign of the way towards the reference: 1 if the motor turns counter-clockwise there, else -1.
    pub fn sign(&self) -> f64 {
        match self.positive {
            true => 1.0,
            false => -1.0,
        }
    }

    /// Computes how far the motor may come beyond its reference in a search, rad.
    /// The switch is debounced, then the motor ramps to rest.
    pub fn overrun_rad(&self, contact: Contact, debounce_ticks: u16, period: f64) -> f64 {
        let (rate, wait) = (self.search_rate_rad_s, f64::from(debounce_ticks) + 1.0);
        match contact {
            Contact::Switch => {
                rate * rate / (2.0 * self.acceleration_rad_s2) + wait * rate * period
            }
            Contact::Stall | Contact::Torque | Contact::Unfelt => 0.0,
        }
    }

    /// Computes the angle at which the motor stands when it is homed, rad.
    pub fn park_rad(&self) -> f64 {
        wrapped::<f64>(self.angle_rad - self.sign() * self.back_off_rad)
    }
}
