//! Failures on purpose: the outputs go off, and after the reset the board says what it was.

use super::board::Board;
use super::clients::Clients;
use super::own_scalar;
use crate::image::Image;
use crate::repository;
use crate::size::FIRMWARE_TARGET;
use anyhow::{Context, Result, ensure};

/// The scene of the images that fail.
const SCENE: &str = "engraving";

/// What an image can be made to do, and what the board has to say of it.
const FAILURES: [(&str, &[&str]); 4] = [
    (
        "panic",
        &[
            "start: a panic in",
            "provoke.rs",
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
];

/// Failures that end in a reset: before it, the outputs go off.
const WITH_RESET: [&str; 3] = ["panic", "hard-fault", "stack-overflow"];

/// The reset register of the ports that the outputs are on (AHB1RSTR), as QEMU names a write to
/// it: it has no such peripheral, and tells so.
const OUTPUTS_OFF: &str = "RCC: unimplemented device write (size 4, offset 0x10, value 0x0000001f)";

pub(super) fn run(clients: &Clients) -> Result<()> {
    let scenes = repository::scenes_named(&[SCENE.to_owned()])?;
    let scene = scenes.first().context("a scene")?;
    let scalar = own_scalar(scene)?;
    let image = Image {
        package: "trirrr-firmware",
        binary: "trirrr-firmware",
        scene,
        scalar,
        target: FIRMWARE_TARGET,
    };
    for (failure, expected) in FAILURES {
        let elf = image.build_as(&format!("-{failure}"), |cargo| {
            cargo
                .args(["--features", "provoke"])
                .env("PROVOKE", failure);
        })?;
        let board = Board::boot(&elf)?;
        let said = clients.report(scene, scalar, &board)?;
        let ended = board.end()?;
        println!("{failure}:\n{}", said.trim_end());
        let words = expected.iter().chain(&["clock: Emulated", "state: fault"]);
        for words in words {
            ensure!(said.contains(words), "{failure}: {words:?} is missing");
        }
        let off = ended.unimplemented.contains(OUTPUTS_OFF);
        ensure!(
            off == WITH_RESET.contains(&failure),
            "{failure}: that the outputs were switched off before a reset is {off}"
        );
    }
    Ok(())
}
