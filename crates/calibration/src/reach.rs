//! Poses that a machine reaches safely, and ways between them.

use nalgebra::Vector3;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_design::workspace::{CellGrid, Conditions, Workspace};
use trirrr_scene::{Scene, pipeline};

/// Cells along the longer side of the map.
const CELLS: usize = 32;

/// Least distances from a serial and from the parallel singularity of poses for a calibration. Nearer than this, parts that are
/// off by some millimetres put a pose out of reach, and errors of the motors grow tenfold.
pub const MARGIN: [f64; 2] = [0.2, 0.1];

/// Part of a torque limit that holding the platform at rest may take.
const TORQUE_PART: f64 = 0.9;

/// Proven workspace of a machine for a range of angles, connected with the start of its job. Each cell is proven for every
/// angle of the range, so that a straight way within the cells is safe, however the platform turns on it.
#[derive(Clone, Debug)]
pub struct SafeRegion {
    grid: CellGrid,
    kept: Vec<bool>,
    start: [f64; 3],
    /// Least and greatest angle, rad.
    alpha_rad: [f64; 2],
}

impl SafeRegion {
    /// Region of the machine of `scene`, whose platform may turn by `turn_rad` to both sides of the angle at the start. Distances to
    /// singularities are at least those of `margin`, as [`MARGIN`], and those of the scene. None where the start itself is not proven with this turn, or a motor could not hold the platform there.
    pub fn of(scene: &Scene, turn_rad: f64, margin: [f64; 2]) -> Option<Self> {
        let machine = pipeline::build_in::<f64>(&scene.parameters, Units::SI).ok()?;
        let at_rest = |pose: [f64; 3]| {
            let setpoint = Setpoint {
                pose: Pose::from_f64(pose[0], pose[1], pose[2]),
                velocity: Vector3::zeros(),
                acceleration: Vector3::zeros(),
            };
            machine.evaluate(0.0, &setpoint).ok()
        };
        let begin = scene.job.start;
        let start = [begin.position.x, begin.position.y, begin.angle];
        let (limits, alpha) = (&scene.limits, start[2]);
        let conditions = Conditions {
            serial_min: limits.serial_distance_min.max(margin[0]),
            parallel_min: limits.parallel_distance_min.max(margin[1]),
            side: Some(at_rest(start)?.det_a > 0.0),
            alpha_rad: [alpha - turn_rad, alpha + turn_rad],
        };
        let grid = CellGrid::around(&scene.parameters, CELLS);
        let map = Workspace::map(&scene.parameters, &conditions, grid);
        let kept = map.connected([start[0], start[1]])?;
        let mut region = Self {
            grid,
            kept,
            start,
            alpha_rad: conditions.alpha_rad,
        };
        let torques = |pose| at_rest(pose).map(|record| record.legs.map(|leg| leg.torque));
        let holds = |pose: [f64; 3]| match (limits.torque_nm, torques(pose)) {
            (None, Some(_)) => true,
            (Some(most), Some(torques)) => {
                (0..3).all(|motor| torques[motor].abs() <= TORQUE_PART * most[motor])
            }
            (_, None) => false,
        };
        let cells = region.cells();
        for [column, row] in cells {
            let [x, y] = grid.centre_m(column, row);
            if !region.angles().iter().all(|angle| holds([x, y, *angle])) {
                region.kept[row * grid.size[0] + column] = false;
            }
        }
        region.is_safe([start[0], start[1]]).then_some(region)
    }

    /// Cells of the region.
    fn cells(&self) -> Vec<[usize; 2]> {
        let columns = self.grid.size[0];
        let cells = self.kept.iter().enumerate().filter(|(_, kept)| **kept);
        cells
            .map(|(index, _)| [index % columns, index / columns])
            .collect()
    }

    /// Angles of candidates: both ends and the middle.
    fn angles(&self) -> Vec<f64> {
        let [low, high] = self.alpha_rad;
        match high > low {
            true => vec![low, 0.5 * (low + high), high],
            false => vec![low],
        }
    }

    /// Poses in the middles of cells: x, y in m, alpha in rad.
    pub fn poses(&self) -> Vec<[f64; 3]> {
        let each = self.cells().into_iter().flat_map(|[column, row]| {
            let [x, y] = self.grid.centre_m(column, row);
            self.angles().into_iter().map(move |angle| [x, y, angle])
        });
        each.collect()
    }

    /// Pose at the start of the job.
    pub fn start(&self) -> [f64; 3] {
        self.start
    }

    /// Area, m^2.
    pub fn area_m2(&self) -> f64 {
        self.cells().len() as f64 * self.grid.cell_m * self.grid.cell_m
    }

    fn is_kept(&self, [column, row]: [usize; 2]) -> bool {
        self.kept[row * self.grid.size[0] + column]
    }

    /// The point and what is within an eighth of a cell of it lie in the region.
    fn is_safe(&self, [x, y]: [f64; 2]) -> bool {
        let near = 0.125 * self.grid.cell_m;
        [(-near, -near), (near, -near), (-near, near), (near, near)]
            .into_iter()
            .all(|(dx, dy)| {
                let cell = self.grid.cell_of([x + dx, y + dy]);
                cell.is_some_and(|cell| self.is_kept(cell))
            })
    }

    /// The straight way between two points stays in the region.
    pub fn leads(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let steps = (4.0 * length / self.grid.cell_m).ceil().max(1.0);
        (0..=steps as u32).all(|step| {
            let part = f64::from(step) / steps;
            self.is_safe([0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis])))
        })
    }

    /// Points between `from` and `to` over which straight ways lead; empty where one leads there directly. None where no way leads.
    pub fn way(&self, from: [f64; 2], to: [f64; 2]) -> Option<Vec<[f64; 2]>> {
        if self.leads(from, to) {
            return Some(Vec::new());
        }
        let chain = self.chain(self.grid.cell_of(from)?, self.grid.cell_of(to)?)?;
        let points: Vec<[f64; 2]> = chain
            .into_iter()
            .map(|[column, row]| self.grid.centre_m(column, row))
            .collect();
        let mut way = Vec::new();
        let mut here = from;
        let mut next = 0;
        while next < points.len() && !self.leads(here, to) {
            let far = (next..points.len()).rev();
            let mut seen = far.filter(|index| self.leads(here, points[*index]));
            // The middle of the own cell, or of the next one, is always seen.
            let index = seen.next().unwrap_or(next);
            here = points[index];
            next = index + 1;
            way.push(here);
        }
        Some(way)
    }

    /// Shortest chain of cells from one to another.
    fn chain(&self, from: [usize; 2], to: [usize; 2]) -> Option<Vec<[usize; 2]>> {
        let [columns, rows] = self.grid.size;
        let mut before = vec![None; columns * rows];
        let mut open = std::collections::VecDeque::from([from]);
        before[from[1] * columns + from[0]] = Some(from);
        while let Some(cell) = open.pop_front() {
            if cell == to {
                let mut chain = vec![to];
                let mut here = to;
                while here != from {
                    here = before[here[1] * columns + here[0]]?;
                    chain.push(here);
                }
                chain.reverse();
                return Some(chain);
            }
            let [column, row] = cell;
            let sides = [
                (column > 0).then(|| [column - 1, row]),
                (column + 1 < columns).then_some([column + 1, row]),
                (row > 0).then(|| [column, row - 1]),
                (row + 1 < rows).then_some([column, row + 1]),
            ];
            for side in sides.into_iter().flatten() {
                let place = &mut before[side[1] * columns + side[0]];
                if place.is_none() && self.is_kept(side) {
                    *place = Some(cell);
                    open.push_back(side);
                }
            }
        }
        None
    }

    /// The poses in an order of short ways from the start, with the points over which the ways lead before each.
    pub fn tour(&self, poses: &[[f64; 3]]) -> Vec<(Vec<[f64; 2]>, [f64; 3])> {
        let mut left = poses.to_vec();
        let mut here = self.start;
        let mut tour = Vec::new();
        while !left.is_empty() {
            let far = |pose: &[f64; 3]| (pose[0] - here[0]).hypot(pose[1] - here[1]);
            let nearest = (0..left.len())
                .min_by(|one, other| far(&left[*one]).total_cmp(&far(&left[*other])));
            let pose = left.swap_remove(nearest.unwrap_or(0));
            // A pose without a way cannot be: the region is connected.
            if let Some(way) = self.way([here[0], here[1]], [pose[0], pose[1]]) {
                tour.push((way, pose));
                here = pose;
            }
        }
        tour
    }
}
