//! Record of one tick, of whatever machine.

use trirrr_linkage::redundant::scene::{self, RedundantRecord};
use trirrr_scene::record::{LegRecord, Record};

/// Motion of a machine of any kind at one tick, for its table, figures and peaks.
pub trait TickRecord {
    /// Time since the start of the job, s.
    fn t(&self) -> f64;

    /// Pose, velocity and acceleration of the platform, SI.
    fn platform(&self) -> [[f64; 3]; 3];

    /// Number of the legs.
    fn legs(&self) -> usize;

    /// Motion, torque and power of the leg `index`, from 0.
    fn leg(&self, index: usize) -> &LegRecord;

    /// Scale-free distance to the parallel singularity.
    fn parallel(&self) -> f64;

    /// Values of a row of `ticks.csv`, of a scene with `torque` or without.
    fn row(&self, torque: bool) -> Vec<f64>;

    /// The record, if it is that of a redundant machine, which has more.
    fn redundant(&self) -> Option<&RedundantRecord> {
        None
    }
}

/// Record of a tick of a machine whose kind is known at run time.
pub type AnyTick = dyn TickRecord;

impl AnyTick {
    /// All legs, in order.
    pub fn each_leg(&self) -> impl Iterator<Item = &LegRecord> {
        (0..self.legs()).map(|index| self.leg(index))
    }
}

impl TickRecord for Record {
    fn t(&self) -> f64 {
        self.t
    }

    fn platform(&self) -> [[f64; 3]; 3] {
        [self.pose, self.velocity, self.acceleration]
    }

    fn legs(&self) -> usize {
        self.legs.len()
    }

    fn leg(&self, index: usize) -> &LegRecord {
        &self.legs[index]
    }

    fn parallel(&self) -> f64 {
        self.parallel
    }

    fn row(&self, torque: bool) -> Vec<f64> {
        self.tick_row(torque).collect()
    }
}

impl TickRecord for RedundantRecord {
    fn t(&self) -> f64 {
        self.t
    }

    fn platform(&self) -> [[f64; 3]; 3] {
        [self.pose, self.velocity, self.acceleration]
    }

    fn legs(&self) -> usize {
        self.legs.len()
    }

    fn leg(&self, index: usize) -> &LegRecord {
        &self.legs[index].leg
    }

    fn parallel(&self) -> f64 {
        self.parallel
    }

    fn row(&self, _: bool) -> Vec<f64> {
        scene::row(self)
    }

    fn redundant(&self) -> Option<&RedundantRecord> {
        Some(self)
    }
}
