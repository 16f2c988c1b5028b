//! Every case as a scene has it: by the method that its stiffness chooses, with a row every
//! millisecond, under the continuous controller and under one that is sampled.

use super::cases::{CASES, Case};
use super::trial::Trial;
use super::{shown, truth};
use crate::error::ReportError;
use crate::table::{Table, two_digits};
use trirrr_scene::{Method, Scene, Timing};

/// Samples of the second controller in a millisecond: it runs at 10 kHz.
const PER_TICK: u32 = 10;

/// Method, cost, error and speed of every case.
pub(super) fn table() -> Result<Table, ReportError> {
    let mut table = Table::new(&[
        "case",
        "controller",
        "method",
        "derivatives",
        "error",
        "times real time",
        "ends",
    ]);
    for case in &CASES {
        let continuous = case.scene()?;
        for (name, scene) in [
            ("sampled at 10 kHz", sampled(&continuous)),
            ("continuous", continuous),
        ] {
            table.row(row(case, name, scene)?);
        }
    }
    Ok(table)
}

fn sampled(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    if let Some(controller) = &mut scene.controller {
        controller.timing = Timing::Sampled { per_tick: PER_TICK };
    }
    scene
}

fn row(case: &Case, controller: &str, mut scene: Scene) -> Result<[String; 7], ReportError> {
    if let Some(plant) = &mut scene.plant {
        plant.method = Method::Auto { tolerance: None };
    }
    let (case, controller) = (case.name.into(), controller.into());
    let trial = match Trial::of(&scene) {
        Ok(trial) => trial,
        Err(ReportError::Refused(reason)) => {
            let ends = format!("refused: {reason}");
            let none = String::new;
            return Ok([case, controller, none(), none(), none(), none(), ends]);
        }
        Err(failure) => return Err(failure),
    };
    let error = trial.error(&truth(&scene)?);
    Ok([
        case,
        controller,
        trial.method.into(),
        trial.cost.to_string(),
        shown(error),
        two_digits(trial.ratio),
        trial.ended.unwrap_or_else(|| "at its end".into()),
    ])
}
