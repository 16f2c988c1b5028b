//! Figures of motors: what the job asks of a motor, under what the motor gives.

use super::study::{MotorRow, Study};
use trirrr_design::motors::CatalogueMotor;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::scatter::{Over, Scatter, Series, draw};
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
    let peak = match motor.curve_source() {
        "estimated" => "pull-out, estimated",
        _ => "peak torque",
    };
    let mut series = vec![
        Series::dots("the job", 2.0, asked).coloured(faded(BLUE, 0.6)),
        Series::line(peak, curve(motor, end)).coloured(VERMILLION),
    ];
    if let Some(torque) = motor.torque_continuous_nm {
        let level = |label, torque: f64| Series::line(label, vec![[0.0, torque], [end, torque]]);
        series.push(level("continuous torque", torque).coloured(GREEN));
        series.push(level("RMS of the job", candidate.torque_rms_nm).coloured(BLUE));
    }
    let over = |quantity, unit| Over::Linear {
        quantity,
        unit,
        from: Some(0.0),
    };
    let title = format!(
        "{}: {}, gear {}, {} V",
        study.scene.name, motor.name, candidate.gear_ratio, motor.supply_v
    );
    draw(&Scatter {
        title: &title,
        x: over("speed at the shaft", "rad/s"),
        y: over("torque at the shaft", "N m"),
        series: &series,
        marks: &[],
        fronts: &[],
    })
}

fn curve(motor: &CatalogueMotor, end: f64) -> Vec<[f64; 2]> {
    let speed = |index: u32| f64::from(index) / f64::from(CURVE_POINTS) * end;
    (0..=CURVE_POINTS)
        .map(|index| [speed(index), motor.torque_at(speed(index))])
        .collect()
}
