//! An identification as a document.

use super::{IdentifyArgs, IdentifyFiles, found_friction};
use crate::calibrate::directions;
use trirrr_calibration::identify::{Identification, body_name, body_unit};
use trirrr_figures::document::{Document, Facts, digits};
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

/// Everything that was found.
pub(super) fn document(scene: &Scene, found: &Identification, written: &IdentifyFiles) -> Document {
    let [viscous, coulomb] = found_friction(found);
    let at_zero: Vec<_> = found
        .at_zero
        .iter()
        .map(|index| body_name(*index))
        .collect();
    let zero = at_zero
        .iter()
        .map(|name| format!("{name} at 0: it would be negative"));
    let pair = |[before, after]: [f64; 2]| {
        format!(
            "before: {} N m, after: {} N m",
            digits(before),
            digits(after)
        )
    };
    let check = match found.check_nm {
        Some(check) => format!(
            "{}, of time that a fit of the rest did not see",
            pair(check)
        ),
        None => "too little to keep some out of a fit".into(),
    };
    let impossible = found
        .impossible
        .iter()
        .map(|body| format!("cannot be: {body}"));
    let refused = written.refusal.as_ref();
    let refused = refused.map(|refusal| format!("the scene with these values: {refusal}"));
    let mut document = Document::new();
    document.pairs(
        Facts::new()
            .pair("scene", "scene", &scene.name)
            .pair("torques", "torques", found.torques.len())
            .pair("period_s", "period", found.period_s)
            .pair("width_s", "filter", found.width_s)
            .and(directions(
                [found.seen(), found.free.len()],
                &found.ratios,
                [&found.blind, &found.weak],
                zero,
            ))
            .data("at_zero", &at_zero)
            .pair("residual_nm", "residuals", found.residual_nm)
            .words(format!("{} (RMS)", pair(found.residual_nm)))
            .pair("check_nm", "check", found.check_nm)
            .words(check)
            .data("friction.viscous_nm_s_rad", viscous)
            .data("friction.coulomb_nm", coulomb)
            .data("friction_in", written.friction_in)
            .text("warning", impossible.chain(refused).collect::<Vec<_>>())
            .data("impossible", &found.impossible)
            .data("refusal", &written.refusal),
    );
    let parameter = |&index: &usize| {
        Facts::new()
            .pair("name", "parameter", body_name(index))
            .pair("unit", "", body_unit(index))
            .pair("nominal", "was", found.nominal.0[index])
            .pair("value", "found", found.values.0[index])
            .pair("deviation", "deviation", found.deviations[index])
            .pair("seen", "seen", found.shares[index])
            .words(format!("{:.0} %", 100.0 * found.shares[index]))
    };
    document.table("parameters", found.free.iter().map(parameter).collect());
    document
}
