//! Motion and loads of a redundant machine at one tick.

use trirrr_scene::record::LegRecord;

/// State and drive of a slider.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SliderRecord {
    /// m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
    /// m/s^2.
    pub acceleration: f64,
    /// Force of the drive on the carriage, N.
    pub force: f64,
    /// Power of the drive, W.
    pub power: f64,
}

/// One leg of a redundant machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RedundantLegRecord {
    /// Motion, torque and power, as of a leg of a 3-RRR.
    pub leg: LegRecord,
    /// Torque of least norm: that without preload, N m.
    pub least_torque: f64,
    /// Forces in A, B and C, each on the outer body, N.
    pub joints: [[f64; 2]; 3],
    /// Slider of the base joint, if there is one.
    pub slider: Option<SliderRecord>,
}

/// Motion of the whole machine at one tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RedundantRecord {
    /// Time since the start of the job, s.
    pub t: f64,
    /// Pose of the platform: x and y of D in m, alpha in rad.
    pub pose: [f64; 3],
    /// Its rate: m/s, m/s, rad/s.
    pub velocity: [f64; 3],
    /// Its acceleration: m/s^2, m/s^2, rad/s^2.
    pub acceleration: [f64; 3],
    /// The legs.
    pub legs: Vec<RedundantLegRecord>,
    /// Scale-free distance to the parallel singularity.
    pub parallel: f64,
}

impl RedundantRecord {
    /// Euclidean norm of the motor torques, N m.
    pub fn torque_norm(&self) -> f64 {
        norm(self.legs.iter().map(|leg| leg.leg.torque))
    }

    /// Euclidean norm of the torques without preload, N m.
    pub fn least_norm(&self) -> f64 {
        norm(self.legs.iter().map(|leg| leg.least_torque))
    }
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).sum::<f64>().sqrt()
}
