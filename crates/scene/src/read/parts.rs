//! A scene whose parts stand in several places: its file, the file of its machine, arguments.

use super::files::is_stream;
use super::{Document, MachineTexts, Place, Setting, TextPart};
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Key of the file that describes the machine.
const MACHINE: &str = "machine";

/// Keys that a scene does not take from the file of its machine.
const OWN: [&str; 3] = ["name", "description", "job"];

/// Name of arguments in messages.
const ARGUMENT: &str = "--set";

/// Name of the file that has the machine of the scene in `text`, as the scene writes it, if the machine has a file of its own.
pub fn machine_file_of(text: &str) -> Option<String> {
    let (root, _) = DeTable::parse_recoverable(text);
    let named = root.get_ref().get(MACHINE)?;
    named.get_ref().as_str().map(str::to_owned)
}

/// Path of the file that the scene in `scene` names as that of its machine: beside the scene, for one that comes through a pipe in the
/// folder of the program.
pub fn machine_path(scene: &Path, name: &str) -> PathBuf {
    let folder = scene.parent().filter(|_| !is_stream(scene));
    folder.unwrap_or(Path::new("")).join(name)
}

/// Text of a scene with all that it takes from elsewhere behind its own: spans count through the whole.
pub struct SceneText {
    /// The whole text.
    pub text: String,
    pub(super) parts: Vec<TextPart>,
    /// Length of the scene's own text.
    own: usize,
    /// File that `machine` names, if the machine has a file of its own.
    pub machine_file: Option<PathBuf>,
    machine_span: Option<Range<usize>>,
    /// Reason why there is no text of the machine.
    missing: Option<String>,
}

impl SceneText {
    /// The text of the scene in `file`, with that of the machine which `root` names, from `machines`, and of `settings`.
    pub(super) fn new(
        text: &str,
        file: &str,
        root: &DeTable,
        settings: &[Setting],
        machines: &MachineTexts,
    ) -> Self {
        let mut whole = Self {
            text: text.to_owned(),
            own: text.len(),
            parts: Vec::new(),
            machine_file: None,
            machine_span: None,
            missing: None,
        };
        let named = root.get(MACHINE).and_then(|value| value.get_ref().as_str());
        if let Some(name) = named {
            let path = machine_path(Path::new(file), name);
            match machines(&path) {
                Ok(machine) => {
                    let begin = whole.add(&path.display().to_string(), &machine, true);
                    whole.machine_span = Some(begin..begin + machine.len());
                }
                Err(reason) => whole.missing = Some(reason),
            }
            whole.machine_file = Some(path);
        }
        for setting in settings {
            whole.add(ARGUMENT, &setting.to_string(), false);
        }
        whole
    }

    /// The text by which a board and a host know that they have the same scene. An argument that mounts another of its tools is no part
    /// of it: a board exchanges them.
    pub(crate) fn keyed(&self) -> String {
        let mut text = self.text[..self.own].to_owned();
        let ends = self.parts.iter().skip(1).map(|part| part.begin);
        for (part, end) in self.parts.iter().zip(ends.chain([self.text.len()])) {
            let own = &self.text[part.begin..end];
            if !part.has_lines && own.starts_with("mounted =") {
                continue;
            }
            if !text.ends_with('\n') {
                text.push('\n');
            }
            text.push_str(own);
        }
        text
    }

    /// Adds a part on lines of its own, and returns its begin.
    fn add(&mut self, name: &str, part: &str, has_lines: bool) -> usize {
        if !self.text.ends_with('\n') {
            self.text.push('\n');
        }
        let begin = self.text.len();
        self.text.push_str(part);
        let name = name.to_owned();
        self.parts.push(TextPart {
            begin,
            name,
            has_lines,
        });
        begin
    }

    /// Texts of the parts behind the first, as TOML in which spans are those of the whole text.
    pub(super) fn padded(&self, settings: &[Setting]) -> PaddedParts {
        let machine = self.machine_span.clone().map(|span| {
            let mut padded = " ".repeat(span.start);
            padded.push_str(self.text.get(span).unwrap_or_default());
            padded
        });
        let arguments = self.parts.iter().filter(|part| !part.has_lines);
        let settings = arguments.zip(settings).map(|(part, setting)| {
            // The key becomes one letter, so that the value stays where it is.
            let pad = part.begin + setting.key.len() - 1;
            format!("{}v = {}", " ".repeat(pad), setting.value)
        });
        let settings = settings.collect();
        PaddedParts { machine, settings }
    }

    /// Puts the parts into the scene's `root`, and refuses what does not go together.
    pub(super) fn merge<'t>(
        &self,
        document: &Document,
        root: &mut DeTable<'t>,
        padded: &'t PaddedParts,
        settings: &[Setting],
    ) {
        if self.machine_file.is_some() {
            self.merge_machine(document, root, padded);
        }
        for (setting, text) in settings.iter().zip(&padded.settings) {
            // It is good TOML: that is what makes a setting.
            let (mut table, _) = DeTable::parse_recoverable(text);
            let Some(value) = table.get_mut().remove("v") else {
                continue;
            };
            let place = place(document, &setting.key, &value);
            if let Err(reason) = setting.put(root, value) {
                document.refuse(&place, reason);
            }
        }
    }

    fn merge_machine<'t>(
        &self,
        document: &Document,
        root: &mut DeTable<'t>,
        padded: &'t PaddedParts,
    ) {
        let Some(named) = root.remove(MACHINE) else {
            return;
        };
        let here = place(document, MACHINE, &named);
        if let Some(reason) = &self.missing {
            document.refuse(&here, reason);
        }
        let Some(text) = &padded.machine else {
            return;
        };
        let Some(mut machine) = super::root_of(document, text) else {
            return;
        };
        match machine.get(MACHINE) {
            None => document.refuse(&here, "the file has no [[machine.leg]]"),
            Some(other) if other.get_ref().is_str() => {
                let reason = "the file of a machine takes no machine from another file";
                document.refuse(&place(document, MACHINE, other), reason);
            }
            Some(_) => {}
        }
        for own in OWN {
            machine.remove(own);
        }
        for (key, value) in machine {
            root.entry(key).or_insert(value);
        }
    }
}

/// Texts that the tables of a scene borrow from.
pub(super) struct PaddedParts {
    machine: Option<String>,
    settings: Vec<String>,
}

fn place(document: &Document, key: &str, value: &Spanned<DeValue>) -> Place {
    Place {
        line: document.line(value.span().start),
        column: document.column(value.span().start),
        key: key.to_owned(),
        value: Some(document.quote(value.span())),
    }
}
