//! `trirrr plan`: the least time of a scene's path, with its proof, as text, tables and figures.

use crate::failure::CliError;
use crate::figures::{self, plan_figure};
use crate::job_file::{self, JobFileArgs, LoadedJob, LongMoves};
use crate::pictures::PictureArgs;
use crate::results::ResultFolder;
use crate::terminal::show;
use clap::Args;
use std::fmt::Write as _;
use std::path::Path;
use std::path::PathBuf;
use trirrr_figures::chart::gathered;
use trirrr_figures::document::{Document, Facts};
use trirrr_plan::course::{Effort, PathPiece, Run};
use trirrr_protocol::message::LEVEL_PARTS;
use trirrr_scene::{
    JobLevels, JobMove, JobPath, MOVE_COLUMNS, PlannedJob, Scene, limited, plan_job,
};

/// `trirrr plan`.
///
/// Plans the `[[job.path]]` of a scene in the least time and proves how near to the optimum the plan is: prints its
/// duration, a lower bound of the duration of any motion along the path, and which limit acts for how long. Writes
/// plan.csv (the plan and the bound along the path), moves.csv (the moves that a machine plays), levels.csv (where a row of an image has its powers in a list) and a figure.
#[derive(Args, Clone, Debug)]
pub struct PlanArgs {
    /// The scene, a TOML file; or with --machine a job: G-code, a drawing (SVG, DXF), an image, a table of poses (CSV)
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// The job in a file of its own.
    #[command(flatten)]
    pub job: JobFileArgs,
    /// Greatest part by which the plan may take longer than its lower bound
    #[arg(long, value_name = "PART", default_value_t = Effort::default().gap, value_parser = gap)]
    pub gap: f64,
    /// Print one JSON object instead of text
    #[arg(long)]
    pub json: bool,
    /// Folder for what is written, made if missing; those of an earlier run go
    /// [default: out/NAME-plan, after the scene's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Figures as PNG.
    #[command(flatten)]
    pub pictures: PictureArgs,
}

fn gap(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(gap) if (1e-5..=1.0).contains(&gap) => Ok(gap),
        _ => Err("expected a number from 0.00001 to 1".into()),
    }
}

/// Files of a plan.
const FILES: [&str; 4] = ["plan.csv", "moves.csv", "levels.csv", "plan.svg"];

/// Plans the path of a scene, writes tables and a figure, and prints what was found.
///
/// # Errors
/// Refused: the scene, or it has no path. Failed: a file cannot be written.
pub fn command(args: &PlanArgs) -> Result<(), CliError> {
    args.pictures.require()?;
    let job = job_file::load(&args.scene, &args.job, LongMoves::InMemory)?;
    job.warn();
    let LoadedJob { scene, .. } = job;
    let name = args.scene.display();
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(format!("{}-plan", scene.name)),
    };
    let mut results = ResultFolder::for_command(&folder, "plan")?.with_pictures(args.pictures.png);
    results.claim(FILES)?;
    let effort = Effort {
        gap: args.gap,
        ..Effort::default()
    };
    let refused = |reason: String| CliError::Refused(format!("{name}: {reason}"));
    let path = scene.job.path.as_ref();
    let path = path.ok_or_else(|| refused("the job has no [[job.path]]".into()))?;
    let job = plan_job(&scene, path, effort).map_err(|error| refused(error.to_string()))?;
    let points = all_points(&scene, &job);
    write(&scene, &job, &points, &mut results)?;
    results.pictures()?;
    results.end(None)?;
    let mut document = document(&scene, &job, &points);
    // Files of the folder: programs know them by their names.
    if !args.json {
        document.files(results.files());
    }
    show(&document, args.json)
}

/// Time, place and speed at the start of a cell of the plan, or at the end of a run.
pub(crate) struct PlanPoint {
    pub(crate) t: f64,
    pub(crate) source: usize,
    pub(crate) p: f64,
    pub(crate) pose: [f64; 3],
    pub(crate) speed: f64,
    pub(crate) speed_max: f64,
    pub(crate) limit: String,
    /// Duration of the cell that begins here.
    pub(crate) lasts: f64,
}

/// The points of a run that begins at `start` seconds.
fn points(path: &JobPath, run: &Run, start: f64) -> Vec<PlanPoint> {
    let mut t = start;
    let mut points = Vec::with_capacity(run.places.len());
    for (index, place) in run.places.iter().enumerate() {
        let piece = &path.pieces[place.piece];
        let at = piece.piece.at(place.p);
        let size = at.first.x.hypot(at.first.y);
        let lasts = match index < run.cells.len() {
            true => run.cell_duration_s(index),
            false => 0.0,
        };
        let acting = (index < run.cells.len())
            .then(|| run.acting(index))
            .flatten();
        points.push(PlanPoint {
            t,
            source: piece.source + 1,
            p: place.p,
            pose: [at.pose.position.x, at.pose.position.y, at.pose.angle],
            speed: size * run.squares[index].sqrt(),
            speed_max: size * run.squares_max[index].sqrt(),
            limit: acting.map_or(String::new(), limited),
            lasts,
        });
        t += lasts;
    }
    points
}

fn all_points(scene: &Scene, job: &PlannedJob) -> Vec<PlanPoint> {
    let path = &job.path;
    let mut start = 0.0;
    let mut after = None;
    let mut all = Vec::new();
    for run in &job.moves.plan.runs {
        let sources = path.pieces[run.pieces.clone()].iter();
        let mut sources = sources.map(|each| each.source);
        let (first, last) = (sources.next(), sources.next_back());
        start += scene.period_s() * path.stand_ticks(after, first) as f64;
        all.extend(points(path, run, start));
        start += run.duration_s;
        after = last.or(first);
    }
    all
}

/// Writes tables and the figure.
fn write(
    scene: &Scene,
    job: &PlannedJob,
    points: &[PlanPoint],
    results: &mut ResultFolder,
) -> Result<(), CliError> {
    // Shortest digits that read back as the same number, as in `ticks.csv`.
    let mut plan = String::from("t,piece,p,x,y,alpha,speed,speed_max,limit\n");
    for point in points {
        let [x, y, alpha] = point.pose;
        let (t, p, speed, speed_max) = (point.t, point.p, point.speed, point.speed_max);
        let _ = writeln!(
            plan,
            "{t:?},{},{p:?},{x:?},{y:?},{alpha:?},{speed:?},{speed_max:?},{}",
            point.source, point.limit
        );
    }
    let (steps, levels) = job.listed();
    let moves = moves_table(scene, job);
    let mut tables = vec![("plan.csv", plan), ("moves.csv", moves)];
    if !levels.is_empty() {
        tables.push(("levels.csv", levels_table(&steps, &levels)));
    }
    for (file, text) in tables {
        results.write(file, text)?;
    }
    let figure = plan_figure(job.path.free.is_some());
    let figures = gathered(vec![figure], points.iter().map(|point| (point.t, point)));
    figures::write(results, &scene.name, &figures).map(drop)
}

/// The moves as a table that other clients play: the state at the end of each, after a row for the start.
fn moves_table(scene: &Scene, job: &PlannedJob) -> String {
    let mut table = MOVE_COLUMNS.join(",") + "\n";
    for [piece, values @ ..] in job.rows(scene) {
        let _ = write!(table, "{piece}");
        for value in values {
            let _ = write!(table, ",{value:?}");
        }
        table.push('\n');
    }
    table
}

/// Levels of the tool's power along moves: the number of the move, from 1, its power at a speed, the place in the first level at which it
/// starts, the levels that it passes, and the levels, parts of 255 of the power.
fn levels_table(steps: &[(usize, JobMove)], levels: &JobLevels) -> String {
    let mut table = String::from("move,power,speed,offset,span,levels\n");
    for (index, range) in &levels.ranges {
        let parts = f64::from(LEVEL_PARTS);
        let [offset, span] =
            [u32::from(range.offset), range.span].map(|all| f64::from(all) / parts);
        let tool = steps.get(*index as usize).and_then(|(_, each)| each.tool);
        let (power, speed) = tool.map_or((0.0, 0.0), |tool| (tool.power, tool.speed_m_s));
        let _ = write!(
            table,
            "{},{power:?},{speed:?},{offset:?},{span:?},",
            index + 1
        );
        let (from, to) = (range.first as usize, range.next() as usize);
        for (place, level) in levels
            .levels
            .get(from..to)
            .into_iter()
            .flatten()
            .enumerate()
        {
            let space = if place == 0 { "" } else { " " };
            let _ = write!(table, "{space}{level}");
        }
        table.push('\n');
    }
    table
}

/// Seconds for which each limit is the nearest, the longest first.
fn acting(points: &[PlanPoint]) -> Vec<(&str, f64)> {
    let mut acting: Vec<(&str, f64)> = Vec::new();
    for point in points {
        match acting.iter_mut().find(|(limit, _)| *limit == point.limit) {
            Some((_, time)) => *time += point.lasts,
            None => acting.push((&point.limit, point.lasts)),
        }
    }
    acting.retain(|(_, time)| *time > 0.0);
    acting.sort_by(|a, b| b.1.total_cmp(&a.1));
    acting
}

/// Least and greatest alpha on the path, if the planner could choose it.
fn alpha_range(path: &JobPath) -> Option<[f64; 2]> {
    const PLACES: u32 = 64;
    path.free.as_ref()?;
    let places = |each: &PathPiece| {
        let piece = each.piece;
        (0..=PLACES).map(move |place| piece.at(f64::from(place) / f64::from(PLACES)).pose.angle)
    };
    let widened = |[least, greatest]: [f64; 2], angle: f64| [least.min(angle), greatest.max(angle)];
    let angles = path.pieces.iter().flat_map(places);
    Some(angles.fold([f64::INFINITY, f64::NEG_INFINITY], widened))
}

/// Pieces of the user's path: rounded corners belong to the piece before.
fn given_pieces(path: &JobPath) -> usize {
    path.pieces.chunk_by(|a, b| a.source == b.source).count()
}

fn document(scene: &Scene, job: &PlannedJob, points: &[PlanPoint]) -> Document {
    let plan = &job.moves.plan;
    let (dwells, stands) = (job.path.dwells.len(), job.stands_s(scene));
    let (duration, least) = (stands + plan.duration_s(), stands + plan.least_s());
    let (moves, ticks) = (job.moves.moves.len() + dwells, job.ticks());
    let played = ticks as f64 * scene.period_s();
    let part = |time: f64| 100.0 * (time / least - 1.0);
    let given_s = job.given_ticks.map(|ticks| ticks as f64 * scene.period_s());
    let alpha = alpha_range(&job.path);
    let chosen = alpha.map(|[least, greatest]| {
        let given = match given_s {
            Some(given_s) => format!("as given the path is played in {given_s:.6} s"),
            None => "as given the path has no plan".into(),
        };
        format!("chosen from {least:.3} to {greatest:.3} rad; with alpha {given}")
    });
    let stand = (dwells > 0).then(|| format!("{stands:.6} s in all three, in dwells: {dwells}"));
    let longest = scene.longest_stop();
    let runs = plan.runs.iter().map(|run| {
        Facts::new()
            .data("duration_s", run.duration_s)
            .data("lower_bound_s", run.least_s)
            .data("cells", run.cells.len())
    });
    let pieces = format!(
        "{}: {} pieces, {} stops",
        scene.name,
        given_pieces(&job.path),
        plan.runs.len() - 1
    );
    let record = Facts::new()
        .pair("scene", "path", &scene.name).words(pieces)
        .pair("time_s", "played", played).words(format!("{played:.6} s   {moves} moves, {ticks} ticks, each admitted by the service; {:+.2} % over the bound", part(played)))
        .pair("duration_s", "plan", duration).words(format!("{duration:.6} s   {:+.2} % over the bound, with room for holds", part(duration)))
        .pair("lower_bound_s", "bound", least).words(format!("{least:.6} s   no motion along the path within the limits is faster"))
        .pair("dwells_s", "stands", stands).words(stand.unwrap_or_default())
        .text("a hold", longest.map(|longest| longest.to_string()))
        .pair("alpha_rad", "alpha", alpha).words(chosen.unwrap_or_default())
        .data("given_s", given_s)
        .data("moves", moves)
        .data("ticks", ticks)
        .data("longest_stop_s", longest.map(|longest| longest.time_s))
        .data("longest_stop_m", longest.map(|longest| longest.way_m))
        .rows("runs", runs);
    let mut document = Document::new();
    document.pairs(record);
    let limits = acting(points).into_iter().map(|(limit, time_s)| {
        let share = format!("{:.1} %", 100.0 * time_s / duration);
        Facts::new()
            .pair("limit", "limited by", limit)
            .pair("time_s", "for", time_s)
            .text("of the time", share)
    });
    document.table("limits", limits.collect());
    document
}
