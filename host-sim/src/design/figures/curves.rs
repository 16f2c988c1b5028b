//! Curves over the angle of the platform, along the job, and over its duration.

use crate::design::study::{AlphaRow, Study};
use trirrr_design::modes::ModeFigures;
use trirrr_design::ratios::RatioInstant;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::panel::{Curve, LimitLine, Panel, draw, draw_over};
use trirrr_figures::scale::{Axis, Margin};
use trirrr_figures::style::{AREA, INK, LIMIT, MOTORS, RGBColor};

const MOTOR_NAMES: [&str; 3] = ["motor 1", "motor 2", "motor 3"];

fn over_angles(study: &Study, title: &str, panels: &[Panel]) -> Drawn {
    let axis = Axis::new(-180.0, 180.0, "", Margin::Exact, 12.0);
    let title = format!("{}: {title}", study.scene.name);
    draw_over(&title, "\u{3b1}, degrees", &axis, panels)
}

/// A curve over the angle; where there is no value, a gap.
fn angle_curve(
    study: &Study,
    label: &'static str,
    colour: RGBColor,
    of: impl Fn(&AlphaRow) -> Option<f64>,
) -> Curve {
    let rows = study.alphas.iter();
    Curve {
        label: label.into(),
        points: rows
            .map(|row| (row.degrees, of(row).unwrap_or(f64::NAN)))
            .collect(),
        colour: Some(colour),
        dashed: false,
    }
}

/// Area over the angle of the platform.
pub(super) fn angles(study: &Study) -> Drawn {
    let bound = |label, bound: usize, colour| {
        angle_curve(study, label, colour, move |row| {
            Some(1e4 * row.area_m2[bound])
        })
    };
    let panel = Panel {
        quantity: "area within the limits, cm\u{b2}",
        from_zero: true,
        curves: vec![bound("at most", 1, AREA), bound("at least", 0, INK)],
        ..Panel::default()
    };
    over_angles(study, "area over the angle of the platform", &[panel])
}

/// Worst and median values over the angle of the platform.
pub(super) fn angle_loads(study: &Study) -> Drawn {
    let panel = |quantity, unit, index: usize| Panel {
        quantity,
        unit,
        from_zero: true,
        curves: vec![
            angle_curve(study, "nine of ten places", AREA, |row| {
                row.values.map(|values| values[index][1])
            }),
            angle_curve(study, "half of the places", INK, |row| {
                row.values.map(|values| values[index][0])
            }),
        ],
        ..Panel::default()
    };
    let mut panels = vec![
        panel("rate at 1 m/s", "rad/s", 0),
        panel("torque of the load", "N m", 1),
        panel("offset for 0.1\u{b0}", "m", 2),
    ];
    if study.stiffness_nm_rad.is_some() {
        panels.push(panel("displacement for 1 N", "m", 3));
    }
    let title = "values that the places of the workspace keep, over the angle";
    over_angles(study, title, &panels)
}

/// Nine quantities along the job: a panel for each coordinate of the platform, a curve for each motor.
fn along(
    study: &Study,
    title: &str,
    names: [[&'static str; 2]; 3],
    of: impl Fn(&RatioInstant, usize, usize) -> f64,
) -> Drawn {
    let panels: Vec<Panel> = names
        .into_iter()
        .enumerate()
        .map(|(axis, [quantity, unit])| Panel {
            quantity,
            unit,
            from_zero: true,
            curves: (0..3)
                .map(|motor| Curve {
                    label: MOTOR_NAMES[motor].into(),
                    points: study
                        .ratios
                        .iter()
                        .map(|instant| (instant.t_s, of(instant, axis, motor)))
                        .collect(),
                    colour: Some(MOTORS[motor]),
                    dashed: false,
                })
                .collect(),
            ..Panel::default()
        })
        .collect();
    draw(&format!("{}: {title}", study.scene.name), &panels)
}

/// Velocity ratios of the source.
pub(super) fn velocity_ratios(study: &Study) -> Drawn {
    let names = [
        ["x per motor", "m/rad"],
        ["y per motor", "m/rad"],
        ["\u{3b1} per motor", ""],
    ];
    let title = "platform's rates over each motor's, with gaps where it reverses";
    along(study, title, names, |instant, axis, motor| {
        instant.velocity_ratios[(axis, motor)]
    })
}

/// Entries of the Jacobian.
pub(super) fn jacobian(study: &Study) -> Drawn {
    let names = [
        ["x, one turning", "m/rad"],
        ["y, one turning", "m/rad"],
        ["\u{3b1}, one turning", ""],
    ];
    let title = "platform's rates where one motor turns alone (Jacobian)";
    along(study, title, names, |instant, axis, motor| {
        instant.jacobian[(axis, motor)]
    })
}

/// Torques and work over the duration of the job.
pub(super) fn durations(study: &Study) -> Drawn {
    let points = |of: &dyn Fn(&ModeFigures) -> f64| -> Vec<(f64, f64)> {
        let rows = study.durations.iter();
        rows.map(|(seconds, figures)| (*seconds, of(figures)))
            .collect()
    };
    let of_motors = |of: fn(&ModeFigures) -> [f64; 3]| {
        let curve = |motor: usize| Curve {
            label: MOTOR_NAMES[motor].into(),
            points: points(&|figures| of(figures)[motor]),
            colour: Some(MOTORS[motor]),
            dashed: false,
        };
        (0..3).map(curve).collect()
    };
    let limits = |limit: Option<[f64; 3]>| {
        let lines = limit.into_iter().flat_map(|limit| {
            let is_one = limit.iter().all(|each| *each == limit[0]);
            let count = if is_one { 1 } else { 3 };
            (0..count).map(move |motor| LimitLine {
                label: match is_one {
                    true => format!("limit {}", limit[0]),
                    false => format!("limit {} {}", motor + 1, limit[motor]),
                },
                values: vec![limit[motor]],
                colour: if is_one { LIMIT } else { MOTORS[motor] },
            })
        });
        lines.collect()
    };
    let panel = |quantity, unit, curves, limits| Panel {
        quantity,
        unit,
        from_zero: true,
        curves,
        limits,
        ..Panel::default()
    };
    let own = &study.scene.limits;
    let work = vec![Curve {
        label: "all motors".into(),
        points: points(&|figures| figures.work_j),
        colour: Some(INK),
        dashed: false,
    }];
    let panels = [
        panel(
            "peak torque",
            "N m",
            of_motors(|figures| figures.torque_peak_nm),
            limits(own.torque_nm),
        ),
        panel(
            "RMS torque",
            "N m",
            of_motors(|figures| figures.torque_rms_nm),
            Vec::new(),
        ),
        panel(
            "peak power",
            "W",
            of_motors(|figures| figures.power_peak_w),
            limits(own.power_w),
        ),
        panel("work given", "J", work, Vec::new()),
    ];
    let times = study.durations.iter().map(|(seconds, _)| *seconds);
    let (low, high) = trirrr_figures::panel::range(times);
    let axis = Axis::new(low, high, "s", Margin::Exact, 10.0);
    let title = format!("{}: the same motion, faster and slower", study.scene.name);
    draw_over(&title, "duration of the job", &axis, &panels)
}
