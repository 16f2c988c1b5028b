//! Calibration of a machine from measurements.

use crate::closure::LoopClosure;
use crate::directions::scaled_slopes;
use crate::first_poses::{NominalMachine, aligned};
use crate::forecast::{PoseError, deviation, uncalibrated};
use crate::measurement::{DeviceReading, MeasuredRow};
use crate::outliers::{FoundValues, MeasuredRows, Spread, fit, without_outliers};
use crate::parameter::{DEVICE, KinematicVector, PARAMETER_COUNT, ParameterGroup};
use crate::refusal::{CalibrationRefusal, MOST_LEFT};
use crate::result::{Calibration, JudgedRow};
use crate::setup::CalibrationSetup;
use nalgebra::DMatrix;
use trirrr_core::machine::Parameters;

/// Each so many rows one is kept out of the fit that is checked.
const CHECKED_EVERY: usize = 5;

/// Deviations, in parts of the expected one, from which on a parameter is told.
const UNLIKELY: f64 = 5.0;

/// Median distance of measured from nominal places, in parts of the expected deviation, from which on the frames differ.
const OTHER_FRAME: f64 = 30.0;

/// Calibrates the machine of `machine`, which stands at the pose `start` (m, m, rad) in its assembly mode, by `rows`. Errors are
/// told over `places`, poses of its workspace.
///
/// # Errors
/// [`CalibrationRefusal`]: rows that fit no pose, or measurements that see nothing useful.
pub fn calibrate(
    machine: &Parameters,
    start: [f64; 3],
    rows: &[MeasuredRow],
    setup: &CalibrationSetup,
    places: &[[f64; 3]],
) -> Result<Calibration, CalibrationRefusal> {
    let nominal = NominalMachine::new(machine, start).ok_or(CalibrationRefusal::Machine)?;
    let given = KinematicVector::of(machine, setup.device, setup.target);
    let is_device_free = setup.free.contains(&ParameterGroup::Device);
    let closed = nominal
        .poses(&given, rows, !is_device_free)
        .map_err(CalibrationRefusal::Rows)?;
    let base = match is_device_free {
        true => aligned(&given, rows, &closed).unwrap_or(given),
        false => given,
    };
    check_frame(setup, rows, &base, &closed)?;
    if setup.free_indices().is_empty() {
        return Err(CalibrationRefusal::NothingFree);
    }
    let all = MeasuredRows {
        rows: rows.to_vec(),
        closed: closed.clone(),
    };
    let (kept, found) = without_outliers(setup, all, base)?;
    let inside = |line: u32| kept.rows.iter().any(|row| row.line == line);
    let FoundValues { directions, fitted } = &found;
    check_use(setup, &nominal, &kept, &found, &base, places)?;

    let spread = Spread::of(&kept, &found);
    let checked = check_rows(setup, &kept, base, directions.sight.seen.ncols());
    let everywhere = nominal_closures(rows, &fitted.values, &closed);
    let judged = rows.iter().enumerate().map(|(index, row)| {
        let at = everywhere[index];
        JudgedRow {
            row: *row,
            before: row.differences(&base, closed[index].pose),
            after: row.differences(&fitted.values, at.pose),
            checked: checked
                .iter()
                .find(|(line, _)| *line == row.line)
                .map(|(_, off)| *off),
            sigmas: largest(&row.residuals(&fitted.values, at.pose)[..row.value_count()]),
            is_outlier: !inside(row.line),
        }
    });
    let rows_judged: Vec<JudgedRow> = judged.collect();
    let [blind, weak] = directions.words(&fitted.values, rows);
    let mut shares = [0.0; PARAMETER_COUNT];
    for (share, index) in directions.sight.shares().iter().zip(&directions.free) {
        shares[*index] = *share;
    }
    let values = fitted.values;
    let (before, after) = forecast(&nominal, &values, &spread.covariance, places);
    let unlikely = directions.free.iter().copied().filter(|&index| {
        let moved = (values.0[index] - base.0[index]).abs();
        index < DEVICE && moved > UNLIKELY * directions.expected[index]
    });
    Ok(Calibration {
        nominal: base,
        values,
        deviations: spread.deviations,
        shares,
        ratios: directions.sight.ratios.clone(),
        blind,
        weak,
        rows: rows_judged,
        noise_factor: spread.noise_factor,
        before,
        after,
        unlikely: unlikely.collect(),
        information: {
            let slopes = scaled_slopes(setup, &kept.rows, &fitted.values, &fitted.closed);
            slopes.transpose() * slopes
        },
        free: directions.free.clone(),
    })
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Poses of rows with other parameters; the nominal pose where a loop does not close, as of an outlier.
fn nominal_closures(
    rows: &[MeasuredRow],
    values: &KinematicVector,
    closed: &[LoopClosure],
) -> Vec<LoopClosure> {
    let each = rows.iter().zip(closed).map(|(row, start)| {
        crate::closure::close(values, &row.angles_rad, start.pose).unwrap_or(*start)
    });
    each.collect()
}

/// Refuses places that lie far from those of the machine as it is.
fn check_frame(
    setup: &CalibrationSetup,
    rows: &[MeasuredRow],
    base: &KinematicVector,
    closed: &[LoopClosure],
) -> Result<(), CalibrationRefusal> {
    let mut off: Vec<f64> = rows
        .iter()
        .zip(closed)
        .map(|(row, at)| {
            let [x, y, _] = row.differences(base, at.pose);
            x.hypot(y)
        })
        .collect();
    off.sort_by(f64::total_cmp);
    let median_m = off[off.len() / 2];
    if median_m <= OTHER_FRAME * setup.expected_m {
        return Ok(());
    }
    let places = rows.iter().map(|row| match row.reading {
        DeviceReading::Place { place_m, .. } => place_m[0].hypot(place_m[1]),
        DeviceReading::Distance { distance_m, .. } => distance_m,
    });
    let hint = match places.fold(0.0, f64::max) > 20.0 {
        true => "lengths in mm stand in columns x_mm, y_mm, distance_mm",
        false if setup.free.contains(&ParameterGroup::Device) => {
            "are the motors in their order, and the angles those of the scene?"
        }
        false => {
            "a device with a frame of its own needs --free device, or its place by --device; or the motors are in another order"
        }
    };
    Err(CalibrationRefusal::OtherFrame {
        median_m,
        expected_m: setup.expected_m,
        hint,
    })
}

/// Refuses measurements that leave most of the error that is expected over the workspace.
fn check_use(
    setup: &CalibrationSetup,
    nominal: &NominalMachine,
    rows: &MeasuredRows,
    found: &FoundValues,
    base: &KinematicVector,
    places: &[[f64; 3]],
) -> Result<(), CalibrationRefusal> {
    let expected = setup.expected();
    let is_part = |index: usize| index < DEVICE && setup.free_indices().contains(&index);
    let prior = DMatrix::from_fn(PARAMETER_COUNT, PARAMETER_COUNT, |row, column| {
        match row == column && is_part(row) {
            true => expected[row] * expected[row],
            false => 0.0,
        }
    });
    let covariance = Spread::of(rows, found).covariance;
    let over = |covariance: &DMatrix<f64>| {
        let each = places.iter().filter_map(|pose| {
            let angles = nominal.angles(*pose)?;
            Some((*pose, deviation(base, covariance, &angles, *pose)))
        });
        PoseError::over(each).rms_m
    };
    let (known, left) = (over(&prior), over(&covariance));
    if left <= MOST_LEFT * known || known == 0.0 {
        return Ok(());
    }
    let unseen = found.directions.words(base, &rows.rows).concat();
    let words = match unseen.is_empty() {
        true => "every direction is seen, but no machine near the scene's explains the rows".into(),
        false => unseen.join("; "),
    };
    Err(CalibrationRefusal::Useless {
        left_percent: 100.0 * left / known,
        words,
    })
}

/// Fits without one row of [`CHECKED_EVERY`], and returns the differences of those rows with their lines. Empty where the rest sees less than all rows do.
fn check_rows(
    setup: &CalibrationSetup,
    rows: &MeasuredRows,
    base: KinematicVector,
    seen: usize,
) -> Vec<(u32, [f64; 3])> {
    let is_checked = |index: usize| index % CHECKED_EVERY == CHECKED_EVERY / 2;
    let part = |checked: bool| {
        let kept = (0..rows.rows.len()).filter(|index| is_checked(*index) == checked);
        let kept: Vec<usize> = kept.collect();
        MeasuredRows {
            rows: kept.iter().map(|index| rows.rows[*index]).collect(),
            closed: kept.iter().map(|index| rows.closed[*index]).collect(),
        }
    };
    let (training, check) = (part(false), part(true));
    let Ok(found) = fit(setup, &training, base) else {
        return Vec::new();
    };
    if found.directions.sight.seen.ncols() < seen {
        return Vec::new();
    }
    let values = &found.fitted.values;
    let each = check
        .rows
        .iter()
        .zip(&check.closed)
        .filter_map(|(row, start)| {
            let at = crate::closure::close(values, &row.angles_rad, start.pose)?;
            Some((row.line, row.differences(values, at.pose)))
        });
    each.collect()
}

/// Errors over places, before by the fitted machine, and after by its covariance.
fn forecast(
    nominal: &NominalMachine,
    values: &KinematicVector,
    covariance: &DMatrix<f64>,
    places: &[[f64; 3]],
) -> (PoseError, PoseError) {
    let before = places.iter().filter_map(|pose| {
        let [x, y, angle] = uncalibrated(nominal, values, *pose)?;
        Some((*pose, [x.hypot(y), angle]))
    });
    let after = places.iter().filter_map(|pose| {
        let angles = angles_told(nominal.parameters, values, *pose)?;
        Some((*pose, deviation(values, covariance, &angles, *pose)))
    });
    (PoseError::over(before), PoseError::over(after))
}

/// Angles that the encoders of the machine of `values` tell at a pose, rad.
pub(crate) fn angles_told(
    parameters: &Parameters,
    values: &KinematicVector,
    pose: [f64; 3],
) -> Option<[f64; 3]> {
    let own = values.put_into(parameters);
    let machine = NominalMachine::new(&own, pose)?;
    let (angles, offsets) = (machine.angles(pose)?, values.offsets_rad());
    Some([0, 1, 2].map(|motor| angles[motor] - offsets[motor]))
}
