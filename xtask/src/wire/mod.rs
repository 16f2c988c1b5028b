//! `cargo xtask wire`: the reference in `docs/wire.md`, and the messages and texts of the Python client, from the types of the
//! protocol.
//!
//! Names, types, order and numbers come from the compiled types' schema. Meanings come from their doc comments, texts for people
//! from the matches of `describe` and its like.

mod docs;
mod python;
mod reference;
mod texts;
mod types;

use crate::repository::root;
use anyhow::{Context, Result, ensure};
use docs::Docs;
use std::fs;
use trirrr_core::number::{Coarse, Fixed};
use trirrr_protocol::message::{Message, Request, Transmit};
use trirrr_protocol::wire::schema;
use types::Types;

const REFERENCE: &str = "docs/wire.md";

#[derive(clap::Args)]
pub(crate) struct WireArgs {
    /// Fail where a file is not as it would be written
    #[arg(long)]
    check: bool,
}

pub(crate) fn run(arguments: &WireArgs) -> Result<()> {
    let types = Types::read();
    let docs = Docs::read()?;
    let old = fs::read_to_string(root().join(REFERENCE)).context(REFERENCE)?;
    let files = [
        (REFERENCE, reference::written(&old, &types, &docs)?),
        (python::MESSAGES, python::messages(&types)),
        (python::TEXTS, texts::written()?),
    ];
    let mut stale = Vec::new();
    for (name, text) in files {
        let file = root().join(name);
        if fs::read_to_string(&file).is_ok_and(|found| found == text) {
            continue;
        }
        stale.push(name);
        if !arguments.check {
            fs::write(&file, text).context(name)?;
        }
    }
    ensure!(
        !arguments.check || stale.is_empty(),
        "not as the protocol's types are: {}; cargo xtask wire writes them",
        stale.join(", ")
    );
    println!(
        "{}",
        if stale.is_empty() {
            "as written".into()
        } else {
            stale.join("\n")
        }
    );
    Ok(())
}

/// Number types of machines: name in scenes, `N` and `Angle` on the line, schema key.
fn numbers() -> [(&'static str, &'static str, &'static str, u64); 4] {
    fn key<N: Transmit>() -> u64 {
        schema::key::<Request<N>, Message<N>>()
    }
    [
        ("f64", "f64", "f64, rad", key::<f64>()),
        ("f32", "f32", "f32, rad", key::<f32>()),
        ("micromath", "f32", "f32, rad", key::<Coarse>()),
        (
            "fixed",
            "i32, in 2^-29",
            "i64, in 2^-32 of a turn",
            key::<Fixed>(),
        ),
    ]
}
