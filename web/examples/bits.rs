//! Prints a hash over the bits of every shipped scene's job: `bits [TICKS]`. The page's test compares the hashes with WebAssembly.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// Ticks of each scene without an argument.
const TICKS: u32 = 1000;

fn main() -> Result<(), String> {
    let ticks = match env::args().nth(1) {
        Some(ticks) => ticks
            .parse()
            .map_err(|error| format!("{ticks}: a number of ticks is expected: {error}"))?,
        None => TICKS,
    };
    for file in scenes()? {
        let text =
            fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let machine = machine_of(&text)?;
        let file = format!("{name}.toml");
        let hash = trirrr_web::bits_of(&text, &file, machine, ticks)?;
        println!("{name} {hash}");
    }
    Ok(())
}

/// Folder of the shipped scenes.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

/// Text of the file that the scene in `text` takes its machine from: one of the shipped ones.
fn machine_of(text: &str) -> Result<Option<String>, String> {
    let Some(name) = trirrr_web::machine_file(text) else {
        return Ok(None);
    };
    let file = folder().join(name);
    let read = fs::read_to_string(&file);
    read.map(Some)
        .map_err(|error| format!("{}: {error}", file.display()))
}

/// The shipped scenes of 3-RRR machines.
fn scenes() -> Result<Vec<PathBuf>, String> {
    let scenes = folder();
    let mut files = Vec::new();
    for folder in ["", "paths", "design", "inputs"] {
        let folder = scenes.join(folder);
        let entries =
            fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        for entry in entries {
            let path = entry.map_err(|error| error.to_string())?.path();
            if path
                .extension()
                .is_some_and(|extension| extension == "toml")
            {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}
