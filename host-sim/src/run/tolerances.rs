//! The part of a run that bounds what the scene's tolerances do.

use super::summary::{digits, line};
use crate::failure::CliError;
use crate::figures::ToleranceTraces;
use crate::recording::unwritable;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use trirrr_scene::Scene;
use trirrr_tolerances::{Margin, Parameter, TimeSpan, ToleranceAnalysis, ToolError, WorstCase};

/// Parameters of the budget that are printed; the file has all.
const PRINTED: usize = 8;

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

/// Bounds the whole job of `scene`, and writes tables and figures into `folder`, which must exist. `stop` ends the
/// analysis early; what was computed until then is written.
///
/// # Errors
/// Failed: something cannot be written.
pub(super) fn bound<'s>(
    scene: &'s Scene,
    analysis: ToleranceAnalysis<'s>,
    folder: &Path,
    stop: &AtomicBool,
) -> Result<Bounded<'s>, CliError> {
    let path = folder.join("tolerances.csv");
    let failed = |error: io::Error| unwritable(&path, &error);
    let mut table = BufWriter::new(File::create(&path).map_err(failed)?);
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
    let mut files = vec![path.clone()];
    if let Some((_, tool)) = &worst.distance {
        files.push(write_budget(&analysis, tool, folder)?);
    }
    let figures = traces.write_all(folder, &scene.name);
    files.extend(figures.map_err(|error| unwritable(&error.path, &error.source))?);
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

fn write_budget(
    analysis: &ToleranceAnalysis,
    tool: &ToolError,
    folder: &Path,
) -> Result<PathBuf, CliError> {
    let path = folder.join("tolerance_budget.csv");
    let mut text = String::from("parameter,unit,half_width,dx,dy,dalpha,along\n");
    for share in analysis.budget(tool) {
        let (parameter, unit) = (share.parameter, share.parameter.unit());
        let numbers = [
            share.half_width,
            share.dx_m,
            share.dy_m,
            share.dalpha_rad,
            share.along_m,
        ];
        let numbers = numbers.map(|value| format!("{value:?}")).join(",");
        text += &format!("{parameter},{unit},{numbers}\n");
    }
    std::fs::write(&path, text).map_err(|error| unwritable(&path, &error))?;
    Ok(path)
}

impl Bounded<'_> {
    /// Returns the files written.
    pub(super) fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns `true` if the user ended the analysis.
    pub(super) fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// Prints what the tolerances do.
    pub(super) fn print(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out)?;
        let spans = self.spans;
        let scope = match self.is_stopped {
            true => "stopped by Ctrl-C after",
            false => "whole job in",
        };
        let text =
            format!("{scope} {spans} intervals of time; bounds hold for every machine within them");
        line(out, "tolerances", &text)?;
        self.half_widths(out)?;
        self.errors(out)?;
        self.budget(out)?;
        self.motors(out)?;
        writeln!(out)?;
        for (i, file) in self.files.iter().enumerate() {
            let label = if i == 0 { "written" } else { "" };
            line(out, label, &file.display().to_string())?;
        }
        out.flush()
    }

    /// One line for each kind of parameter: one value for all legs, or three.
    fn half_widths(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut kinds: Vec<(String, &str, Vec<f64>)> = Vec::new();
        for parameter in Parameter::all() {
            let half_width = self.analysis.half_width(parameter);
            let name = match parameter.leg() {
                Some(_) => parameter.name().into(),
                None => parameter.to_string(),
            };
            match kinds.iter_mut().find(|kind| kind.0 == name) {
                Some(kind) => kind.2.push(half_width),
                None => kinds.push((name, parameter.unit(), vec![half_width])),
            }
        }
        let mut label = "  within";
        for (name, unit, values) in kinds {
            let values = match values.as_slice() {
                [all @ .., last] if all.iter().all(|value| value == last) => vec![*last],
                _ => values,
            };
            if values == [0.0] {
                continue;
            }
            let values: Vec<String> = values.into_iter().map(digits).collect();
            let text = format!("{name:<25} +- {} {unit}", values.join(", "));
            line(out, label, &text)?;
            label = "";
        }
        Ok(())
    }

    fn errors(&self, out: &mut dyn Write) -> io::Result<()> {
        if let Some(span) = &self.worst.not_bounded {
            let text = format!(
                "no bound of the error is proven {}: for these tolerances a parallel singularity may be too near",
                at(span)
            );
            line(out, "  unbounded", &text)?;
        }
        if let Some((span, tool)) = &self.worst.distance {
            let text = format!(
                "at most {} um {}",
                digits(1e6 * tool.distance_m()),
                at(span)
            );
            line(out, "  tool off", &text)?;
        }
        if let Some((span, tool)) = &self.worst.angle {
            let [_, _, dalpha] = tool.sizes();
            line(
                out,
                "",
                &format!("at most {} mrad {}", digits(1e3 * dalpha), at(span)),
            )?;
        }
        Ok(())
    }

    fn budget(&self, out: &mut dyn Write) -> io::Result<()> {
        let Some((_, tool)) = &self.worst.distance else {
            return Ok(());
        };
        let shares = self.analysis.budget(tool);
        let um = |value: f64| format!("{:>8} um", digits(1e6 * value));
        let (first, rest) = shares.split_at(shares.len().min(PRINTED));
        for (i, share) in first.iter().enumerate() {
            let label = if i == 0 { "  budget" } else { "" };
            let (half_width, unit) = (digits(share.half_width), share.parameter.unit());
            let text = format!(
                "{}  {} + {half_width} {unit}",
                um(share.along_m),
                share.parameter
            );
            line(out, label, &text)?;
        }
        if !rest.is_empty() {
            let sum = rest.iter().map(|share| share.along_m.abs()).sum();
            line(
                out,
                "",
                &format!("{}  {} others, sum of the sizes", um(sum), rest.len()),
            )?;
        }
        Ok(())
    }

    fn motors(&self, out: &mut dyn Write) -> io::Result<()> {
        if let Some(span) = &self.worst.torque_not_bounded {
            let text = format!(
                "no bound of the torques is proven {}: a singularity may be too near",
                at(span)
            );
            line(out, "  unbounded", &text)?;
        }
        let text = |worst: &Margin, what: &str, unit: &str| {
            let margin = match (worst.margin(), worst.limit) {
                (Some(margin), Some(limit)) => {
                    let percent = 100.0 * margin / limit;
                    format!(", margin {} {unit} ({percent:.1} %)", digits(margin))
                }
                _ => String::new(),
            };
            format!(
                "{what} at most {} {unit}{margin}, {}",
                digits(worst.size),
                at_time(&worst.span)
            )
        };
        for motor in 0..3 {
            let rate = self.worst.rates[motor].as_ref();
            let torque = self.worst.torques[motor].as_ref();
            let rate = rate.map(|worst| text(worst, "rate", "rad/s"));
            let torque = torque.map(|worst| text(worst, "torque", "N m"));
            for (i, text) in rate.iter().chain(&torque).enumerate() {
                let label = format!("  motor {}", motor + 1);
                line(out, if i == 0 { &label } else { "" }, text)?;
            }
        }
        Ok(())
    }
}

fn at_time(span: &TimeSpan) -> String {
    format!("at t = {} s", digits((span.start_s + span.end_s) / 2.0))
}

/// The middle of an interval: time, pose, move.
fn at(span: &TimeSpan) -> String {
    let (place, alpha) = (span.pose.position, span.pose.angle);
    format!(
        "{} in move {}: x = {} m, y = {} m, alpha = {} rad",
        at_time(span),
        span.job_move + 1,
        digits(place.x),
        digits(place.y),
        digits(alpha)
    )
}
