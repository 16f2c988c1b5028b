//! `cargo xtask emulate`: the image that is flashed, in QEMU, under the clients of a real board.

mod board;
mod clients;
mod failures;

use crate::callgraph;
use crate::image::Image;
use crate::parallel;
use crate::repository::{self, SceneFile};
use crate::symbols;
use crate::table::table;
use anyhow::{Context, Result, ensure};
use board::Board;
use clap::ValueEnum;
use clients::{Clients, HomingInputs};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use trirrr_image::generate::{SCALARS, of_scene};
use trirrr_scene::Scene;
use trirrr_service::Contact;

/// Most instructions that a tick may take on the board in f32, for service and drives. The count
/// runs from when the tick was due until its outputs stood.
const TICK_CEILING: f64 = 1500.0;

/// The scene whose jobs are played over a bad line, and left in the middle: 1000 ticks per second,
/// a job of some seconds.
const LINE_SCENE: &str = "engraving";

#[derive(clap::Args)]
pub(crate) struct EmulateArgs {
    /// Scenes, by name or file; all that are for a board without
    scenes: Vec<String>,
    /// Part to run; repeat for more
    #[arg(long, value_enum, default_values_t = [EmulationPart::Jobs])]
    part: Vec<EmulationPart>,
    /// Number type of the images [default: the scene's, f32 for f64; in `jobs` of all scenes fixed
    /// point, too]
    #[arg(long)]
    scalar: Option<String>,
    /// Frames of `line` before the last job begins
    #[arg(long, default_value_t = 20_000)]
    frames: u64,
    /// Seed of `line`
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Part of the emulation: one kind of run on an emulated board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EmulationPart {
    /// Play each scene's job with every client, compare every sample with the host's
    Jobs,
    /// Random jobs over a line that damages every fifth frame; a client that goes
    Line,
    /// Inject failures, read their causes after the reset
    Failures,
}

pub(crate) fn run(arguments: &EmulateArgs) -> Result<()> {
    let clients = Clients::build()?;
    // An emulator sleeps while its board waits for the next tick, so several boards run at once. Time on a
    // board passes with its instructions: no sample depends on how busy the host is.
    parallel::map(arguments.part.len(), &arguments.part, |part| match part {
        EmulationPart::Jobs => jobs(arguments, &clients),
        EmulationPart::Line => line(arguments, &clients),
        EmulationPart::Failures => failures::run(&clients),
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
        symbols::check_ruled_switches(&image)?;
        Ok(Self {
            scene: scene.clone(),
            scalar,
            image,
            inputs: Some(HomingInputs::Switches),
        })
    }
}

fn known_scalar(name: &str) -> Result<&'static str> {
    let found = SCALARS.iter().find(|(scalar, _)| *scalar == name);
    found
        .map(|(scalar, _)| *scalar)
        .with_context(|| format!("{name}: no number type of an image"))
}

fn jobs(arguments: &EmulateArgs, clients: &Clients) -> Result<()> {
    let mut played = Vec::new();
    for scene in repository::scenes_named(&arguments.scenes)? {
        let read = Scene::read(&scene.path)?;
        let own = match &arguments.scalar {
            Some(name) => known_scalar(name)?,
            None => of_scene(read.number),
        };
        let mut scalars = vec![own];
        if arguments.scenes.is_empty() && arguments.scalar.is_none() && own != "fixed" {
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
    let Built {
        scene,
        scalar,
        image,
        inputs,
    } = built;
    let about = || format!("{} in {scalar}", scene.name);
    let start = Instant::now();
    let board = Board::boot(image)?;
    let played = clients.play(scene, scalar, &board, *inputs);
    let played = played.with_context(about)?;
    let ended = board.end().with_context(about)?;
    let bound = stack_bound(image, ended.stack).with_context(about)?;
    let log = clients.read_log(image, &ended.log).with_context(about)?;
    let boot = format!("scene {}, ", scene.name);
    ensure!(
        log.contains(&boot),
        "{}: {boot:?} is missing in the log: {log}",
        about()
    );
    let instructions = (f64::from(played.longest) / board::COUNTS_PER_INSTRUCTION).ceil();
    ensure!(
        *scalar != "f32" || instructions <= TICK_CEILING,
        "{}: a tick of {instructions} instructions, the ceiling is {TICK_CEILING}",
        about()
    );
    let mut names = "board-test".to_owned();
    if with_all_clients && played.ticks == 0 {
        // Its homing has failed, as it has to; so it does under the other clients, who say why.
        for client in [Clients::stream_in_vain, Clients::python_in_vain] {
            let board = Board::boot(image)?;
            client(clients, scene, scalar, &board).with_context(about)?;
            board.end()?;
        }
        names += ", trirrr, python";
    } else if with_all_clients {
        let expected = clients.run(scene, scalar).with_context(about)?;
        let board = Board::boot(image)?;
        clients
            .stream(scene, scalar, &board, &expected)
            .with_context(about)?;
        board.end()?;
        let board = Board::boot(image)?;
        clients
            .python(scene, scalar, &board, &expected)
            .with_context(about)?;
        board.end()?;
        names += ", trirrr, python";
    }
    Ok(vec![
        scene.name.clone(),
        (*scalar).into(),
        inputs.map_or("-", HomingInputs::name).into(),
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
    let names = match arguments.scenes.as_slice() {
        [] => vec![LINE_SCENE.to_owned()],
        some => some.to_vec(),
    };
    for scene in repository::scenes_named(&names)? {
        let scalar = match &arguments.scalar {
            Some(name) => known_scalar(name)?,
            None => of_scene(Scene::read(&scene.path)?.number),
        };
        let built = Built::new(&scene, scalar)?;
        let board = Board::boot(&built.image)?;
        clients.torture(&scene, scalar, &board, arguments.frames, arguments.seed)?;
        let used = board.end()?.stack;
        let bound = stack_bound(&built.image, used)?;
        println!(
            "{} in {scalar}: {used} bytes of stack, by its code {bound} at most",
            scene.name
        );
        let board = Board::boot(&built.image)?;
        clients.abandon(&scene, scalar, &board)?;
        board.end()?;
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
