//! `[io]`: status lamp, spare outputs and spare inputs of a board.

use crate::inputs::{NormalContact, read_contact_ticks, read_normal_contact};
use crate::read::Section;
use trirrr_service::features::DigitalParameters;

/// Most outputs of a scene, and most inputs.
const MOST_PINS: usize = trirrr_protocol::message::DIGITAL;

/// Spare outputs and inputs that a scene names. Their places in it are their numbers, from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SparePins {
    /// Outputs.
    pub outputs: Vec<SpareOutput>,
    /// Inputs.
    pub inputs: Vec<SpareInput>,
}

/// Spare output of a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SpareOutput {
    /// Name: letters, digits, `-` and `_`.
    pub name: String,
    /// The output is on only while a job runs, as a tool is.
    pub job_only: bool,
}

/// Spare input of a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SpareInput {
    /// Name: letters, digits, `-` and `_`.
    pub name: String,
    /// Ticks of a change without bounces; at least 1.
    pub debounce_ticks: u16,
    /// Position of the contact while the input is not active.
    pub normally: NormalContact,
}

impl SparePins {
    /// Returns true if there is any.
    pub fn are_named(&self) -> bool {
        !self.outputs.is_empty() || !self.inputs.is_empty()
    }

    /// Returns the number of the output `name`.
    pub fn output(&self, name: &str) -> Option<u8> {
        let found = self.outputs.iter().position(|output| output.name == name);
        found.map(|index| index as u8)
    }

    /// Returns the names of the outputs.
    pub fn output_names(&self) -> Vec<&str> {
        let names = self.outputs.iter().map(|output| output.name.as_str());
        names.collect()
    }

    /// Returns the settings of a service.
    pub fn parameters(&self) -> DigitalParameters {
        let mut debounce_ticks = [1; MOST_PINS];
        for (ticks, input) in debounce_ticks.iter_mut().zip(&self.inputs) {
            *ticks = input.debounce_ticks;
        }
        let in_jobs = self.outputs.iter().enumerate();
        DigitalParameters {
            outputs: self.outputs.len() as u8,
            in_jobs: in_jobs.fold(0, |bits, (index, output)| {
                bits | u8::from(output.job_only) << index
            }),
            inputs: self.inputs.len() as u8,
            debounce_ticks,
        }
    }

    /// Returns the inputs that are active at a high level, a bit for each: a contact to ground that opens.
    pub fn active_high(&self) -> u8 {
        let inputs = self.inputs.iter().enumerate();
        inputs.fold(0, |bits, (index, input)| {
            bits | u8::from(input.normally == NormalContact::Closed) << index
        })
    }
}

/// Reads `[io]`: true if the machine has a status lamp, and its spare pins. Without a tick rate, no time is checked in ticks.
pub(crate) fn read_io(root: &Section, rate: Option<f64>) -> Option<(bool, SparePins)> {
    if !root.has("io") {
        return Some((false, SparePins::default()));
    }
    let section = root.section("io")?;
    let has_pins = section.has("outputs") || section.has("inputs");
    let has_lamp = match has_pins && !section.has("lamp") {
        true => Some(false),
        false => section.boolean("lamp"),
    };
    let outputs = read_list(&section, "outputs", read_output);
    let inputs = read_list(&section, "inputs", |each| read_input(each, rate));
    let (has_lamp, outputs, inputs) = (has_lamp?, outputs?, inputs?);
    let output_names = outputs.iter().map(|(_, output)| &output.name);
    let names: Vec<&String> = output_names
        .chain(inputs.iter().map(|(_, input)| &input.name))
        .collect();
    let sections = outputs.iter().map(|(section, _)| section);
    let sections = sections.chain(inputs.iter().map(|(section, _)| section));
    let mut is_good = true;
    for (index, section) in sections.enumerate() {
        if names[..index].contains(&names[index]) {
            let reason = "another of [[io.outputs]] and [[io.inputs]] has this name";
            section.refuse("name", reason);
            is_good = false;
        }
    }
    let pins = SparePins {
        outputs: outputs.into_iter().map(|(_, output)| output).collect(),
        inputs: inputs.into_iter().map(|(_, input)| input).collect(),
    };
    is_good.then_some((has_lamp, pins))
}

/// Reads each table of a list, and keeps it for the place of what is refused later.
fn read_list<'d, 't, T>(
    section: &Section<'d, 't>,
    key: &'d str,
    read: impl Fn(&Section<'d, 't>) -> Option<T>,
) -> Option<Vec<(Section<'d, 't>, T)>> {
    let sections = section.sections(key)?;
    if sections.len() > MOST_PINS {
        let found = sections.len();
        let reason = format!("expected at most {MOST_PINS} [[io.{key}]], found {found}");
        section.refuse_list(key, reason);
        return None;
    }
    let each = sections.into_iter().map(|section| {
        let value = read(&section);
        value.map(|value| (section, value))
    });
    // All are looked at before the first refusal counts.
    each.collect::<Vec<_>>().into_iter().collect()
}

fn read_output(section: &Section) -> Option<SpareOutput> {
    let name = section.folder_name("name");
    let job_only = match section.has("job_only") {
        true => section.boolean("job_only"),
        false => Some(false),
    };
    Some(SpareOutput {
        name: name?,
        job_only: job_only?,
    })
}

/// Reads an input. Most contacts are open until they tell something.
fn read_input(section: &Section, rate: Option<f64>) -> Option<SpareInput> {
    let name = section.folder_name("name");
    let debounce = read_contact_ticks(section, rate);
    let normally = match section.has("normally") {
        true => read_normal_contact(section),
        false => Some(NormalContact::Open),
    };
    Some(SpareInput {
        name: name?,
        debounce_ticks: debounce?,
        normally: normally?,
    })
}
