//! What a job asks of the motors as a whole: heat and work.

use trirrr_scene::record::Record;

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
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LoadMeter {
    last: Option<Record>,
    /// N^2 m^2 s, J, J.
    sums: [[f64; 3]; 3],
    time_s: f64,
}

impl LoadMeter {
    /// Takes the next record.
    pub(super) fn push(&mut self, record: &Record) {
        // A record behind a gap, or of another stream, has no step to it.
        if let Some(last) = self.last
            && record.t > last.t
        {
            let step_s = record.t - last.t;
            self.time_s += step_s;
            for (sums, (old, new)) in self.sums.iter_mut().zip(last.legs.iter().zip(&record.legs)) {
                let mean =
                    |value: fn(f64) -> f64, of: [f64; 2]| of.map(value).iter().sum::<f64>() / 2.0;
                sums[0] += step_s * mean(|torque| torque * torque, [old.torque, new.torque]);
                sums[1] += step_s * mean(|power| power.max(0.0), [old.power, new.power]);
                sums[2] += step_s * mean(|power| (-power).max(0.0), [old.power, new.power]);
            }
        }
        self.last = Some(*record);
    }

    /// Loads up to now.
    pub(super) fn loads(&self) -> [MotorLoad; 3] {
        self.sums.map(|[squares, given_j, returned_j]| MotorLoad {
            rms_torque_nm: match self.time_s > 0.0 {
                true => (squares / self.time_s).sqrt(),
                false => 0.0,
            },
            given_j,
            returned_j,
        })
    }
}
