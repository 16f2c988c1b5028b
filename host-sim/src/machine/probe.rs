//! `trirrr probe`: a straight way of a machine that ends where its probe touches.

use super::settled;
use super::talk::Talk;
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::numbers::{in_boards_numbers, units};
use crate::terminal::print;
use clap::Args;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use trirrr_client::describe;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Acting, Command, Move, ProbeRun, State};
use trirrr_scene::{in_number_type, offer};
use trirrr_service::ServiceNumber;

/// Time from one look at the machine to the next: well within its host timeout.
const LOOK: Duration = Duration::from_millis(20);

/// `trirrr probe`.
///
/// Moves a machine that is on straight towards a pose, from rest to rest, until its probe touches: the machine keeps the pose of
/// that tick, comes to rest on its way, and the pose is printed. The way ends without a contact: that is a failure.
#[derive(Args, Clone, Debug)]
pub struct ProbeArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// End of the way: x and y in m, alpha in rad
    #[arg(
        long,
        value_names = ["X", "Y", "ALPHA"],
        num_args = 3,
        required = true
    )]
    pub to: Vec<f64>,
    /// Duration of the whole way, s
    #[arg(long, value_name = "SECONDS", value_parser = crate::arguments::factor)]
    pub seconds: f64,
    /// Move away from what the probe touches, until it lets go
    #[arg(long)]
    pub away: bool,
}

/// Moves the machine until its probe touches, and prints where that was.
///
/// # Errors
/// Refused: the scene, the way, or by the board. Failed: the port, a fault, or no contact.
pub fn probe(args: &ProbeArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let scene = args.machine.set.scene(&args.machine.scene)?;
    in_boards_numbers(args.machine.scalar, scene.number, |number| {
        in_number_type!(number, N => {
            let mut talk = Talk::<N>::open(&args.machine, &scene, stop)?;
            let units = units::<N>(&scene)?;
            let [x, y, alpha] = [0, 1, 2].map(|i| args.to.get(i).copied().unwrap_or_default());
            let to = offer::pose(&units.pose(&Pose::from_f64(x, y, alpha)));
            let ticks = (args.seconds * scene.tick_rate_hz).ceil().clamp(1.0, f64::from(u32::MAX));
            run(&mut talk, to, ticks as u32, args.away)
        })
    })
}

fn run<N: ServiceNumber>(
    talk: &mut Talk<'_, N>,
    to: Pose<N>,
    ticks: u32,
    away: bool,
) -> Result<(), CliError> {
    let status = settled(talk)?;
    let Some(from) = status.end.filter(|_| status.state == State::Idle) else {
        return Err(CliError::Refused(format!(
            "not while the machine is {}{}",
            describe::state(status.state, Acting::Nothing),
            match status.state {
                State::Disabled => " (`trirrr enable` switches its drives on)",
                _ => "",
            }
        )));
    };
    let end = along(
        talk,
        Move::rest_to_rest(status.next, from.pose, to, ticks),
        away,
    );
    if talk.is_interrupted() {
        talk.bring_to_rest();
    }
    end
}

/// Goes along `way` until the probe touches.
fn along<N: ServiceNumber>(
    talk: &mut Talk<'_, N>,
    way: Move<N>,
    away: bool,
) -> Result<(), CliError> {
    let Move { number, ticks, .. } = way;
    talk.done(Command::Move(way))?;
    // The admission decides.
    while let status = talk.status()?
        && status.admitted != number.wrapping_add(1)
    {
        let verdict = status.refused.filter(|verdict| verdict.number == number);
        if let Some(violation) = verdict.and_then(|verdict| verdict.violation) {
            let why = describe::violation(&violation, ticks, &talk.units());
            return Err(CliError::Refused(format!("the way is not admitted: {why}")));
        }
        if status.state != State::Idle {
            break;
        }
        talk.listen(LOOK)?;
    }
    if let Err(refused) = talk.done(Command::Probe { away }) {
        // The move is no business of the next command.
        talk.done(Command::Stop)?;
        return Err(refused);
    }
    loop {
        let status = talk.status()?;
        match (status.state, status.fault, status.probe) {
            (_, Some(fault), _) => {
                return Err(CliError::Failed(describe::fault(&fault, &talk.units())));
            }
            (State::Idle, _, Some(run)) if run != ProbeRun::Armed => {
                let text = describe::probe(&run, &talk.units());
                return match run {
                    ProbeRun::Touched(_) => print(&format!("{text}\n")),
                    _ => Err(CliError::Failed(text)),
                };
            }
            // Nothing is measured by a way that somebody has stopped.
            (State::Holding, _, _) if matches!(status.acting, Acting::Door | Acting::Hold) => {
                talk.bring_to_rest();
                let state = describe::state(status.state, status.acting);
                return Err(CliError::Failed(format!(
                    "the machine was {state}: the way has ended there; the same command goes on from where it stands"
                )));
            }
            // A machine that waited for this host goes on.
            _ if status.waits_for_host() => talk.done(Command::Resume)?,
            _ => {}
        }
        talk.listen(LOOK)?;
    }
}
