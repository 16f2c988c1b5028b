//! `trirrr tool`: shows which tool a machine carries, and mounts another.

use super::geometry::{read_platform, stands};
use super::talk::Talk;
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::terminal::print;
use clap::Args;
use std::sync::atomic::AtomicBool;
use trirrr_client::describe;
use trirrr_protocol::message::Command;
use trirrr_protocol::message::scene::{Platform, Section};
use trirrr_scene::{MountableTool, Scene, ToolRack, in_number_type};
use trirrr_service::ServiceNumber;

/// Relative difference of values that a board has taken into its units and back.
const ROUNDING: f64 = 1e-9;

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
    in_number_type!(args.machine.scalar.unwrap_or(scene.number), N => {
        let mut talk = Talk::<N>::open(&args.machine, &scene, stop)?;
        match wanted {
            Some(index) => mount(&mut talk, &scene, rack, index),
            None => show(&mut talk, &scene, rack),
        }
    })
}

/// Checks that the board of `scene` carries the tool that the scene has mounted: its job is planned for that one.
///
/// # Errors
/// Refused: another tool, with the command that mounts this one. Failed: the port, or the board.
pub(crate) fn require_mounted<N: ServiceNumber>(
    args: &MachineArgs,
    scene: &Scene,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    let Some(rack) = &scene.tools else {
        return Ok(());
    };
    let mut talk = Talk::<N>::open(args, scene, stop)?;
    let found = mounted(&read_platform(&mut talk)?, scene, rack);
    if found == Some(rack.mounted()) {
        return Ok(());
    }
    let of = |index: usize| rack.tools()[index].name.as_str();
    Err(CliError::Refused(format!(
        "the machine carries {}, and the job is for the tool {:?}: `trirrr tool SCENE --port PORT --mount {}` once that is on it, or \
         `--set mounted=NAME` for a job with another",
        found.map_or("no tool of the scene".into(), |index| format!(
            "the tool {:?}",
            of(index)
        )),
        of(rack.mounted()),
        of(rack.mounted()),
    )))
}

fn show<N: ServiceNumber>(
    talk: &mut Talk<'_, N>,
    scene: &Scene,
    rack: &ToolRack,
) -> Result<(), CliError> {
    let found = mounted(&read_platform(talk)?, scene, rack);
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
    if mounted(&read_platform(talk)?, scene, rack) != Some(index) {
        return Err(CliError::Failed(
            "the board has not taken the tool: it tells another platform".into(),
        ));
    }
    let text = format!("mounted: {}\n", line(&rack.tools()[index]));
    print(&(text + &pose(talk)?))
}

/// Index of the tool that `platform` carries; none of a platform with no tool of `rack`.
fn mounted(platform: &Platform, scene: &Scene, rack: &ToolRack) -> Option<usize> {
    let values = |of: &Platform| {
        let [[cx, cy], [tx, ty]] = [of.com_m, of.tool_point_m];
        [of.mass_kg, of.inertia_kgm2, cx, cy, tx, ty]
    };
    let told = values(platform);
    (0..rack.tools().len()).find(|&index| {
        let own = values(&Platform::from(&rack.put_into(&scene.parameters, index)));
        let pairs = told.iter().zip(own);
        // Lengths are compared in m, whatever their direction.
        let largest = |a: f64, b: f64| a.abs().max(b.abs()).max(1e-3);
        pairs
            .into_iter()
            .all(|(a, b)| (a - b).abs() <= ROUNDING * largest(*a, b))
    })
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
