//! A calibration as a document, and its table of residuals.

use super::{CalibrateArgs, CalibrateFiles, Findings, POSES};
use std::path::{Path, PathBuf};
use trirrr_calibration::{
    Calibration, DeviceReading, JudgedRow, PoseError, ResidualSize, is_angle, parameter_name,
};
use trirrr_figures::document::{Document, Facts, csv, digits, quantity};

/// Unit of a parameter.
fn unit(index: usize) -> &'static str {
    match is_angle(index) {
        true => "rad",
        false => "m",
    }
}

fn sizes(size: &ResidualSize) -> Facts {
    Facts::new()
        .data("rows", size.rows)
        .pair("place_rms_m", "place", size.place_m)
        .pair("angle_rms_rad", "angle", size.angle_rad)
        .pair("distance_rms_m", "distance", size.distance_m)
}

fn error(error: &PoseError) -> Facts {
    let [x, y, alpha] = error.worst_at;
    let place = format!("x = {x:.4} m, y = {y:.4} m, alpha = {alpha:.4} rad");
    Facts::new()
        .pair("rms_m", "RMS", error.rms_m)
        .pair("worst_m", "worst", error.worst_m)
        .pair("worst_at", "at", error.worst_at)
        .words(place)
        .pair("rms_rad", "angle RMS", error.rms_rad)
        .data("worst_rad", error.worst_rad)
}

/// Lines for values before and after.
fn compared(before: Facts, after: Facts) -> [String; 2] {
    [
        format!("before: {}", before.line()),
        format!("after:  {}", after.line()),
    ]
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

/// Everything that was found.
pub(super) fn document(
    findings: &Findings,
    args: &CalibrateArgs,
    written: &CalibrateFiles,
) -> Document {
    let mut document = Document::new();
    let region = findings.region;
    let [serial, parallel] = region.margin;
    let limits = &findings.scene.limits;
    let workspace = format!(
        "{:.1} cm^2, turned by up to {:.1} degrees to both sides, at least {} and {} from singularities",
        1e4 * region.safe.area_m2(),
        region.turn_rad.to_degrees(),
        serial.max(limits.serial_distance_min),
        parallel.max(limits.parallel_distance_min),
    );
    document.pairs(
        Facts::new()
            .pair("scene", "scene", &findings.scene.name)
            .pair("region.area_m2", "workspace", region.safe.area_m2())
            .words(workspace)
            .data("region.turn_rad", region.turn_rad)
            .data("region.margin", region.margin),
    );
    match findings.calibration {
        Some(calibration) => found(&mut document, calibration, written),
        None => {
            document.data("calibration", ());
        }
    }
    let board = findings.board.map(super::board::CalibratedBoard::record);
    let next = findings.next.map(|next| {
        let proposal = &next.proposal;
        let expected = format!(
            "{} poses; expected error over the workspace: {} without, {} with them",
            proposal.poses.len(),
            quantity(proposal.before.rms_m, "m"),
            quantity(proposal.after.rms_m, "m")
        );
        let poses = written.files.iter().find(|file| file.ends_with(POSES));
        let poses = poses.map_or(Path::new(POSES), PathBuf::as_path).display();
        let command = format!("trirrr run {poses} --machine {}", args.scene.display());
        Facts::new()
            .text("next", vec![expected, command])
            .data(
                "poses",
                next.tour.iter().map(|(_, pose)| pose).collect::<Vec<_>>(),
            )
            .data("gain", proposal.gain)
            .data("before", error(&proposal.before))
            .data("after", error(&proposal.after))
    });
    for (key, record) in [("board", board), ("next", next)] {
        match record {
            Some(record) => document.pairs_in(key, record),
            None => document.data(key, ()),
        };
    }
    document
}

/// Directions of the free parameters, those that were seen of all, and the lines why parameters are held, with `others` behind them.
pub(crate) fn directions(
    [seen, of]: [usize; 2],
    ratios: &[f64],
    [blind, weak]: [&[String]; 2],
    others: impl IntoIterator<Item = String>,
) -> Facts {
    let blind_lines = blind
        .iter()
        .map(|it| format!("{it} (cannot be seen, held)"));
    let weak_lines = weak
        .iter()
        .map(|it| format!("{it} (seen less than it is known, held)"));
    let held = blind_lines.chain(weak_lines).chain(others);
    Facts::new()
        .pair("directions.seen", "seen", seen)
        .words(format!("{seen} of {of} directions of the free parameters"))
        .data("directions.free", of)
        .data("directions.signal_to_noise", ratios)
        .data("directions.blind", blind)
        .data("directions.weak", weak)
        .text("held", held.collect::<Vec<_>>())
}

fn found(document: &mut Document, it: &Calibration, written: &CalibrateFiles) {
    let values: usize = it.rows.iter().map(|row| row.row.value_count()).sum();
    let outliers: Vec<_> = it.rows.iter().filter(|row| row.is_outlier).collect();
    let left_out = outliers.iter().map(|row| {
        let (line, sigmas) = (row.row.line, digits(row.sigmas));
        format!("line {line}: {sigmas} standard deviations off; left out")
    });
    let left_out = left_out.collect::<Vec<_>>();
    let outliers = outliers.iter().map(|row| {
        Facts::new()
            .data("line", row.row.line)
            .data("sigmas", row.sigmas)
    });
    let residuals = it.fit_sizes().each_ref().map(sizes);
    let check = it.check_sizes();
    let check_lines = match &check {
        None => vec!["too few rows to keep some out of a fit".into()],
        Some([before, after]) => {
            let rows = format!("{} rows that a fit of the others did not see", after.rows);
            let lines = compared(sizes(before), sizes(after));
            [rows].into_iter().chain(lines).collect()
        }
    };
    let unlikely = it.unlikely.iter().map(|&index| {
        let moved = quantity(it.values.0[index] - it.nominal.0[index], unit(index));
        let name = parameter_name(index);
        format!("{name} is {moved} off: far more than is expected")
    });
    let refusal = written.refusal.as_ref();
    let refused = refusal.map(|refusal| format!("the calibrated scene is refused: {refusal}"));
    let no_key = match written.offsets_in {
        None => offsets(it),
        Some(_) => None,
    };
    let errors = compared(error(&it.before), error(&it.after));
    document.pairs_in(
        "calibration",
        Facts::new()
            .pair("rows", "rows", it.rows.len())
            .words(format!("{} with {values} values", it.rows.len()))
            .and(directions(
                [it.seen(), it.free.len()],
                &it.ratios,
                [&it.blind, &it.weak],
                [],
            ))
            .text("outlier", left_out)
            .rows("outliers", outliers)
            .pair("noise_factor", "noise", it.noise_factor)
            .words(format!("{} of what was given", digits(it.noise_factor)))
            .text(
                "residuals",
                compared(residuals[0].clone(), residuals[1].clone()).to_vec(),
            )
            .data("residuals", residuals)
            .text("check", check_lines)
            .data("check", check.map(|of| of.each_ref().map(sizes)))
            .text("errors", errors.to_vec())
            .data("workspace.before", error(&it.before))
            .data("workspace.after", error(&it.after))
            .text(
                "offsets",
                no_key.map(|offsets| format!("{offsets}; the scene has no key for it")),
            )
            .data("offsets_rad", it.values.offsets_rad())
            .data("offsets_in", written.offsets_in)
            .data("device", it.values.device())
            .data("target", it.values.target())
            .text("warning", Vec::from_iter(unlikely.chain(refused)))
            .data("refusal", refusal),
    );
    let parameter = |&index: &usize| {
        let (nominal, value, unit) = (it.nominal.0[index], it.values.0[index], unit(index));
        Facts::new()
            .pair("name", "parameter", parameter_name(index))
            .pair("value", "calibrated", value)
            .in_unit("")
            .decimals(6)
            .pair("unit", "", unit)
            .text("change", quantity(value - nominal, unit))
            .pair("deviation", "deviation", it.deviations[index])
            .words(quantity(it.deviations[index], unit))
            .pair("seen", "seen", it.shares[index])
            .words(format!("{:.0} %", 100.0 * it.shares[index]))
            .data("nominal", nominal)
            .data("unlikely", it.unlikely.contains(&index))
    };
    document.table(
        "calibration.parameters",
        it.free.iter().map(parameter).collect(),
    );
}

/// Residuals of all rows as CSV, SI units.
pub(super) fn residuals(calibration: &Calibration) -> String {
    let row = |row: &JudgedRow| {
        let measured = &row.row;
        let kind = match measured.reading {
            DeviceReading::Place { .. } => "place",
            DeviceReading::Distance { .. } => "distance",
        };
        let mut record = Facts::new().data("line", measured.line).data("kind", kind);
        for (name, values) in [
            ("before", Some(row.before)),
            ("after", Some(row.after)),
            ("checked", row.checked),
        ] {
            for index in 0..3 {
                let value = values.filter(|_| index < measured.value_count());
                let value = value.map(|values| values[index]);
                record = record.data(format!("{name}_{}", index + 1), value);
            }
        }
        record
            .data("sigmas", row.sigmas)
            .data("outlier", row.is_outlier)
    };
    csv(&calibration.rows.iter().map(row).collect::<Vec<_>>())
}
