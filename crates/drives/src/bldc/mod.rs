//! Motors with an amplifier that controls the current, and an encoder: the loops of position and rate are the board's.
//!
//! The tick gives [`Bldcs`] angle, rate, acceleration and torque of each joint. [`Loops`] run above the tick, some
//! thousand times per second, from a timer: they read the counters of the encoders, close the loop of
//! [`crate::joint::Loop`] on the reference of the tick, carried on to the sample, and set the amplifiers' set values. A
//! [`LoopLine`] joins the two.
//!
//! An amplifier takes its set value as the duty of a PWM signal: 10 % for all backward, 90 % for all forward, or
//! any other two. Outside these it has an input that enables it, and an output that tells a failure. All three share
//! the enable line.
//!
//! | what | by |
//! |---|---|
//! | off | the tick, in the next sample; a failure of any amplifier; three ticks without a reference |
//! | angle | from the counters: 0 where the board started, until homing tells where that is |
//! | state | on, off, or failed, as the amplifier says |

mod amplifier;
mod encoder;
mod line;
mod loops;

pub use amplifier::{AmplifierParameters, torque_of};
pub use encoder::EncoderScale;
pub use line::LoopLine;
pub use loops::{LoopMotor, Loops};

use crate::count::Countable;
use core::f64::consts::TAU;
use core::ops::Deref;
use line::{Counted, Measurements};
use trirrr_protocol::message::{DriveReading, DriveState};
use trirrr_service::Output;

/// Code of an amplifier that reports a failure.
pub const AMPLIFIER_FAILED: u32 = 1;

/// Units of a tick, seen from a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopUnits {
    /// rad/s per unit of a rate,
    pub rate_rad_s: f32,
    /// rad/s^2 per unit of an acceleration,
    pub acceleration_rad_s2: f32,
    /// N m per unit of a torque.
    pub torque_nm: f32,
    /// Ticks per second.
    pub tick_rate_hz: f32,
}

/// Half in the tick: references to the loops, and what they measure.
#[derive(Debug)]
pub struct Bldcs<L> {
    line: L,
    units: LoopUnits,
    /// Angle of each joint at count 0, in 2^-32 of a turn.
    zero: [u32; 3],
    /// Measured in the tick before, after this many samples.
    last: (u32, [u32; 3]),
    /// Ticks since the loops have measured.
    age: u16,
    on: bool,
}

impl<L: Deref<Target = LoopLine>> Bldcs<L> {
    /// Motors whose joints are taken to be at `angles` where their encoders start to count.
    pub fn new<N: Countable>(line: L, units: LoopUnits, angles: [N::Angle; 3]) -> Self {
        Self {
            line,
            units,
            zero: angles.map(N::turn),
            last: (0, [0; 3]),
            age: u16::MAX,
            on: false,
        }
    }

    /// Returns what the loops have measured. Rates are those from tick to tick.
    #[inline]
    pub fn measure<N: Countable>(&mut self) -> [DriveReading<N>; 3] {
        let (sample, measured) = self.line.measured();
        let Measurements {
            turns,
            torques,
            failed,
        } = measured;
        let (before, was) = self.last;
        self.age = match sample == before {
            true => self.age.saturating_add(1),
            false => 0,
        };
        self.last = (sample, turns);
        let per_turn =
            (TAU / 4_294_967_296.0) as f32 * self.units.tick_rate_hz / self.units.rate_rad_s;
        let mut readings = self
            .zero
            .map(|zero| DriveReading::unheard(N::angle_of(zero)));
        let parts = turns.iter().zip(was).zip(torques).zip(failed);
        for ((reading, zero), (((turn, was), torque), failed)) in
            readings.iter_mut().zip(self.zero).zip(parts)
        {
            reading.state = match (failed, self.on) {
                (true, _) => DriveState::Fault,
                (false, true) => DriveState::On,
                (false, false) => DriveState::Off,
            };
            reading.error = if failed { AMPLIFIER_FAILED } else { 0 };
            reading.angle = N::angle_of(turn.wrapping_add(zero));
            reading.rate = N::from_f32(turn.wrapping_sub(was) as i32 as f32 * per_turn);
            reading.torque = N::from_f32(torque / self.units.torque_nm);
            reading.age = self.age;
            reading.state_age = self.age;
        }
        readings
    }

    /// Gives the loops the references of a tick. Switches them off unless the output is on.
    #[inline]
    pub fn apply<N: Countable>(&mut self, output: &Output<N>) {
        self.on = output.is_on();
        if !self.on {
            self.line.off();
            return;
        }
        let units = self.units;
        let mut references = [Counted::default(); 3];
        let each = references.iter_mut().zip(&output.motors).zip(self.zero);
        for ((reference, motor), zero) in each {
            *reference = Counted {
                turn: N::turn(motor.angle).wrapping_sub(zero),
                rate: motor.rate.to_f32() * units.rate_rad_s,
                acceleration: motor.acceleration.to_f32() * units.acceleration_rad_s2,
                torque: motor.torque.to_f32() * units.torque_nm,
            };
        }
        self.line.give(&references);
    }

    /// Follows a new zero of the joint angles: all are greater `by` so much. Nothing moves.
    pub fn shift<N: Countable>(&mut self, by: [N::Angle; 3]) {
        for (zero, by) in self.zero.iter_mut().zip(by) {
            *zero = zero.wrapping_add(N::turn(by));
        }
    }
}
