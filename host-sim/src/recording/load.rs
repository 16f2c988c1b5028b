//! Loads of the motors over a whole job: heat and work.

use crate::tick_record::AnyTick;

/// Load of one motor over a job.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorLoad {
    /// Root mean square of the torque, N m: that of the current, and so of the heat.
    pub rms_torque_nm: f64,
    /// Work that the motor gives to the machine, J.
    pub given_j: f64,
    /// Work that the machine gives back, J: the motor brakes.
    pub returned_j: f64,
}

/// Sums up the loads, by the trapezoidal rule between records.
#[derive(Clone, Debug, Default)]
pub(super) struct LoadMeter {
    /// Time and, of each motor, torque and power of the last record.
    last: Option<(f64, Vec<[f64; 2]>)>,
    /// N^2 m^2 s, J, J.
    sums: Vec<[f64; 3]>,
    time_s: f64,
}

impl LoadMeter {
    /// Takes the next record.
    pub(super) fn push(&mut self, record: &AnyTick) {
        let new: Vec<_> = record
            .each_leg()
            .map(|leg| [leg.torque, leg.power])
            .collect();
        self.sums.resize(new.len(), [0.0; 3]);
        // A record behind a gap, or of another stream, has no step to it.
        if let Some((t, old)) = &self.last
            && record.t() > *t
        {
            let step_s = record.t() - t;
            self.time_s += step_s;
            let mean = |value: fn(f64) -> f64, of: [f64; 2]| (value(of[0]) + value(of[1])) / 2.0;
            for (sums, (old, new)) in self.sums.iter_mut().zip(old.iter().zip(&new)) {
                let [torques, powers] = [0, 1].map(|index| [old[index], new[index]]);
                sums[0] += step_s * mean(|torque| torque * torque, torques);
                sums[1] += step_s * mean(|power| power.max(0.0), powers);
                sums[2] += step_s * mean(|power| (-power).max(0.0), powers);
            }
        }
        self.last = Some((record.t(), new));
    }

    /// Loads up to now.
    pub(super) fn loads(&self) -> Vec<MotorLoad> {
        let load = |[squares, given_j, returned_j]: &[f64; 3]| MotorLoad {
            rms_torque_nm: match self.time_s > 0.0 {
                true => (squares / self.time_s).sqrt(),
                false => 0.0,
            },
            given_j: *given_j,
            returned_j: *returned_j,
        };
        self.sums.iter().map(load).collect()
    }
}
