//! The part of a run that bounds what the scene's tolerances do.

mod document;

use crate::failure::CliError;
use crate::figures::ToleranceTraces;
use crate::results::{ResultFolder, unwritable};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use trirrr_scene::Scene;
use trirrr_tolerances::{Parameter, TimeSpan, ToleranceAnalysis, ToolError, WorstCase};

/// Bounds of a job, and the files written.
pub(super) struct Bounded<'s> {
    analysis: ToleranceAnalysis<'s>,
    worst: WorstCase,
    spans: u64,
    /// The user ended the analysis.
    is_stopped: bool,
    files: Vec<PathBuf>,
}

/// Prepares the analysis of `scene`.
///
/// # Errors
/// Refused: the scene has no tolerances.
pub(super) fn prepare<'s>(
    file: &Path,
    scene: &'s Scene,
) -> Result<ToleranceAnalysis<'s>, CliError> {
    ToleranceAnalysis::new(scene)
        .map_err(|error| CliError::Refused(format!("{}: --tolerances: {error}", file.display())))
}

const TABLE: &str = "tolerances.csv";
const BUDGET: &str = "tolerance_budget.csv";

/// Names of the files that [`bound`] writes, for a scene with `torque` or without.
pub(super) fn names(torque: bool) -> impl Iterator<Item = &'static str> {
    let figures = ToleranceTraces::names(torque).iter().copied();
    [TABLE, BUDGET].into_iter().chain(figures)
}

/// Bounds the whole job of `scene`, and writes tables and figures into `results`. `stop` ends the
/// analysis early; what was computed until then is written.
///
/// # Errors
/// Failed: something cannot be written.
pub(super) fn bound<'s>(
    scene: &'s Scene,
    analysis: ToleranceAnalysis<'s>,
    results: &mut ResultFolder,
    stop: &AtomicBool,
) -> Result<Bounded<'s>, CliError> {
    let (path, table) = results.table(TABLE)?;
    let failed = |error: io::Error| unwritable(&path, &error);
    let mut table = BufWriter::new(table);
    writeln!(table, "{}", columns(scene).join(",")).map_err(failed)?;
    let mut worst = WorstCase::default();
    let mut traces = ToleranceTraces::new(scene.job.moves.len(), scene.torque);
    let (mut spans, mut is_stopped) = (0, false);
    for span in analysis.spans() {
        is_stopped = stop.load(Ordering::Relaxed);
        if is_stopped {
            break;
        }
        spans += 1;
        worst.note(&span, &scene.limits, scene.torque);
        traces.push(&span);
        writeln!(table, "{}", row(scene, &span).join(",")).map_err(failed)?;
    }
    table.flush().map_err(failed)?;
    let budget = results.write(BUDGET, budget(scene, &analysis, &worst))?;
    let mut files = vec![path.clone(), budget];
    files.extend(traces.write_all(results, &scene.name)?);
    Ok(Bounded {
        analysis,
        worst,
        spans,
        is_stopped,
        files,
    })
}

fn columns(scene: &Scene) -> Vec<String> {
    let fixed = "t,t_end,move,x,y,alpha,dx,dy,dalpha,distance";
    let mut columns: Vec<String> = fixed.split(',').map(String::from).collect();
    let mut motors = |names: &[&str]| {
        for motor in 1..=3 {
            columns.extend(
                names
                    .iter()
                    .map(|name| name.replace('#', &motor.to_string())),
            );
        }
    };
    motors(&["dth1_#_min", "dth1_#_max"]);
    if scene.torque {
        motors(&["tau#_min", "tau#_max"]);
        if scene.limits.torque_nm.is_some() {
            motors(&["margin#"]);
        }
    }
    columns
}

/// The fields of an interval; those of what is not bounded are empty.
fn row(scene: &Scene, span: &TimeSpan) -> Vec<String> {
    // Shortest digits that read back as the same number, as in `ticks.csv`.
    let number = |value: f64| format!("{value:?}");
    let pose = span.pose.position;
    let mut fields = vec![
        number(span.start_s),
        number(span.end_s),
        (span.job_move + 1).to_string(),
    ];
    fields.extend([pose.x, pose.y, span.pose.angle].map(number));
    let mut bounds = |values: Option<Vec<f64>>, count: usize| match values {
        Some(values) => fields.extend(values.into_iter().map(number)),
        None => fields.extend(vec![String::new(); count]),
    };
    let tool = |tool: ToolError| [&tool.sizes()[..], &[tool.distance_m()]].concat();
    bounds(span.tool.map(tool), 4);
    bounds(span.rates.map(|rates| rates.concat()), 6);
    if scene.torque {
        bounds(span.torques.map(|torques| torques.concat()), 6);
        if let Some(limits) = scene.limits.torque_nm {
            let margins = |torques: [[f64; 2]; 3]| {
                let size = |[least, greatest]: [f64; 2]| least.abs().max(greatest.abs());
                let each = torques.into_iter().zip(limits);
                each.map(|(range, limit)| limit - size(range)).collect()
            };
            bounds(span.torques.map(margins), 3);
        }
    }
    fields
}

/// A row for each parameter that is not exact. Its shares in the error are those at the greatest distance, its share in
/// a torque is that at the greatest torque of the motor; fields of what is not bounded are empty.
fn budget(scene: &Scene, analysis: &ToleranceAnalysis, worst: &WorstCase) -> String {
    let shares = worst.distance.map(|(_, tool)| analysis.budget(&tool));
    let torques = worst.torques.each_ref().map(|worst| worst.as_ref());
    let torques = [0, 1, 2]
        .map(|motor| torques[motor].map(|worst| analysis.torque_budget(&worst.span, motor)));
    let mut text = String::from("parameter,unit,half_width,dx,dy,dalpha,along");
    text += if scene.torque {
        ",tau1,tau2,tau3\n"
    } else {
        "\n"
    };
    // Those that move the tool, the greatest first; then the others.
    let moving = shares.iter().flatten().map(|share| share.parameter);
    let mut parameters: Vec<Parameter> = moving.collect();
    let others = Parameter::all().filter(|each| analysis.half_width(*each) != 0.0);
    for parameter in others {
        if !parameters.contains(&parameter) {
            parameters.push(parameter);
        }
    }
    for parameter in parameters {
        let share = shares.as_ref().map(|shares| {
            let share = shares.iter().find(|share| share.parameter == parameter);
            share.map_or([0.0; 4], |share| {
                [share.dx_m, share.dy_m, share.dalpha_rad, share.along_m]
            })
        });
        let mut fields: Vec<Option<f64>> = vec![Some(analysis.half_width(parameter))];
        fields.extend([0, 1, 2, 3].map(|column| share.map(|share| share[column])));
        if scene.torque {
            fields.extend(torques.each_ref().map(|shares| {
                let shares = shares.as_ref()?;
                let share = shares.iter().find(|(of, _)| *of == parameter);
                Some(share.map_or(0.0, |(_, share)| *share))
            }));
        }
        text += &format!("{parameter},{}", parameter.unit());
        for field in fields {
            text.push(',');
            text += &field.map_or(String::new(), |value| format!("{value:?}"));
        }
        text.push('\n');
    }
    text
}

impl Bounded<'_> {
    /// Returns `true` if the user ended the analysis.
    pub(super) fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// Files that were written.
    pub(super) fn files(&self) -> &[PathBuf] {
        &self.files
    }
}
