//! Scene whose values a command has found: copies of its files with these values, beside the results.

use crate::arguments::{BUILT_IN, DEFAULT_SCENE};
use crate::failure::CliError;
use crate::recording::unwritable;
use std::path::{Path, PathBuf};
use trirrr_calibration::ScenePatch;
use trirrr_scene::Scene;

/// Copies of a scene's file, and of that of its machine where the scene names one.
pub(crate) struct PatchedScene {
    name: String,
    scene: ScenePatch,
    /// File name of the machine, and its text.
    machine: Option<(String, ScenePatch)>,
}

/// Written copies.
pub(crate) struct WrittenScene {
    pub(crate) files: Vec<PathBuf>,
    /// Reason for which the reader refuses the copy.
    pub(crate) refusal: Option<String>,
}

impl PatchedScene {
    /// Takes the files of `scene`, which was read from `file`.
    ///
    /// # Errors
    /// Refused: a file cannot be read again.
    pub(crate) fn of(scene: &Scene, file: &Path) -> Result<Self, CliError> {
        let text = match file == Path::new(DEFAULT_SCENE) && !file.exists() {
            true => BUILT_IN[0].1.to_owned(),
            false => text_of(file)?,
        };
        let name = file_name(file);
        let refused = |error: String| CliError::Refused(format!("{}: {error}", file.display()));
        let machine = match &scene.machine_file {
            None => None,
            Some(machine) => {
                let own = match file_name(machine) {
                    same if same == name => format!("machine-{same}"),
                    other => other,
                };
                let patch = ScenePatch::of(&text_of(machine)?).map_err(refused)?;
                Some((own, patch))
            }
        };
        let mut scene = ScenePatch::of(&text).map_err(refused)?;
        if let Some((own, _)) = &machine {
            scene.put_text("machine", own);
        }
        Ok(Self {
            name,
            scene,
            machine,
        })
    }

    /// The file that has the table in which `path` begins: a table of the scene goes before the same of its machine.
    pub(crate) fn at(&mut self, path: &str) -> &mut ScenePatch {
        let top = path.split(['.', '[']).next().unwrap_or(path);
        match &mut self.machine {
            Some((_, machine)) if top == "machine" || !self.scene.has(top) => machine,
            _ => &mut self.scene,
        }
    }

    /// Writes the copies into `folder`, below the lines of `head`, and reads them as every command does.
    ///
    /// # Errors
    /// Failed: a file cannot be written.
    pub(crate) fn write(&self, folder: &Path, head: &[String]) -> Result<WrittenScene, CliError> {
        let machine = self.machine.iter().map(|(name, patch)| (name, patch));
        let mut files = Vec::new();
        for (name, patch) in std::iter::once((&self.name, &self.scene)).chain(machine) {
            let path = folder.join(name);
            std::fs::write(&path, patch.text(head)).map_err(|error| unwritable(&path, &error))?;
            files.push(path);
        }
        let read = Scene::read(folder.join(&self.name));
        let refusal = read.err().map(|error| error.to_string());
        Ok(WrittenScene {
            files,
            refusal: refusal.and_then(|text| text.lines().next().map(str::to_owned)),
        })
    }
}

fn text_of(file: &Path) -> Result<String, CliError> {
    trirrr_scene::read::text_of(file).map_err(|error| CliError::Refused(error.to_string()))
}

fn file_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
