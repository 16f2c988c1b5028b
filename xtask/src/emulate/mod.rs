//! `cargo xtask emulate`: the image that is flashed, in QEMU, under the clients of a real board.

mod alone;
mod board;
mod clients;
mod failures;

use crate::callgraph;
use crate::image::Image;
use crate::parallel;
use crate::repository::{self, SceneFile};
use crate::symbols;
use crate::table::table;
use anyhow::{Context, Result, bail, ensure};
use board::Board;
use clap::ValueEnum;
use clients::{Clients, HomingInputs, JobClient};
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;
use trirrr_service::features::Contact;

/// Most instructions that a tick may take on the board in f32, for service and drives. The count
/// runs from when the tick was due until its outputs stood. A tick that is due while the background masks interrupts, to hand
/// something over, begins up to some hundred instructions later: that depends on when the host's bytes come, and differs from run to
/// run. `cargo xtask insns` has the exact counts and their ceilings.
const TICK_CEILING: f64 = 2700.0;

/// Scene that a plant simulates: the image holds the very loops.
const SIMULATED: &str = "plant-thesis";

/// The scene whose jobs are played over a bad line, and left in the middle: 1000 ticks per second,
/// a job of some seconds.
const LINE_SCENE: &str = "chained";

/// Mass that the platform of an adjustable board gets, kg.
const OTHER_MASS_KG: &str = "0.7";

/// The scene with power lists.
const RASTER_SCENE: &str = "scenes/paths/raster.toml";

#[derive(clap::Args)]
pub(crate) struct EmulateArgs {
    /// Scenes, by name or file; all that are for a board without
    scenes: Vec<String>,
    /// Play each scene whose job is no path in fixed point, too, besides its own number type
    #[arg(long)]
    fixed: bool,
    /// Part to run; repeat for more
    #[arg(long, value_enum, default_values_t = [EmulationPart::Jobs])]
    part: Vec<EmulationPart>,
    /// Frames of `line` before the last job begins
    #[arg(long, default_value_t = 20_000)]
    frames: u64,
    /// Seconds of the image of `raster`, least seconds of the job of `line` that is cut off
    #[arg(long, default_value_t = 6)]
    seconds: u32,
    /// Times that the job of `line` is cut off
    #[arg(long, default_value_t = 4)]
    cuts: u32,
}

/// Part of the emulation: one kind of run on an emulated board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EmulationPart {
    /// Play each scene's job with every client, compare every sample with the host's
    Jobs,
    /// Random jobs over a line that damages every fifth frame; a job that is cut off at random places
    Line,
    /// Burn a raster image on a scene with power lists, and compare the power at each place
    Raster,
    /// Inject failures, read their causes after the reset
    Failures,
    /// A board without a host: read out of its memory what it plays
    Alone,
}

pub(crate) fn run(arguments: &EmulateArgs) -> Result<()> {
    let clients = Clients::build()?;
    // An emulator sleeps while its board waits for the next tick, so several boards run at once. Time on a
    // board passes with its instructions: no sample depends on how busy the host is.
    parallel::map(arguments.part.len(), &arguments.part, |part| match part {
        EmulationPart::Jobs => jobs(arguments, &clients),
        EmulationPart::Line => line(arguments, &clients),
        EmulationPart::Raster => raster(arguments, &clients),
        EmulationPart::Failures => failures::run(&clients),
        EmulationPart::Alone => alone::run(&clients),
    })?;
    Ok(())
}

/// A scene in a number type, and its image.
struct Built {
    scene: SceneFile,
    scalar: &'static str,
    image: PathBuf,
    /// None where nobody asks for them.
    inputs: Option<HomingInputs>,
}

impl Built {
    /// The image that is flashed.
    fn new(scene: &SceneFile, scalar: &'static str) -> Result<Self> {
        Ok(Self {
            scene: scene.clone(),
            scalar,
            image: Image::firmware(scene, scalar).build()?,
            inputs: None,
        })
    }

    /// The same with switches that close by rule, which no image that is flashed has.
    fn with_switches(scene: &SceneFile, scalar: &'static str) -> Result<Self> {
        let image = Image::firmware(scene, scalar).build_as("-switches", |cargo| {
            cargo.args(["--features", "ruled-switches"]);
        })?;
        symbols::check_mark(&image, symbols::RULED_SWITCHES)?;
        Ok(Self {
            scene: scene.clone(),
            scalar,
            image,
            inputs: Some(HomingInputs::Switches),
        })
    }
}

impl fmt::Display for Built {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in {}", self.scene.name, self.scalar)
    }
}

fn jobs(arguments: &EmulateArgs, clients: &Clients) -> Result<()> {
    let mut played = Vec::new();
    let mut scenes = repository::scenes_named(&arguments.scenes)?;
    if arguments.scenes.is_empty() {
        scenes.extend(repository::scenes_named(&[SIMULATED.to_owned()])?);
    }
    for scene in scenes {
        let read = Scene::read(&scene.path)?;
        let own = of_scene(read.number);
        let mut scalars = vec![own];
        // A plan uses the limits fully, and is proven in the scene's own number type: rounded otherwise, it is refused.
        let may_be_fixed = read.job.path.is_none() && scene.name != SIMULATED;
        if arguments.fixed && own != "fixed" && may_be_fixed {
            scalars.push("fixed");
        }
        let contact = read.homing.map(|homing| homing.contact);
        // In the other number type the samples are what may differ, not the clients.
        let of = |scalar| (scene.clone(), contact, scalar, scalar == own);
        played.extend(scalars.into_iter().map(of));
    }
    let rows = parallel::map(
        parallel::workers(),
        &played,
        |(scene, contact, scalar, with_all_clients)| {
            jobs_of(clients, scene, *contact, scalar, *with_all_clients)
        },
    )?;
    let rows: Vec<_> = rows.into_iter().flatten().collect();
    let headings = [
        "scene",
        "scalar",
        "inputs",
        "ticks",
        "samples",
        "lost",
        "longest tick",
        "stack",
        "at most",
        "clients",
        "seconds",
    ];
    print!("{}", table(&headings, &rows));
    Ok(())
}

/// Plays a scene's job in one number type: once, or with and without its switches. A row of figures for each.
fn jobs_of(
    clients: &Clients,
    scene: &SceneFile,
    contact: Option<Contact>,
    scalar: &'static str,
    with_all_clients: bool,
) -> Result<Vec<Vec<String>>> {
    let built = Built::new(scene, scalar)?;
    let mut rows = Vec::new();
    let built = match contact {
        // The emulated drives obey: a motor presses against nothing.
        Some(Contact::Torque) => bail!("{}: an emulated stop has no torque", scene.name),
        None | Some(Contact::Unfelt) => built,
        Some(Contact::Switch | Contact::Stall) => {
            // In an emulator its inputs stay low.
            let inputs = Some(HomingInputs::Open);
            let as_flashed = Built { inputs, ..built };
            rows.push(job(clients, &as_flashed, with_all_clients)?);
            Built::with_switches(scene, scalar)?
        }
    };
    rows.push(job(clients, &built, with_all_clients)?);
    Ok(rows)
}

/// Plays a scene's job on its image, freshly booted for each client; a row of figures.
fn job(clients: &Clients, built: &Built, with_all_clients: bool) -> Result<Vec<String>> {
    let about = || built.to_string();
    let start = Instant::now();
    let board = Board::boot(&built.image)?;
    let played = clients.play(built, &board).with_context(about)?;
    let ended = board.end().with_context(about)?;
    let bound = stack_bound(&built.image, ended.stack).with_context(about)?;
    let log = clients
        .read_log(&built.image, &ended.log)
        .with_context(about)?;
    let boot = format!("scene {}, ", built.scene.name);
    ensure!(
        log.contains(&boot),
        "{built}: {boot:?} is missing in the log: {log}"
    );
    let instructions = (f64::from(played.longest) / board::COUNTS_PER_INSTRUCTION).ceil();
    ensure!(
        built.scalar != "f32" || instructions <= TICK_CEILING,
        "{built}: a tick of {instructions} instructions, the ceiling is {TICK_CEILING}"
    );
    if Scene::read(&built.scene.path)?.service.adjustable {
        let board = Board::boot(&built.image)?;
        let other = clients.play_with_mass(built, &board, OTHER_MASS_KG);
        other.with_context(about)?;
        board.end()?;
    }
    let mut names = "board-test".to_owned();
    if with_all_clients {
        // Without a tick its homing has failed, as it has to; so it does under the other clients, who say why.
        let expected = match played.ticks {
            0 => None,
            _ => Some(clients.run(built).with_context(about)?),
        };
        for client in [JobClient::Stream, JobClient::Python] {
            let board = Board::boot(&built.image)?;
            let followed = clients.follow(client, built, &board, expected.as_deref());
            followed.with_context(about)?;
            board.end()?;
        }
        names += ", trirrr, python";
    }
    Ok(vec![
        built.scene.name.clone(),
        built.scalar.into(),
        built.inputs.map_or("-", HomingInputs::name).into(),
        played.ticks.to_string(),
        played.samples.to_string(),
        played.lost.to_string(),
        instructions.to_string(),
        ended.stack.to_string(),
        bound.to_string(),
        names,
        seconds(start.elapsed()),
    ])
}

fn line(arguments: &EmulateArgs, clients: &Clients) -> Result<()> {
    // Beside jobs, the scenes named are those of the jobs.
    let names = match arguments.scenes.as_slice() {
        some @ [_, ..] if !arguments.part.contains(&EmulationPart::Jobs) => some.to_vec(),
        _ => vec![LINE_SCENE.to_owned()],
    };
    for scene in repository::scenes_named(&names)? {
        let built = Built::new(&scene, of_scene(Scene::read(&scene.path)?.number))?;
        let board = Board::boot(&built.image)?;
        let frames = arguments.frames.to_string();
        clients.show("torture", &built, &board, &["--frames", &frames])?;
        let used = board.end()?.stack;
        let bound = stack_bound(&built.image, used)?;
        println!("{built}: {used} bytes of stack, by its code {bound} at most");
        let board = Board::boot(&built.image)?;
        clients.cut(&built, &board, arguments.cuts, arguments.seconds)?;
        board.end()?;
    }
    Ok(())
}

fn raster(arguments: &EmulateArgs, clients: &Clients) -> Result<()> {
    for scene in repository::scenes_named(&[RASTER_SCENE.to_owned()])? {
        let built = Built::new(&scene, of_scene(Scene::read(&scene.path)?.number))?;
        let board = Board::boot(&built.image)?;
        clients.burn(&built, &board, arguments.seconds)?;
        let used = board.end()?.stack;
        let bound = stack_bound(&built.image, used)?;
        println!("{built}: {used} bytes of stack, by its code {bound} at most");
    }
    Ok(())
}

/// Returns the most bytes of stack that the image's code can take. Fails if a run has `used` more.
fn stack_bound(image: &Path, used: u32) -> Result<u32> {
    let most = callgraph::check(image)?.most;
    ensure!(
        used <= most,
        "{used} bytes of stack were used, of which the code says that it takes {most} at most"
    );
    Ok(most)
}

fn seconds(time: Duration) -> String {
    format!("{:.1}", time.as_secs_f64())
}
