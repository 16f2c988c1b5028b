//! Map of the places that a machine reaches with one angle of its platform.

use crate::Scene;
use crate::pipeline::{self, Pipeline};
use crate::record::Record;
use nalgebra::Vector3;
use trirrr_core::machine::{BuildError, LegParameters};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;

/// Nodes along the longer side of the map.
const NODES: usize = 240;

/// Bisections of the size of a rectangle: its factor is known to 2^-40 of the map.
const BISECTIONS: u32 = 40;

/// Places of D that a machine reaches from its start without passing a singularity, with the angle that the platform
/// has there, on a square grid.
///
/// A node is reached where every leg reaches it, where the distances to the singularities are at least those of the
/// scene's limits, and where a chain of such nodes leads to the start. Between nodes nothing is proven: the planner
/// proves the path itself.
#[derive(Clone, Debug)]
pub struct ReachMap {
    low_m: [f64; 2],
    step_m: f64,
    columns: usize,
    rows: usize,
    /// Rows from below, each from the left.
    margins: Vec<Option<f64>>,
}

/// Rectangle within the reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// Its centre, m.
    pub centre_m: [f64; 2],
    /// Its sides, in those that were asked for.
    pub factor: f64,
}

/// Poses that a machine has on the side of the singularities on which it starts.
pub(crate) struct StartReach {
    machine: Box<dyn Pipeline<f64>>,
    /// Least distances to the serial and parallel singularities.
    least: [f64; 2],
    /// Side on which the machine starts.
    is_positive: bool,
    holds_start: bool,
}

/// Corners of the rectangle beyond which a leg is too short, m.
fn legs_box(legs: &[LegParameters; 3]) -> [[f64; 2]; 2] {
    let reach = |leg: &LegParameters| leg.proximal_m + leg.distal_m + leg.joint_radius_m;
    let low = [0, 1].map(|axis: usize| {
        let sides = legs.iter().map(|leg| leg.base_m[axis] - reach(leg));
        sides.fold(f64::NEG_INFINITY, f64::max)
    });
    let high = [0, 1].map(|axis: usize| {
        let sides = legs.iter().map(|leg| leg.base_m[axis] + reach(leg));
        sides.fold(f64::INFINITY, f64::min).max(low[axis])
    });
    [low, high]
}

impl StartReach {
    /// Reach of the machine of `scene` from `start`.
    ///
    /// # Errors
    /// First quantity of the machine that is refused.
    pub(crate) fn new(scene: &Scene, start: &Pose<f64>) -> Result<Self, BuildError> {
        let limits = &scene.limits;
        let mut reach = Self {
            machine: pipeline::of_scene::<f64>(scene, Units::SI)?,
            least: [limits.serial_distance_min, limits.parallel_distance_min],
            is_positive: true,
            holds_start: true,
        };
        let at_start = reach.at(start);
        reach.is_positive = at_start.as_ref().is_some_and(|record| record.det_a > 0.0);
        reach.holds_start = at_start.is_some();
        Ok(reach)
    }

    fn at(&self, pose: &Pose<f64>) -> Option<Record> {
        let setpoint = Setpoint {
            pose: *pose,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        };
        self.machine.evaluate(0.0, &setpoint).ok()
    }

    /// Distance of a pose to the next singularity. None: the machine does not get there.
    pub(crate) fn margin(&self, pose: &Pose<f64>) -> Option<f64> {
        let record = self.at(pose)?;
        let [serial_min, parallel_min] = self.least;
        let serial = record.legs.iter().map(|leg| leg.serial).fold(1.0, f64::min);
        let reached = serial >= serial_min
            && record.parallel >= parallel_min
            && (record.det_a > 0.0) == self.is_positive;
        reached.then_some(serial.min(record.parallel))
    }
}

impl ReachMap {
    /// Maps the reach of the machine of `scene` with the angle of `start`.
    ///
    /// # Errors
    /// First quantity of the machine that is refused.
    pub fn new(scene: &Scene, start: &Pose<f64>) -> Result<Self, BuildError> {
        let mut map = Self::empty(&scene.parameters.legs);
        let reach = StartReach::new(scene, start)?;
        if !reach.holds_start {
            return Ok(map);
        }
        for row in 0..map.rows {
            for column in 0..map.columns {
                let [x, y] = map.place_m(column, row);
                let pose = Pose::from_f64(x, y, start.angle);
                map.margins[row * map.columns + column] = reach.margin(&pose);
            }
        }
        map.keep_what_leads_to(start.position.into());
        Ok(map)
    }

    /// Grid over the places that no leg is too short for.
    fn empty(legs: &[LegParameters; 3]) -> Self {
        let [[left, bottom], [right, top]] = legs_box(legs);
        let step_m = (right - left).max(top - bottom) / (NODES - 1) as f64;
        let nodes = |length: f64| match step_m > 0.0 {
            true => (length / step_m).round() as usize + 1,
            false => 1,
        };
        let (columns, rows) = (nodes(right - left), nodes(top - bottom));
        Self {
            low_m: [left, bottom],
            step_m,
            columns,
            rows,
            margins: vec![None; columns * rows],
        }
    }

    /// Clears the nodes from which no chain of others leads to `start`.
    fn keep_what_leads_to(&mut self, start: [f64; 2]) {
        let node = |axis: usize, nodes: usize| {
            let steps = (start[axis] - self.low_m[axis]) / self.step_m;
            let first = steps.floor().clamp(0.0, (nodes - 1) as f64) as usize;
            [first, (first + 1).min(nodes - 1)]
        };
        let (columns, rows) = (node(0, self.columns), node(1, self.rows));
        let around = rows.map(|row| columns.map(|column| (column, row)));
        let mut open: Vec<_> = around.as_flattened().to_vec();
        let mut kept = vec![None; self.margins.len()];
        while let Some((column, row)) = open.pop() {
            let Some(margin) = self.margins[row * self.columns + column].take() else {
                continue;
            };
            kept[row * self.columns + column] = Some(margin);
            open.extend((column > 0).then(|| (column - 1, row)));
            open.extend((row > 0).then(|| (column, row - 1)));
            open.extend((column + 1 < self.columns).then_some((column + 1, row)));
            open.extend((row + 1 < self.rows).then_some((column, row + 1)));
        }
        self.margins = kept;
    }

    /// Columns and rows of the grid.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// Distance of the nodes in both directions, m.
    pub fn step_m(&self) -> f64 {
        self.step_m
    }

    /// Place of a node in the fixed frame, m.
    pub fn place_m(&self, column: usize, row: usize) -> [f64; 2] {
        let [x, y] = self.low_m;
        [
            x + column as f64 * self.step_m,
            y + row as f64 * self.step_m,
        ]
    }

    /// Least distance to a singularity at a node, scale-free, 0 to 1. None: the machine does not reach it.
    pub fn margin(&self, column: usize, row: usize) -> Option<f64> {
        self.margins[row * self.columns + column]
    }

    /// Largest rectangle with the sides `size_m` times a factor all of whose nodes are reached; of several the nearest
    /// to the middle of the map. None: no node is reached, or `size_m` has no length.
    pub fn room(&self, size_m: [f64; 2]) -> Option<Room> {
        let longest = size_m[0].max(size_m[1]);
        if !(longest > 0.0 && longest.is_finite() && self.step_m > 0.0) {
            return None;
        }
        let reached = Reached::new(self);
        let span = self.step_m * self.columns.max(self.rows) as f64;
        let (mut low, mut high) = (0.0, span / longest);
        let mut found = None;
        for _ in 0..BISECTIONS {
            let factor = 0.5 * (low + high);
            match self.place_for(&reached, size_m.map(|side| factor * side)) {
                Some(centre_m) => {
                    found = Some(Room { centre_m, factor });
                    low = factor;
                }
                None => high = factor,
            }
        }
        found
    }

    /// Centre of a rectangle that holds one with sides `size_m`.
    fn place_for(&self, reached: &Reached, size_m: [f64; 2]) -> Option<[f64; 2]> {
        let [width, height] = size_m.map(|side| (side / self.step_m).ceil() as usize);
        let columns = 0..self.columns.saturating_sub(width);
        let off_middle = |(column, row): &(usize, usize)| {
            let off = |at: usize, side: usize, nodes: usize| (2 * at + side).abs_diff(nodes - 1);
            off(*column, width, self.columns).pow(2) + off(*row, height, self.rows).pow(2)
        };
        let rows = 0..self.rows.saturating_sub(height);
        let places = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
        let good = places.filter(|&(column, row)| reached.all([column, row], [width, height]));
        let (column, row) = good.min_by_key(off_middle)?;
        let [x, y] = self.place_m(column, row);
        let half = 0.5 * self.step_m;
        Some([x + half * width as f64, y + half * height as f64])
    }
}

/// Sums of reached nodes over all rectangles that begin in the lower left corner.
struct Reached {
    columns: usize,
    sums: Vec<u32>,
}

impl Reached {
    fn new(map: &ReachMap) -> Self {
        let columns = map.columns + 1;
        let mut sums = vec![0; columns * (map.rows + 1)];
        for row in 0..map.rows {
            let mut in_row = 0;
            for column in 0..map.columns {
                in_row += u32::from(map.margin(column, row).is_some());
                sums[(row + 1) * columns + column + 1] = sums[row * columns + column + 1] + in_row;
            }
        }
        Self { columns, sums }
    }

    /// True if all nodes of a rectangle of `width` by `height` steps are reached.
    fn all(&self, [column, row]: [usize; 2], [width, height]: [usize; 2]) -> bool {
        let sum = |column: usize, row: usize| self.sums[row * self.columns + column];
        let (right, top) = (column + width + 1, row + height + 1);
        let reached = sum(right, top) + sum(column, row) - sum(column, top) - sum(right, row);
        reached as usize == (width + 1) * (height + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn engraving() -> Scene {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/engraving.toml");
        Scene::read(std::path::Path::new(file)).expect("a shipped scene")
    }

    /// The judgement of the map against the geometry alone: both circles of each leg.
    #[test]
    fn reached_places_are_within_the_legs() {
        let scene = engraving();
        let start = scene.job.start;
        let map = ReachMap::new(&scene, &start).expect("a machine");
        let mut reached = 0;
        let [columns, rows] = map.size();
        for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |c| (c, row))) {
            let [x, y] = map.place_m(column, row);
            let within = scene.parameters.legs.iter().all(|leg| {
                let (sin, cos) = (start.angle + leg.joint_angle_rad).sin_cos();
                let joint = [x + leg.joint_radius_m * cos, y + leg.joint_radius_m * sin];
                let far = (joint[0] - leg.base_m.x).hypot(joint[1] - leg.base_m.y);
                far < leg.proximal_m + leg.distal_m && far > (leg.proximal_m - leg.distal_m).abs()
            });
            reached += u32::from(map.margin(column, row).is_some());
            assert!(within || map.margin(column, row).is_none(), "{x} {y}");
        }
        assert!(reached > 1000, "{reached} nodes");
    }

    #[test]
    fn a_room_is_as_large_as_it_can_be() {
        let mut map = ReachMap {
            low_m: [0.0, 1.0],
            step_m: 0.1,
            columns: 21,
            rows: 11,
            margins: vec![Some(0.5); 21 * 11],
        };
        // 2 m by 1 m in all.
        let all = map.room([4.0, 1.0]).expect("room");
        assert!((all.factor - 0.5).abs() < 1e-6, "{all:?}");
        assert!((all.centre_m[0] - 1.0).abs() < 1e-9 && (all.centre_m[1] - 1.5).abs() < 0.06);
        // A hole leaves what is right of it: 1.4 m by 1 m.
        map.margins[5 * 21 + 5] = None;
        let beside = map.room([1.4, 1.0]).expect("room");
        assert!((beside.factor - 1.0).abs() < 1e-6, "{beside:?}");
        assert!((beside.centre_m[0] - 1.3).abs() < 1e-9, "{beside:?}");
        // A level line.
        let line = map.room([1.0, 0.0]).expect("room");
        assert!((line.factor - 2.0).abs() < 1e-6, "{line:?}");
        assert_eq!(map.room([0.0, 0.0]), None);
        map.margins.fill(None);
        assert_eq!(map.room([1.0, 1.0]), None);
    }

    #[test]
    fn what_cannot_be_walked_to_is_not_reached() {
        let mut map = ReachMap {
            low_m: [0.0; 2],
            step_m: 1.0,
            columns: 5,
            rows: 2,
            margins: vec![Some(0.5); 10],
        };
        (map.margins[2], map.margins[7]) = (None, None);
        map.keep_what_leads_to([0.5, 0.5]);
        let reached = |row: usize| [0, 1, 2, 3, 4].map(|column| map.margin(column, row).is_some());
        let left = [true, true, false, false, false];
        assert_eq!([reached(0), reached(1)], [left, left]);
    }
}
