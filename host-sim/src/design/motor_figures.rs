//! Figures of motors: what the job asks of a motor, under what the motor gives.

use super::scatter::{ScatterAxis, ScatterMarks, ScatterSet, scatter};
use super::study::{MotorRow, Study};
use trirrr_design::motors::CatalogueMotor;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::style::{BLUE, GREEN, VERMILLION, faded};

/// Names of the figures, of the first motors.
pub(super) const NAMES: [&str; 3] = ["motor-1", "motor-2", "motor-3"];

/// Points of the job in a figure, at most: those that are left out lie between those that are there.
const POINTS: usize = 1500;

/// Points of a curve.
const CURVE_POINTS: u32 = 160;

/// Figures of the first motors, by their names.
pub(super) fn all(study: &Study) -> Vec<(&'static str, String)> {
    let drawn = NAMES.into_iter().zip(&study.motors);
    drawn
        .filter_map(|(name, row)| Some((name, motor(study, row).ok()?)))
        .collect()
}

/// Speeds and torques of the job at the shaft, and the curve of the motor.
fn motor(study: &Study, row: &MotorRow) -> Drawn {
    let MotorRow {
        motor, candidate, ..
    } = row;
    let step = row.points.len().div_ceil(POINTS).max(1);
    let points = row.points.iter().step_by(step);
    let asked: Vec<[f64; 2]> = points.map(|[rate, own]| [rate.abs(), own.abs()]).collect();
    let fastest = asked.iter().map(|point| point[0]).fold(0.0, f64::max);
    // Not all of a curve that reaches far beyond the job.
    let end = motor.no_load_rad_s().min((4.0 * fastest).max(1.0));
    let mut sets = vec![ScatterSet {
        label: "the job".into(),
        colour: faded(BLUE, 0.6),
        marks: ScatterMarks::Dots(2.0),
        points: asked,
    }];
    sets.push(ScatterSet {
        label: match motor.curve_source() {
            "estimated" => "pull-out, estimated".into(),
            _ => "peak torque".into(),
        },
        colour: VERMILLION,
        marks: ScatterMarks::Line,
        points: curve(motor, end),
    });
    if let Some(torque) = motor.torque_continuous_nm {
        let level = |torque: f64| vec![[0.0, torque], [end, torque]];
        sets.push(ScatterSet {
            label: "continuous torque".into(),
            colour: GREEN,
            marks: ScatterMarks::Line,
            points: level(torque),
        });
        sets.push(ScatterSet {
            label: "RMS of the job".into(),
            colour: BLUE,
            marks: ScatterMarks::Line,
            points: level(candidate.torque_rms_nm),
        });
    }
    let axis = |quantity, unit| ScatterAxis {
        quantity,
        unit,
        from: Some(0.0),
    };
    let title = format!(
        "{}: {}, gear {}, {} V",
        study.scene.name, motor.name, candidate.gear_ratio, motor.supply_v
    );
    let axes = [
        axis("speed at the shaft", "rad/s"),
        axis("torque at the shaft", "N m"),
    ];
    scatter(&title, axes, &sets)
}

fn curve(motor: &CatalogueMotor, end: f64) -> Vec<[f64; 2]> {
    let speed = |index: u32| f64::from(index) / f64::from(CURVE_POINTS) * end;
    (0..=CURVE_POINTS)
        .map(|index| [speed(index), motor.torque_at(speed(index))])
        .collect()
}
