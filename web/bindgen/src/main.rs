//! Writes JavaScript and types for a module of the page: `trirrr-web-bindgen MODULE.wasm FOLDER NAME`.
//!
//! The generator has to be of exactly the version of `wasm-bindgen` that the module was compiled with. As a program of the workspace it is,
//! by `Cargo.lock`. The command line tool of wasm-bindgen compiles a web server and an HTTP client beside the same library.

use anyhow::{Result, bail};
use std::env;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [module, folder, name] = arguments.as_slice() else {
        bail!("expected the module, the folder for its JavaScript, and its name");
    };
    Bindgen::new()
        .input_path(module)
        .out_name(name)
        .web(true)?
        .omit_default_module_path(true)
        .typescript(true)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(folder)
}
