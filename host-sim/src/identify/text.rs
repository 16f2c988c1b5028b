//! An identification as text and JSON.

use super::{IdentifyArgs, IdentifyFiles, found_friction};
use crate::terminal::digits;
use serde_json::{Value, json};
use std::fmt::Write;
use trirrr_calibration::identify::{Identification, body_name, body_unit};
use trirrr_scene::Scene;

/// Lines at the head of the files with the found values.
pub(super) fn head(
    found: &Identification,
    args: &IdentifyArgs,
    friction_in: Option<&str>,
) -> Vec<String> {
    // A name with a line break in it would end the comment.
    let file = args
        .telemetry
        .display()
        .to_string()
        .replace(char::is_control, " ");
    let mut lines = vec![format!(
        "Identified by `trirrr identify` from {file}; values before stand behind `was`."
    )];
    if friction_in.is_none() {
        let [viscous, coulomb] = found_friction(found);
        lines.push(format!(
            "Friction of the motors, which has no key in this scene: viscous_nm_s_rad = {viscous:?}, coulomb_nm = {coulomb:?}"
        ));
    }
    lines
}

/// Summary for a terminal.
pub(super) fn summary(scene: &Scene, found: &Identification, written: &IdentifyFiles) -> String {
    let mut text = format!(
        "{}: {} torques, sampled every {} ms, filtered with sigma = {} ms\n",
        scene.name,
        found.torques.len(),
        digits(1e3 * found.period_s),
        digits(1e3 * found.width_s)
    );
    let (seen, of) = (found.seen(), found.free.len());
    let _ = writeln!(
        text,
        "  seen        {seen} of {of} directions of the free parameters"
    );
    for (list, why) in [
        (&found.blind, "cannot be seen, held"),
        (&found.weak, "seen less than it is known, held"),
    ] {
        for words in list {
            let _ = writeln!(text, "  held        {words} ({why})");
        }
    }
    for index in &found.at_zero {
        let _ = writeln!(
            text,
            "  held        {} at 0: it would be negative",
            body_name(*index)
        );
    }
    let pair = |[before, after]: [f64; 2]| {
        format!(
            "before: {} N m, after: {} N m",
            digits(before),
            digits(after)
        )
    };
    let _ = writeln!(text, "  residuals   {} (RMS)", pair(found.residual_nm));
    match found.check_nm {
        Some(check) => {
            let _ = writeln!(
                text,
                "  check       {}, of time that a fit of the rest did not see",
                pair(check)
            );
        }
        None => text += "  check       too little to keep some out of a fit\n",
    }
    for body in &found.impossible {
        let _ = writeln!(text, "  warning     cannot be: {body}");
    }
    if let Some(refusal) = &written.refusal {
        let _ = writeln!(text, "  warning     the scene with these values: {refusal}");
    }
    let _ = writeln!(
        text,
        "\n  {:<58}{:>12}{:>12}{:>12}{:>7}",
        "parameter", "was", "found", "deviation", "seen"
    );
    for &index in &found.free {
        let _ = writeln!(
            text,
            "  {:<58}{:>12}{:>12}{:>12}{:>6.0}%",
            format!("{}, {}", body_name(index), body_unit(index)),
            digits(found.nominal.0[index]),
            digits(found.values.0[index]),
            found.deviations[index].map_or("-".into(), digits),
            100.0 * found.shares[index]
        );
    }
    text.push('\n');
    for file in &written.files {
        let _ = writeln!(text, "  wrote       {}", file.display());
    }
    text
}

/// Everything as one object, SI units.
pub(super) fn as_json(scene: &Scene, found: &Identification, written: &IdentifyFiles) -> Value {
    let parameter = |index: &usize| {
        json!({
            "name": body_name(*index),
            "unit": body_unit(*index),
            "nominal": found.nominal.0[*index],
            "value": found.values.0[*index],
            "deviation": found.deviations[*index],
            "seen": found.shares[*index],
        })
    };
    let [viscous, coulomb] = found_friction(found);
    json!({
        "scene": scene.name,
        "torques": found.torques.len(),
        "period_s": found.period_s,
        "width_s": found.width_s,
        "parameters": found.free.iter().map(parameter).collect::<Vec<_>>(),
        "friction": { "viscous_nm_s_rad": viscous, "coulomb_nm": coulomb },
        "friction_in": written.friction_in,
        "directions": { "free": found.free.len(), "seen": found.seen(), "signal_to_noise": found.ratios, "blind": found.blind, "weak": found.weak },
        "at_zero": found.at_zero.iter().map(|index| body_name(*index)).collect::<Vec<_>>(),
        "impossible": found.impossible,
        "residual_nm": found.residual_nm,
        "check_nm": found.check_nm,
        "refusal": written.refusal,
    })
}
