//! A study as text, JSON and a table.

use super::DesignArgs;
use super::study::{ModeRow, MotorRow, Study, Surface, largest};
use crate::terminal::digits;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

const CM2: f64 = 1e4;

/// Motors in the summary for a terminal.
const MOTORS_SHOWN: usize = 8;

/// Bounds of an area in words, cm^2.
pub(super) fn area([low, high]: [f64; 2]) -> String {
    format!("{:.2} to {:.2} cm^2", CM2 * low, CM2 * high)
}

/// Cells of a row of the table of modes, after its name.
pub(super) fn mode_cells(row: &ModeRow) -> [String; 8] {
    let number = |value: Option<f64>| value.map_or("-".into(), digits);
    let figures = row.result.figures.filter(|_| row.is_feasible());
    let of =
        |value: fn(&trirrr_design::modes::ModeFigures) -> f64| number(figures.as_ref().map(value));
    [
        number(row.duration_s.filter(|_| row.is_feasible())),
        of(|figures| largest(figures.torque_peak_nm)),
        of(|figures| largest(figures.torque_rms_nm)),
        of(|figures| largest(figures.rate_peak_rad_s)),
        of(|figures| figures.work_j),
        of(|figures| figures.serial_min),
        of(|figures| figures.parallel_min),
        of(|figures| 100.0 * figures.time_at_limits),
    ]
}

/// Heads of the table of modes.
pub(super) const MODE_HEADS: [&str; 9] = [
    "elbows",
    "duration, s",
    "peak torque, N m",
    "RMS torque, N m",
    "peak rate, rad/s",
    "work, J",
    "least serial distance",
    "least parallel distance",
    "time at limits, %",
];

/// Heads of the table of motors.
pub(super) const MOTOR_HEADS: [&str; 14] = [
    "motor",
    "gear",
    "supply, V",
    "supply needed, V",
    "curve",
    "torque margin",
    "heat margin",
    "limited by",
    "peak, N m",
    "RMS, N m",
    "part of the speed",
    "rotor / machine inertia",
    "brought back by each, J",
    "least time, s",
];

/// Cells of a row of the table of motors, after its name.
pub(super) fn motor_cells(row: &MotorRow) -> [String; 13] {
    let MotorRow {
        motor, candidate, ..
    } = row;
    [
        candidate.gear_ratio.to_string(),
        motor.supply_v.to_string(),
        match candidate.supply_needed_v {
            Some(supply) if supply.is_finite() => digits(supply),
            Some(_) => "none is enough".into(),
            None => "-".into(),
        },
        motor.curve_source().into(),
        digits(candidate.peak_margin),
        candidate.heat_margin.map_or("-".into(), digits),
        candidate.limited_by().into(),
        digits(candidate.torque_peak_nm),
        digits(candidate.torque_rms_nm),
        digits(candidate.speed_part),
        candidate.inertia_ratio.map_or("unknown".into(), digits),
        candidate.regenerated_j.map_or("unknown".into(), digits),
        match (row.least_time_s, candidate.inertia_ratio) {
            (Some(time_s), _) => digits(time_s),
            (None, Some(_)) => "-".into(),
            (None, None) => "unknown".into(),
        },
    ]
}

/// Summary for a terminal.
pub(super) fn summary(study: &Study, args: &DesignArgs, files: &[PathBuf]) -> String {
    let mut text = format!("{}: {}\n\n", study.scene.name, study.scene.description);
    let _ = writeln!(
        text,
        "{:<7} {:>9} {:>10} {:>10} {:>10} {:>9} {:>8} {:>9} {:>8}",
        "elbows",
        "time s",
        "peak N m",
        "rms N m",
        "rad/s",
        "work J",
        "serial",
        "parallel",
        "limit %"
    );
    for row in &study.modes {
        let [time, peak, rms, rate, work, serial, parallel, limits] = mode_cells(row);
        let own = if row.result.elbows == study.own_mode() {
            "*"
        } else {
            ""
        };
        let _ = match row.reason() {
            Some(reason) => writeln!(text, "{:<7} no: {reason}", row.result.name() + own),
            None => writeln!(
                text,
                "{:<7} {time:>9} {peak:>10} {rms:>10} {rate:>10} {work:>9} {serial:>8} {parallel:>9} {limits:>8}",
                row.result.name() + own
            ),
        };
    }
    text += "* the mode of the scene\n\n";
    if let Some(best) = study
        .best_mode()
        .filter(|best| best.result.elbows != study.own_mode())
    {
        let signs = best.result.elbows.map(|elbow| elbow.sign());
        let _ = writeln!(
            text,
            "least peak torque: elbows {}, {}, {}\n",
            signs[0], signs[1], signs[2]
        );
    }
    let alpha = study.alpha_rad.to_degrees();
    let turn = if args.turn > 0.0 {
        format!(" +- {}", args.turn)
    } else {
        String::new()
    };
    let _ = writeln!(text, "alpha       {alpha:.3}{turn} degrees");
    let _ = writeln!(text, "reach       {}", area(study.reach.area_m2()));
    let _ = writeln!(
        text,
        "workspace   {}, {:.2} cm^2 connected with the start, undecided {:.3} % of the map",
        area(study.work.map.area_m2()),
        CM2 * study.work.connected_m2(),
        100.0 * study.work.map.undecided()
    );
    shapes(&mut text, &study.work);
    let _ = writeln!(
        text,
        "all angles  {}, {:.2} cm^2 connected with the start",
        area(study.total.map.area_m2()),
        CM2 * study.total.connected_m2()
    );
    shapes(&mut text, &study.total);
    text += "\njoint       peak N      rms N\n";
    for (leg, joints) in study.reactions.forces.iter().enumerate() {
        for (joint, force) in ["A", "B", "C"].iter().zip(joints) {
            let name = format!("{joint}{}", leg + 1);
            let _ = writeln!(
                text,
                "{name:<8} {:>9} {:>10}",
                digits(force.peak_n),
                digits(force.rms_n)
            );
        }
    }
    let _ = writeln!(
        text,
        "\n{:<26} {:>5} {:>6} {:>8} {:>8} {:>7} {:>8}",
        "motor", "gear", "V", "torque", "heat", "limit", "time s"
    );
    for row in study.motors.iter().take(MOTORS_SHOWN) {
        let [gear, supply, _, _, torque, heat, limit, .., time] = motor_cells(row);
        let _ = writeln!(
            text,
            "{:<26} {gear:>5} {supply:>6} {torque:>8} {heat:>8} {limit:>7} {time:>8}",
            row.motor.name
        );
    }
    text += "margins: what there is over what is asked for; below 1 the motor does not do the job; time: the least in which it does\n";
    text.push('\n');
    for (index, file) in files.iter().enumerate() {
        let head = if index == 0 { "written" } else { "" };
        let _ = writeln!(text, "{head:<11} {}", file.display());
    }
    text
}

/// Largest circle and rectangle of a surface.
fn shapes(text: &mut String, surface: &Surface) {
    if let Some(disc) = surface.disc {
        let [x, y] = disc.centre_m;
        let _ = writeln!(
            text,
            "circle      radius {:.4} m about {x:.4}, {y:.4}",
            disc.radius_m
        );
    }
    if let Some(rectangle) = surface.rectangle {
        let ([x, y], [width, height]) = (rectangle.low_m, rectangle.size_m);
        let _ = writeln!(
            text,
            "rectangle   {width:.4} m by {height:.4} m from {x:.4}, {y:.4}"
        );
    }
}

/// Everything as JSON, in SI units.
pub(super) fn as_json(study: &Study, args: &DesignArgs) -> Value {
    let mode = |row: &ModeRow| {
        let figures = row.result.figures.map(|figures| {
            json!({
                "torque_peak_nm": figures.torque_peak_nm,
                "torque_rms_nm": figures.torque_rms_nm,
                "rate_peak_rad_s": figures.rate_peak_rad_s,
                "power_peak_w": figures.power_peak_w,
                "work_j": figures.work_j,
                "serial_distance_min": figures.serial_min,
                "parallel_distance_min": figures.parallel_min,
                "limit_part": figures.limit_part,
                "time_at_limits": figures.time_at_limits,
            })
        });
        // Of a mode that ends early, the peaks of a part would be taken for those of the job.
        let whole = row.result.figures.filter(|_| row.is_feasible());
        let greatest = |of_motors: [f64; 3]| of_motors.into_iter().fold(0.0, f64::max);
        json!({
            "elbows": row.result.elbows.map(|elbow| elbow.sign() as i32),
            "feasible": row.is_feasible(),
            "peak_torque_nm": whole.map(|figures| greatest(figures.torque_peak_nm)),
            "rms_torque_nm": whole.map(|figures| greatest(figures.torque_rms_nm)),
            "reason": row.reason(),
            "duration_s": row.duration_s,
            "figures": figures,
        })
    };
    let disc = |surface: &Surface| {
        let disc = surface.disc;
        disc.map(|disc| json!({ "centre_m": disc.centre_m, "radius_m": disc.radius_m }))
    };
    let rectangle = |surface: &Surface| {
        let rectangle = surface.rectangle;
        rectangle.map(|each| json!({ "low_m": each.low_m, "size_m": each.size_m }))
    };
    let map = |map: &trirrr_design::workspace::Workspace| {
        let [lower, upper] = map.area_m2();
        json!({
            "alpha_rad": study.alpha_rad,
            "area_lower_m2": lower,
            "area_upper_m2": upper,
            "undecided": map.undecided(),
        })
    };
    json!({
        "scene": study.scene.name,
        "elbows": study.own_mode().map(|elbow| elbow.sign() as i32),
        "best_elbows": study.best_mode().map(|row| row.result.elbows.map(|elbow| elbow.sign() as i32)),
        "modes": study.modes.iter().map(mode).collect::<Vec<_>>(),
        "turn_rad": args.turn.to_radians(),
        "cells": study.work.map.grid.size,
        "reach": map(&study.reach),
        "workspace": map(&study.work.map),
        "connected_m2": study.work.connected_m2(),
        "disc": disc(&study.work),
        "rectangle": rectangle(&study.work),
        "total_orientation": {
            "workspace": map(&study.total.map),
            "connected_m2": study.total.connected_m2(),
            "disc": disc(&study.total),
            "rectangle": rectangle(&study.total),
        },
        "load_n": study.case.load_n,
        "acceleration_m_s2": study.case.acceleration_m_s2,
        "stiffness_nm_rad": study.stiffness_nm_rad,
        "alphas": study.alphas.iter().map(|row| json!({
            "alpha_rad": row.degrees.to_radians(),
            "area_m2": row.area_m2,
            "rate_per_speed_rad_m": row.values.map(|values| values[0]),
            "torque_nm": row.values.map(|values| values[1]),
            "offset_m": row.values.map(|values| values[2]),
            "compliance_m_n": row.values.filter(|_| study.stiffness_nm_rad.is_some()).map(|values| values[3]),
        })).collect::<Vec<_>>(),
        "motors": study.motors.iter().map(motor_json).collect::<Vec<_>>(),
        "joints": study.reactions.forces.map(|leg| leg.map(|force| json!({ "peak_n": force.peak_n, "rms_n": force.rms_n }))),
        "durations": study.durations.iter().map(|(seconds, figures)| json!({
            "duration_s": seconds,
            "torque_peak_nm": figures.torque_peak_nm,
            "torque_rms_nm": figures.torque_rms_nm,
            "power_peak_w": figures.power_peak_w,
            "work_j": figures.work_j,
        })).collect::<Vec<_>>(),
    })
}

fn motor_json(row: &MotorRow) -> Value {
    let MotorRow {
        motor, candidate, ..
    } = row;
    json!({
        "name": motor.name,
        "gear_ratio": candidate.gear_ratio,
        "supply_v": motor.supply_v,
        "supply_needed_v": candidate.supply_needed_v,
        "curve": motor.curve_source(),
        "peak_margin": candidate.peak_margin,
        "heat_margin": candidate.heat_margin,
        "margin": candidate.margin(),
        "limited_by": candidate.limited_by(),
        "torque_peak_nm": candidate.torque_peak_nm,
        "torque_rms_nm": candidate.torque_rms_nm,
        "speed_part": candidate.speed_part,
        "inertia_ratio": candidate.inertia_ratio,
        "regenerated_j": candidate.regenerated_j,
        "least_time_s": row.least_time_s,
        "mass_kg": motor.mass_kg,
        "source": motor.source,
    })
}

/// Values at the cells that the machine works in, as CSV in SI units. What the scene does not tell is empty.
pub(super) fn map_table(study: &Study) -> String {
    let mut text = String::from(
        "x_m,y_m,serial,parallel,rate_per_speed_rad_m,torque_per_force_m,offset_per_error_m_rad,torque_nm,force_limit_n,compliance_m_n,tolerance_m\n",
    );
    let grid = &study.coarse;
    for (index, each) in study.loads.iter().enumerate() {
        let Some(each) = each else {
            continue;
        };
        let [x, y] = grid.centre_m(index % grid.size[0], index / grid.size[0]);
        let ratios = &each.ratios;
        let [serial, parallel] = ratios.distances;
        let limits = study.scene.limits.torque_nm;
        let errors = study.errors_m.as_ref();
        let values = [
            Some(x),
            Some(y),
            Some(serial),
            Some(parallel),
            Some(ratios.rate_per_speed()),
            Some(ratios.torque_per_force()),
            Some(ratios.offset_per_error()),
            Some(study.case.torque_nm(each)),
            limits.map(|limits| each.force_n(limits)),
            study
                .stiffness_nm_rad
                .map(|each_nm| each.compliance_m_n(each_nm)),
            errors.and_then(|errors| errors[index]),
        ];
        let cells = values.map(|value| value.map_or(String::new(), |value| format!("{value:?}")));
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}
