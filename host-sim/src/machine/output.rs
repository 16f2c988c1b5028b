//! `trirrr output`: shows the spare outputs and inputs of a machine, and switches an output.

use super::talk::Talk;
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::numbers::in_boards_numbers;
use crate::terminal::print;
use clap::{Args, ValueEnum};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use trirrr_protocol::message::{Command, DigitalStates};
use trirrr_scene::{Scene, in_number_type};
use trirrr_service::ServiceNumber;

/// Time from one look at the machine to the next.
const LOOK: Duration = Duration::from_millis(5);

/// Looks at the machine until the tick has switched the output: at least a tick of the slowest scene.
const LOOKS: u32 = 400;

/// `trirrr output`.
///
/// Shows which spare outputs of a machine are on, and which spare inputs are active. With a name and a level, switches that
/// output first: off in every state, on only while the drives are on.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
An output with job_only = true goes on once a job runs, and off with it. All outputs are off in a fault and while the drives are off.")]
pub struct OutputArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// Output to switch, by its name in the scene
    #[arg(value_name = "NAME", requires = "level")]
    pub name: Option<String>,
    /// Its level from now on
    #[arg(value_name = "LEVEL")]
    pub level: Option<OutputLevel>,
}

/// Level of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OutputLevel {
    /// On.
    On,
    /// Off.
    Off,
}

/// Shows the outputs and inputs, and switches an output before.
///
/// # Errors
/// Refused: the scene, a name of no output, or by the board. Failed: the port, or the board.
pub fn output(args: &OutputArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let scene = args.machine.set.scene(&args.machine.scene)?;
    if !scene.spare_pins.are_named() {
        return Err(CliError::Refused(format!(
            "scene {}: names no spare outputs or inputs: [[io.outputs]] and [[io.inputs]] would",
            scene.name
        )));
    }
    let wanted = match (&args.name, args.level) {
        (Some(name), Some(level)) => Some((numbered(&scene, name)?, level == OutputLevel::On)),
        _ => None,
    };
    in_boards_numbers(args.machine.scalar, scene.number, |number| {
        in_number_type!(number, N => {
            let mut talk = Talk::<N>::open(&args.machine, &scene, stop)?;
            if let Some((index, on)) = wanted {
                switch(&mut talk, &scene, index, on)?;
            }
            let states = states(&mut talk)?;
            print(&lines(&scene, &states))
        })
    })
}

fn numbered(scene: &Scene, name: &str) -> Result<u8, CliError> {
    scene.spare_pins.output(name).ok_or_else(|| {
        let outputs = scene.spare_pins.output_names();
        let known = match outputs.is_empty() {
            true => "it names none".into(),
            false => format!("its outputs are {}", outputs.join(", ")),
        };
        CliError::Refused(format!(
            "scene {}: has no output {name:?}; {known}",
            scene.name
        ))
    })
}

fn switch<N: ServiceNumber>(
    talk: &mut Talk<'_, N>,
    scene: &Scene,
    index: u8,
    on: bool,
) -> Result<(), CliError> {
    talk.done(Command::Output { index, on })?;
    let is_job_only = |output: &trirrr_scene::SpareOutput| output.job_only;
    let output = scene.spare_pins.outputs.get(usize::from(index));
    if output.is_some_and(is_job_only) && on {
        // It may wait for a job.
        return Ok(());
    }
    for _ in 0..LOOKS {
        if (states(talk)?.outputs >> index & 1 != 0) == on {
            return Ok(());
        }
        talk.listen(LOOK)?;
    }
    let level = if on { "on" } else { "off" };
    Err(CliError::Failed(format!(
        "the board has not switched the output {level}: a fault, or another client"
    )))
}

fn states<N: ServiceNumber>(talk: &mut Talk<'_, N>) -> Result<DigitalStates, CliError> {
    let digital = talk.status()?.digital;
    digital.ok_or_else(|| {
        CliError::Failed("the board tells nothing of spare outputs and inputs".into())
    })
}

/// The states, a line for each output and input.
fn lines(scene: &Scene, states: &DigitalStates) -> String {
    let mut text = String::new();
    for (index, output) in scene.spare_pins.outputs.iter().enumerate() {
        let level = if states.outputs >> index & 1 != 0 {
            "on"
        } else {
            "off"
        };
        text += &format!("output P{index} {}: {level}\n", output.name);
    }
    for (index, input) in scene.spare_pins.inputs.iter().enumerate() {
        let level = if states.inputs >> index & 1 != 0 {
            "active"
        } else {
            "not active"
        };
        text += &format!("input P{index} {}: {level}\n", input.name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use trirrr_client::describe;

    #[test]
    fn outputs_are_found_by_name_and_told_line_by_line() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/inputs/valves.toml");
        let scene = Scene::read(file).expect("a shipped scene");
        assert_eq!(numbered(&scene, "vacuum").expect("an output"), 1);
        let said = numbered(&scene, "sheet").expect_err("an input").to_string();
        assert!(said.contains("its outputs are air, vacuum"), "{said}");
        let states = DigitalStates {
            inputs: 1,
            outputs: 2,
            tick: 5,
        };
        let expected = "output P0 air: off\noutput P1 vacuum: on\ninput P0 sheet: active\n";
        assert_eq!(lines(&scene, &states), expected);
        let said = describe::digital(&states, &scene.spare_pins);
        assert_eq!(said, "outputs on: vacuum; inputs active: sheet");
    }
}
