//! The program: a thread for each machine.

use crate::args::{FleetArgs, MachineEntry};
use crate::error::ZenohError;
use crate::keys::MachineKeys;
use crate::line::SimulatedLine;
use crate::machine::{MachineSetup, Worker};
use crate::outlet::Outlet;
use crate::session::{self, SessionMode};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use trirrr_client::local::{self, HostNumber};
use trirrr_line::{Port, Retry, SharedKey, entropy};
use trirrr_scene::{Scene, in_number_type};
use zenoh::Session;

/// Time from one look at the end of the program to the next.
const LOOK: Duration = Duration::from_millis(50);

/// Memory of a thread: a machine is built on its stack before it is boxed.
const STACK_BYTES: usize = 16 << 20;

/// Carries the machines until `stop` is raised, which is the good end.
///
/// # Errors
/// Refused: a scene, a key file, the fleet file, or Zenoh's configuration. Failed: no router answers.
pub fn run(args: &FleetArgs, stop: &AtomicBool) -> Result<(), ZenohError> {
    let mut scenes = BTreeMap::new();
    let own = args.scene().map(|scene| read(&mut scenes, &scene.into()));
    let own = own.transpose()?;
    let machines = args.machines(own.as_ref().map_or("", |scene| &scene.name))?;
    let mut prepared = Vec::new();
    for entry in machines {
        let scene = read(&mut scenes, &entry.scene)?;
        let key = entry.key.as_ref().map(|file| SharedKey::read(file));
        let key = key.transpose().map_err(|error| {
            let file = entry.key.as_deref().unwrap_or_else(|| "".as_ref());
            ZenohError::Refused(format!("{}: {error}", file.display()))
        })?;
        prepared.push((entry, scene, key));
    }
    let endpoints = args.connect();
    let zenoh = session::open(SessionMode::Client, args.config.as_deref(), &endpoints)?;
    let count = prepared.len();
    std::thread::scope(|scope| {
        let mut threads = Vec::new();
        for (entry, scene, key) in prepared {
            let (name, zenoh) = (entry.name.clone(), &zenoh);
            let carry = move || carry(args, entry, &scene, key, zenoh, stop);
            let thread = std::thread::Builder::new()
                .name(name)
                .stack_size(STACK_BYTES)
                .spawn_scoped(scope, carry);
            match thread {
                Ok(thread) => threads.push(thread),
                Err(error) => {
                    stop.store(true, Ordering::Relaxed);
                    return Err(ZenohError::Failed(format!("no thread: {error}")));
                }
            }
        }
        let access = match args.control {
            true => "they take commands",
            false => "looking on: commands need --control",
        };
        println!(
            "{count} machines below {}/ through {}; {access}",
            args.prefix,
            endpoints.join(", ")
        );
        while !stop.load(Ordering::Relaxed) && !threads.iter().any(|thread| thread.is_finished()) {
            std::thread::sleep(LOOK);
        }
        // The error of one ends all: a fleet is started with what it has to be.
        stop.store(true, Ordering::Relaxed);
        let ends = threads.into_iter().map(|thread| {
            let panicked = |_| Err(ZenohError::Failed("a machine's thread has panicked".into()));
            thread.join().unwrap_or_else(panicked)
        });
        ends.collect::<Result<Vec<()>, _>>().map(|_| ())
    })
}

/// Reads a scene once, however many machines have it.
fn read(
    scenes: &mut BTreeMap<PathBuf, Arc<Scene>>,
    file: &PathBuf,
) -> Result<Arc<Scene>, ZenohError> {
    if let Some(scene) = scenes.get(file) {
        return Ok(scene.clone());
    }
    let scene = Scene::read(file).map_err(|error| ZenohError::Refused(error.to_string()))?;
    let scene = Arc::new(scene);
    scenes.insert(file.clone(), scene.clone());
    Ok(scene)
}

fn carry(
    args: &FleetArgs,
    entry: MachineEntry,
    scene: &Scene,
    key: Option<SharedKey>,
    zenoh: &Session,
    stop: &AtomicBool,
) -> Result<(), ZenohError> {
    let keys = MachineKeys::new(&args.prefix, &entry.name);
    let setup = MachineSetup {
        name: entry.name,
        scene,
        is_simulated: entry.port.is_none(),
        telemetry: args.telemetry,
        history_s: args.history,
        takes_commands: args.control,
        session: u64::from(entropy()) << 32 | u64::from(entropy()),
    };
    in_number_type!(scene.number, N => play::<N>(args, setup, entry.port, key, zenoh, &keys, stop))
}

fn play<N: HostNumber>(
    args: &FleetArgs,
    setup: MachineSetup,
    port: Option<trirrr_line::Address>,
    key: Option<SharedKey>,
    zenoh: &Session,
    keys: &MachineKeys,
    stop: &AtomicBool,
) -> Result<(), ZenohError> {
    let (scene, outlet) = (setup.scene, Outlet::declare(zenoh, keys, args.ros)?);
    let mut worker = Worker::<N>::new(setup, outlet)?;
    let _declared = worker.declare(zenoh, keys)?;
    match port {
        Some(address) => {
            let mut port = Port::new(address, args.baud, key, Retry::Always);
            worker.run(&mut port, stop)
        }
        None => local::with_machine::<N, _>(scene, |machine| {
            machine.stir(entropy());
            let mut line = SimulatedLine::new(machine, scene.tick_rate_hz);
            worker.run(&mut line, stop)
        })
        .map_err(|error| ZenohError::Refused(error.to_string()))?,
    }
}
