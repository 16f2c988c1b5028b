//! Scene over the line: the board keeps it and plays it, and power that is cut leaves one of both.

use super::update::{Ended, Updater, described};
use super::{Row, Subject, fact};
use crate::chip::ResetCause;
use crate::cpu::Board;
use crate::time::{MS, SECOND};
use anyhow::{Result, anyhow};
use trirrr_client::{Patience, SceneImage, UpdateClient, UpdateFailure};
use trirrr_image::generate::BoardScene;
use trirrr_protocol::message::{SceneNeed, SceneNeeds};
use trirrr_scene::Scene;

const CASE: &str = "install";

/// Scene named `name`, with other links than those of the image.
fn scene(subject: &Subject, name: &str) -> Scene {
    let mut scene = Scene {
        name: name.into(),
        key: key_of(name),
        ..subject.scene.clone()
    };
    for leg in &mut scene.parameters.legs {
        leg.proximal_m = 0.21;
    }
    scene
}

/// A key of its own, not 0.
fn key_of(name: &str) -> u32 {
    name.bytes().map(u32::from).sum()
}

/// Host that installs `scene`, in a conversation of its own.
fn installer(board: &mut Board, scene: &Scene) -> Result<Updater> {
    let of_board = BoardScene::of(scene).map_err(|error| anyhow!("{error}"))?;
    let image = SceneImage::new(of_board.types, &of_board.values);
    let conversation = board.now() as u32;
    let client = UpdateClient::of_scene(image, Patience::default(), conversation);
    let mut host = Updater::of(client);
    // What the board has said to hosts before.
    host.line.drop_all(board);
    Ok(host)
}

/// Name of the scene that the board tells a host, of which nothing more comes.
fn told(board: &mut Board, scene: &Scene) -> Result<String> {
    board.run(board.now() + 100 * MS)?;
    let mut host = installer(board, scene)?;
    host.run(board, |host| host.client.identity().is_some())?;
    Ok(host.scene())
}

pub(super) fn run(subject: &Subject) -> Result<Vec<Row>> {
    let mut board = subject.switch_on()?;
    board.run(100 * MS)?;
    let mut rows = Vec::new();
    let mut row = |what: &str, measured: String, bound: &str| {
        rows.push(fact(CASE, what, measured, bound));
    };

    let [first, second] = ["first", "second"].map(|name| scene(subject, name));
    row(
        "a scene of another tick rate",
        refused(&mut board, subject)?,
        "true, 0 erasures, 0 units",
    );

    let mut host = installer(&mut board, &first)?;
    let ended = host.run_to_end(&mut board)?;
    row("first scene: result", described(ended), "Ok(())");
    row("first scene: told afterwards", host.scene(), "first");
    let erased = board.chip().flash.erasures;
    row("first scene: sectors erased", erased.to_string(), "1");
    let mut player = subject.host_of(&mut board, &first)?;
    let played = player.play(&mut board, 10 * SECOND);
    row(
        "first scene: its job",
        format!("{:?}", played.is_ok()),
        "true",
    );

    // Power is cut while the second comes: its sector is erased, and its first block is there.
    board.reset(ResetCause::Pin)?;
    board.run(board.now() + 100 * MS)?;
    let mut host = installer(&mut board, &second)?;
    host.run(&mut board, |host| host.client.progress().0 > 0)?;
    board.reset(ResetCause::Power)?;
    row(
        "power cut while a second comes",
        told(&mut board, &second)?,
        "first",
    );

    board.reset(ResetCause::Pin)?;
    board.run(board.now() + 100 * MS)?;
    let mut host = installer(&mut board, &second)?;
    let ended = host.run_to_end(&mut board)?;
    row("second scene: result", described(ended), "Ok(())");
    row("second scene: told afterwards", host.scene(), "second");
    board.reset(ResetCause::Power)?;
    row(
        "second scene: told after power off and on",
        told(&mut board, &second)?,
        "second",
    );

    // The second lies in the other slot.
    let [a, b] = subject.kind.layout().scenes.map(|slot| slot.start);
    board.damage(b + 64)?;
    board.reset(ResetCause::Power)?;
    let left = told(&mut board, &second)?;
    row("second scene is damaged in the flash", left, "first");
    board.damage(a + 64)?;
    board.reset(ResetCause::Power)?;
    let left = told(&mut board, &second)?;
    row("both are damaged", left, &subject.scene.name);
    Ok(rows)
}

/// A scene whose type the image lacks.
fn refused(board: &mut Board, subject: &Subject) -> Result<String> {
    let other = Scene {
        tick_rate_hz: subject.scene.tick_rate_hz / 2.0,
        ..scene(subject, "slow")
    };
    let ended = installer(board, &other)?.run_to_end(board)?;
    let mut lacks = SceneNeeds::default();
    lacks.insert(SceneNeed::TickRate);
    let named: Ended = Err(UpdateFailure::Lacks(lacks));
    let flash = &board.chip().flash;
    Ok(format!(
        "{}, {} erasures, {} units",
        ended == named,
        flash.erasures,
        flash.units
    ))
}
