//! Results of one tick of a run or one row of a batch. They are in SI units and binary64, whatever
//! number type computed them.

/// The motion of one leg at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct LegRecord {
    /// Absolute angle of the proximal link A -> B, which is the motor's, rad.
    pub th1: f64,
    /// Absolute angle of the distal link B -> C, rad.
    pub th2: f64,
    /// Rate of the proximal link, rad/s.
    pub dth1: f64,
    /// Rate of the distal link, rad/s.
    pub dth2: f64,
    /// Angular acceleration of the proximal link, rad/s^2.
    pub ddth1: f64,
    /// Angular acceleration of the distal link, rad/s^2.
    pub ddth2: f64,
    /// Torque of the motor on the proximal link, N m, counter-clockwise positive.
    pub torque: f64,
    /// Mechanical power that the motor delivers, W.
    pub power: f64,
    /// D = r1 x r2, m^2; zero where the leg is stretched or folded.
    pub cross: f64,
    /// Scale-free distance to the serial singularity, |r1 x r2| / (l1 l2), 0 to 1.
    pub serial: f64,
    /// Base joint A in the fixed frame, m.
    pub base: [f64; 2],
    /// Vector A -> B in the fixed frame, m.
    pub r1: [f64; 2],
    /// Vector B -> C in the fixed frame, m.
    pub r2: [f64; 2],
}

impl LegRecord {
    /// The elbow B in the fixed frame, m.
    pub fn elbow(&self) -> [f64; 2] {
        [self.base[0] + self.r1[0], self.base[1] + self.r1[1]]
    }

    /// The platform joint C in the fixed frame, m.
    pub fn platform_joint(&self) -> [f64; 2] {
        let elbow = self.elbow();
        [elbow[0] + self.r2[0], elbow[1] + self.r2[1]]
    }
}

/// The motion of the whole machine at one instant: the setpoint and what follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Record {
    /// Time since the start of the job, s.
    pub t: f64,
    /// Pose of the platform: x and y of D in m, alpha in rad (not wrapped).
    pub pose: [f64; 3],
    /// Its rate: m/s, m/s, rad/s.
    pub velocity: [f64; 3],
    /// Its acceleration: m/s^2, m/s^2, rad/s^2.
    pub acceleration: [f64; 3],
    /// The three legs.
    pub legs: [LegRecord; 3],
    /// det A, rows [r2x, r2y, c x r2], m^4; zero at the parallel singularity.
    pub det_a: f64,
    /// Scale-free distance to the parallel singularity, |det A| / (l2_1 l2_2 l2_3 rho).
    pub parallel: f64,
    /// Power of the tool, 0 to 1 of what it can give.
    pub tool: f64,
}

impl Record {
    /// The result columns of a batch, in their order: the values, without case and status.
    pub fn results(&self) -> [f64; 28] {
        let mut values = [0.0; 28];
        let per_leg: [fn(&LegRecord) -> f64; 7] = [
            |leg| leg.th1,
            |leg| leg.th2,
            |leg| leg.dth1,
            |leg| leg.dth2,
            |leg| leg.ddth1,
            |leg| leg.ddth2,
            |leg| leg.cross,
        ];
        for (group, value) in per_leg.iter().enumerate() {
            for (i, leg) in self.legs.iter().enumerate() {
                values[3 * group + i] = value(leg);
            }
        }
        values[21] = self.det_a;
        for (i, leg) in self.legs.iter().enumerate() {
            values[22 + i] = leg.torque;
            values[25 + i] = leg.power;
        }
        values
    }

    /// Returns the values of a row of `ticks.csv`, in the order of [`tick_columns`].
    pub fn tick_row(&self, torque: bool) -> impl Iterator<Item = f64> {
        let values = self.values().into_iter().enumerate();
        values.filter_map(move |(column, value)| is_kept(column, torque).then_some(value))
    }

    fn values(&self) -> [f64; TICK_COLUMNS.len()] {
        let mut values = [0.0; TICK_COLUMNS.len()];
        let mut next = 0;
        let mut put = |value: f64| {
            values[next] = value;
            next += 1;
        };
        put(self.t);
        for triple in [&self.pose, &self.velocity, &self.acceleration] {
            triple.iter().copied().for_each(&mut put);
        }
        let mut legs =
            |value: fn(&LegRecord) -> f64| self.legs.iter().map(value).for_each(&mut put);
        legs(|leg| leg.th1);
        legs(|leg| leg.dth1);
        legs(|leg| leg.ddth1);
        legs(|leg| leg.torque);
        legs(|leg| leg.power);
        put(self.det_a);
        let mut legs =
            |value: fn(&LegRecord) -> f64| self.legs.iter().map(value).for_each(&mut put);
        legs(|leg| leg.th2);
        legs(|leg| leg.dth2);
        legs(|leg| leg.ddth2);
        legs(|leg| leg.cross);
        legs(|leg| leg.serial);
        put(self.parallel);
        put(self.tool);
        debug_assert_eq!(next, TICK_COLUMNS.len());
        values
    }

    /// Returns true if every value is finite.
    pub fn is_finite(&self) -> bool {
        self.values().iter().all(|value| value.is_finite())
    }
}

/// Returns the columns of `ticks.csv`, SI units. A scene without `torque` has no torques and powers.
///
/// The setpoint comes first, then the motors, det A, the distal links, D = r1 x r2, the scale-free
/// distances to the serial and parallel singularity, and the tool.
pub fn tick_columns(torque: bool) -> impl Iterator<Item = &'static str> {
    let columns = TICK_COLUMNS.into_iter().enumerate();
    columns.filter_map(move |(column, name)| is_kept(column, torque).then_some(name))
}

/// Returns true if `column` is in the table of a scene with or without `torque`.
fn is_kept(column: usize, torque: bool) -> bool {
    torque || !TORQUES_AND_POWERS.contains(&column)
}

/// Columns that only a scene with torques has.
const TORQUES_AND_POWERS: std::ops::Range<usize> = 19..25;

/// Columns of a scene with torques.
const TICK_COLUMNS: [&str; 43] = [
    "t", "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha", //
    "th1_1", "th1_2", "th1_3", "dth1_1", "dth1_2", "dth1_3", "ddth1_1", "ddth1_2",
    "ddth1_3", //
    "tau1", "tau2", "tau3", "P1", "P2", "P3", "detA", //
    "th2_1", "th2_2", "th2_3", "dth2_1", "dth2_2", "dth2_3", "ddth2_1", "ddth2_2",
    "ddth2_3", //
    "D1", "D2", "D3", "serial1", "serial2", "serial3", "parallel", "tool",
];

/// Result columns of a batch after `case` and `status`, SI units.
pub const RESULT_COLUMNS: [&str; 28] = [
    "th1_1", "th1_2", "th1_3", "th2_1", "th2_2", "th2_3", //
    "dth1_1", "dth1_2", "dth1_3", "dth2_1", "dth2_2", "dth2_3", //
    "ddth1_1", "ddth1_2", "ddth1_3", "ddth2_1", "ddth2_2", "ddth2_3", //
    "D1", "D2", "D3", "detA", "tau1", "tau2", "tau3", "P1", "P2", "P3",
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Every value distinct, so that a swapped column shows.
    fn numbered() -> Record {
        let leg = |i: f64| LegRecord {
            th1: 10.0 + i,
            th2: 20.0 + i,
            dth1: 30.0 + i,
            dth2: 40.0 + i,
            ddth1: 50.0 + i,
            ddth2: 60.0 + i,
            torque: 70.0 + i,
            power: 80.0 + i,
            cross: 90.0 + i,
            serial: 100.0 + i,
            ..LegRecord::default()
        };
        Record {
            t: 1.0,
            pose: [2.0, 3.0, 4.0],
            velocity: [5.0, 6.0, 7.0],
            acceleration: [8.0, 9.0, 9.5],
            legs: [leg(1.0), leg(2.0), leg(3.0)],
            det_a: 200.0,
            parallel: 300.0,
            tool: 0.5,
        }
    }

    #[test]
    fn values_stand_under_their_names() {
        let record = numbered();
        let tick =
            |name: &str| record.values()[TICK_COLUMNS.iter().position(|&c| c == name).unwrap()];
        let result =
            |name: &str| record.results()[RESULT_COLUMNS.iter().position(|&c| c == name).unwrap()];
        for (i, leg) in record.legs.iter().enumerate() {
            let n = i + 1;
            for (name, value) in [
                (format!("th1_{n}"), leg.th1),
                (format!("th2_{n}"), leg.th2),
                (format!("dth1_{n}"), leg.dth1),
                (format!("dth2_{n}"), leg.dth2),
                (format!("ddth1_{n}"), leg.ddth1),
                (format!("ddth2_{n}"), leg.ddth2),
                (format!("D{n}"), leg.cross),
                (format!("tau{n}"), leg.torque),
                (format!("P{n}"), leg.power),
            ] {
                assert_eq!(tick(&name), value, "{name}");
                assert_eq!(result(&name), value, "{name}");
            }
            assert_eq!(tick(&format!("serial{n}")), leg.serial);
        }
        assert_eq!([tick("detA"), result("detA")], [200.0; 2]);
        assert_eq!([tick("parallel"), tick("tool")], [300.0, 0.5]);
        assert_eq!(
            [
                "t", "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha"
            ]
            .map(tick),
            [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 9.5]
        );
    }

    #[test]
    fn a_scene_without_torques_has_no_columns_of_them() {
        let record = numbered();
        let all: Vec<_> = tick_columns(true).zip(record.tick_row(true)).collect();
        assert_eq!(all.len(), 43);
        let left: Vec<_> = tick_columns(false).zip(record.tick_row(false)).collect();
        let is_dynamic = |name: &str| name.starts_with("tau") || name.starts_with('P');
        let expected = all.into_iter().filter(|(name, _)| !is_dynamic(name));
        assert_eq!(left, expected.collect::<Vec<_>>());
        assert_eq!(left.len(), 37);
    }
}
