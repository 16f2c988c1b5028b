//! Writes the scene's constants and types.

use std::error::Error;
use std::path::Path;
use std::process;

fn main() {
    if let Err(error) = build() {
        // In the error's own words: it is the user's scene that it is about.
        eprintln!("{error}");
        process::exit(1);
    }
}

fn build() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    trirrr_image::generate::build_script(&root)
}
