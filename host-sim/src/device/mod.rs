//! `trirrr device`: the service of a scene behind a TCP port, in real time. A client talks to the device
//! as to a board.

mod args;
mod event_log;
mod inputs;
mod motors;
mod server;

pub use args::DeviceArgs;

use crate::failure::CliError;
use crate::realtime::{Deadlines, Pacer};
use crate::serve::{Doors, Hub, ListenArgs};
use crate::terminal::print_line;
use event_log::EventLog;
use inputs::PressedInputs;
use motors::Motors;
use server::{Server, Surroundings};
use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use trirrr_client::describe::Units;
use trirrr_client::local;
use trirrr_client::local::HostNumber;
use trirrr_client::transport::entropy;
use trirrr_drives::ObeyingDrives;
use trirrr_scene::Scene;
use trirrr_scene::in_number_type;
use trirrr_service::ServiceNumber;

/// Time from one look at the link to the next, while no tick is due.
const LOOK: Duration = Duration::from_micros(500);

/// Serves clients until `stop` is raised, which is the good end.
///
/// # Errors
/// Refused: the scene, or its number type. Failed: the address cannot be listened at.
pub fn command(args: &DeviceArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let mut scene = args.set.scene_to_move(&args.scene)?;
    // Clients repeat a request in real time, however fast the machine plays.
    scene.service.silence_timeout_s *= args.speed;
    let scalar = args.scalar.unwrap_or(scene.number);
    let inputs = PressedInputs::new(&scene, &args.press, args.touch, args.keys)?;
    let doors = args.listen.open()?;
    print_line(&format!(
        "tcp:{} plays scene {} in {scalar}, {} ticks per second",
        doors.address(),
        scene.name,
        scene.tick_rate_hz * args.speed
    ));
    doors.lines().iter().for_each(|line| print_line(line));
    let device = Device {
        scene: &scene,
        doors,
        rate_hz: scene.tick_rate_hz * args.speed,
        stop,
        offset: match args.offset_rad.as_deref() {
            Some([a, b, c]) => Some([*a, *b, *c]),
            _ => None,
        },
        inputs,
        is_quiet: false,
    };
    in_number_type!(scalar, N => device.play::<N>())
}

/// Machine that another command brings along, at a port of this computer that is free.
pub(crate) struct Simulated {
    doors: Doors,
}

impl Simulated {
    /// Listens.
    ///
    /// # Errors
    /// Failed: there is no free port.
    pub(crate) fn listen() -> Result<Self, CliError> {
        let doors = ListenArgs {
            listen: "127.0.0.1:0".into(),
            watch: None,
            key: None,
            beyond_loopback: false,
        };
        Ok(Self {
            doors: doors.open()?,
        })
    }

    /// Address of the machine.
    pub(crate) fn address(&self) -> SocketAddr {
        self.doors.address()
    }

    /// Plays `scene` in real time until `stop` is raised.
    ///
    /// # Errors
    /// As [`command`].
    pub(crate) fn play<N: HostNumber>(
        self,
        scene: &Scene,
        stop: &AtomicBool,
    ) -> Result<(), CliError> {
        let device = Device {
            scene,
            doors: self.doors,
            rate_hz: scene.tick_rate_hz,
            stop,
            offset: None,
            inputs: PressedInputs::new(scene, &[], None, false)?,
            is_quiet: true,
        };
        device.play::<N>()
    }
}

/// A device before its number type is chosen.
struct Device<'a> {
    scene: &'a Scene,
    doors: Doors,
    /// Ticks per second of real time.
    rate_hz: f64,
    stop: &'a AtomicBool,
    /// Offset of the motors, rad. `None` takes one that depends on the scene.
    offset: Option<[f64; 3]>,
    /// Emergency stop, door, probe and limit switches.
    inputs: PressedInputs,
    /// Another command speaks to the user.
    is_quiet: bool,
}

impl Device<'_> {
    fn play<N: HostNumber>(self) -> Result<(), CliError> {
        let Self {
            scene,
            doors,
            rate_hz,
            stop,
            offset,
            inputs,
            is_quiet,
        } = self;
        let units = trirrr_scene::units::<N>(scene)
            .map_err(|error| CliError::Refused(format!("scene {}: {error}", scene.name)))?;
        let played = local::with_machine_switched_on::<N, _>(scene, |machine| {
            machine.stir(entropy());
            let motors = scene.homing.map(|homing| {
                let commanded = motors::angles(machine.motors());
                let offset =
                    offset.unwrap_or_else(|| Motors::some_offset(&homing, scene.key, commanded));
                Motors::new(scene, homing, commanded, offset, units.torque_nm())
            });
            // Drives stand anywhere: at the start of the job, unless they are told otherwise. Those that have to be homed count
            // from there, wherever their joints are.
            let drives = scene.feedback.map(|_| {
                let off = offset.filter(|_| scene.homing.is_none());
                let off = off.unwrap_or_default();
                let stand = motors::angles(machine.motors());
                let angle = |i: usize| N::angle_from_f64(motors::wrapped(stand[i] + off[i]));
                ObeyingDrives::new([angle(0), angle(1), angle(2)])
            });
            let length_m = units.length_m();
            let log = EventLog::new(
                Units::of_scene(scene, &units),
                scene.spare_pins.clone(),
                is_quiet,
            );
            let silence = Duration::from_secs_f64(
                scene.service.silence_timeout_s * scene.tick_rate_hz / rate_hz,
            );
            let hub = Hub::new(doors, silence);
            let around = Surroundings {
                motors,
                drives,
                inputs,
                length_m,
            };
            let server = Server::new(machine, around, hub, log);
            run(server, rate_hz, stop)
        })?;
        let (log, clients, deadlines) =
            played.map_err(|error| CliError::Failed(format!("the listener failed: {error}")))?;
        if is_quiet {
            return Ok(());
        }
        let [ticks, requests] = log.totals();
        print_line(&format!(
            "ended by Ctrl-C after {ticks} ticks, {} of them late; {clients} clients, \
             {requests} requests",
            deadlines.late
        ));
        Ok(())
    }
}

/// Ticks at `rate_hz` until `stop` is raised.
fn run<N: ServiceNumber>(
    mut server: Server<N>,
    rate_hz: f64,
    stop: &AtomicBool,
) -> io::Result<(EventLog, u64, Deadlines)> {
    let mut pacer = Pacer::start(rate_hz);
    let mut tick = 0;
    while !stop.load(Ordering::Relaxed) {
        let left = pacer.left(tick);
        if left.is_zero() {
            server.tick()?;
            if pacer.done(tick) {
                server.count_late();
            }
            tick += 1;
        } else if !server.serve()? {
            std::thread::sleep(left.min(LOOK));
        }
    }
    let (log, clients) = server.end();
    Ok((log, clients, pacer.finish()))
}
