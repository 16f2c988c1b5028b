//! Whatever is done to the text of a scene, it is accepted or refused with reasons; never a panic.

use proptest::prelude::*;
use trirrr_scene::{JobPlayer, Scene, SceneError};

const SCENES: [&str; 4] = [
    include_str!("../../../../scenes/thesis.toml"),
    include_str!("../../../../scenes/thesis-links.toml"),
    include_str!("../../../../scenes/vertical.toml"),
    include_str!("../../../../scenes/chained.toml"),
];

/// What a value is replaced with.
const VALUES: [&str; 22] = [
    "nan",
    "inf",
    "-inf",
    "-1",
    "0",
    "1",
    "3",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-320",
    "0.1",
    "1e9",
    "99999999999999999999",
    "\"0.2 m\"",
    "\"\"",
    "true",
    "[]",
    "[nan, 1.0]",
    "{}",
    "1979-05-27",
    "[[1]]",
];

/// Byte ranges of the numbers and strings that follow a `=`, a `[` or a `,`.
fn values(text: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        let code = line.split('#').next().unwrap_or_default();
        let mut start = None;
        for (i, c) in code.char_indices() {
            let in_value = c.is_ascii_alphanumeric() || "+-._\"".contains(c);
            match start {
                None if "=[,".contains(c) && code.contains('=') => start = Some(i + 1),
                Some(from) if !in_value && c != ' ' => {
                    if !code[from..i].trim().is_empty() {
                        found.push((offset + from, offset + i));
                    }
                    start = "[,=".contains(c).then_some(i + 1);
                }
                _ => {}
            }
        }
        offset += line.len();
    }
    found
}

/// Reads a text, and checks what must hold of either outcome.
fn read(text: &str) -> Result<(), TestCaseError> {
    match Scene::parse(text, "mutant.toml") {
        Ok(scene) => {
            let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
            for tick in [0, scene.ticks() / 2, scene.ticks()] {
                let setpoint = player.at(tick);
                prop_assert!(setpoint.pose.position.iter().all(|x| x.is_finite()));
            }
        }
        Err(error @ SceneError::Refused { .. }) => {
            let message = error.to_string();
            prop_assert!(!message.is_empty());
            for line in message.lines() {
                prop_assert!(line.starts_with("mutant.toml:"), "{line}");
            }
        }
        Err(error) => prop_assert!(false, "{error}"),
    }
    Ok(())
}

#[test]
fn values_are_found() {
    let text = "a = 1.5 # c\n[t]\nb = { x = 2, y = -3 }\nc = [4, 5]\n";
    let found: Vec<&str> = values(text)
        .iter()
        .map(|&(from, to)| text[from..to].trim())
        .collect();
    for value in ["2", "-3", "4", "5"] {
        assert!(found.contains(&value), "{value} in {found:?}");
    }
    for scene in SCENES {
        assert!(values(scene).len() > 20);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn replaced_values_never_panic(
        scene in 0..SCENES.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..VALUES.len()), 1..4),
    ) {
        let mut text = SCENES[scene].to_owned();
        for (place, value) in edits {
            let places = values(&text);
            if places.is_empty() {
                break;
            }
            let (from, to) = places[place.index(places.len())];
            text.replace_range(from..to, &format!(" {} ", VALUES[value]));
        }
        read(&text)?;
    }

    #[test]
    fn replaced_numbers_never_panic(
        scene in 0..SCENES.len(),
        place in any::<prop::sample::Index>(),
        number in prop_oneof![any::<f64>(), -2.0..2.0],
    ) {
        let mut text = SCENES[scene].to_owned();
        let places = values(&text);
        let (from, to) = places[place.index(places.len())];
        text.replace_range(from..to, &format!(" {number:?} "));
        read(&text)?;
    }

    #[test]
    fn edited_bytes_never_panic(
        scene in 0..SCENES.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3_u8), 1..6),
    ) {
        let mut bytes = SCENES[scene].as_bytes().to_vec();
        for (place, byte, kind) in edits {
            let place = place.index(bytes.len());
            match kind {
                0 => bytes[place] = byte,
                1 => bytes.insert(place, byte),
                _ => drop(bytes.remove(place)),
            }
        }
        read(&String::from_utf8_lossy(&bytes))?;
    }

    #[test]
    fn exchanged_and_dropped_lines_never_panic(
        scene in 0..SCENES.len(),
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<bool>()),
            1..4,
        ),
    ) {
        let mut lines: Vec<&str> = SCENES[scene].lines().collect();
        for (one, other, exchange) in edits {
            let (one, other) = (one.index(lines.len()), other.index(lines.len()));
            if exchange {
                lines.swap(one, other);
            } else {
                lines.remove(one);
            }
        }
        read(&lines.join("\n"))?;
    }

    #[test]
    fn any_text_at_all_never_panics(text in "\\PC*") {
        read(&text)?;
    }
}
