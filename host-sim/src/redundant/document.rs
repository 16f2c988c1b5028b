//! Checks and runs of redundant machines as documents.

use super::play::RedundantReport;
use super::{kind_text, placement_text, slider_texts};
use crate::run::document::{RunScene, document, signal};
use std::path::Path;
use trirrr_figures::document::{Document, Facts, digits, quantity};
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_plant::redundant::RedundantOutcome;
use trirrr_scene::words::{counted, tick_time};

/// Kind of the machine, and its sliders at the start of the job.
fn machine(scene: &RedundantScene) -> Facts {
    let legs = scene.sliders.iter().zip(1..);
    let sliders = legs.filter_map(|(slider, leg): (_, u32)| {
        let slider = slider.as_ref()?;
        let record = Facts::new()
            .data("leg", leg)
            .data("position_m", slider.position_m);
        Some(record.data("placed", slider.is_placed))
    });
    let placement = scene.placement.as_ref().map(|placement| {
        Facts::new()
            .data("distance_before", placement.before)
            .data("distance_after", placement.after)
            .data("looked_at", placement.looked_at)
    });
    let record = Facts::new()
        .data("kind", scene.kind.name())
        .rows("sliders", sliders);
    record.data("placement", placement)
}

fn machine_texts(scene: &RedundantScene) -> impl Iterator<Item = String> {
    let own = std::iter::once(kind_text(scene.kind));
    own.chain(slider_texts(scene)).chain(placement_text(scene))
}

/// A scene that is good.
pub(super) fn checked(scene: &RedundantScene) -> Document {
    let mut document = Document::new();
    let moves = scene.job.moves.len();
    let (duration_s, ticks) = (scene.duration_s(), scene.ticks());
    let job = format!(
        "{}, {} s: {ticks} ticks at {} Hz in f64",
        counted(moves, "move"),
        tick_time(duration_s),
        scene.tick_rate_hz
    );
    document.note(format!("{}: good", scene.name));
    let mut texts: Vec<String> = machine_texts(scene).collect();
    texts.insert(1, job);
    for text in texts {
        document.note(text);
    }
    document.pairs(
        machine(scene)
            .data("scene", &scene.name)
            .data("description", &scene.description)
            .data("tick_rate_hz", scene.tick_rate_hz)
            .data("moves", moves)
            .data("ticks", ticks)
            .data("duration_s", duration_s),
    );
    document
}

/// The run of `scene`, read from `file`.
pub(super) fn played(file: &Path, scene: &RedundantScene, report: &RedundantReport) -> Document {
    let texts: Vec<String> = machine_texts(scene).collect();
    let head = Facts::new().data("number", "f64").text("machine", texts);
    let played = RunScene {
        name: &scene.name,
        description: &scene.description,
        file,
        moves: scene.job.moves.len(),
        ticks: scene.ticks(),
        rate_hz: scene.tick_rate_hz,
        torque: true,
        head: head.and(machine(scene)),
        hold: None,
    };
    let mut document = document(played, report);
    match &report.plant {
        Some(simulated) => document.pairs_in("plant", plant(scene, &simulated.outcome)),
        None => document.data("plant", ()),
    };
    document.files(report.all_files());
    document
}

fn plant(scene: &RedundantScene, outcome: &RedundantOutcome) -> Facts {
    let steps = outcome.steps;
    let (label, end) = match &outcome.failure {
        Some(failure) => ("  failed", failure.clone()),
        None if outcome.is_stopped => ("  stopped", "by Ctrl-C".into()),
        None => ("", String::new()),
    };
    let legs = scene.slider_legs().into_iter();
    let torques = (1..)
        .zip(&outcome.torques)
        .map(|(leg, own): (usize, _)| ("  motor", leg, "N m", own));
    let forces = legs
        .zip(&outcome.forces)
        .map(|(leg, own)| ("  slider", leg + 1, "N", own));
    let record = Facts::new()
        .pair("simulated_s", "plant", outcome.simulated_s)
        .words(format!(
            "{} simulated in {steps} steps",
            quantity(outcome.simulated_s, "s")
        ))
        .data("steps", steps)
        .pair("reason", label, &outcome.failure)
        .words(end)
        .group("path_error_m", "  path", signal(&outcome.path_error))
        .group("angle_error_rad", "  angle", signal(&outcome.angle_error));
    let record = torques
        .chain(forces)
        .fold(record, |record, (what, number, unit, own)| {
            record.text(format!("{what} {number}"), signal(own).line_in(Some(unit)))
        });
    let energy = format!(
        "work {} J, stored {} J, lost {} J; {} J are missing",
        digits(outcome.work_j),
        digits(outcome.stored_j),
        digits(outcome.lost_j),
        digits(outcome.balance_error_j())
    );
    record
        .rows("torques_nm", outcome.torques.iter().map(signal))
        .rows("forces_n", outcome.forces.iter().map(signal))
        .text("  energy", energy)
        .data("work_j", outcome.work_j)
        .data("stored_j", outcome.stored_j)
        .data("lost_j", outcome.lost_j)
        .data("balance_error_j", outcome.balance_error_j())
}
