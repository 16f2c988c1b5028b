//! Section "work-precision": error against run time of every method of integration, over a range
//! of steps or tolerances.
//!
//! The truth of a case is a solve by Radau IIA at the tolerance [`TRUTH`]. What that is worth is
//! measured here by a second one at a tenfold tolerance, and by the crate `oracle` against the solver
//! of others.

pub mod cases;
mod chosen;
mod trial;

use super::page::Page;
use super::progress::Progress;
use super::table::{Table, two_digits};
use crate::error::ReportError;
use cases::{CASES, Case};
use rayon::prelude::*;
use trial::FOLLOWED;
pub use trial::{COMPARED_S, Trial};
use trirrr_figures::scatter::{Over, Point, RADIUS, Scatter, Series, draw};
use trirrr_integrate as integrate;
use trirrr_scene::{Method, Scene};

/// Tolerance of the truth.
pub const TRUTH: f64 = 1e-12;
/// Fixed steps, s.
const STEPS_S: [f64; 11] = [
    1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6,
];
/// Tolerances.
const TOLERANCES: [f64; 6] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12];
/// Errors that the table has the cost of, in m and rad.
const WANTED: [f64; 2] = [1e-6, 1e-9];

/// Errors below this are not told apart, in m and rad: the truths are not known to less, and rounding
/// decides. A series of steps or tolerances ends where it is reached.
const KNOWN: f64 = 1e-11;

/// The solution that others are compared with.
///
/// # Errors
/// Why the scene is refused.
pub fn truth(scene: &Scene) -> Result<Trial, ReportError> {
    by_radau(scene, TRUTH)
}

fn by_radau(scene: &Scene, tolerance: f64) -> Result<Trial, ReportError> {
    let tolerance = Some(tolerance);
    Trial::run(scene, Method::RadauIia { tolerance })
}

/// A method and all that was tried with it, the coarsest first.
struct Tried {
    name: &'static str,
    /// Step in s or tolerance, and the run.
    trials: Vec<(f64, Trial, f64)>,
}

/// Findings about a case.
struct CaseFindings {
    case: &'static Case,
    /// The truth and its own error; or why the case is refused.
    truth: Result<(Trial, f64), String>,
    methods: Vec<Tried>,
}

/// Steps of the section: every case, and all of them as scenes have them.
pub(crate) const STEPS: usize = CASES.len() + 1;

/// Writes the section.
pub(super) fn write(page: &mut Page, progress: &Progress<'_>) -> Result<(), ReportError> {
    let found = CASES.par_iter().map(|case| progress.step(study(case)));
    let found = found.collect::<Result<Vec<_>, _>>()?;
    page.heading(2, "Integrators: error against run time");
    page.paragraph(&format!(
        "Largest error of the platform's pose (m and rad, every 20 ms) against a solve by Radau IIA \
         at the tolerance {TRUTH:e}. The cost is counted in derivatives of the state, those of \
         Jacobians among them. A motion is followed while the error stays below {FOLLOWED:e}."
    ));
    page.csv("work-precision.csv", &records(&found))?;
    page.heading(3, "Cases");
    page.block("work-precision-cases", true, &outcomes(&found).markdown());
    page.heading(3, "Methods");
    page.paragraph(
        "The longest step or the largest tolerance that follows the motion, its error and cost; the \
         cost of an error below 1e-6 and 1e-9; and what became of the next longer step or larger \
         tolerance.",
    );
    page.block("work-precision-methods", true, &methods(&found).markdown());
    page.heading(3, "By default");
    page.paragraph(
        "By the method that its stiffness chooses, with a row every millisecond, and how many times \
         faster than real time that is on this machine.",
    );
    page.block(
        "work-precision-default",
        false,
        &progress.step(chosen::table())?.markdown(),
    );
    page.heading(3, "Error against cost");
    for found in found.iter().filter(|found| found.truth.is_ok()) {
        let title = format!("{}: {}", found.case.name, found.case.what);
        let file = format!("work-precision-{}.svg", found.case.name);
        let x = "derivatives";
        let y = "error of the pose (m, rad)";
        let series: Vec<Series> = found
            .methods
            .iter()
            .map(|tried| Series {
                label: tried.name.into(),
                colour: None,
                line: 1.8,
                radius: RADIUS,
                points: tried
                    .trials
                    .iter()
                    .filter(|(_, _, error)| error.is_finite())
                    .map(|(_, trial, error)| Point {
                        x: trial.cost as f64,
                        y: *error,
                        mark: 0,
                    })
                    .collect(),
            })
            .collect();
        let figure = Scatter {
            title: &title,
            x: Over::Decades(x),
            y: Over::Decades(y),
            series: &series,
            marks: &[],
            fronts: &[],
        };
        page.figure(
            &file,
            &format!("Error against cost, {title}"),
            draw(&figure),
        )?;
    }
    Ok(())
}

fn study(case: &'static Case) -> Result<CaseFindings, ReportError> {
    let scene = case.scene()?;
    let truth = match truth(&scene) {
        Ok(truth) => truth,
        Err(ReportError::Refused(reason)) => {
            return Ok(CaseFindings {
                case,
                truth: Err(reason),
                methods: vec![],
            });
        }
        Err(failure) => return Err(failure),
    };
    let check = by_radau(&scene, 10.0 * TRUTH)?;
    let uncertainty = check.error(&truth);
    let methods = METHODS.par_iter().map(|(name, build, range)| {
        let mut trials = Vec::new();
        for &parameter in *range {
            let trial = Trial::run(&scene, build(parameter))?;
            let error = trial.error(&truth);
            trials.push((parameter, trial, error));
            if error < KNOWN {
                break;
            }
        }
        Ok(Tried { name, trials })
    });
    let methods = methods.collect::<Result<_, ReportError>>()?;
    Ok(CaseFindings {
        case,
        truth: Ok((truth, uncertainty)),
        methods,
    })
}

/// Name, the method with its step or tolerance, and the range of these.
type Range = (&'static str, fn(f64) -> Method, &'static [f64]);

const METHODS: [Range; 4] = [
    (
        integrate::Method::NAMES[0],
        |step_s| Method::SemiImplicitEuler { step_s },
        &STEPS_S,
    ),
    (
        integrate::Method::NAMES[1],
        |step_s| Method::Rk4 { step_s },
        &STEPS_S,
    ),
    (
        integrate::Method::NAMES[2],
        |tolerance| Method::DormandPrince {
            tolerance: Some(tolerance),
        },
        &TOLERANCES,
    ),
    (
        integrate::Method::NAMES[3],
        |tolerance| Method::RadauIia {
            tolerance: Some(tolerance),
        },
        &TOLERANCES,
    ),
];

impl Tried {
    /// The first trial from the coarsest one on that follows the motion, all finer ones doing so
    /// too.
    fn follows(&self) -> Option<usize> {
        let lost = |(_, _, error): &(f64, Trial, f64)| *error >= FOLLOWED || error.is_nan();
        let first = self
            .trials
            .iter()
            .rposition(lost)
            .map_or(0, |lost| lost + 1);
        (first < self.trials.len()).then_some(first)
    }

    /// The cheapest trial with an error up to `wanted`.
    fn cheapest(&self, wanted: f64) -> Option<&Trial> {
        let good = self.trials.iter().filter(|(_, _, error)| *error <= wanted);
        good.map(|(_, trial, _)| trial)
            .min_by_key(|trial| trial.cost)
    }
}

/// Every run, for programs.
fn records(found: &[CaseFindings]) -> Table {
    let mut table = Table::new(&[
        "case",
        "method",
        "step_s",
        "tolerance",
        "error",
        "derivatives",
        "seconds",
        "ended",
    ]);
    for found in found {
        for tried in &found.methods {
            let fixed = integrate::Method::NAMES[..2].contains(&tried.name);
            for (parameter, trial, error) in &tried.trials {
                let (step, tolerance) = match fixed {
                    true => (format!("{parameter:e}"), String::new()),
                    false => (String::new(), format!("{parameter:e}")),
                };
                table.row([
                    found.case.name.into(),
                    tried.name.into(),
                    step,
                    tolerance,
                    if error.is_finite() {
                        format!("{error:e}")
                    } else {
                        String::new()
                    },
                    trial.cost.to_string(),
                    format!("{:.6}", trial.elapsed.as_secs_f64()),
                    trial.ended.clone().unwrap_or_default(),
                ]);
            }
        }
    }
    table
}

/// Builds the table of how each case ends.
fn outcomes(found: &[CaseFindings]) -> Table {
    let mut table = Table::new(&["case", "what", "ends", "truth known to"]);
    for CaseFindings { case, truth, .. } in found {
        let (ends, known) = match truth {
            Ok((truth, uncertainty)) => (
                truth.ended.clone().unwrap_or_else(|| "at its end".into()),
                bound(*uncertainty),
            ),
            Err(reason) => (format!("refused: {reason}"), String::new()),
        };
        table.row([case.name.into(), case.what.into(), ends, known]);
    }
    table
}

/// Builds the table of which methods are stable, at what step, at what cost.
fn methods(found: &[CaseFindings]) -> Table {
    let mut table = Table::new(&[
        "case",
        "method",
        "follows from",
        "error",
        "derivatives",
        "for 1e-6",
        "for 1e-9",
        "beyond",
    ]);
    for found in found {
        for tried in &found.methods {
            let first = tried.follows();
            let [from, error, cost] = match first.and_then(|first| tried.trials.get(first)) {
                Some((parameter, trial, error)) => [
                    format!("{parameter:e}"),
                    shown(*error),
                    trial.cost.to_string(),
                ],
                None => ["-".into(), "-".into(), "-".into()],
            };
            let [rough, fine] = WANTED.map(|wanted| {
                let cheapest = tried.cheapest(wanted);
                cheapest.map_or_else(|| "-".into(), |trial| trial.cost.to_string())
            });
            let coarser = match first {
                Some(first) => first.checked_sub(1),
                None => tried.trials.len().checked_sub(1),
            };
            let beyond = match coarser.and_then(|coarser| tried.trials.get(coarser)) {
                None => String::new(),
                Some((_, trial, error)) => match &trial.ended {
                    Some(ended) => ended.clone(),
                    None => {
                        let warnings = trial.warnings.iter().map(|warning| format!("; {warning}"));
                        format!("error {}{}", shown(*error), warnings.collect::<String>())
                    }
                },
            };
            table.row([
                found.case.name.into(),
                tried.name.into(),
                from,
                error,
                cost,
                rough,
                fine,
                beyond,
            ]);
        }
    }
    table
}

/// An error as far as it is known.
fn shown(error: f64) -> String {
    if error < KNOWN {
        format!("< {KNOWN:e}")
    } else {
        two_digits(error)
    }
}

/// The least power of ten that is not below `error`, nor below what is known.
fn bound(error: f64) -> String {
    format!("{:e}", 10_f64.powi(error.max(KNOWN).log10().ceil() as i32))
}
