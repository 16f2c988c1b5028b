//! The frames that the guide explains are those of the reference.

use super::document;

/// The bytes at the start of `text` in hex, up to the first word that is none.
fn bytes(text: &str) -> Vec<&str> {
    let is_byte = |word: &&str| word.len() == 2 && u8::from_str_radix(word, 16).is_ok();
    text.split_whitespace().take_while(is_byte).collect()
}

#[test]
fn the_frames_of_the_guide_are_example_frames() {
    let text = document::text();
    let (guide, reference) = text
        .split_once("\n## Frames\n")
        .expect("the reference begins with frames");
    let examples: Vec<Vec<&str>> = reference
        .split("\nframe:\n")
        .skip(1)
        .map(|rest| rest.split("```").next().map(bytes).unwrap_or_default())
        .collect();
    let shown: Vec<Vec<&str>> = guide
        .lines()
        .filter_map(|line| line.strip_prefix("> ").or(line.strip_prefix("< ")))
        .map(bytes)
        .collect();
    assert!(shown.len() >= 5, "{shown:?}");
    for frame in shown {
        assert!(examples.contains(&frame), "no example has {frame:?}");
    }
}
