//! The machine of a scene.

use crate::arrays::{Rows, array, rows, table};
use crate::errors::{exception, of_scene};
use crate::{plan, play, pool};
use nalgebra::Vector3;
use numpy::PyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use rayon::prelude::*;
use std::path::PathBuf;
use trirrr_batch::{BatchMachine, BatchReactions, FailedRow, MotorRows, StateRows};
use trirrr_client::SceneImage;
use trirrr_core::forward::Completeness;
use trirrr_core::machine::Elbow;
use trirrr_core::setpoint::Pose;
use trirrr_design::assembly::{AssemblyModes, elbows_of, working_modes};
use trirrr_image::generate::BoardScene;
use trirrr_protocol::wire::to_bytes;
use trirrr_scene::read::Setting;
use trirrr_scene::{JobMove, JobPlayer, Scene, judge_move};

/// Most assembly modes of a machine.
const MODES: usize = 6;

/// Array of numbers.
type Numbers<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Most bytes of the header of a scene.
const HEADER: usize = 256;

/// Board, key, header and values of a scene.
type OverLine<'py> = (
    Option<String>,
    u32,
    Bound<'py, PyBytes>,
    Bound<'py, PyBytes>,
);

/// Rows without a result, and the reason.
type Failures = Vec<(usize, String)>;

/// A scene that was read, and its machine built for arrays.
#[pyclass(frozen, module = "trirrr._native")]
pub(crate) struct NativeMachine {
    scene: Scene,
    kinematics: BatchMachine<f64>,
    dynamics: BatchMachine<f64>,
    reactions: BatchReactions<f64>,
}

#[pymethods]
impl NativeMachine {
    /// Reads the scene in `file`, or in `text` if there is one, with `settings` such as `limits.rate_rad_s=3` in place of its values.
    #[new]
    fn new(
        py: Python<'_>,
        file: PathBuf,
        text: Option<String>,
        settings: Vec<String>,
    ) -> PyResult<Self> {
        let settings = settings.iter().map(|setting| {
            let parsed = setting.parse::<Setting>();
            parsed.map_err(|reason| PyValueError::new_err(format!("{setting:?}: {reason}")))
        });
        let settings = settings.collect::<PyResult<Vec<_>>>()?;
        let read = py.detach(|| match text {
            None => Scene::read_set(&file, &settings),
            Some(text) => Scene::parse_set(&text, &file.display().to_string(), &settings),
        });
        let scene = read.map_err(|error| of_scene(py, &error))?;
        let parameters = &scene.parameters;
        let refused = |error: trirrr_core::machine::BuildError| {
            PyValueError::new_err(format!("scene {}: {error}", scene.name))
        };
        Ok(Self {
            kinematics: BatchMachine::build(parameters, false).map_err(refused)?,
            dynamics: BatchMachine::build(parameters, true).map_err(refused)?,
            reactions: BatchReactions::build(parameters).map_err(refused)?,
            scene,
        })
    }

    /// The board that the scene names, its key, its header as it is sent, and its values as they go over the line of a board.
    fn values<'py>(&self, py: Python<'py>) -> PyResult<OverLine<'py>> {
        let Self { scene, .. } = self;
        let for_board = BoardScene::of(scene).map_err(|error| {
            let reason = format!("scene {}: {error}", scene.name);
            exception(py, "SceneError", (reason,))
        })?;
        let image = SceneImage::new(for_board.types, &for_board.values);
        let mut room = [0; HEADER];
        let header = to_bytes(image.header(), &mut room)
            .map_err(|_| PyValueError::new_err("the header of the scene is too long"))?;
        Ok((
            scene.board.clone(),
            scene.key,
            PyBytes::new(py, header),
            PyBytes::new(py, image.bytes()),
        ))
    }

    /// Values of the scene by name.
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Self { scene, .. } = self;
        let facts = PyDict::new(py);
        facts.set_item("name", &scene.name)?;
        facts.set_item("description", &scene.description)?;
        facts.set_item("key", scene.key)?;
        facts.set_item("number", scene.number.name())?;
        facts.set_item("torque", scene.torque)?;
        facts.set_item("tick_rate_hz", scene.tick_rate_hz)?;
        facts.set_item("start", numbers_of(&scene.job.start))?;
        facts.set_item("elbows", signs(scene.parameters.legs.map(|leg| leg.elbow)))?;
        facts.set_item("moves", scene.job.count())?;
        facts.set_item("duration_s", f64::from(scene.ticks()) * scene.period_s())?;
        facts.set_item("has_plant", scene.plant.is_some())?;
        facts.set_item("has_path", scene.job.path.is_some())?;
        facts.set_item("warning", scene.limits_warning())?;
        let legs = scene.parameters.legs.each_ref().map(|leg| {
            let base: [f64; 2] = leg.base_m.into();
            let lengths = (leg.proximal_m, leg.distal_m);
            (base, lengths, leg.joint_radius_m, leg.joint_angle_rad)
        });
        facts.set_item("legs", legs)?;
        let tools = PyDict::new(py);
        if let Some(rack) = &scene.tools {
            for (index, tool) in rack.tools().iter().enumerate() {
                let carried = rack.put_into(&scene.parameters, index).platform;
                let places: [[f64; 2]; 2] = [carried.com_m.into(), carried.tool_point_m.into()];
                tools.set_item(&tool.name, (carried.mass_kg, carried.inertia_kgm2, places))?;
            }
        }
        facts.set_item("tools", tools)?;
        Ok(facts)
    }

    /// Angles, rates, accelerations and torques of the motors, one array (n, 3) each, and the rows without a motion, which are NaN.
    fn motors<'py>(
        &self,
        py: Python<'py>,
        poses: Rows<'py>,
        velocities: Rows<'py>,
        accelerations: Rows<'py>,
        torque: bool,
    ) -> PyResult<([Numbers<'py>; 4], Failures)> {
        let states = states(&poses, &velocities, &accelerations)?;
        let machine = match torque {
            true => &self.dynamics,
            false => &self.kinematics,
        };
        let count = states.poses.len();
        let (mut results, failed) = py.detach(|| {
            let mut results = [(); 4].map(|()| vec![[0.0; 3]; count]);
            let [angles, rates, accelerations, torques] = &mut results;
            let found = MotorRows {
                angles,
                rates,
                accelerations,
                torques,
            };
            let failed = pool::install(|| machine.evaluate(states, found))?;
            PyResult::Ok((results, failed.map_err(in_words)?))
        })?;
        for FailedRow { row, .. } in &failed {
            results
                .iter_mut()
                .for_each(|rows| rows[*row] = [f64::NAN; 3]);
        }
        let [angles, rates, accelerations, torques] = results;
        let arrays = [
            table(py, angles)?,
            table(py, rates)?,
            table(py, accelerations)?,
            table(py, torques)?,
        ];
        Ok((arrays, failures(&failed)))
    }

    /// Distances from the singularities, (n, 4): serial of the three legs, parallel; and the rows without a position, which are NaN.
    fn distances<'py>(
        &self,
        py: Python<'py>,
        poses: Rows<'py>,
    ) -> PyResult<(Numbers<'py>, Failures)> {
        let poses = rows(&poses)?;
        let (found, failed) = py.detach(|| {
            let mut found = vec![[f64::NAN; 4]; poses.len()];
            let failed = pool::install(|| self.kinematics.distances(poses, &mut found))?;
            PyResult::Ok((found, failed.map_err(in_words)?))
        })?;
        Ok((table(py, found)?, failures(&failed)))
    }

    /// Forces in the joints, (n, 3, 3, 2), and the rows without a motion, which are NaN.
    fn reactions<'py>(
        &self,
        py: Python<'py>,
        poses: Rows<'py>,
        velocities: Rows<'py>,
        accelerations: Rows<'py>,
    ) -> PyResult<(Numbers<'py>, Failures)> {
        let states = states(&poses, &velocities, &accelerations)?;
        let count = states.poses.len();
        let (forces, failed) = py.detach(|| {
            let mut forces = vec![[[[f64::NAN; 2]; 3]; 3]; count];
            let failed = pool::install(|| self.reactions.evaluate(states, &mut forces))?;
            PyResult::Ok((forces, failed.map_err(in_words)?))
        })?;
        let numbers = forces.into_flattened().into_flattened().into_flattened();
        let forces = array(py, numbers, &[count, 3, 3, 2])?;
        Ok((forces, failures(&failed)))
    }

    /// Assembly modes: poses (n, 6, 3) and parallel distances (n, 6), NaN where there is no mode; elbow signs (n, 6, 3), 0 where there is
    /// none; the number of modes of each row, true if the list is known to be complete; and the rows without a list.
    #[expect(clippy::type_complexity, reason = "a tuple of Python")]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        angles: Rows<'py>,
    ) -> PyResult<(
        Numbers<'py>,
        Numbers<'py>,
        Bound<'py, PyArrayDyn<i8>>,
        Bound<'py, PyArrayDyn<i64>>,
        Bound<'py, PyArrayDyn<bool>>,
        Failures,
    )> {
        let angles = rows(&angles)?;
        let parameters = &self.scene.parameters;
        let found: Vec<_> = py.detach(|| {
            let each = |angles: &[f64; 3]| AssemblyModes::of(parameters, *angles);
            pool::install(|| angles.par_iter().map(each).collect())
        })?;
        let count = found.len();
        let mut poses = vec![f64::NAN; count * MODES * 3];
        let mut parallel = vec![f64::NAN; count * MODES];
        let mut elbows = vec![0; count * MODES * 3];
        let mut counts = vec![0; count];
        let mut complete = vec![false; count];
        let mut failed = Vec::new();
        for (row, found) in found.into_iter().enumerate() {
            let found = match found {
                Ok(found) => found,
                Err(fault) => {
                    failed.push((row, fault.to_string()));
                    continue;
                }
            };
            counts[row] = found.modes.len() as i64;
            complete[row] = found.completeness != Completeness::Undecided;
            for (mode, found) in found.modes.iter().enumerate().take(MODES) {
                let place = row * MODES + mode;
                poses[3 * place..][..3].copy_from_slice(&found.record.pose);
                parallel[place] = found.record.parallel;
                let signs = elbows_of(&found.record).map(|elbow| elbow.map_or(0, sign));
                elbows[3 * place..][..3].copy_from_slice(&signs);
            }
        }
        Ok((
            array(py, poses, &[count, MODES, 3])?,
            array(py, parallel, &[count, MODES])?,
            array(py, elbows, &[count, MODES, 3])?,
            array(py, counts, &[count])?,
            array(py, complete, &[count])?,
            failed,
        ))
    }

    /// The eight working modes at a pose: elbow signs and motor angles.
    fn working_modes(&self, py: Python<'_>, pose: [f64; 3]) -> PyResult<Vec<([i8; 3], [f64; 3])>> {
        let modes = working_modes(&self.scene.parameters, pose_of(pose));
        let modes = modes.map_err(|reason| {
            exception(py, "MotionError", (reason.clone(), vec![(0_usize, reason)]))
        })?;
        let each = modes.map(|(elbows, record)| (signs(elbows), record.legs.map(|leg| leg.th1)));
        Ok(each.into())
    }

    /// The verdict of the scene's service on a move: the reason of a refusal, and a duration in s that is long enough.
    fn admit(
        &self,
        py: Python<'_>,
        poses: [[f64; 3]; 2],
        velocities: [[f64; 3]; 2],
        accelerations: Option<[[f64; 3]; 2]>,
        duration_s: f64,
    ) -> PyResult<(Option<String>, Option<f64>)> {
        let Self { scene, .. } = self;
        let ticks = (duration_s * scene.tick_rate_hz).round();
        let values = poses.iter().chain(&velocities);
        let values = values.chain(accelerations.iter().flatten()).flatten();
        if !values.copied().all(f64::is_finite) {
            return Err(PyValueError::new_err(
                "a pose, velocity or acceleration is not finite",
            ));
        }
        if !(1.0..=f64::from(u32::MAX)).contains(&ticks) {
            return Err(PyValueError::new_err(format!(
                "duration_s = {duration_s}: must be at least one tick, 1/{} s",
                scene.tick_rate_hz
            )));
        }
        let each = JobMove {
            from: pose_of(poses[0]),
            to: pose_of(poses[1]),
            start_velocity: Vector3::from(velocities[0]),
            end_velocity: Vector3::from(velocities[1]),
            accelerations: accelerations.map(|both| both.map(Vector3::from)),
            duration_ticks: ticks as u32,
            tool: None,
        };
        let verdict = py.detach(|| judge_move(scene, &each));
        let verdict = verdict.map_err(PyValueError::new_err)?;
        let enough_s = verdict
            .enough_ticks
            .map(|ticks| f64::from(ticks) * scene.period_s());
        Ok((verdict.reason, enough_s))
    }

    /// Setpoints of the job: times (n,), poses, velocities and accelerations (n, 3).
    fn setpoints<'py>(&self, py: Python<'py>) -> PyResult<(Numbers<'py>, [Numbers<'py>; 3])> {
        let Self { scene, .. } = self;
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let all: Vec<_> = player.setpoints().collect();
        let times = (0..all.len()).map(|tick| tick as f64 / scene.tick_rate_hz);
        let times: Vec<f64> = times.collect();
        let count = times.len();
        let of = |part: fn(&trirrr_core::setpoint::Setpoint<f64>) -> [f64; 3]| {
            table(py, all.iter().map(part).collect())
        };
        let parts = [
            of(|setpoint| numbers_of(&setpoint.pose))?,
            of(|setpoint| setpoint.velocity.into())?,
            of(|setpoint| setpoint.acceleration.into())?,
        ];
        Ok((array(py, times, &[count])?, parts))
    }

    /// Plans the path of the job in the least time.
    fn plan<'py>(&self, py: Python<'py>, gap: Option<f64>) -> PyResult<Bound<'py, PyDict>> {
        plan::plan(py, &self.scene, gap)
    }

    /// Plays the job on the machine's service in this process, with the plant of the scene if asked for.
    fn run<'py>(&self, py: Python<'py>, plant: bool) -> PyResult<Bound<'py, PyDict>> {
        play::run(py, &self.scene, plant)
    }
}

fn states<'a>(
    poses: &'a Rows<'_>,
    velocities: &'a Rows<'_>,
    accelerations: &'a Rows<'_>,
) -> PyResult<StateRows<'a, f64>> {
    Ok(StateRows {
        poses: rows(poses)?,
        velocities: rows(velocities)?,
        accelerations: rows(accelerations)?,
    })
}

fn in_words(error: trirrr_batch::LengthError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn failures(failed: &[FailedRow]) -> Failures {
    let each = failed.iter();
    each.map(|failed| (failed.row, failed.status.to_string()))
        .collect()
}

fn pose_of([x, y, alpha]: [f64; 3]) -> Pose<f64> {
    Pose::from_f64(x, y, alpha)
}

fn numbers_of(pose: &Pose<f64>) -> [f64; 3] {
    [pose.position.x, pose.position.y, pose.angle]
}

fn sign(elbow: Elbow) -> i8 {
    match elbow {
        Elbow::Positive => 1,
        Elbow::Negative => -1,
    }
}

fn signs(elbows: [Elbow; 3]) -> [i8; 3] {
    elbows.map(sign)
}
