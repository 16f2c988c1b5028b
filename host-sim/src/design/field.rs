//! Values over the plane of D: areas that are proven, and loads at the centres of cells.

use super::study::AlphaRow;
use nalgebra::Vector2;
use trirrr_core::setpoint::Pose;
use trirrr_design::loads::PoseLoads;
use trirrr_design::workspace::{CellGrid, Conditions, Disc, Rectangle, Workspace};
use trirrr_scene::Scene;
use trirrr_scene::pipeline::Pipeline;
use trirrr_tolerances::ToleranceAnalysis;

/// Area that keeps conditions, and what fits into it.
pub(super) struct Surface {
    pub(super) map: Workspace,
    /// Whole cells that are connected with the start of the job.
    pub(super) connected: Vec<bool>,
    pub(super) disc: Option<Disc>,
    pub(super) rectangle: Option<Rectangle>,
}

impl Surface {
    /// Maps where the machine of `scene` keeps `conditions`.
    pub(super) fn of(scene: &Scene, conditions: &Conditions, grid: CellGrid) -> Self {
        let map = Workspace::map(&scene.parameters, conditions, grid);
        let connected = map
            .connected(scene.job.start.position.into())
            .unwrap_or_else(|| vec![false; map.cells.len()]);
        Self {
            disc: grid.largest_disc(&connected),
            rectangle: grid.largest_rectangle(&connected),
            map,
            connected,
        }
    }

    /// Area of the connected cells, m^2.
    pub(super) fn connected_m2(&self) -> f64 {
        let cell = self.map.grid.cell_m;
        let count = self.connected.iter().filter(|is_kept| **is_kept).count();
        count as f64 * cell * cell
    }

    /// Returns `true` if `place` lies in a connected cell.
    fn holds(&self, place: [f64; 2]) -> bool {
        let cell = self.map.grid.cell_of(place);
        cell.is_some_and(|[column, row]| self.connected[row * self.map.grid.size[0] + column])
    }
}

/// Load that the machine carries in maps of torques.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadCase {
    /// Force on D in its worst direction, N.
    pub(super) load_n: f64,
    /// Acceleration of D in its worst direction, m/s^2.
    pub(super) acceleration_m_s2: f64,
}

impl LoadCase {
    /// Title of a map.
    pub(super) fn title(&self) -> String {
        let Self {
            load_n,
            acceleration_m_s2,
        } = self;
        format!(
            "largest torque with {load_n} N on D and {acceleration_m_s2} m/s\u{b2}, worst directions"
        )
    }

    /// Largest torque at a pose, N m.
    pub(super) fn torque_nm(&self, at: &PoseLoads) -> f64 {
        at.torque_nm(self.load_n, self.acceleration_m_s2)
    }
}

/// Loads at the centres of the cells of `grid` that `surface` holds, with the platform at `alpha_rad`.
pub(super) fn loads(
    machine: &dyn Pipeline<f64>,
    surface: &Surface,
    grid: &CellGrid,
    alpha_rad: f64,
) -> Vec<Option<PoseLoads>> {
    let [columns, rows] = grid.size;
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let at = |(column, row)| {
        let [x, y] = grid.centre_m(column, row);
        let pose = Pose::from_f64(x, y, alpha_rad);
        surface
            .holds([x, y])
            .then(|| PoseLoads::at(machine, pose))
            .flatten()
    };
    cells.map(at).collect()
}

/// Bounds of the offset of D, m, where there are `loads`, within the tolerances of the scene and the steps of its encoders; none of a scene
/// without tolerances. They hold at the centres of the cells.
pub(super) fn errors_m(
    scene: &Scene,
    loads: &[Option<PoseLoads>],
    grid: &CellGrid,
    alpha_rad: f64,
) -> Option<Vec<Option<f64>>> {
    let analysis = ToleranceAnalysis::new(scene).ok()?;
    let [columns, _] = grid.size;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let at = |index: usize| {
        loads[index].as_ref()?;
        let place = grid.centre_m(index % columns, index / columns);
        let pose = Pose {
            position: Vector2::from(place),
            angle: alpha_rad,
        };
        Some(analysis.at_rest(&pose)?.distance_m())
    };
    let mut errors = vec![None; loads.len()];
    let share = loads.len().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        for (start, errors) in errors.chunks_mut(share).enumerate() {
            scope.spawn(move || {
                for (index, error) in errors.iter_mut().enumerate() {
                    *error = at(start * share + index);
                }
            });
        }
    });
    Some(errors)
}

/// Study of a machine over the angles of its platform.
pub(super) struct AngleStudy<'a> {
    pub(super) scene: &'a Scene,
    pub(super) machine: &'a dyn Pipeline<f64>,
    pub(super) grid: CellGrid,
    pub(super) case: LoadCase,
    pub(super) stiffness_nm_rad: Option<[f64; 3]>,
}

/// Cells of a grid of areas from one at which values are taken to the next.
const STRIDE: usize = 2;

impl AngleStudy<'_> {
    /// Area and values with the platform at `degrees`, under `conditions` for that angle.
    pub(super) fn row(&self, degrees: f64, conditions: &Conditions) -> AlphaRow {
        let map = Workspace::map(&self.scene.parameters, conditions, self.grid);
        let [columns, rows] = self.grid.size;
        let mut found: [Vec<f64>; 4] = Default::default();
        for row in (0..rows).step_by(STRIDE) {
            for column in (0..columns).step_by(STRIDE) {
                if map.cells[row * columns + column].within < 0.5 {
                    continue;
                }
                let [x, y] = self.grid.centre_m(column, row);
                let pose = Pose::from_f64(x, y, conditions.alpha_rad[0]);
                let Some(at) = PoseLoads::at(self.machine, pose) else {
                    continue;
                };
                let compliance = self.stiffness_nm_rad.map(|each| at.compliance_m_n(each));
                let values = [
                    at.ratios.rate_per_speed(),
                    self.case.torque_nm(&at),
                    at.ratios.offset_per_error() * 0.1_f64.to_radians(),
                    compliance.unwrap_or(0.0),
                ];
                for (found, value) in found.iter_mut().zip(values) {
                    found.push(value);
                }
            }
        }
        let is_empty = found[0].is_empty();
        let values = found.map(|mut found| {
            found.sort_by(f64::total_cmp);
            let at = |part: f64| {
                let index = (part * found.len() as f64) as usize;
                found.get(index.min(found.len().saturating_sub(1))).copied()
            };
            [0.5, 0.9].map(|part| at(part).unwrap_or(0.0))
        });
        AlphaRow {
            degrees,
            area_m2: map.area_m2(),
            values: (!is_empty).then_some(values),
        }
    }
}
