//! Scenes of redundant machines: those of the repository, and what is refused.

mod refusals;
mod shipped;

use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_scene::SceneError;

/// Kinds of the shipped scenes, which are named after them.
const KINDS: [&str; 5] = ["4rrr", "6rrr", "prrr-2rrr", "2prrr-rrr", "3prrr"];

fn text(kind: &str) -> String {
    let file = format!(
        "{}/../../scenes/redundant/{kind}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn parsed(text: &str) -> Result<RedundantScene, SceneError> {
    RedundantScene::parse_set(text, "bad.toml", &[])
}
