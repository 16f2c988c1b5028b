//! `trirrr goto`, `park`, `jog` and `follow`: send a machine to goals, from rest or from any motion.

mod args;
mod follow;
mod goto;
mod jog;
mod lines;
mod park;
mod session;

pub use args::{FollowArgs, GotoArgs, JogArgs, MachineArgs, ParkArgs};

use crate::failure::CliError;
use crate::numbers::in_boards_numbers;
use crate::terminal::print;
use session::{GoalSession, Goals};
use std::sync::atomic::AtomicBool;
use trirrr_scene::Scene;
use trirrr_scene::in_number_type;
use trirrr_service::ServiceNumber;

/// Moves to a pose. Returns false if the user has stopped the machine.
///
/// # Errors
/// Refused: the scene, or the pose. Failed: the port, the board, or a fault.
pub fn goto(args: &GotoArgs, stop: &AtomicBool) -> Result<bool, CliError> {
    command(&args.machine, &mut goto::OneGoal::new(args), true, stop)
}

/// Moves to the start of the scene's job, or to another pose, slowly. Returns as [`goto()`].
///
/// # Errors
/// As [`goto()`].
pub fn park(args: &ParkArgs, stop: &AtomicBool) -> Result<bool, CliError> {
    let scene = args.machine.set.scene_to_move(&args.machine.scene)?;
    in_boards_numbers(
        args.machine.scalar,
        scene.number,
        |number| in_number_type!(number, N => park::park::<N>(args, &scene, stop)),
    )
}

/// Moves by steps and at velocities. Returns as [`goto()`].
///
/// # Errors
/// As [`goto()`].
pub fn jog(args: &JogArgs, stop: &AtomicBool) -> Result<bool, CliError> {
    command(&args.machine, &mut jog::Jog::new(args.renew), false, stop)
}

/// Follows poses. Returns as [`goto()`].
///
/// # Errors
/// As [`goto()`]; refused: poses that cannot be read.
pub fn follow(args: &FollowArgs, stop: &AtomicBool) -> Result<bool, CliError> {
    let mut poses = follow::Poses::open(args)?;
    command(&args.machine, &mut poses, false, stop)
}

fn command(
    args: &MachineArgs,
    goals: &mut impl Goals,
    strict: bool,
    stop: &AtomicBool,
) -> Result<bool, CliError> {
    let scene = args.set.scene_to_move(&args.scene)?;
    in_boards_numbers(
        args.scalar,
        scene.number,
        |number| in_number_type!(number, N => run::<N>(args, &scene, goals, strict, stop)),
    )
}

fn run<N: ServiceNumber>(
    args: &MachineArgs,
    scene: &Scene,
    goals: &mut impl Goals,
    strict: bool,
    stop: &AtomicBool,
) -> Result<bool, CliError> {
    let (mut session, mut port) = GoalSession::<N>::open(args, scene)?;
    let Some([x, y, alpha]) = session.run(&mut port, goals, strict, stop)? else {
        return Ok(false);
    };
    print(&format!(
        "stands at x {x:.6} m, y {y:.6} m, alpha {alpha:.6} rad\n"
    ))?;
    goals.verdict()?;
    Ok(true)
}
