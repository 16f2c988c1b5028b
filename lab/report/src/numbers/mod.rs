//! Section "numbers": error against run time, for every number type.

mod counts;
mod error;
mod time;
mod tool;

use super::exact::{self, Instant};
use super::page::Page;
use super::scenes::shipped;
use super::table::{Table, two_digits};
use crate::error::ReportError;
use counts::{CORES, InstructionCount};
use error::{Errors, SceneErrors, Stage};
use trirrr_core::number::{Coarse, Fixed, Number};
use trirrr_figures::loglog::{Front, LogLog, Point, Series, draw, pareto_front};
use trirrr_scene::NumberType;
use trirrr_scene::Scene;

/// The scenes whose ticks are counted and timed: massless links, and links with masses.
const TIMED: [&str; 2] = ["thesis", "thesis-links"];

/// Findings about one number type.
struct TypeFindings {
    scalar: NumberType,
    /// Scene by scene.
    errors: Vec<SceneErrors>,
    /// Of the timed scenes.
    nanoseconds: [f64; 2],
}

/// Writes the section.
pub(super) fn write(page: &mut Page<'_>) -> Result<(), ReportError> {
    let scenes = shipped()?;
    let instants: Vec<Vec<Instant>> = scenes.iter().map(exact::instants).collect();
    let measured = [
        measure::<f64>(NumberType::F64, &scenes, &instants)?,
        measure::<f32>(NumberType::F32, &scenes, &instants)?,
        measure::<Fixed>(NumberType::Fixed, &scenes, &instants)?,
        measure::<Coarse>(NumberType::Micromath, &scenes, &instants)?,
    ];
    let counts = counts::checked_in()?;

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
    page.block(
        "numbers-errors",
        true,
        &absolute(&scenes, &measured).markdown(),
    );
    page.paragraph("The worst of them divided by the largest value of its job:");
    page.block(
        "numbers-relative",
        true,
        &relative(&scenes, &measured).markdown(),
    );
    page.heading(3, "What that is at the tool");
    page.paragraph(
        "Forward kinematics of the computed angles: how far the platform stands from where the \
         job wants it.",
    );
    page.block("numbers-tool", true, &at_the_tool(&measured).markdown());
    page.heading(3, "Instructions per tick");
    page.paragraph("Mean and, in brackets, most over the job's ticks.");
    let instructions = instructions(&measured, &counts);
    page.csv("instructions.csv", &counts_table(&counts))?;
    page.block("numbers-instructions", true, &instructions.markdown());
    page.heading(3, "Nanoseconds per tick on this machine");
    page.block("numbers-nanoseconds", false, &times(&measured).markdown());

    page.heading(3, "Error against run time");
    for (scene, file, title) in [
        (TIMED[0], "numbers-massless.svg", "massless links"),
        (TIMED[1], "numbers-links.svg", "links with masses"),
    ] {
        let drawn = on_cores(&scenes, &measured, &counts, scene, title);
        let caption = format!("Torque error against instructions per tick, {title}");
        page.figure(file, &caption, drawn)?;
    }
    let caption = "Error at the tool against instructions per tick";
    page.figure(
        "numbers-tool.svg",
        caption,
        tool_on_cores(&scenes, &measured, &counts),
    )?;
    let caption = "Torque error against nanoseconds per tick on this machine";
    page.figure("numbers-host.svg", caption, on_host(&scenes, &measured))
}

fn measure<N: Number>(
    scalar: NumberType,
    scenes: &[Scene],
    instants: &[Vec<Instant>],
) -> Result<TypeFindings, ReportError> {
    let mut errors = Vec::with_capacity(scenes.len());
    for (scene, instants) in scenes.iter().zip(instants) {
        errors.push(error::measure::<N>(scene, instants)?);
    }
    let mut nanoseconds = [f64::NAN; 2];
    for (nanoseconds, name) in nanoseconds.iter_mut().zip(TIMED) {
        if let Some(scene) = scenes.iter().find(|scene| scene.name == name) {
            *nanoseconds = time::nanoseconds::<N>(scene)?;
        }
    }
    Ok(TypeFindings {
        scalar,
        errors,
        nanoseconds,
    })
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

    fn of_scene(&self, scenes: &[Scene], name: &str) -> Option<&SceneErrors> {
        let index = scenes.iter().position(|scene| scene.name == name)?;
        self.errors.get(index)
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

fn absolute(scenes: &[Scene], measured: &[TypeFindings]) -> Table {
    let headings = Stage::ALL.map(|stage| format!("{} ({})", stage.name(), stage.unit()));
    let mut table = Table::new(&with_first("number type", &headings));
    for each in measured {
        let cells = Stage::ALL.map(|stage| worst_and_rms(&each.of_stage(scenes, stage), 1.0));
        table.row(std::iter::once(each.scalar.to_string()).chain(cells));
    }
    table
}

fn relative(scenes: &[Scene], measured: &[TypeFindings]) -> Table {
    let headings = Stage::ALL.map(|stage| stage.name().to_owned());
    let mut table = Table::new(&with_first("number type", &headings));
    for each in measured {
        let cells = Stage::ALL.map(|stage| two_digits(each.of_stage(scenes, stage).worst_relative));
        table.row(std::iter::once(each.scalar.to_string()).chain(cells));
    }
    table
}

fn at_the_tool(measured: &[TypeFindings]) -> Table {
    let mut table = Table::new(&[
        "number type",
        "place (\u{b5}m)",
        "angle (\u{b5}rad)",
        "ticks lost",
    ]);
    for each in measured {
        let [place, angle] = each.of_tool();
        let lost: usize = each.errors.iter().map(|errors| errors.lost).sum();
        table.row([
            each.scalar.to_string(),
            worst_and_rms(&place, 1e6),
            worst_and_rms(&angle, 1e6),
            lost.to_string(),
        ]);
    }
    table
}

fn instructions(measured: &[TypeFindings], counts: &[InstructionCount]) -> Table {
    let headings = CORES.map(str::to_owned);
    let mut headings = with_first("number type", &headings);
    headings.insert(1, "scene");
    let mut table = Table::new(&headings);
    for scene in TIMED {
        for each in measured {
            let name = each.scalar.to_string();
            let cells: Vec<String> = CORES
                .iter()
                .filter_map(|core| counts::find(counts, core, &name, scene))
                .map(|count| format!("{:.0} ({:.0})", count.mean, count.max))
                .collect();
            // f64 runs on the host only.
            if cells.len() == CORES.len() {
                table.row([name, scene.to_owned()].into_iter().chain(cells));
            }
        }
    }
    table
}

fn times(measured: &[TypeFindings]) -> Table {
    let mut table = Table::new(&["number type", "massless", "with links"]);
    for each in measured {
        let times = each.nanoseconds.map(|time| format!("{time:.0}"));
        table.row(std::iter::once(each.scalar.to_string()).chain(times));
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

fn with_first<'a>(first: &'a str, others: &'a [String]) -> Vec<&'a str> {
    std::iter::once(first)
        .chain(others.iter().map(String::as_str))
        .collect()
}

/// One point per number type and core, for the error that `error` picks.
fn cloud(
    measured: &[TypeFindings],
    counts: &[InstructionCount],
    scene: &str,
    error: impl Fn(&TypeFindings) -> Option<f64>,
) -> Vec<Series> {
    let series = measured.iter().map(|each| {
        let name = each.scalar.to_string();
        let points = CORES.iter().enumerate().filter_map(|(mark, core)| {
            let count = counts::find(counts, core, &name, scene)?;
            Some(Point {
                x: count.mean,
                y: error(each)?,
                mark,
            })
        });
        Series {
            label: name.clone(),
            joined: false,
            points: points.collect(),
        }
    });
    series.filter(|series| !series.points.is_empty()).collect()
}

/// The front over all, and that of each core, for a core is rarely a choice.
fn fronts(series: &[Series], each: &str) -> Vec<Front> {
    let of = |mark: Option<usize>| {
        let points = series.iter().flat_map(|series| &series.points);
        let points = points.filter(|point| mark.is_none_or(|mark| mark == point.mark));
        pareto_front(points.map(|point| (point.x, point.y)))
    };
    let marks = (0..CORES.len()).map(|mark| Front {
        label: if mark == 0 {
            each.into()
        } else {
            String::new()
        },
        strong: false,
        points: of(Some(mark)),
    });
    marks
        .chain([Front {
            label: "Pareto front".into(),
            strong: true,
            points: of(None),
        }])
        .collect()
}

fn on_cores(
    scenes: &[Scene],
    measured: &[TypeFindings],
    counts: &[InstructionCount],
    scene: &str,
    title: &str,
) -> trirrr_figures::canvas::Drawn {
    let series = cloud(measured, counts, scene, |each| {
        let errors = each.of_scene(scenes, scene)?;
        errors.stages.last().map(|errors| errors.worst_relative)
    });
    draw(&LogLog {
        title: &format!("Torque error against run time, {title}"),
        x: "instructions per tick, mean",
        y: "worst torque error / largest torque",
        series: &series,
        marks: &CORES,
        fronts: &fronts(&series, "of each core"),
    })
}

fn tool_on_cores(
    scenes: &[Scene],
    measured: &[TypeFindings],
    counts: &[InstructionCount],
) -> trirrr_figures::canvas::Drawn {
    let series = cloud(measured, counts, TIMED[0], |each| {
        let errors = each.of_scene(scenes, TIMED[0])?;
        Some(errors.tool[0].worst * 1e6)
    });
    draw(&LogLog {
        title: "Error at the tool against run time, massless links",
        x: "instructions per tick, mean",
        y: "worst error of the tool's place (\u{b5}m)",
        series: &series,
        marks: &CORES,
        fronts: &fronts(&series, "of each core"),
    })
}

fn on_host(scenes: &[Scene], measured: &[TypeFindings]) -> trirrr_figures::canvas::Drawn {
    let series: Vec<Series> = measured
        .iter()
        .map(|each| {
            let timed = TIMED.iter().zip(each.nanoseconds).enumerate();
            let points = timed.filter_map(|(mark, (scene, x))| {
                let errors = each.of_scene(scenes, scene)?;
                Some(Point {
                    x,
                    y: errors.stages.last()?.worst_relative,
                    mark,
                })
            });
            Series {
                label: each.scalar.to_string(),
                joined: false,
                points: points.collect(),
            }
        })
        .collect();
    draw(&LogLog {
        title: "Torque error against run time on this machine",
        x: "nanoseconds per tick",
        y: "worst torque error / largest torque",
        series: &series,
        marks: &TIMED,
        fronts: &fronts(&series, "of each scene"),
    })
}
