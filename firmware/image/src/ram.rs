//! RAM of images for the RP2040, whose program runs in it: an estimate, before anything is compiled.
//!
//! The parts were measured on images of shipped scenes (`size -A` of `cargo fw-rp2040`), except inputs and power lists: these two are
//! guesses. An image that is larger than its estimate is refused by the linker.

use std::fmt::Write;
use trirrr_scene::{NumberType, Scene};

/// RAM for program and queues, as `firmware/boards/rp2040/rp2040.x` has it, bytes.
const ROOM: u32 = 224 * 1024;

/// A change of the scene, or of the build, after which less is needed.
#[derive(Clone, Copy, Debug, Default)]
struct Without {
    paths: bool,
    lists: bool,
    homing: bool,
    usb: bool,
}

/// Part of an image and its bytes.
type RamPart = (&'static str, u32);

/// Parts of the image of `scene` in the number type `number`; `usb`: with the line over USB.
fn parts(scene: &Scene, number: NumberType, usb: bool, without: Without) -> Vec<RamPart> {
    let is_fixed = number == NumberType::Fixed;
    let paths = scene.service.plans_paths && !without.paths;
    let quintics = scene.plays_quintics() || paths;
    let program = if is_fixed { 89_000 } else { 81_000 };
    let queue = match (is_fixed, quintics) {
        (true, true) => 59_400,
        (true, false) => 40_300,
        (false, true) => 50_900,
        (false, false) => 33_600,
    };
    let mut parts = vec![
        ("service, admission and line", program),
        (
            "queues of 128 moves, of telemetry and of the line",
            queue + 1_800,
        ),
    ];
    let lists = u32::from(scene.service.power_lists);
    let named = |name| scene.inputs.are_named().then_some((name, 4_000));
    let optional = [
        quintics.then_some(("quintic moves", 41_500)),
        paths.then_some(("planner of paths and its window", 68_000)),
        (scene.homing.is_some() && !without.homing).then_some(("homing", 12_000)),
        (lists > 0 && !without.lists).then_some(("power lists", 8_000 + lists)),
        named("inputs"),
        (usb && !without.usb).then_some(("line over USB", 14_400)),
    ];
    parts.extend(optional.into_iter().flatten());
    parts
}

fn sum(parts: &[RamPart]) -> u32 {
    parts.iter().map(|(_, bytes)| bytes).sum()
}

/// Checks that the RAM of an RP2040 holds the image of `scene`.
///
/// # Errors
/// The sum by part, and each single change after which the image fits.
pub fn check(scene: &Scene, number: NumberType, usb: bool) -> Result<(), String> {
    let needed = parts(scene, number, usb, Without::default());
    let total = sum(&needed);
    if total <= ROOM {
        return Ok(());
    }
    let mut text = format!(
        "an RP2040 has {ROOM} bytes of RAM for program and queues, and the image of this scene in {number} needs about {total}:"
    );
    for (name, bytes) in &needed {
        let _ = write!(text, " {name} {bytes},");
    }
    text.pop();
    let all = Without::default();
    let changes = [
        (
            "without plans_paths in [service]",
            Without { paths: true, ..all },
        ),
        (
            "without power_lists in [service]",
            Without { lists: true, ..all },
        ),
        (
            "without [homing]",
            Without {
                homing: true,
                ..all
            },
        ),
        (
            "with the line at the UART in place of USB",
            Without { usb: true, ..all },
        ),
    ];
    let fits = changes
        .into_iter()
        .filter(|(_, without)| sum(&parts(scene, number, usb, *without)) <= ROOM);
    let words: Vec<&str> = fits.map(|(words, _)| words).collect();
    text += &match words.is_empty() {
        true => "; no single change makes room: take a board with an STM32".to_owned(),
        false => format!("; it fits {}", words.join(", or ")),
    };
    Err(text)
}

/// Checks the image of `scene` where its `board` is the shipped Pico. Of a board file of the user's own the build says it.
///
/// # Errors
/// As [`check`].
pub fn check_board(scene: &Scene) -> Result<(), String> {
    match scene.board.as_deref() {
        Some(board) if board == "pico" => {
            let number = match scene.number {
                NumberType::F64 => NumberType::F32,
                other => other,
            };
            check(scene, number, false).map_err(|why| format!("board = \"{board}\": {why}"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn read(name: &str) -> Scene {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        Scene::read(folder.join(name)).expect("a good scene")
    }

    #[test]
    fn what_fits_is_built_and_what_does_not_is_refused_by_part() {
        // Linked, with the bytes that `size -A` printed in all.
        let linked = [
            ("pick-stepper.toml", NumberType::Fixed, false, 130_124),
            ("pick-home.toml", NumberType::Fixed, false, 141_044),
            ("engraving.toml", NumberType::F32, false, 174_900),
            ("plotter.toml", NumberType::F32, false, 177_892),
        ];
        for (name, number, usb, measured) in linked {
            let scene = read(name);
            let told = sum(&parts(&scene, number, usb, Without::default()));
            assert!(
                (0.98..1.08).contains(&(f64::from(told) / f64::from(measured))),
                "{name}: {told} told, {measured} measured"
            );
            assert_eq!(check(&scene, number, true), Ok(()), "{name}");
        }
        let planning = read("paths/onboard.toml");
        let why = check(&planning, NumberType::F32, false).expect_err("no room");
        assert!(
            why.contains("planner of paths and its window 68000"),
            "{why}"
        );
        assert!(
            why.ends_with("it fits without plans_paths in [service]"),
            "{why}"
        );
        let pico = Scene {
            board: Some("pico".into()),
            ..planning
        };
        assert!(check_board(&pico).is_err());
        assert_eq!(check_board(&read("plotter.toml")), Ok(()));
    }
}
