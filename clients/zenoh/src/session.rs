//! Sessions of Zenoh: that of a program with machines, and that of a router.

use crate::error::ZenohError;
use std::path::Path;
use zenoh::{Config, Session, Wait};

/// Part that a program has in the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionMode {
    /// Talks to a router, and connects again where the router was lost.
    Client,
    /// Passes on what others say.
    Router,
}

/// Opens a session. `config` is a file of Zenoh's configuration, whose values stand unless they are given here: the mode is,
/// and `endpoints` to connect to, or to listen at for a router, where there are any. Without a file nobody is looked for by
/// multicast.
///
/// # Errors
/// Refused: the file or an endpoint. Failed: no router answers, or an address cannot be listened at.
pub fn open(
    mode: SessionMode,
    config: Option<&Path>,
    endpoints: &[String],
) -> Result<Session, ZenohError> {
    let mut settings = match config {
        Some(file) => Config::from_file(file)
            .map_err(|error| ZenohError::Refused(format!("{}: {error}", file.display())))?,
        None => {
            let mut settings = Config::default();
            set(&mut settings, "scouting/multicast/enabled", "false")?;
            settings
        }
    };
    let (mode, place) = match mode {
        SessionMode::Client => ("\"client\"", "connect/endpoints"),
        SessionMode::Router => ("\"router\"", "listen/endpoints"),
    };
    set(&mut settings, "mode", mode)?;
    if !endpoints.is_empty() {
        let list = serde_json::json!(endpoints).to_string();
        set(&mut settings, place, &list)?;
    }
    let named = endpoints.join(", ");
    zenoh::open(settings)
        .wait()
        .map_err(|error| ZenohError::zenoh(&named, &error))
}

fn set(settings: &mut Config, key: &str, value: &str) -> Result<(), ZenohError> {
    settings
        .insert_json5(key, value)
        .map_err(|error| ZenohError::Refused(format!("Zenoh: {key} = {value}: {error}")))
}
