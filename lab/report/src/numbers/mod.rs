//! Section "numbers": error against run time, for every number type.

mod counts;
mod cycles;
mod error;
mod time;
mod tool;

use super::exact::{self, Instant};
use super::page::Page;
use super::progress::Progress;
use super::scenes::shipped;
use super::table::{Table, two_digits};
use crate::colours::of_number;
use crate::error::ReportError;
use counts::{CORES, InstructionCount};
use cycles::{BOARDS, ModelledCycles};
use error::{Errors, SceneErrors, Stage};
use rayon::prelude::*;
use trirrr_core::number::Number;
use trirrr_figures::scatter::{Front, Over, Point, RADIUS, Scatter, Series, draw, pareto_front};
use trirrr_scene::{NumberType, Scene, in_number_type};

/// The scenes whose ticks are counted and timed: massless links, and links with masses.
const TIMED: [&str; 2] = ["thesis", "thesis-links"];

/// Steps of the section: the exact values, four number types, and their run times.
pub(crate) const STEPS: usize = 6;

/// Findings about one number type.
struct TypeFindings {
    scalar: NumberType,
    /// Scene by scene.
    errors: Vec<SceneErrors>,
    /// Of the timed scenes.
    nanoseconds: [f64; 2],
}

/// Writes the section.
pub(super) fn write(page: &mut Page, progress: &Progress<'_>) -> Result<(), ReportError> {
    let scenes = shipped()?;
    let instants: Vec<Vec<Instant>> = scenes.iter().map(exact::instants).collect();
    progress.step(());
    let errors = |scalar: &NumberType| {
        let errors = in_number_type!(*scalar, N => measure::<N>(&scenes, &instants));
        progress.step(errors)
    };
    let errors = NumberType::ALL.par_iter().map(errors);
    let errors = errors.collect::<Result<Vec<_>, _>>()?;
    // Nothing else runs while run times are measured.
    let measured = NumberType::ALL.into_iter().zip(errors);
    let measured = measured.map(|(scalar, errors)| {
        let nanoseconds = in_number_type!(scalar, N => run_times::<N>(&scenes))?;
        Ok(TypeFindings {
            scalar,
            errors,
            nanoseconds,
        })
    });
    let measured = measured.collect::<Result<Vec<_>, ReportError>>()?;
    progress.step(());
    let counts = counts::checked_in()?;
    let cycles = cycles::checked_in()?;

    page.heading(2, "Numbers: error against run time");
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let ticks: usize = instants.iter().map(Vec::len).sum();
    page.paragraph(&format!(
        "Every tick of the shipped scenes ({}; {ticks} ticks), from the job in the scene file to \
         the twelve results of the motors, against the exact values: the exact setpoints and \
         Newton's and Euler's equations of the seven bodies, in 31 digits.",
        names.join(", ")
    ));
    page.csv("numbers.csv", &by_scene(&scenes, &measured))?;
    page.heading(
        3,
        "Errors of the motors' angle, rate, acceleration and torque",
    );
    page.paragraph("Worst, and in brackets the root of the mean square.");
    let units = Stage::ALL.map(|stage| format!("{} ({})", stage.name(), stage.unit()));
    let absolute = by_type(&units, &measured, |each| {
        let of = |stage| worst_and_rms(&each.of_stage(&scenes, stage), 1.0);
        Stage::ALL.map(of).to_vec()
    });
    page.block("numbers-errors", true, &absolute);
    page.paragraph("The worst of them divided by the largest value of its job:");
    let relative = by_type(&Stage::ALL.map(Stage::name), &measured, |each| {
        let of = |stage| two_digits(each.of_stage(&scenes, stage).worst_relative);
        Stage::ALL.map(of).to_vec()
    });
    page.block("numbers-relative", true, &relative);
    page.heading(3, "What that is at the tool");
    page.paragraph(
        "Forward kinematics of the computed angles: how far the platform stands from where the \
         job wants it.",
    );
    let headings = ["place (\u{b5}m)", "angle (\u{b5}rad)", "ticks lost"];
    let tool = by_type(&headings, &measured, |each| {
        let [place, angle] = each.of_tool().map(|errors| worst_and_rms(&errors, 1e6));
        let lost: usize = each.errors.iter().map(|errors| errors.lost).sum();
        vec![place, angle, lost.to_string()]
    });
    page.block("numbers-tool", true, &tool);
    page.heading(3, "Instructions per tick");
    page.paragraph("Mean and, in brackets, most over the job's ticks.");
    let instructions = instructions(&measured, &counts);
    page.csv("instructions.csv", &counts_table(&counts))?;
    page.block("numbers-instructions", true, &instructions.markdown());
    page.heading(3, "Modelled cycles per tick with its setpoint");
    page.paragraph("Mean over ticks of the job, in flash, and in brackets microseconds.");
    let modelled = modelled(&measured, &cycles);
    page.block("numbers-cycles", true, &modelled.markdown());
    page.heading(3, "Nanoseconds per tick on this machine");
    let times = by_type(&["massless", "with links"], &measured, |each| {
        each.nanoseconds.map(|time| format!("{time:.0}")).to_vec()
    });
    page.block("numbers-nanoseconds", false, &times);

    page.heading(3, "Error against run time");
    let torque = |each: &TypeFindings, scene: &str| {
        // As in the tables: over all scenes with such links.
        let stage = match scene == TIMED[0] {
            true => Stage::TorqueMassless,
            false => Stage::TorqueWithLinks,
        };
        Some(each.of_stage(&scenes, stage).worst_relative)
    };
    let microseconds = |each: &TypeFindings, board: usize, scene| {
        let (core, _) = BOARDS[board];
        let tick = cycles::find(&cycles, core, &each.scalar.to_string(), scene)?;
        Some(tick.us_mean)
    };
    let boards = BOARDS.map(|(_, name)| name);
    for (scene, file, title) in [
        (TIMED[0], "numbers-massless.svg", "massless links"),
        (TIMED[1], "numbers-links.svg", "links with masses"),
    ] {
        let cloud = Cloud {
            caption: &format!("Torque error against microseconds per tick, {title}"),
            title: &format!("Torque error against run time, {title}"),
            x: MICROSECONDS,
            y: TORQUE_ERROR,
            marks: &boards,
            front: "of each board",
        };
        let point = |each: &TypeFindings, board| {
            Some((microseconds(each, board, scene)?, torque(each, scene)?))
        };
        cloud.write(page, file, &measured, point)?;
    }
    let tool = Cloud {
        caption: "Error at the tool against microseconds per tick",
        title: "Error at the tool against run time, massless links",
        x: MICROSECONDS,
        y: "worst error of the tool's place (\u{b5}m)",
        marks: &boards,
        front: "of each board",
    };
    tool.write(page, "numbers-tool.svg", &measured, |each, board| {
        let [place, _] = each.of_tool();
        let time = microseconds(each, board, TIMED[0])?;
        Some((time, place.worst * 1e6))
    })?;
    let host = Cloud {
        caption: "Torque error against nanoseconds per tick on this machine",
        title: "Torque error against run time on this machine",
        x: "nanoseconds per tick",
        y: TORQUE_ERROR,
        marks: &TIMED,
        front: "of each scene",
    };
    host.write(page, "numbers-host.svg", &measured, |each, mark| {
        Some((each.nanoseconds[mark], torque(each, TIMED[mark])?))
    })
}

/// Errors of one number type, scene by scene.
fn measure<N: Number>(
    scenes: &[Scene],
    instants: &[Vec<Instant>],
) -> Result<Vec<SceneErrors>, ReportError> {
    let of_scenes = scenes.iter().zip(instants);
    of_scenes
        .map(|(scene, instants)| error::measure::<N>(scene, instants))
        .collect()
}

/// Run times of the timed scenes, ns per tick.
fn run_times<N: Number>(scenes: &[Scene]) -> Result<[f64; 2], ReportError> {
    let mut nanoseconds = [f64::NAN; 2];
    for (nanoseconds, name) in nanoseconds.iter_mut().zip(TIMED) {
        if let Some(scene) = scenes.iter().find(|scene| scene.name == name) {
            *nanoseconds = time::nanoseconds::<N>(scene)?;
        }
    }
    Ok(nanoseconds)
}

impl TypeFindings {
    /// Over all scenes that go through `stage`.
    fn of_stage(&self, scenes: &[Scene], stage: Stage) -> Errors {
        let mut all = Errors::default();
        for (scene, errors) in scenes.iter().zip(&self.errors) {
            for (of_scene, errors) in Stage::of(scene).iter().zip(&errors.stages) {
                if *of_scene == stage {
                    all = all.with(errors);
                }
            }
        }
        all
    }

    /// Over all scenes: of the tool's place and angle.
    fn of_tool(&self) -> [Errors; 2] {
        let of = |part: usize| {
            let parts = self.errors.iter().map(|errors| &errors.tool[part]);
            parts.fold(Errors::default(), Errors::with)
        };
        [of(0), of(1)]
    }
}

/// `worst (rms)`.
fn worst_and_rms(errors: &Errors, scale: f64) -> String {
    format!(
        "{} ({})",
        two_digits(scale * errors.worst),
        two_digits(scale * errors.rms())
    )
}

/// A table with a row for each number type, as Markdown.
fn by_type(
    headings: &[impl AsRef<str>],
    measured: &[TypeFindings],
    cells: impl Fn(&TypeFindings) -> Vec<String>,
) -> String {
    let headings = headings.iter().map(AsRef::as_ref);
    let mut table = Table::new(
        &["number type"]
            .into_iter()
            .chain(headings)
            .collect::<Vec<_>>(),
    );
    for each in measured {
        table.row([each.scalar.to_string()].into_iter().chain(cells(each)));
    }
    table.markdown()
}

fn instructions(measured: &[TypeFindings], counts: &[InstructionCount]) -> Table {
    by_type_and_scene(measured, &CORES, |core, scalar, scene| {
        let count = counts::find(counts, CORES[core], scalar, scene)?;
        Some(format!("{:.0} ({:.0})", count.mean, count.max))
    })
}

fn modelled(measured: &[TypeFindings], cycles: &[ModelledCycles]) -> Table {
    let names = BOARDS.map(|(_, name)| name);
    by_type_and_scene(measured, &names, |board, scalar, scene| {
        let tick = cycles::find(cycles, BOARDS[board].0, scalar, scene)?;
        Some(format!("{:.0} ({:.2})", tick.mean, tick.us_mean))
    })
}

/// A table with a row for each number type in each of the timed scenes; a dash is what nothing was measured of.
fn by_type_and_scene(
    measured: &[TypeFindings],
    columns: &[&str],
    cell: impl Fn(usize, &str, &str) -> Option<String>,
) -> Table {
    let mut table = Table::new(&[&["number type", "scene"], columns].concat());
    for scene in TIMED {
        for each in measured {
            let name = each.scalar.to_string();
            let cells = 0..columns.len();
            let cells = cells.map(|column| cell(column, &name, scene).unwrap_or("-".into()));
            table.row([name.clone(), scene.to_owned()].into_iter().chain(cells));
        }
    }
    table
}

fn by_scene(scenes: &[Scene], measured: &[TypeFindings]) -> Table {
    let mut table = Table::new(&[
        "scalar",
        "scene",
        "quantity",
        "unit",
        "worst",
        "rms",
        "worst_over_largest",
        "compared",
    ]);
    for each in measured {
        for (scene, errors) in scenes.iter().zip(&each.errors) {
            let mut row = |quantity: &str, unit: &str, errors: &Errors, relative: String| {
                table.row([
                    each.scalar.to_string(),
                    scene.name.clone(),
                    quantity.to_owned(),
                    unit.to_owned(),
                    format!("{:e}", errors.worst),
                    format!("{:e}", errors.rms()),
                    relative,
                    errors.count.to_string(),
                ]);
            };
            for (stage, errors) in Stage::of(scene).into_iter().zip(&errors.stages) {
                let relative = format!("{:e}", errors.worst_relative);
                row(stage.name(), stage.unit(), errors, relative);
            }
            for (index, (quantity, unit)) in [("tool place", "m"), ("tool angle", "rad")]
                .into_iter()
                .enumerate()
            {
                row(quantity, unit, &errors.tool[index], String::new());
            }
        }
    }
    table
}

fn counts_table(counts: &[InstructionCount]) -> Table {
    let mut table = Table::new(&["core", "scalar", "scene", "min", "mean", "max"]);
    for count in counts {
        let names = [&count.core, &count.scalar, &count.scene].map(Clone::clone);
        let figures = [count.min, count.mean, count.max].map(|figure| format!("{figure}"));
        table.row(names.into_iter().chain(figures));
    }
    table
}

/// Horizontal axis of a figure of boards.
const MICROSECONDS: &str = "\u{b5}s per tick with its setpoint, modelled, in flash";

/// Vertical axis of a figure of torques.
const TORQUE_ERROR: &str = "worst torque error / largest torque";

/// Figure with a point for each number type and mark: an error over a run time.
struct Cloud<'a> {
    caption: &'a str,
    title: &'a str,
    x: &'a str,
    y: &'a str,
    /// Meanings of the shapes of points: cores or scenes.
    marks: &'a [&'a str],
    /// Legend entry of the fronts of single marks.
    front: &'a str,
}

impl Cloud<'_> {
    /// Draws the points that `point` gives for number types and marks. With them stand the front over
    /// all, and that of each mark, for a core is rarely a choice.
    fn write(
        &self,
        page: &mut Page,
        file: &str,
        measured: &[TypeFindings],
        point: impl Fn(&TypeFindings, usize) -> Option<(f64, f64)>,
    ) -> Result<(), ReportError> {
        let marks = 0..self.marks.len();
        let series = measured.iter().map(|each| {
            let points = marks.clone().filter_map(|mark| {
                let (x, y) = point(each, mark)?;
                Some(Point { x, y, mark })
            });
            Series {
                label: each.scalar.to_string(),
                colour: of_number(each.scalar.name()),
                line: 0.0,
                radius: RADIUS,
                points: points.collect(),
            }
        });
        let series: Vec<Series> = series.filter(|one| !one.points.is_empty()).collect();
        let front = |label: &str, mark: Option<usize>| {
            let points = series.iter().flat_map(|series| &series.points);
            let points = points.filter(|point| mark.is_none_or(|mark| mark == point.mark));
            Front {
                label: label.into(),
                strong: mark.is_none(),
                points: pareto_front(points.map(|point| (point.x, point.y))),
            }
        };
        let of_mark = |mark| front(if mark == 0 { self.front } else { "" }, Some(mark));
        let fronts: Vec<Front> = marks
            .clone()
            .map(of_mark)
            .chain([front("Pareto front", None)])
            .collect();
        let figure = Scatter {
            title: self.title,
            x: Over::Decades(self.x),
            y: Over::Decades(self.y),
            series: &series,
            marks: self.marks,
            fronts: &fronts,
        };
        page.figure(file, self.caption, draw(&figure))
    }
}
