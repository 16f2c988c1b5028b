//! A calibration as text, JSON and a table.

use super::board::CalibratedBoard;
use super::{CalibrateArgs, CalibrateFiles, Findings, POSES};
use crate::terminal::digits;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use trirrr_calibration::{
    Calibration, DeviceReading, JudgedRow, PoseError, ResidualSize, is_angle, parameter_name,
};

/// Length in words, um or mm.
fn length(metres: f64) -> String {
    match metres.abs() < 1e-3 {
        true => format!("{} um", digits(1e6 * metres)),
        false => format!("{} mm", digits(1e3 * metres)),
    }
}

fn angle(radians: f64) -> String {
    format!("{} mrad", digits(1e3 * radians))
}

fn quantity(index: usize, value: f64) -> String {
    match is_angle(index) {
        true => angle(value),
        false => length(value),
    }
}

fn sizes(size: &ResidualSize) -> String {
    let parts = [
        size.place_m.map(|place| format!("place {}", length(place))),
        size.angle_rad
            .map(|value| format!("angle {}", angle(value))),
        size.distance_m
            .map(|way| format!("distance {}", length(way))),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    parts.join(", ")
}

fn error(error: &PoseError) -> String {
    let [x, y, alpha] = error.worst_at;
    format!(
        "RMS {}, at most {} (x = {x:.4} m, y = {y:.4} m, alpha = {alpha:.4} rad); angle RMS {}",
        length(error.rms_m),
        length(error.worst_m),
        angle(error.rms_rad)
    )
}

/// Lines at the head of the calibrated files.
pub(super) fn head(
    calibration: &Calibration,
    args: &CalibrateArgs,
    offsets_in: Option<&str>,
) -> Vec<String> {
    let file = args.measurements.as_deref().unwrap_or(&args.scene);
    let mut lines = vec![format!(
        "Calibrated by `trirrr calibrate` from {} rows of {}; values before stand behind `was`.",
        calibration.rows.len(),
        // A name with a line break in it would end the comment.
        file.display().to_string().replace(char::is_control, " ")
    )];
    if let (None, Some(offsets)) = (offsets_in, offsets(calibration)) {
        lines.push(format!(
            "Encoder offsets have no key in this scene: {offsets}"
        ));
    }
    lines
}

/// Encoder offsets in words, where they were fitted.
fn offsets(calibration: &Calibration) -> Option<String> {
    let offsets = calibration.values.offsets_rad();
    let is_fitted = offsets.iter().any(|offset| *offset != 0.0);
    let each = (1..).zip(offsets).map(|(motor, offset): (u32, f64)| {
        format!("motor {motor} stands at {offset:+.6} rad from what it tells")
    });
    is_fitted.then(|| each.collect::<Vec<_>>().join(", "))
}

/// Summary for a terminal.
pub(super) fn summary(
    findings: &Findings,
    args: &CalibrateArgs,
    written: &CalibrateFiles,
) -> String {
    let scene = findings.scene;
    let mut text = String::new();
    if let Some(calibration) = findings.calibration {
        let values: usize = calibration
            .rows
            .iter()
            .map(|row| row.row.value_count())
            .sum();
        let _ = writeln!(
            text,
            "{}: {} rows, {values} values",
            scene.name,
            calibration.rows.len()
        );
        found(&mut text, calibration, findings);
        if let (None, Some(offsets)) = (written.offsets_in, offsets(calibration)) {
            let _ = writeln!(text, "  offsets     {offsets}; the scene has no key for it");
        }
        if let Some(refusal) = &written.refusal {
            let _ = writeln!(
                text,
                "  warning     the calibrated scene is refused: {refusal}"
            );
        }
        if let Some(board) = findings.board {
            board.say(&mut text);
        }
    }
    if let Some(next) = findings.next {
        let proposal = &next.proposal;
        let _ = writeln!(
            text,
            "  next        {} poses; expected error over the workspace: {} without, {} with them",
            proposal.poses.len(),
            length(proposal.before.rms_m),
            length(proposal.after.rms_m)
        );
        let poses = written.files.iter().find(|file| file.ends_with(POSES));
        let poses = poses.map_or(Path::new(POSES), PathBuf::as_path).display();
        let machine = args.scene.display();
        let _ = writeln!(text, "              trirrr run {poses} --machine {machine}");
    }
    for file in &written.files {
        let _ = writeln!(text, "  wrote       {}", file.display());
    }
    text
}

fn found(text: &mut String, calibration: &Calibration, findings: &Findings) {
    let (seen, of) = (calibration.seen(), calibration.free.len());
    let _ = writeln!(
        text,
        "  seen        {seen} of {of} directions of the free parameters"
    );
    for (list, why) in [
        (&calibration.blind, "cannot be seen, held"),
        (&calibration.weak, "seen less than it is known, held"),
    ] {
        for words in list {
            let _ = writeln!(text, "  held        {words} ({why})");
        }
    }
    for row in calibration.rows.iter().filter(|row| row.is_outlier) {
        let (line, sigmas) = (row.row.line, digits(row.sigmas));
        let _ = writeln!(
            text,
            "  outlier     line {line}: {sigmas} standard deviations off; left out"
        );
    }
    let _ = writeln!(
        text,
        "  noise       {} of what was given",
        digits(calibration.noise_factor)
    );
    let [before, after] = calibration.fit_sizes();
    let _ = writeln!(text, "  residuals   before: {}", sizes(&before));
    let _ = writeln!(text, "              after:  {}", sizes(&after));
    match calibration.check_sizes() {
        Some([before, after]) => {
            let rows = after.rows;
            let _ = writeln!(
                text,
                "  check       {rows} rows that a fit of the others did not see"
            );
            let _ = writeln!(text, "              before: {}", sizes(&before));
            let _ = writeln!(text, "              after:  {}", sizes(&after));
        }
        None => *text += "  check       too few rows to keep some out of a fit\n",
    }
    let region = findings.region;
    let _ = writeln!(
        text,
        "  workspace   {:.1} cm^2, turned by up to {:.1} degrees to both sides, at least {} and {} from singularities",
        1e4 * region.safe.area_m2(),
        region.turn_rad.to_degrees(),
        region.margin[0].max(findings.scene.limits.serial_distance_min),
        region.margin[1].max(findings.scene.limits.parallel_distance_min),
    );
    let _ = writeln!(text, "              before: {}", error(&calibration.before));
    let _ = writeln!(
        text,
        "              after, expected: {}",
        error(&calibration.after)
    );
    for index in &calibration.unlikely {
        let moved = calibration.values.0[*index] - calibration.nominal.0[*index];
        let _ = writeln!(
            text,
            "  warning     {} is {} off: far more than is expected",
            parameter_name(*index),
            quantity(*index, moved)
        );
    }
    let _ = writeln!(
        text,
        "\n  {:<26}{:>14}{:>15}{:>15}{:>8}",
        "parameter", "calibrated", "change", "deviation", "seen"
    );
    for &index in &calibration.free {
        let value = calibration.values.0[index];
        let _ = writeln!(
            text,
            "  {:<26}{:>14.6}{:>15}{:>15}{:>7.0}%",
            parameter_name(index),
            value,
            quantity(index, value - calibration.nominal.0[index]),
            quantity(index, calibration.deviations[index]),
            100.0 * calibration.shares[index]
        );
    }
    text.push('\n');
}

fn size_json(size: &ResidualSize) -> Value {
    json!({
        "rows": size.rows,
        "place_rms_m": size.place_m,
        "angle_rms_rad": size.angle_rad,
        "distance_rms_m": size.distance_m,
    })
}

fn error_json(error: &PoseError) -> Value {
    json!({
        "rms_m": error.rms_m,
        "worst_m": error.worst_m,
        "worst_at": error.worst_at,
        "rms_rad": error.rms_rad,
        "worst_rad": error.worst_rad,
    })
}

/// Everything as one object, SI units.
pub(super) fn as_json(findings: &Findings, written: &CalibrateFiles) -> Value {
    let calibration = findings.calibration.map(|it| {
        let parameter = |index: &usize| {
            json!({
                "name": parameter_name(*index),
                "unit": if is_angle(*index) { "rad" } else { "m" },
                "nominal": it.nominal.0[*index],
                "value": it.values.0[*index],
                "deviation": it.deviations[*index],
                "seen": it.shares[*index],
                "unlikely": it.unlikely.contains(index),
            })
        };
        let outliers = it.rows.iter().filter(|row| row.is_outlier);
        json!({
            "rows": it.rows.len(),
            "parameters": it.free.iter().map(parameter).collect::<Vec<_>>(),
            "offsets_rad": it.values.offsets_rad(),
            "offsets_in": written.offsets_in,
            "device": it.values.device(),
            "target": it.values.target(),
            "directions": { "free": it.free.len(), "seen": it.seen(), "signal_to_noise": it.ratios, "blind": it.blind, "weak": it.weak },
            "outliers": outliers.map(|row| json!({ "line": row.row.line, "sigmas": row.sigmas })).collect::<Vec<_>>(),
            "noise_factor": it.noise_factor,
            "residuals": it.fit_sizes().each_ref().map(size_json),
            "check": it.check_sizes().map(|sizes| sizes.each_ref().map(size_json)),
            "workspace": { "before": error_json(&it.before), "after": error_json(&it.after) },
            "refusal": written.refusal,
        })
    });
    let next = findings.next.map(|next| {
        json!({
            "poses": next.tour.iter().map(|(_, pose)| pose).collect::<Vec<_>>(),
            "gain": next.proposal.gain,
            "before": error_json(&next.proposal.before),
            "after": error_json(&next.proposal.after),
        })
    });
    json!({
        "scene": findings.scene.name,
        "region": {
            "area_m2": findings.region.safe.area_m2(),
            "turn_rad": findings.region.turn_rad,
            "margin": findings.region.margin,
        },
        "calibration": calibration,
        "board": findings.board.map(CalibratedBoard::as_json),
        "next": next,
    })
}

/// Residuals of all rows as CSV, SI units.
pub(super) fn residuals(calibration: &Calibration) -> String {
    let mut text = String::from(
        "line,kind,before_1,before_2,before_3,after_1,after_2,after_3,checked_1,checked_2,checked_3,sigmas,outlier\n",
    );
    for row in &calibration.rows {
        let JudgedRow {
            row: measured,
            sigmas,
            is_outlier,
            ..
        } = row;
        let kind = match measured.reading {
            DeviceReading::Place { .. } => "place",
            DeviceReading::Distance { .. } => "distance",
        };
        let cells = [Some(row.before), Some(row.after), row.checked].map(|values| {
            let cell = |index: usize| match values {
                Some(values) if index < measured.value_count() => format!("{:?}", values[index]),
                _ => String::new(),
            };
            [cell(0), cell(1), cell(2)].join(",")
        });
        let _ = writeln!(
            text,
            "{},{kind},{},{sigmas:?},{}",
            measured.line,
            cells.join(","),
            u8::from(*is_outlier)
        );
    }
    text
}
