//! The extremes of a run.

use crate::tick_record::AnyTick;
use trirrr_figures::document::Facts;
use trirrr_linkage::redundant::scene::RedundantRecord;
use trirrr_scene::record::LegRecord;
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

/// Greatest sizes at one slider, each with its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderPeaks {
    /// Leg of the slider, from 0.
    pub leg: usize,
    /// m/s.
    pub velocity: At,
    /// N.
    pub force: At,
    /// W.
    pub power: At,
}

/// Extremes that only records of redundant machines have.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadPeaks {
    /// Those of the sliders.
    pub sliders: Vec<SliderPeaks>,
    /// Greatest norm of the motor torques, N m.
    pub norm: At,
    /// The same without preload.
    pub least_norm: At,
    /// Leg, from 0, with the greatest force in a joint, N.
    pub joint: (usize, At),
}

impl LoadPeaks {
    fn new(record: &RedundantRecord) -> Self {
        let at = |value| At { value, t: record.t };
        let legs = || record.legs.iter().enumerate();
        let sliders = legs().filter_map(|(leg, own)| {
            let slider = own.slider?;
            Some(SliderPeaks {
                leg,
                velocity: at(slider.velocity),
                force: at(slider.force),
                power: at(slider.power),
            })
        });
        let joints = legs().map(|(leg, own)| {
            let sizes = own.joints.map(|[x, y]| x.hypot(y));
            (leg, at(sizes.into_iter().fold(0.0, f64::max)))
        });
        let joint = joints.max_by(|(_, one), (_, other)| one.value.total_cmp(&other.value));
        Self {
            sliders: sliders.collect(),
            norm: at(record.torque_norm()),
            least_norm: at(record.least_norm()),
            joint: joint.unwrap_or((0, at(0.0))),
        }
    }

    fn merge(&mut self, new: &Self) {
        for (old, new) in self.sliders.iter_mut().zip(&new.sliders) {
            old.velocity.grow(new.velocity);
            old.force.grow(new.force);
            old.power.grow(new.power);
        }
        self.norm.grow(new.norm);
        self.least_norm.grow(new.least_norm);
        if new.joint.1.value > self.joint.1.value {
            self.joint = new.joint;
        }
    }
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
    /// More of a redundant machine.
    pub loads: Option<LoadPeaks>,
}

impl Peaks {
    /// The peaks of a single record.
    pub fn new(record: &AnyTick) -> Self {
        let t = record.t();
        let at = |value| At { value, t };
        let motor = |leg: &LegRecord| MotorPeaks {
            rate: at(leg.dth1),
            torque: at(leg.torque),
            power: at(leg.power),
        };
        Self {
            motors: record.each_leg().map(motor).collect(),
            serial: record.each_leg().map(|leg| at(leg.serial)).collect(),
            parallel: at(record.parallel()),
            loads: record.redundant().map(LoadPeaks::new),
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
        if let (Some(old), Some(new)) = (&mut self.loads, &new.loads) {
            old.merge(new);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_scene::record::Record;

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
