//! Failures on purpose: the outputs go off, and after the reset the board says what it was.

use super::Built;
use super::board::Board;
use super::clients::Clients;
use crate::callgraph;
use crate::image::Image;
use crate::repository;
use anyhow::{Context, Result, ensure};
use std::fs;
use trirrr_image::generate::of_scene;
use trirrr_scene::Scene;

/// The scene of the images that fail,
const SCENE: &str = "chained";

/// and of the one whose emergency stop is pressed.
const GUARDED: &str = "inputs/guarded";

/// Failures that an image can be made to cause, and what the board has to say of each.
const FAILURES: [(&str, &[&str]); 5] = [
    (
        "panic",
        &[
            "start: a panic in",
            "fault_injection.rs",
            "fault: the board has started anew",
        ],
    ),
    (
        "hard-fault",
        &[
            "start: a hard fault at",
            "address 0x60000000",
            "fault: the board has started anew",
        ],
    ),
    (
        "stack-overflow",
        &[
            "start: its stack ran over",
            "fault: the board has started anew",
        ],
    ),
    ("overrun", &["start: it was switched on", "fault: a tick"]),
    (
        STOP,
        &[
            "start: it was switched on",
            "fault: the emergency stop was pressed",
        ],
    ),
];

/// Failure that the image of [`GUARDED`] is made to cause.
const STOP: &str = "emergency-stop";

/// Failures that the check of the code can see, each with the message it must give of the image.
/// Without these messages, the check would see none.
const REFUSED: [(&str, &str); 2] = [
    ("panic", "a handler may panic: SysTick > "),
    ("stack-overflow", "recursion: "),
];

/// Failures that end in a reset: before it, the outputs go off.
const WITH_RESET: [&str; 3] = ["panic", "hard-fault", "stack-overflow"];

/// A write to the reset register of the ports that the outputs are on (AHB1RSTR: A to E), as QEMU
/// names it up to its version 8, which has no such peripheral and tells so.
const OUTPUTS_OFF: &str =
    "RCC: unimplemented device write (size 4, offset 0x010, value 0x0000001f)";

pub(super) fn run(clients: &Clients) -> Result<()> {
    for (failure, expected) in FAILURES {
        let name = if failure == STOP { GUARDED } else { SCENE };
        let scenes = repository::scenes_named(&[name.to_owned()])?;
        let scene = scenes.first().context("a scene")?;
        let scalar = of_scene(Scene::read(&scene.path)?.number);
        let image = Image::firmware(scene, scalar);
        let elf = image.build_as(&format!("-{failure}"), |cargo| {
            cargo
                .args(["--features", "fault-injection"])
                .env("FAULT", failure);
        })?;
        let checked = callgraph::check(&elf).map_err(|error| format!("{error:#}"));
        match REFUSED.iter().find(|(of, _)| *of == failure) {
            Some((_, reason)) => {
                let refusal = checked.err();
                ensure!(
                    refusal.as_ref().is_some_and(|said| said.contains(reason)),
                    "{failure}: {reason:?} is not what the check of its code says: {refusal:?}"
                );
            }
            None => ensure!(checked.is_ok(), "{failure}: {checked:?}"),
        }
        let (board, accesses) = Board::boot_watched(&elf)?;
        let built = Built {
            scene: scene.clone(),
            scalar,
            image: elf,
            inputs: None,
        };
        let said = clients.test("report", &built, &board, &[])?;
        let log = clients.read_log(&built.image, &board.end()?.log)?;
        println!("{failure}:\n{}", said.trim_end());
        let words = expected.iter().chain(&["clock: Emulated", "state: fault"]);
        for words in words {
            ensure!(said.contains(words), "{failure}: {words:?} is missing");
        }
        let resets = WITH_RESET.contains(&failure);
        ensure!(
            log.contains("started after") == resets,
            "{failure}: the log does not tell of it: {log}"
        );
        let accesses = fs::read_to_string(&accesses)?;
        if !accesses.contains("RCC: unimplemented") {
            println!("this emulator does not tell whether the outputs went off");
            continue;
        }
        ensure!(
            accesses.contains(OUTPUTS_OFF) == resets,
            "{failure}: the outputs were {}switched off before a reset",
            if resets { "not " } else { "" }
        );
    }
    Ok(())
}
