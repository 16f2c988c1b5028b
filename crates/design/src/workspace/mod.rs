//! Workspace of a machine in the plane of D, for one angle of the platform or a range of them.
//!
//! A cell is *within* where every pose of it is proven to keep the conditions, *beyond* where every pose is proven to break
//! one, and *undecided* otherwise. Undecided cells are divided, so that little is left.

mod bounds;
mod shapes;

pub use shapes::{Disc, Rectangle};

use bounds::{Box2, CellVerdict, MachineBounds};
use trirrr_core::machine::Parameters;

/// Halvings of an undecided cell.
const DIVISIONS: u32 = 4;

/// Widest slice of a range of angles that is looked at at once, rad.
const SLICE_RAD: f64 = 0.02;

/// Conditions that a pose keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Least distance of each leg from its serial singularity, 0 to 1; 0: the legs need only reach.
    pub serial_min: f64,
    /// Least distance from the parallel singularity, 0 to 1; 0 does not ask for it.
    pub parallel_min: f64,
    /// Sign of det A that is asked for.
    pub side: Option<bool>,
    /// Least and greatest angle of the platform, rad: a pose keeps the conditions with all angles between.
    pub alpha_rad: [f64; 2],
}

/// Grid of square cells in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellGrid {
    /// Lower left corner, m.
    pub low_m: [f64; 2],
    /// Side of a cell, m.
    pub cell_m: f64,
    /// Cells along x and along y.
    pub size: [usize; 2],
}

impl CellGrid {
    /// Grid of about `cells` along the longer side over all places that no leg is too short for, whatever the angle.
    pub fn around(parameters: &Parameters, cells: usize) -> Self {
        let side = |axis: usize| {
            let reach = |sign: f64| {
                let ends = parameters.legs.iter().map(|leg| {
                    let reach = leg.proximal_m + leg.distal_m + leg.joint_radius_m;
                    sign * leg.base_m[axis] + reach
                });
                sign * ends.fold(f64::INFINITY, f64::min)
            };
            [reach(-1.0), reach(1.0)]
        };
        let [[left, right], [bottom, top]] = [side(0), side(1)];
        let longer = (right - left).max(top - bottom).max(1e-6);
        let cell_m = longer / cells.max(1) as f64;
        let count = |length: f64| ((length / cell_m).ceil().max(1.0)) as usize;
        Self {
            low_m: [left, bottom],
            cell_m,
            size: [count(right - left), count(top - bottom)],
        }
    }

    /// Centre of a cell, m.
    pub fn centre_m(&self, column: usize, row: usize) -> [f64; 2] {
        [
            self.low_m[0] + (column as f64 + 0.5) * self.cell_m,
            self.low_m[1] + (row as f64 + 0.5) * self.cell_m,
        ]
    }

    /// Cell that holds a point.
    pub fn cell_of(&self, point_m: [f64; 2]) -> Option<[usize; 2]> {
        let at = [0, 1].map(|axis| ((point_m[axis] - self.low_m[axis]) / self.cell_m).floor());
        let inside = (0..2).all(|axis| at[axis] >= 0.0 && at[axis] < self.size[axis] as f64);
        inside.then(|| at.map(|index| index as usize))
    }
}

/// Proven and open parts of a cell's area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellShare {
    /// Proven to keep the conditions.
    pub within: f64,
    /// Neither proven to keep nor to break them.
    pub undecided: f64,
}

/// Map of the places that keep [`Conditions`].
#[derive(Clone, Debug, PartialEq)]
pub struct Workspace {
    /// The grid.
    pub grid: CellGrid,
    /// Shares of the cells, row by row from below.
    pub cells: Vec<CellShare>,
}

impl Workspace {
    /// Maps the places of `grid` where the machine keeps `conditions`, on all cores.
    pub fn map(parameters: &Parameters, conditions: &Conditions, grid: CellGrid) -> Self {
        let slices = slices(conditions.alpha_rad);
        let machines: Vec<MachineBounds> = slices
            .iter()
            .map(|slice| MachineBounds::new(parameters, conditions, *slice))
            .collect();
        let [columns, rows] = grid.size;
        let mut cells = vec![CellShare::default(); columns * rows];
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        // Rows in turns: those in the middle take longer.
        std::thread::scope(|scope| {
            let mut shares: Vec<Vec<(usize, &mut [CellShare])>> =
                (0..threads).map(|_| Vec::new()).collect();
            for (row, line) in cells.chunks_mut(columns).enumerate() {
                shares[row % threads].push((row, line));
            }
            for share in shares {
                let machines = &machines;
                scope.spawn(move || {
                    for (row, line) in share {
                        for (column, cell) in line.iter_mut().enumerate() {
                            let centre = grid.centre_m(column, row);
                            *cell = share_of(machines, centre, 0.5 * grid.cell_m, DIVISIONS);
                        }
                    }
                });
            }
        });
        Self { grid, cells }
    }

    /// Bounds of the area that keeps the conditions, m^2.
    pub fn area_m2(&self) -> [f64; 2] {
        let cell = self.grid.cell_m * self.grid.cell_m;
        let sum = |of: fn(&CellShare) -> f64| cell * self.cells.iter().map(of).sum::<f64>();
        [
            sum(|share| share.within),
            sum(|share| share.within + share.undecided),
        ]
    }

    /// Part of the grid's area that is undecided.
    pub fn undecided(&self) -> f64 {
        let sum: f64 = self.cells.iter().map(|share| share.undecided).sum();
        sum / self.cells.len().max(1) as f64
    }

    /// Returns true for a cell all of which is within.
    pub fn is_within(&self, column: usize, row: usize) -> bool {
        self.cells[row * self.grid.size[0] + column].within == 1.0
    }

    /// Whole cells within to which a chain of such cells leads from the one that holds `start`; none: that one is not within.
    /// Row by row from below.
    pub fn connected(&self, start_m: [f64; 2]) -> Option<Vec<bool>> {
        let [columns, rows] = self.grid.size;
        let [column, row] = self.grid.cell_of(start_m)?;
        if !self.is_within(column, row) {
            return None;
        }
        let mut kept = vec![false; columns * rows];
        let mut open = vec![[column, row]];
        while let Some([column, row]) = open.pop() {
            let cell = &mut kept[row * columns + column];
            if std::mem::replace(cell, true) {
                continue;
            }
            let sides = [
                (column > 0).then(|| [column - 1, row]),
                (column + 1 < columns).then_some([column + 1, row]),
                (row > 0).then(|| [column, row - 1]),
                (row + 1 < rows).then_some([column, row + 1]),
            ];
            let next = sides.into_iter().flatten();
            open.extend(next.filter(|[column, row]| {
                self.is_within(*column, *row) && !kept[row * columns + column]
            }));
        }
        Some(kept)
    }
}

fn slices([low, high]: [f64; 2]) -> Vec<[f64; 2]> {
    let count = ((high - low) / SLICE_RAD).ceil().max(1.0);
    let edge = |index: u32| low + (high - low) * f64::from(index) / count;
    (0..count as u32)
        .map(|index| [edge(index), edge(index + 1)])
        .collect()
}

/// Shares of the square about `centre` with half the side `half`.
fn share_of(machines: &[MachineBounds], centre: [f64; 2], half: f64, divisions: u32) -> CellShare {
    let square = Box2::around(centre, half);
    let mut all_within = true;
    for machine in machines {
        match machine.verdict(&square) {
            CellVerdict::Beyond => return CellShare::default(),
            CellVerdict::Undecided => all_within = false,
            CellVerdict::Within => {}
        }
    }
    if all_within {
        return CellShare {
            within: 1.0,
            undecided: 0.0,
        };
    }
    if divisions == 0 {
        return CellShare {
            within: 0.0,
            undecided: 1.0,
        };
    }
    let mut sum = CellShare::default();
    let quarter = 0.5 * half;
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let place = [centre[0] + x * quarter, centre[1] + y * quarter];
        let part = share_of(machines, place, quarter, divisions - 1);
        sum.within += 0.25 * part.within;
        sum.undecided += 0.25 * part.undecided;
    }
    sum
}
