//! `trirrr tool`: shows which tool a machine carries, and mounts another.

use super::geometry::{read_platform, stands};
use super::talk::Talk;
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::numbers::in_boards_numbers;
use crate::terminal::print;
use clap::Args;
use std::sync::atomic::AtomicBool;
use trirrr_client::describe;
use trirrr_protocol::message::Command;
use trirrr_protocol::message::scene::{Platform, Section};
use trirrr_scene::{CarriedTools, MountableTool, Scene, ToolRack, in_number_type};
use trirrr_service::ServiceNumber;

/// `trirrr tool`.
///
/// Shows the tools of a scene, the one that the board counts with, and the pose of its tool point. With --mount, tells a board that stands
/// idle that it carries another one from now on: its mass, its inertia and its tool point.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The scene must be the one that the board's image was built from. The board does not move, and has the tool of its scene again after it \
was switched off.")]
pub struct ToolArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// Name of the tool that the platform carries now
    #[arg(long, value_name = "NAME")]
    pub mount: Option<String>,
}

/// Shows the tool of a machine, or mounts one.
///
/// # Errors
/// Refused: the scene, a name of no tool, or by the board. Failed: the port, or the board.
pub fn tool(args: &ToolArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let scene = args.machine.set.scene(&args.machine.scene)?;
    let Some(rack) = &scene.tools else {
        return Err(CliError::Refused(format!(
            "scene {}: has no [[tools]] to mount",
            scene.name
        )));
    };
    let wanted = match &args.mount {
        None => None,
        Some(name) => Some(rack.find(name).ok_or_else(|| {
            CliError::Refused(format!(
                "scene {}: has no tool {name:?}; its tools are {}",
                scene.name,
                names(rack)
            ))
        })?),
    };
    in_boards_numbers(args.machine.scalar, scene.number, |number| {
        in_number_type!(number, N => {
            let mut talk = Talk::<N>::open(&args.machine, &scene, stop)?;
            match wanted {
                Some(index) => mount(&mut talk, &scene, rack, index),
                None => show(&mut talk, &scene, rack),
            }
        })
    })
}

/// Checks that the board of `scene` carries the tool that the scene has mounted, for a conversation that plays no job of its own.
///
/// # Errors
/// Refused: another tool, with the command that mounts this one. Failed: the port, or the board.
pub(crate) fn require_mounted<N: ServiceNumber>(
    args: &MachineArgs,
    scene: &Scene,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    let Some(tools) = CarriedTools::of(scene) else {
        return Ok(());
    };
    let mut talk = Talk::<N>::open(args, scene, stop)?;
    match tools.found(&read_platform(&mut talk)?) {
        found if found == Some(tools.wanted()) => Ok(()),
        found => Err(CliError::Refused(tools.complaint(found))),
    }
}

fn show<N: ServiceNumber>(
    talk: &mut Talk<'_, N>,
    scene: &Scene,
    rack: &ToolRack,
) -> Result<(), CliError> {
    let platform = read_platform(talk)?;
    let found = CarriedTools::of(scene).and_then(|tools| tools.found(&platform));
    let mut text = String::new();
    for (index, tool) in rack.tools().iter().enumerate() {
        let mark = if found == Some(index) { "*" } else { " " };
        text += &format!("{mark} {}\n", line(tool));
    }
    if found.is_none() {
        text += "the machine counts with none of these\n";
    }
    print(&(text + &pose(talk)?))
}

fn mount<N: ServiceNumber>(
    talk: &mut Talk<'_, N>,
    scene: &Scene,
    rack: &ToolRack,
    index: usize,
) -> Result<(), CliError> {
    let kept = read_platform(talk)?;
    let carried = Platform::from(&rack.put_into(&scene.parameters, index));
    // Gravity and the force at the tool are the board's.
    let wanted = Platform {
        gravity_m_s2: kept.gravity_m_s2,
        wrench_force_n: kept.wrench_force_n,
        wrench_torque_nm: kept.wrench_torque_nm,
        ..carried
    };
    talk.done(Command::Replace(Section::Platform(wanted)))?;
    let platform = read_platform(talk)?;
    if CarriedTools::of(scene).and_then(|tools| tools.found(&platform)) != Some(index) {
        return Err(CliError::Failed(
            "the board has not taken the tool: it tells another platform".into(),
        ));
    }
    let text = format!("mounted: {}\n", line(&rack.tools()[index]));
    print(&(text + &pose(talk)?))
}

/// A tool in a line.
fn line(tool: &MountableTool) -> String {
    let [x, y] = tool.point_m;
    format!(
        "{}, {} kg, tool point at {x} m, {y} m",
        tool.name, tool.mass_kg
    )
}

/// The pose of the tool point, as a line.
fn pose<N: ServiceNumber>(talk: &mut Talk<'_, N>) -> Result<String, CliError> {
    let status = talk.status()?;
    Ok(match stands(&status, &talk.units()) {
        Some([x, y, alpha]) => format!("stands at x {x:.6} m, y {y:.6} m, alpha {alpha:.6} rad\n"),
        None => format!("{}\n", describe::state(status.state, status.acting)),
    })
}

fn names(rack: &ToolRack) -> String {
    let names: Vec<&str> = rack.tools().iter().map(|tool| tool.name.as_str()).collect();
    names.join(", ")
}
