//! The plan of a scene's path.

use crate::arrays::table;
use crate::errors::exception;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trirrr_plan::course::Effort;
use trirrr_scene::{MOVE_COLUMNS, Scene, plan_job};

/// Plans the path of the job of `scene`; the moves and times by name.
pub(crate) fn plan<'py>(
    py: Python<'py>,
    scene: &Scene,
    gap: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let refused = |reason: String| {
        let text = format!("scene {}: {reason}", scene.name);
        exception(py, "PlanError", (text,))
    };
    let path = scene.job.path.as_ref();
    let path = path.ok_or_else(|| refused("the job has no [[job.path]]".into()))?;
    let usual = Effort::default();
    let effort = Effort {
        gap: gap.unwrap_or(usual.gap),
        ..usual
    };
    let planned = py.detach(|| plan_job(scene, path, effort));
    let planned = planned.map_err(|error| refused(error.to_string()))?;
    let stands_s = planned.stands_s(scene);
    let found = PyDict::new(py);
    found.set_item("duration_s", planned.ticks() as f64 * scene.period_s())?;
    found.set_item("planned_s", stands_s + planned.moves.plan.duration_s())?;
    found.set_item("lower_bound_s", stands_s + planned.moves.plan.least_s())?;
    found.set_item("columns", MOVE_COLUMNS)?;
    found.set_item("moves", table(py, planned.rows(scene))?)?;
    Ok(found)
}
