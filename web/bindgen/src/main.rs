//! Writes JavaScript and types for a module of the page, and the module compressed: `trirrr-web-bindgen MODULE.wasm FOLDER NAME`.
//!
//! The generator has to be of exactly the version of `wasm-bindgen` that the module was compiled with. As a program of the workspace it is,
//! by `Cargo.lock`. The command line tool of wasm-bindgen compiles a web server and an HTTP client beside the same library.

use anyhow::{Context, Result, bail};
use lzma_rust2::{LzmaOptions, LzmaWriter};
use std::io::Write;
use std::path::Path;
use std::{env, fs};
use wasm_bindgen_cli_support::Bindgen;

/// Places that are tried for each match.
const DEPTH: i32 = 512;

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [module, folder, name] = arguments.as_slice() else {
        bail!("expected the module, the folder for its JavaScript, and its name there");
    };
    Bindgen::new()
        .input_path(module)
        .out_name(name)
        .web(true)?
        .omit_default_module_path(true)
        .typescript(true)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(folder)?;
    compress(Path::new(folder), name)
}

/// Writes `NAME.lzma` beside `NAME_bg.wasm`. Its dictionary holds the whole module: functions that are the same for several number types
/// are megabytes apart.
fn compress(folder: &Path, name: &str) -> Result<()> {
    let file = folder.join(format!("{name}_bg.wasm"));
    let module = fs::read(&file).with_context(|| file.display().to_string())?;
    let mut options = LzmaOptions::with_preset(9);
    // Code has no words of four bytes, as the preset assumes.
    (options.lc, options.lp, options.pb) = (4, 0, 0);
    options.nice_len = LzmaOptions::NICE_LEN_MAX;
    options.depth_limit = DEPTH;
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(module.len() as u64))?;
    writer.write_all(&module)?;
    let file = folder.join(format!("{name}.lzma"));
    fs::write(&file, writer.finish()?).with_context(|| file.display().to_string())
}
