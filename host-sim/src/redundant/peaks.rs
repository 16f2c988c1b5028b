//! Extremes of the job of a redundant machine.

use crate::recording::{At, MotorPeaks};
use trirrr_linkage::redundant::scene::RedundantRecord;

/// Greatest sizes at one slider, each with its sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct SliderPeaks {
    /// Leg of the slider, from 0.
    pub(super) leg: usize,
    /// m/s.
    pub(super) velocity: At,
    /// N.
    pub(super) force: At,
    /// W.
    pub(super) power: At,
}

/// Extremes of a motion.
#[derive(Clone, Debug)]
pub(super) struct RedundantPeaks {
    pub(super) motors: Vec<MotorPeaks>,
    pub(super) sliders: Vec<SliderPeaks>,
    /// Least distance to the serial singularity, and its leg.
    pub(super) serial: (usize, At),
    pub(super) parallel: At,
    /// Greatest norm of the motor torques, with preload and without, N m.
    pub(super) norm: At,
    pub(super) least_norm: At,
    /// Greatest force in a joint, N, and its leg.
    pub(super) joint: (usize, At),
}

impl RedundantPeaks {
    /// Extremes of one record.
    pub(super) fn new(record: &RedundantRecord) -> Self {
        let at = |value| At { value, t: record.t };
        let legs = || record.legs.iter().enumerate();
        let extreme = |values: &mut dyn Iterator<Item = (usize, f64)>, greatest: bool| {
            let sign = if greatest { 1.0 } else { -1.0 };
            let best = values.max_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)));
            best.map_or((0, at(0.0)), |(leg, value)| (leg, at(value)))
        };
        let joints =
            |(leg, own): (usize, &trirrr_linkage::redundant::scene::RedundantLegRecord)| {
                let sizes = own.joints.map(|[x, y]| x.hypot(y));
                (leg, sizes.into_iter().fold(0.0, f64::max))
            };
        Self {
            motors: legs()
                .map(|(_, own)| MotorPeaks {
                    rate: at(own.leg.dth1),
                    torque: at(own.leg.torque),
                    power: at(own.leg.power),
                })
                .collect(),
            sliders: legs()
                .filter_map(|(leg, own)| {
                    let slider = own.slider?;
                    Some(SliderPeaks {
                        leg,
                        velocity: at(slider.velocity),
                        force: at(slider.force),
                        power: at(slider.power),
                    })
                })
                .collect(),
            serial: extreme(&mut legs().map(|(leg, own)| (leg, own.leg.serial)), false),
            parallel: at(record.parallel),
            norm: at(record.torque_norm()),
            least_norm: at(record.least_norm()),
            joint: extreme(&mut legs().map(joints), true),
        }
    }

    /// Takes a later record in; of equals the earlier stays.
    pub(super) fn merge(&mut self, record: &RedundantRecord) {
        let new = Self::new(record);
        for (old, new) in self.motors.iter_mut().zip(&new.motors) {
            greater(&mut old.rate, new.rate);
            greater(&mut old.torque, new.torque);
            greater(&mut old.power, new.power);
        }
        for (old, new) in self.sliders.iter_mut().zip(&new.sliders) {
            greater(&mut old.velocity, new.velocity);
            greater(&mut old.force, new.force);
            greater(&mut old.power, new.power);
        }
        greater(&mut self.norm, new.norm);
        greater(&mut self.least_norm, new.least_norm);
        if new.serial.1.value < self.serial.1.value {
            self.serial = new.serial;
        }
        if new.parallel.value < self.parallel.value {
            self.parallel = new.parallel;
        }
        if new.joint.1.value > self.joint.1.value {
            self.joint = new.joint;
        }
    }
}

fn greater(old: &mut At, new: At) {
    if new.value.abs() > old.value.abs() {
        *old = new;
    }
}
