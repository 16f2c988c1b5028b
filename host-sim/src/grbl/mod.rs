//! `trirrr grbl`: a machine for senders of G-code.
//!
//! The dialect of the sender is `trirrr-grbl`; here it gets a port, and the machine behind it pieces of a path, which the machine plans
//! while later lines still come.

mod args;
#[cfg(test)]
mod bench;
mod driver;
#[cfg(test)]
mod holds;
mod inputs;
mod outputs;
mod path;
#[cfg(test)]
mod programs;
mod reach;
mod sender;

pub use args::GrblArgs;

use crate::device::Simulated;
use crate::dialogue::{carry, reopening};
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::machine::require_mounted;
use crate::numbers;
use crate::stream::{PortArgs, conversation, patience};
use crate::terminal::{print_line, say};
use driver::{MachineDriver, place_of};
use reach::SceneReach;
use sender::{Sender, SenderDoor};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use trirrr_client::{Dialogue, Turn, local};
use trirrr_grbl::{Dialect, MachineAct, MachineFacts};
use trirrr_line::{Address, LostLine, Retry};
use trirrr_protocol::message::{Message, Transmit};
use trirrr_scene::{NumberType, ReachMap, Scene, in_number_type};
use trirrr_service::ServiceNumber;

/// Time that a board may be silent before it is found.
const PATIENCE: Duration = Duration::from_secs(10);

/// Time without an answer after which the board counts as lost: a machine that hears nothing has come to rest by then.
const SILENCE: Duration = Duration::from_secs(2);

/// Time for a machine to come to rest at the end.
const FAREWELL: Duration = Duration::from_secs(5);

/// Serves senders until `stop` is raised, which is the good end.
///
/// # Errors
/// Refused: the scene, its number type, an address. Failed: a port, or the board.
pub fn command(args: &GrblArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let mut scene = args.set.scene_to_move(&args.scene)?;
    let scalar = args.scalar.unwrap_or(scene.number);
    if scalar == NumberType::Fixed {
        return Err(CliError::Refused(format!(
            "{}: senders need a machine that plans paths, and that needs a number type with a floating point: --scalar f32",
            args.scene.display()
        )));
    }
    let door = open_door(args)?;
    if let Some(port) = &args.port {
        let line = PortArgs {
            port: port.clone(),
            baud: args.baud,
            key: args.key.clone(),
        };
        // Goals and paths are those of the scene's tool.
        let machine = MachineArgs {
            scene: args.scene.clone(),
            set: args.set.clone(),
            line: line.clone(),
            scalar: Some(scalar),
            patience: PATIENCE.as_secs_f64(),
            feed: None,
        };
        return in_number_type!(scalar, N => {
            require_mounted::<N>(&machine, &scene, stop)?;
            serve::<N>(args, &scene, &line, door, stop)
        });
    }
    // The machine that comes along plans paths, whatever its scene says.
    scene.service.plans_paths = true;
    let machine = Simulated::listen()?;
    let line = PortArgs {
        port: Address::Tcp(machine.address().to_string()),
        baud: args.baud,
        key: None,
    };
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let played =
            scope.spawn(|| in_number_type!(scalar, N => machine.play::<N>(&scene, &ended)));
        let served = in_number_type!(scalar, N => serve::<N>(args, &scene, &line, door, stop));
        ended.store(true, Ordering::Relaxed);
        // A panic there is a bug and goes on here.
        let played = played.join();
        let played = played.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        served.and(played)
    })
}

fn open_door(args: &GrblArgs) -> Result<SenderDoor, CliError> {
    #[cfg(unix)]
    if args.pty {
        return SenderDoor::terminal();
    }
    SenderDoor::listen(&args.listen)
}

fn serve<N: ServiceNumber>(
    args: &GrblArgs,
    scene: &Scene,
    line: &PortArgs,
    door: SenderDoor,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    let refused = |why: String| CliError::Refused(format!("scene {}: {why}", scene.name));
    let units = numbers::units::<N>(scene)?;
    let reach = SceneReach::new(scene).map_err(CliError::Refused)?;
    let map = ReachMap::new(scene, &scene.job.start).map_err(|error| refused(error.to_string()))?;
    let facts = MachineFacts {
        name: scene.name.clone(),
        travel_m: map.size().map(|nodes| nodes as f64 * map.step_m()),
        has_homing: scene.homing.is_some(),
        motions: path::MOTIONS,
        z: args.z.words(),
        outputs: scene.spare_pins.outputs.len() as u8,
        inputs: scene.spare_pins.inputs.len() as u8,
    };
    let driver = MachineDriver::<N>::new(
        scene,
        units,
        local::hello::<N>(scene),
        patience(SILENCE),
        conversation(),
        args.corner / 1000.0,
    );
    let mut port = line.open(Retry::Always)?;
    let mut server = SenderServer {
        driver,
        dialect: Dialect::new(facts, place_of(&scene.job.start)),
        door,
        sender: None,
        reach: &reach,
        scene: &scene.name,
        is_found: false,
        is_open: true,
        farewell: None,
        is_stopped: false,
    };
    carry(&mut server, &mut port, stop)?
}

/// Senders of G-code, one at a time, and the machine behind them.
struct SenderServer<'a, N: Transmit> {
    driver: MachineDriver<N>,
    dialect: Dialect,
    door: SenderDoor,
    sender: Option<Sender>,
    reach: &'a SceneReach<'a>,
    /// Name of the scene.
    scene: &'a str,
    /// The machine has answered, and senders are served.
    is_found: bool,
    /// The line to the machine is open.
    is_open: bool,
    is_stopped: bool,
    /// Time at which the machine is to be off, behind a stop.
    farewell: Option<Duration>,
}

impl<N: Transmit> SenderServer<'_, N> {
    /// Hears the sender, once the machine is found. Returns the end of the server.
    fn serve(&mut self, now: Duration) -> Option<Result<(), CliError>> {
        if !self.driver.is_known() && !self.is_found {
            let why = self
                .driver
                .why_lost()
                .unwrap_or("the board does not answer");
            return (now > PATIENCE).then(|| Err(CliError::Failed(why.to_owned())));
        }
        if !std::mem::replace(&mut self.is_found, true) {
            let (name, scene) = (self.door.name(), self.scene);
            print_line(&format!("{name} takes a sender for scene {scene}"));
        }
        match self.door.next(self.sender.is_some()) {
            Ok(None) => {}
            Ok(Some(sender)) => {
                print_line("a sender is connected");
                self.dialect.connect();
                self.sender = Some(sender);
            }
            Err(error) => {
                let why = format!("the port for senders is lost: {error}");
                return Some(Err(CliError::Failed(why)));
            }
        }
        let mut sender = self.sender.take()?;
        match self.converse(&mut sender, now) {
            Ok(()) => self.sender = Some(sender),
            Err(error) => {
                print_line(&format!("the sender is gone: {error}"));
                self.driver.take(MachineAct::Stop);
            }
        }
        None
    }

    /// Carries out what the sender wants.
    fn converse(&mut self, sender: &mut Sender, now: Duration) -> std::io::Result<()> {
        self.dialect.bytes(&sender.receive()?);
        if let Some(reason) = self.driver.take_refused() {
            self.dialect.refused(&reason);
        }
        let view = self.driver.view();
        for act in self.dialect.step(now, &view, self.reach) {
            self.driver.take(act);
        }
        sender.send(&self.dialect.take_output())?;
        match self.dialect.is_closed() {
            true => Err(std::io::Error::other("it is no sender of G-code")),
            false => Ok(()),
        }
    }

    /// Result behind a stop.
    fn farewell(&self) -> Result<(), CliError> {
        if let Some(why) = self.driver.why_lost() {
            return Err(CliError::Failed(why.to_owned()));
        }
        if !self.driver.is_off() {
            let why = "the machine was told to stop, and does not say that its drives are off";
            return Err(CliError::Failed(why.into()));
        }
        print_line("ended by Ctrl-C, with the drives off");
        Ok(())
    }
}

impl<N: Transmit> Dialogue<N> for SenderServer<'_, N> {
    type End = Result<(), CliError>;
    const LOOK: Duration = Duration::from_millis(1);

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        let turn = self.driver.poll(now);
        turn.map(|why| Err(CliError::Refused(why)))
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        self.driver.receive(message, now);
    }

    fn stop(&mut self) {
        self.is_stopped = true;
        self.driver.stop();
    }

    fn reconnected(&mut self) {
        self.is_open = true;
        self.driver.reconnected();
    }

    fn lost(&mut self, why: &LostLine, is_news: bool) {
        self.is_open = false;
        self.driver.lost(why, is_news);
        if is_news {
            say(&reopening(self.driver.why_lost().unwrap_or_default()));
        }
    }

    fn attend(&mut self, now: Duration) -> Option<Self::End> {
        if !self.is_stopped {
            return self.serve(now);
        }
        // A port that is lost now is lost for a command that ends.
        let until = *self.farewell.get_or_insert(now + FAREWELL);
        let is_late = now >= until && !self.driver.is_stopping();
        let is_over = is_late || !self.is_open || self.driver.is_off();
        is_over.then(|| self.farewell())
    }
}
