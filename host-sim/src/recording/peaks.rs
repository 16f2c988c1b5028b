//! The extremes of a run.

use trirrr_scene::record::Record;

/// A value and when it occurred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    /// The value, SI units.
    pub value: f64,
    /// Time since the start of the job, s.
    pub t: f64,
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peaks {
    /// The three motors.
    pub motors: [MotorPeaks; 3],
    /// Least distance to the serial singularity of each leg.
    pub serial: [At; 3],
    /// Least distance to the parallel singularity.
    pub parallel: At,
}

impl Peaks {
    /// The peaks of a single record.
    pub fn new(record: &Record) -> Self {
        let at = |value| At { value, t: record.t };
        Self {
            motors: record.legs.map(|leg| MotorPeaks {
                rate: at(leg.dth1),
                torque: at(leg.torque),
                power: at(leg.power),
            }),
            serial: record.legs.map(|leg| at(leg.serial)),
            parallel: at(record.parallel),
        }
    }

    /// Takes a later record in; of equals the earlier stays.
    pub fn merge(&mut self, record: &Record) {
        let new = Self::new(record);
        let greater = |old: &mut At, new: At| {
            if new.value.abs() > old.value.abs() {
                *old = new;
            }
        };
        let less = |old: &mut At, new: At| {
            if new.value < old.value {
                *old = new;
            }
        };
        for (old, new) in self.motors.iter_mut().zip(new.motors) {
            greater(&mut old.rate, new.rate);
            greater(&mut old.torque, new.torque);
            greater(&mut old.power, new.power);
        }
        for (old, new) in self.serial.iter_mut().zip(new.serial) {
            less(old, new);
        }
        less(&mut self.parallel, new.parallel);
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
        peaks.merge(&record(1.0, -3.0, 0.2));
        peaks.merge(&record(2.0, 3.0, 0.3));
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
