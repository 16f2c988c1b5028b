//! `trirrr grbl`: a machine for senders of G-code.
//!
//! The dialect of the sender is `trirrr-grbl`; here it gets a port, and the machine behind it pieces of a path, which the machine plans
//! while later lines still come.

mod args;
mod driver;
#[cfg(test)]
mod holds;
mod inputs;
mod outputs;
mod path;
mod reach;
mod sender;

pub use args::GrblArgs;

use crate::device::Simulated;
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::machine::require_mounted;
use crate::stream::{Port, PortArgs, conversation, patience};
use crate::terminal::{print_line, say};
use driver::{MachineDriver, place_of};
use reach::SceneReach;
use sender::{Sender, SenderDoor};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use trirrr_client::exchange::Turn;
use trirrr_client::local;
use trirrr_grbl::{Dialect, MachineAct, MachineFacts};
use trirrr_line::{Address, KeyRefusal, Link, OpenError};
use trirrr_protocol::message::Transmit;
use trirrr_scene::{NumberType, ReachMap, Scene, in_number_type};
use trirrr_service::ServiceNumber;

/// Longest wait for the board before the sender is heard again.
const LOOK: Duration = Duration::from_millis(1);

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
    mut door: SenderDoor,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    let refused = |why: String| CliError::Refused(format!("scene {}: {why}", scene.name));
    let units = trirrr_scene::units::<N>(scene).map_err(|error| refused(error.to_string()))?;
    let reach = SceneReach::new(scene).map_err(CliError::Refused)?;
    let map = ReachMap::new(scene, &scene.job.start).map_err(|error| refused(error.to_string()))?;
    let facts = MachineFacts {
        name: scene.name.clone(),
        travel_m: map.size().map(|nodes| nodes as f64 * map.step_m()),
        has_homing: scene.homing.is_some(),
        motions: path::MOTIONS,
        ignore_z: args.ignore_z,
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
    let mut machine = MachineLine {
        driver,
        port: Port::open(line, PATIENCE)?,
        opening: None,
        begun: Instant::now(),
    };
    machine.find(stop)?;
    print_line(&format!(
        "{} takes a sender for scene {}",
        door.name(),
        scene.name
    ));
    let mut dialect = Dialect::new(facts, place_of(&scene.job.start));
    let mut client: Option<Sender> = None;
    while !stop.load(Ordering::Relaxed) {
        let lost = |error| CliError::Failed(format!("the port for senders is lost: {error}"));
        if let Some(sender) = door.next(client.is_some()).map_err(lost)? {
            print_line("a sender is connected");
            dialect.connect();
            client = Some(sender);
        }
        if let Some(sender) = &mut client
            && let Err(error) = converse(sender, &mut dialect, &mut machine, &reach)
        {
            print_line(&format!("the sender is gone: {error}"));
            client = None;
            machine.driver.take(MachineAct::Stop);
        }
        machine.talk()?;
    }
    machine.farewell()
}

/// Carries out what the sender wants.
fn converse<N: Transmit>(
    sender: &mut Sender,
    dialect: &mut Dialect,
    machine: &mut MachineLine<N>,
    reach: &SceneReach,
) -> std::io::Result<()> {
    dialect.bytes(&sender.receive()?);
    if let Some(reason) = machine.driver.take_refused() {
        dialect.refused(&reason);
    }
    let view = machine.driver.view();
    for act in dialect.step(machine.begun.elapsed(), &view, reach) {
        machine.driver.take(act);
    }
    sender.send(&dialect.take_output())?;
    match dialect.is_closed() {
        true => Err(std::io::Error::other("it is no sender of G-code")),
        false => Ok(()),
    }
}

/// Driver with its port.
struct MachineLine<N: Transmit> {
    driver: MachineDriver<N>,
    port: Port,
    /// Attempt to open a port anew that is lost.
    opening: Option<JoinHandle<Result<Box<dyn Link>, OpenError>>>,
    begun: Instant,
}

impl<N: Transmit> MachineLine<N> {
    /// Waits for the machine's first answer.
    ///
    /// # Errors
    /// Failed: it does not come.
    fn find(&mut self, stop: &AtomicBool) -> Result<(), CliError> {
        while !self.driver.is_known() && !stop.load(Ordering::Relaxed) {
            self.talk()?;
            if self.begun.elapsed() > PATIENCE {
                let why = self.driver.lost().unwrap_or("the board does not answer");
                return Err(CliError::Failed(why.to_owned()));
            }
        }
        Ok(())
    }

    /// Sends what is to be sent, and listens for a moment. A line that is lost is opened anew meanwhile, however long it takes.
    fn talk(&mut self) -> Result<(), CliError> {
        if let Some(opening) = self.opening.take_if(|opening| opening.is_finished()) {
            // A panic there is a bug and goes on here.
            let opened = opening.join();
            let opened = opened.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            match opened {
                Ok(link) => self.port.take(link),
                Err(error) if error.may_pass() => self.opening = Some(self.port.open_anew()),
                Err(error) => return Err(CliError::Failed(error.to_string())),
            }
        }
        if self.opening.is_some() {
            std::thread::sleep(LOOK);
            return Ok(());
        }
        let wait = loop {
            match self.driver.poll(self.begun.elapsed()) {
                Turn::Send(request) => {
                    if let Err(error) = self.port.send(&request) {
                        self.lose(&error.to_string());
                        return Ok(());
                    }
                }
                Turn::Wait(until) => break until.saturating_sub(self.begun.elapsed()),
                Turn::Free => break LOOK,
                Turn::Silent => {
                    self.lose("the board does not answer");
                    return Ok(());
                }
            }
        };
        match self.port.receive(wait.min(LOOK)) {
            Ok(messages) => {
                for message in &messages {
                    self.driver.receive(message, self.begun.elapsed());
                }
            }
            // To open the port anew does not help.
            Err(error) if KeyRefusal::of(&error).is_some() => {
                return Err(CliError::Failed(error.to_string()));
            }
            Err(error) => self.lose(&error.to_string()),
        }
        match self.driver.failure.take() {
            Some(failure) => Err(CliError::Refused(failure)),
            None => Ok(()),
        }
    }

    /// Begins to open the port anew.
    fn lose(&mut self, why: &str) {
        let why = format!("the line to the machine is lost: {why}");
        say(&format!("{why}; opening the port anew"));
        self.driver.lose(&why);
        self.opening = Some(self.port.open_anew());
    }

    /// Brings the machine to rest and switches it off.
    fn farewell(mut self) -> Result<(), CliError> {
        self.driver.take(MachineAct::Stop);
        self.driver.take(MachineAct::Sleep);
        let until = self.begun.elapsed() + FAREWELL;
        // A port that is lost now is lost for a command that ends.
        while self.begun.elapsed() < until && self.opening.is_none() && !self.driver.is_off() {
            self.talk()?;
        }
        if let Some(why) = self.driver.lost() {
            return Err(CliError::Failed(why.to_owned()));
        }
        print_line("ended by Ctrl-C, with the drives off");
        Ok(())
    }
}
