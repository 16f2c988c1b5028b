//! Scene whose values a command has found: copies of its files with these values, beside the results.

use crate::arguments::{BUILT_IN, DEFAULT_SCENE};
use crate::failure::CliError;
use crate::results::ResultFolder;
use std::path::{Path, PathBuf};
use trirrr_calibration::ScenePatch;
use trirrr_scene::Scene;
use trirrr_scene::read::files::is_stream;

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
    /// Names of the copies of the files of `scene`, which was read from `file`.
    pub(crate) fn names(scene: &Scene, file: &Path) -> Vec<String> {
        let name = file_name(file);
        let machine = scene.machine_file.as_ref();
        let machine = machine.map(|machine| match file_name(machine) {
            same if same == name => format!("machine-{same}"),
            other => other,
        });
        std::iter::once(name).chain(machine).collect()
    }

    /// Takes the files of `scene`, which was read from `file`.
    ///
    /// # Errors
    /// Refused: a file cannot be read again.
    pub(crate) fn of(scene: &Scene, file: &Path) -> Result<Self, CliError> {
        let text = match file == Path::new(DEFAULT_SCENE) && !file.exists() {
            true => BUILT_IN[0].1.to_owned(),
            false => text_of(file)?,
        };
        let mut names = Self::names(scene, file).into_iter();
        let name = names.next().unwrap_or_default();
        let refused = |error: String| CliError::Refused(format!("{}: {error}", file.display()));
        let machine = match scene.machine_file.as_ref().zip(names.next()) {
            None => None,
            Some((machine, own)) => {
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

    /// Writes the copies into the folder of `results`, below the lines of `head`, and reads them as every command does.
    ///
    /// # Errors
    /// Those of [`ResultFolder::write`].
    pub(crate) fn write(
        &self,
        results: &mut ResultFolder,
        head: &[String],
    ) -> Result<WrittenScene, CliError> {
        let scene = self.scene.text(head);
        let machine = self.machine.as_ref();
        let machine = machine.map(|(name, patch)| (name, patch.text(head)));
        let mut files = vec![results.write(&self.name, scene.as_str())?];
        if let Some((name, text)) = &machine {
            files.push(results.write(name, text.as_str())?);
        }
        let text = machine.map(|(_, text)| text);
        let machines = |_: &Path| text.clone().ok_or_else(|| "no machine".to_owned());
        let name = files[0].display().to_string();
        let (read, _) = Scene::parse_shown(&scene, &name, &[], &machines);
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

/// Name of the copy of a file. A pipe has no name of its own.
fn file_name(file: &Path) -> String {
    if is_stream(file) {
        return "scene.toml".into();
    }
    let name = file.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
