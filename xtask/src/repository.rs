//! Places of the files in the repository, and the call of Cargo.

use anyhow::{Context, Result, bail, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};
use trirrr_scene::Scene;

/// The repository's root.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("xtask lies in the root")
}

/// Cargo, to be run in the root.
pub(crate) fn cargo() -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

/// Returns the directory where Cargo puts what it builds.
pub(crate) fn target_directory() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |dir| root().join(dir))
}

/// A scene file of the repository or elsewhere.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct SceneFile {
    /// The file's name without `.toml`: the scene's name in tables and budgets.
    pub(crate) name: String,
    /// The file.
    pub(crate) path: PathBuf,
}

/// The scene that `name` means: a path, or the name of one in `scenes/`.
fn scene(name: &str) -> Result<SceneFile> {
    let shipped = root().join("scenes").join(format!("{name}.toml"));
    let path = if shipped.is_file() {
        shipped
    } else {
        let path = env::current_dir()?.join(name);
        if !path.is_file() {
            let known: Vec<String> = scenes()?.into_iter().map(|scene| scene.name).collect();
            bail!(
                "{name}: neither a file nor a scene of the repository ({})",
                known.join(", ")
            );
        }
        path
    };
    scene_file(path)
}

/// The scenes that `names` mean; without names, all scenes in `scenes/`.
pub(crate) fn scenes_named(names: &[String]) -> Result<Vec<SceneFile>> {
    if names.is_empty() {
        return scenes();
    }
    names.iter().map(|name| scene(name)).collect()
}

/// All scenes in `scenes/` that are for a board, by name: those with a plant are the simulator's.
fn scenes() -> Result<Vec<SceneFile>> {
    let directory = root().join("scenes");
    let mut found = Vec::new();
    for entry in fs::read_dir(&directory).with_context(|| directory.display().to_string())? {
        let path = entry?.path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
            && Scene::read(&path)?.plant.is_none()
        {
            found.push(scene_file(path)?);
        }
    }
    found.sort();
    Ok(found)
}

fn scene_file(path: PathBuf) -> Result<SceneFile> {
    let name = path
        .file_stem()
        .and_then(|stem| stem.to_str())
        .with_context(|| format!("{}: not a name that can be printed", path.display()))?
        .to_owned();
    Ok(SceneFile { name, path })
}

/// Returns what `command` prints. It has to end well.
pub(crate) fn text(command: &mut Command) -> Result<String> {
    let output = command.output();
    let output = output.with_context(|| format!("{command:?} cannot be run"))?;
    ensure!(output.status.success(), "{command:?} failed");
    String::from_utf8(output.stdout).with_context(|| format!("{command:?} printed no text"))
}

/// Returns what the compiler prints of itself.
pub(crate) fn rustc(option: &str) -> Result<String> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    text(Command::new(rustc).current_dir(root()).arg(option))
}

/// The compiler, as `rustc 1.95.0`.
pub(crate) fn compiler() -> Result<String> {
    let text = rustc("--version")?;
    Ok(text
        .split_whitespace()
        .take(2)
        .collect::<Vec<_>>()
        .join(" "))
}
