//! Writes every shipped scene as the constants of an image, in every number type that it fits, for
//! the test that looks whether they are the bits that the host builds.

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::{env, fs};
use trirrr_image::generate::{SCALARS, source};
use trirrr_scene::{Scene, units_of_scene};

fn main() -> Result<(), Box<dyn Error>> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").ok_or("no CARGO_MANIFEST_DIR")?);
    let scenes = root.join("../../scenes");
    println!("cargo:rerun-if-changed={}", scenes.display());
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("no OUT_DIR")?);
    let mut list = String::from("images! {\n");
    let mut files: Vec<PathBuf> = fs::read_dir(&scenes)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()?;
    files.retain(|file| {
        file.extension()
            .is_some_and(|extension| extension == "toml")
    });
    files.sort();
    for file in files {
        let scene = Scene::read(&file)?;
        for (name, scalar) in SCALARS {
            if *name == "fixed" && units_of_scene(&scene).is_err() {
                continue;
            }
            let module = format!("{}_{name}", scene.name.replace('-', "_"));
            fs::write(
                out.join(&module).with_extension("rs"),
                source(&scene, scalar)?,
            )?;
            writeln!(list, "    {module} = \"/{module}.rs\";")?;
        }
    }
    list.push('}');
    fs::write(out.join("images.rs"), list)?;
    Ok(())
}
