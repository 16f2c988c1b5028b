//! The extremes of a run.

use trirrr_figures::document::Facts;
use trirrr_scene::record::{LegRecord, Record};
use trirrr_scene::words::tick_time;

/// A value and when it occurred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    /// The value, SI units.
    pub value: f64,
    /// Time since the start of the job, s.
    pub t: f64,
}

impl At {
    /// Value and its time.
    pub(crate) fn facts(self) -> Facts {
        let time = format!("{} s", tick_time(self.t));
        Facts::new()
            .pair("value", "", self.value)
            .pair("t_s", "at t =", self.t)
            .words(time)
    }

    /// Takes a later value in, if its size is greater.
    pub(crate) fn grow(&mut self, new: At) {
        if new.value.abs() > self.value.abs() {
            *self = new;
        }
    }

    /// Takes a later value in, if it is less.
    pub(crate) fn fall(&mut self, new: At) {
        if new.value < self.value {
            *self = new;
        }
    }
}

/// Greatest magnitudes at one motor, each with its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorPeaks {
    /// rad/s.
    pub rate: At,
    /// N m.
    pub torque: At,
    /// W.
    pub power: At,
}

/// Extremes of a motion, for the summary of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Peaks {
    /// The motors.
    pub motors: Vec<MotorPeaks>,
    /// Least distance to the serial singularity of each leg.
    pub serial: Vec<At>,
    /// Least distance to the parallel singularity.
    pub parallel: At,
}

impl Peaks {
    /// The peaks of a single record.
    pub fn new(record: &Record) -> Self {
        Self::of_legs(record.t, &record.legs, record.parallel)
    }

    /// Values at the time `t`, s.
    pub(crate) fn of_legs<'r>(
        t: f64,
        legs: impl IntoIterator<Item = &'r LegRecord>,
        parallel: f64,
    ) -> Self {
        let at = |value| At { value, t };
        let leg = |leg: &LegRecord| {
            let motor = MotorPeaks {
                rate: at(leg.dth1),
                torque: at(leg.torque),
                power: at(leg.power),
            };
            (motor, at(leg.serial))
        };
        let (motors, serial) = legs.into_iter().map(leg).unzip();
        Self {
            motors,
            serial,
            parallel: at(parallel),
        }
    }

    /// Takes later values in; of equals the earlier stays.
    pub fn merge(&mut self, new: &Self) {
        for (old, new) in self.motors.iter_mut().zip(&new.motors) {
            old.rate.grow(new.rate);
            old.torque.grow(new.torque);
            old.power.grow(new.power);
        }
        for (old, new) in self.serial.iter_mut().zip(&new.serial) {
            old.fall(*new);
        }
        self.parallel.fall(new.parallel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_keep_sign_and_time() {
        let record = |t: f64, torque: f64, distance: f64| {
            let mut record = Record {
                t,
                parallel: distance,
                ..Record::default()
            };
            record.legs[1].torque = torque;
            record.legs[2].serial = distance;
            record
        };
        let mut peaks = Peaks::new(&record(0.0, 1.0, 0.5));
        peaks.merge(&Peaks::new(&record(1.0, -3.0, 0.2)));
        peaks.merge(&Peaks::new(&record(2.0, 3.0, 0.3)));
        assert_eq!(
            peaks.motors[1].torque,
            At {
                value: -3.0,
                t: 1.0
            }
        );
        assert_eq!(peaks.motors[0].torque, At { value: 0.0, t: 0.0 });
        assert_eq!(peaks.serial[2], At { value: 0.2, t: 1.0 });
        assert_eq!(peaks.parallel, At { value: 0.2, t: 1.0 });
    }
}
