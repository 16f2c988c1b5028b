//! One measurement: motor angles, and what a device saw of the platform there.

use crate::closure::{LoopClosure, slopes, turned};
use crate::parameter::{DEVICE, KinematicVector, PARAMETER_COUNT, TARGET, wrapped};

/// Values of a row, at most.
pub(crate) const MOST_VALUES: usize = 3;

/// Standard deviations of the device, where a row gives none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasurementNoise {
    /// Of each coordinate and of a distance, m.
    pub place_m: f64,
    /// Of the platform's angle, rad.
    pub angle_rad: f64,
}

/// Reading of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceReading {
    /// Place of the target in the frame of the device, and the angle of the target there if it was measured.
    Place {
        /// x and y, m.
        place_m: [f64; 2],
        /// Angle, rad; full turns do not count.
        angle_rad: Option<f64>,
    },
    /// Distance of the target from a fixed point, as a ball bar measures it.
    Distance {
        /// The distance, m.
        distance_m: f64,
        /// The fixed point in the frame of the device, m.
        centre_m: [f64; 2],
    },
}

/// A measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredRow {
    /// Line in the file of the measurements, from 1.
    pub line: u32,
    /// Angles that the encoders told, or that were commanded, rad.
    pub angles_rad: [f64; 3],
    /// Measured value.
    pub reading: DeviceReading,
    /// Standard deviations of the reading.
    pub noise: MeasurementNoise,
}

/// Slopes of the computed values of a row by all parameters, in standard deviations; the first `count` hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowSlopes {
    pub(crate) count: usize,
    pub(crate) slopes: [[f64; PARAMETER_COUNT]; MOST_VALUES],
}

/// Target in the frame of the device, with its slopes.
pub(crate) struct SeenTarget {
    /// x, y in m and angle in rad.
    pub(crate) seen: [f64; 3],
    pub(crate) slopes: [[f64; PARAMETER_COUNT]; 3],
}

/// x, y and angle of the target in the frame of the device, with the platform at `pose`.
pub(crate) fn seen_at(values: &KinematicVector, pose: [f64; 3]) -> [f64; 3] {
    let (device, target) = (values.device(), values.target());
    let arm = turned([target[0], target[1]], pose[2]);
    let point = [pose[0] + arm[0] - device[0], pose[1] + arm[1] - device[1]];
    let [x, y] = turned(point, -device[2]);
    [x, y, pose[2] + target[2] - device[2]]
}

/// As [`seen_at`], with the slopes: through the loops for the legs, directly for device and target.
pub(crate) fn seen_with_slopes(
    values: &KinematicVector,
    angles: &[f64; 3],
    pose: [f64; 3],
) -> SeenTarget {
    let (device, target) = (values.device(), values.target());
    let seen = seen_at(values, pose);
    let of_pose = slopes(values, angles, pose);
    let arm = turned([target[0], target[1]], pose[2]);
    let mut slopes = [[0.0; PARAMETER_COUNT]; 3];
    let mut put = |index: usize, by: [f64; 3]| {
        for (row, part) in slopes.iter_mut().zip(by) {
            row[index] = part;
        }
    };
    let in_device = |vector: [f64; 2]| turned(vector, -device[2]);
    let [of_x, of_y, of_alpha] = &of_pose;
    let columns = of_x.iter().zip(of_y).zip(of_alpha);
    for (index, ((&dx, &dy), &dalpha)) in columns.enumerate() {
        let [x, y] = in_device([dx - arm[1] * dalpha, dy + arm[0] * dalpha]);
        put(index, [x, y, dalpha]);
    }
    for axis in 0..2 {
        let mut unit = [0.0; 2];
        unit[axis] = 1.0;
        let [x, y] = in_device(unit);
        put(DEVICE + axis, [-x, -y, 0.0]);
        let [x, y] = in_device(turned(unit, pose[2]));
        put(TARGET + axis, [x, y, 0.0]);
    }
    put(DEVICE + 2, [seen[1], -seen[0], -1.0]);
    put(TARGET + 2, [0.0, 0.0, 1.0]);
    SeenTarget { seen, slopes }
}

impl MeasuredRow {
    /// Number of values.
    pub fn value_count(&self) -> usize {
        match self.reading {
            DeviceReading::Place {
                angle_rad: Some(_), ..
            } => 3,
            DeviceReading::Place { .. } => 2,
            DeviceReading::Distance { .. } => 1,
        }
    }

    /// Measured less computed values with the platform at `pose`, in their own units: m, m, rad or m.
    pub(crate) fn differences(&self, values: &KinematicVector, pose: [f64; 3]) -> [f64; 3] {
        let seen = seen_at(values, pose);
        match self.reading {
            DeviceReading::Place { place_m, angle_rad } => [
                place_m[0] - seen[0],
                place_m[1] - seen[1],
                angle_rad.map_or(0.0, |angle| wrapped(angle - seen[2])),
            ],
            DeviceReading::Distance {
                distance_m,
                centre_m,
            } => {
                let way = (seen[0] - centre_m[0]).hypot(seen[1] - centre_m[1]);
                [distance_m - way, 0.0, 0.0]
            }
        }
    }

    /// Standard deviations of the values.
    pub(crate) fn deviations(&self) -> [f64; 3] {
        let MeasurementNoise { place_m, angle_rad } = self.noise;
        [place_m, place_m, angle_rad]
    }

    /// Differences in standard deviations.
    pub(crate) fn residuals(&self, values: &KinematicVector, pose: [f64; 3]) -> [f64; 3] {
        let (differences, deviations) = (self.differences(values, pose), self.deviations());
        [0, 1, 2].map(|index| differences[index] / deviations[index])
    }

    /// Slopes of the computed values.
    pub(crate) fn linearised(&self, values: &KinematicVector, at: &LoopClosure) -> RowSlopes {
        let target = seen_with_slopes(values, &self.angles_rad, at.pose);
        let mut row = RowSlopes {
            count: self.value_count(),
            slopes: target.slopes,
        };
        if let DeviceReading::Distance { centre_m, .. } = self.reading {
            let way = [0, 1].map(|axis| target.seen[axis] - centre_m[axis]);
            let length = way[0].hypot(way[1]).max(f64::MIN_POSITIVE);
            let along = |x: f64, y: f64| (way[0] * x + way[1] * y) / length;
            row.slopes[0] = std::array::from_fn(|index| {
                along(target.slopes[0][index], target.slopes[1][index])
            });
        }
        for (slopes, deviation) in row.slopes.iter_mut().zip(self.deviations()) {
            slopes.iter_mut().for_each(|slope| *slope /= deviation);
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closure::close;
    use crate::parameter::parameter_name;
    use trirrr_core::machine::example;

    #[test]
    fn slopes_of_every_reading_are_those_of_finite_differences() {
        let mut values = KinematicVector::of(&example(), [0.1, -0.2, 0.4], [0.03, 0.01, 0.2]);
        values.0[6] = 0.002;
        let angles = [-0.03, -1.95, 2.79];
        let start = [0.21, 0.22, 0.15];
        let noise = MeasurementNoise {
            place_m: 2e-5,
            angle_rad: 2e-4,
        };
        let place = DeviceReading::Place {
            place_m: [0.2, 0.3],
            angle_rad: Some(0.1),
        };
        let distance = DeviceReading::Distance {
            distance_m: 0.3,
            centre_m: [0.05, 0.07],
        };
        for reading in [place, distance] {
            let row = MeasuredRow {
                line: 1,
                angles_rad: angles,
                reading,
                noise,
            };
            let at = close(&values, &angles, start).expect("a pose");
            let exact = row.linearised(&values, &at);
            for index in 0..PARAMETER_COUNT {
                let side = |by: f64| {
                    let mut moved = values;
                    moved.0[index] += by;
                    let pose = close(&moved, &angles, start).expect("a pose").pose;
                    row.residuals(&moved, pose)
                };
                let (low, high) = (side(-1e-6), side(1e-6));
                for value in 0..exact.count {
                    // A residual falls where the computed value grows.
                    let difference = (low[value] - high[value]) / 2e-6;
                    let off = (difference - exact.slopes[value][index]).abs();
                    assert!(off < 1e-2, "{}: {off}", parameter_name(index));
                }
            }
        }
    }
}
