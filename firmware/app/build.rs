//! Writes the scene's constants and types, and hands its kinds on to the boards.

use std::error::Error;
use std::path::Path;
use std::process;

fn main() {
    if let Err(error) = build() {
        // Printed as text: the user reads about a scene, not about a build script.
        eprintln!("{error}");
        process::exit(1);
    }
}

fn build() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    trirrr_image::generate::build_script(&root)
}
