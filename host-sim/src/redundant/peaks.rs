//! Extremes of the job of a redundant machine.

use crate::recording::{At, Peaks};
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

/// Extremes of a motion: those of every machine, and more.
#[derive(Clone, Debug)]
pub(super) struct RedundantPeaks {
    pub(super) machine: Peaks,
    pub(super) sliders: Vec<SliderPeaks>,
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
        let own = record.legs.iter().map(|leg| &leg.leg);
        Self {
            machine: Peaks::of_legs(record.t, own, record.parallel),
            sliders: sliders.collect(),
            norm: at(record.torque_norm()),
            least_norm: at(record.least_norm()),
            joint: joint.unwrap_or((0, at(0.0))),
        }
    }

    /// Takes a later record in; of equals the earlier stays.
    pub(super) fn merge(&mut self, record: &RedundantRecord) {
        let new = Self::new(record);
        self.machine.merge(&new.machine);
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
