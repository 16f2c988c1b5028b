//! `trirrr device`: the service of a scene behind a TCP port, in real time. A client talks to the device
//! as to a board.

mod args;
mod event_log;
mod inputs;
mod motors;
mod server;

pub use args::DeviceArgs;

use crate::failure::CliError;
use crate::numbers;
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
use std::time::{Duration, Instant};
use trirrr_client::describe::Units;
use trirrr_client::local;
use trirrr_client::local::{HostNumber, Sensed};
use trirrr_drives::ObeyingDrives;
use trirrr_line::entropy;
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
    if scene.service.autonomous.is_some() {
        return Err(CliError::Refused(format!(
            "{}:{}",
            args.scene.display(),
            crate::stream::NO_LINE
        )));
    }
    // Clients repeat a request in real time, however fast the machine plays.
    scene.service.silence_timeout_s *= args.speed;
    let scalar = args.scalar.unwrap_or(scene.number);
    if args.offset_rad.is_some() && scene.homing.is_none() && scene.feedback.is_none() {
        return Err(CliError::Refused(format!(
            "{}: --offset-rad has nothing to move: the scene has neither [homing] nor [feedback], so its motors are where they are commanded",
            args.scene.display()
        )));
    }
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
        let units = numbers::units::<N>(scene)?;
        let sensed = Sensed::all(scene);
        let played = local::with_machine_in::<N, _>(scene, units, sensed, |machine| {
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
            let log = EventLog::new(Units::of_scene(scene, &units), scene, is_quiet);
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
    let mut turns = Turns::default();
    let mut tick = 0;
    while !stop.load(Ordering::Relaxed) {
        pacer.stand(tick, LEAP);
        let left = pacer.left(tick);
        if turns.is_for_tick(left, Instant::now()) {
            server.tick()?;
            if pacer.done(tick) {
                server.count_late();
            }
            tick += 1;
            continue;
        }
        let is_busy = server.serve()?;
        turns.served(is_busy);
        if !is_busy && !left.is_zero() {
            std::thread::sleep(left.min(LOOK));
        }
    }
    let (log, clients) = server.end();
    Ok((log, clients, pacer.finish()))
}

/// Longest time that late ticks keep the line waiting, and that the line keeps late ticks waiting.
const TURN: Duration = Duration::from_millis(4);

/// Most time that is made up for by ticks in a row. Longer leaps would look like a host that is silent: it cannot answer within them.
const LEAP: Duration = Duration::from_millis(50);

/// Turns of ticks and of the line. A tick that is due goes first; on a computer that is too busy ticks are always due, and the line would
/// never be served until it is idle.
#[derive(Clone, Copy, Debug, Default)]
struct Turns {
    /// Start of the ticks since the line was idle, if there were any,
    ticks: Option<Instant>,
    /// and of the turn of the line.
    line: Option<Instant>,
}

impl Turns {
    /// Returns true if the next act at `now` is a tick, which is due in `left`.
    fn is_for_tick(&mut self, left: Duration, now: Instant) -> bool {
        if !left.is_zero() {
            return false;
        }
        match self.line {
            Some(since) if now.duration_since(since) < TURN => false,
            Some(_) => {
                *self = Self {
                    ticks: Some(now),
                    line: None,
                };
                true
            }
            None => {
                let since = *self.ticks.get_or_insert(now);
                let is_for_tick = now.duration_since(since) < TURN;
                if !is_for_tick {
                    self.line = Some(now);
                }
                is_for_tick
            }
        }
    }

    /// The line was served, and is idle unless it `is_busy`.
    fn served(&mut self, is_busy: bool) {
        if !is_busy {
            *self = Self::default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays 100 ms in virtual time: each tick takes `tick`, each look at the line `look`, of which `looks` follow each tick of `period`.
    /// Returns ticks, and the longest time until the line was idle.
    fn play(period: Duration, tick: Duration, look: Duration, looks: u32) -> (u32, Duration) {
        let start = Instant::now();
        let (mut now, mut turns) = (start, Turns::default());
        let (mut ticks, mut open, mut idle, mut longest) = (0, 0, start, Duration::ZERO);
        while now < start + Duration::from_millis(100) {
            let left = (start + ticks * period).saturating_duration_since(now);
            if turns.is_for_tick(left, now) {
                now += tick;
                ticks += 1;
                open += looks;
                continue;
            }
            let is_busy = open > 0;
            open = open.saturating_sub(1);
            turns.served(is_busy);
            now += look;
            if !is_busy {
                longest = longest.max(now - idle);
                now += left;
                idle = now;
            }
        }
        (ticks, longest)
    }

    #[test]
    fn late_ticks_do_not_starve_the_line() {
        let us = Duration::from_micros;
        // In time: each tick is played when it is due.
        let (ticks, longest) = play(us(1000), us(50), us(20), 5);
        assert_eq!(ticks, 100);
        assert!(longest < us(1100), "{longest:?}");
        // Too slow by far: the line is served until idle after each few milliseconds of ticks, and the ticks go on.
        let (ticks, longest) = play(us(20), us(50), us(1), 5);
        assert!(ticks > 1500, "{ticks}");
        assert!(longest < 2 * TURN + us(100), "{longest:?}");
        // A line that is never idle takes half of the time.
        let (ticks, _) = play(us(20), us(50), us(20), 1000);
        assert!((900..1100).contains(&ticks), "{ticks}");
    }
}
