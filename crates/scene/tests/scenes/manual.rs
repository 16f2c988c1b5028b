//! The first scene of `docs/scene.md`: accepted, and refused with the message that the page shows.

use crate::common::edit;
use trirrr_scene::Scene;

const MANUAL: &str = include_str!("../../../../docs/scene.md");

/// The first block of the page that begins with `fence`.
fn block(fence: &str) -> &'static str {
    let (_, rest) = MANUAL.split_once(fence).expect(fence);
    let (text, _) = rest.split_once("```").expect("every block ends");
    text
}

#[test]
fn the_first_scene_is_accepted() {
    let scene = Scene::parse(block("```toml\n"), "my.toml").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((scene.name.as_str(), scene.ticks()), ("first", 2000));
}

#[test]
fn the_first_refusal_is_the_one_shown() {
    let faster = edit(
        block("```toml\n"),
        "duration_s = 1.0",
        1,
        "duration_s = 0.4",
    );
    let error = Scene::parse(&faster, "my.toml").expect_err("too much torque");
    assert_eq!(
        error.to_string().trim(),
        block("run the scene again:\n\n```text\n").trim()
    );
}
