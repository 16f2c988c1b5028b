//! Curves over the angle of the platform, along the job, and over its duration.

use crate::design::study::{AlphaRow, Study};
use crate::figures::limit_lines;
use trirrr_design::modes::ModeFigures;
use trirrr_design::ratios::RatioInstant;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::chart::{Chart, Figure, Series, gathered};
use trirrr_figures::panel::{draw_over, range};
use trirrr_figures::scale::{Axis, Margin};
use trirrr_figures::style::{AREA, INK};

/// Draws `charts` of `rows`, each with its place on the axis `over` of this quantity.
fn draw<'r, R: 'static>(
    study: &Study,
    title: &str,
    (quantity, over): (&str, &Axis),
    charts: impl IntoIterator<Item = Chart<R>>,
    rows: impl ExactSizeIterator<Item = (f64, &'r R)>,
) -> Drawn {
    let charts = charts.into_iter().map(Chart::with_zero);
    let figures = gathered(vec![Figure::new("", "", charts)], rows);
    let panels = figures.into_iter().flat_map(|figure| figure.panels);
    let title = format!("{}: {title}", study.scene.name);
    draw_over(&title, quantity, over, &panels.collect::<Vec<_>>())
}

/// Draws `charts` over the angle of the platform.
fn over_angles(
    study: &Study,
    title: &str,
    charts: impl IntoIterator<Item = Chart<AlphaRow>>,
) -> Drawn {
    let over = Axis::new(-180.0, 180.0, "", Margin::Exact, 12.0);
    let rows = study.alphas.iter().map(|row| (row.degrees, row));
    draw(study, title, ("\u{3b1}, degrees", &over), charts, rows)
}

/// Area over the angle of the platform.
pub(super) fn angles(study: &Study) -> Drawn {
    let bound = |label, bound: usize, colour| {
        Series::new(label, move |row: &AlphaRow| 1e4 * row.area_m2[bound]).coloured(colour)
    };
    let bounds = [bound("at most", 1, AREA), bound("at least", 0, INK)];
    let chart = Chart::new("area within the limits, cm\u{b2}", "", bounds);
    over_angles(study, "area over the angle of the platform", [chart])
}

/// Worst and median values over the angle of the platform.
pub(super) fn angle_loads(study: &Study) -> Drawn {
    let chart = |quantity, unit, index: usize| {
        let series = |label, part: usize, colour| {
            // Where there is no value, a gap.
            let value = move |row: &AlphaRow| row.values.map_or(f64::NAN, |all| all[index][part]);
            Series::new(label, value).coloured(colour)
        };
        let parts = [
            series("nine of ten places", 1, AREA),
            series("half of the places", 0, INK),
        ];
        Chart::new(quantity, unit, parts)
    };
    let mut charts = vec![
        chart("rate at 1 m/s", "rad/s", 0),
        chart("torque of the load", "N m", 1),
        chart("offset for 0.1\u{b0}", "m", 2),
    ];
    if study.stiffness_nm_rad.is_some() {
        charts.push(chart("displacement for 1 N", "m", 3));
    }
    let title = "values that the places of the workspace keep, over the angle";
    over_angles(study, title, charts)
}

/// Nine quantities along the job: a panel for each coordinate of the platform, a curve for each motor.
fn along(
    study: &Study,
    title: &str,
    names: [[&'static str; 2]; 3],
    of: fn(&RatioInstant, usize, usize) -> f64,
) -> Drawn {
    let charts = names.into_iter().enumerate();
    let charts = charts.map(|(axis, [quantity, unit])| {
        let value = move |instant: &RatioInstant, motor| of(instant, axis, motor);
        Chart::new(quantity, unit, Series::numbered("motor", 3, value))
    });
    let rows = study.ratios.iter().map(|instant| (instant.t_s, instant));
    let (start, end) = range(rows.clone().map(|(t, _)| t));
    let over = Axis::time(start, end);
    draw(study, title, ("time", &over), charts, rows)
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
    let motors = |quantity, unit, of: fn(&ModeFigures) -> [f64; 3]| {
        let value = move |row: &ModeFigures, motor: usize| of(row)[motor];
        Chart::new(quantity, unit, Series::numbered("motor", 3, value))
    };
    let limits =
        |limit: Option<[f64; 3]>| limit_lines(limit.as_ref().map_or(&[], |each| each), false);
    let own = &study.scene.limits;
    let work = Series::new("all motors", |row: &ModeFigures| row.work_j).coloured(INK);
    let charts = [
        motors("peak torque", "N m", |row| row.torque_peak_nm).within(limits(own.torque_nm)),
        motors("RMS torque", "N m", |row| row.torque_rms_nm),
        motors("peak power", "W", |row| row.power_peak_w).within(limits(own.power_w)),
        Chart::new("work given", "J", [work]),
    ];
    let rows = study.durations.iter().map(|(seconds, row)| (*seconds, row));
    let (low, high) = range(rows.clone().map(|(seconds, _)| seconds));
    let over = Axis::new(low, high, "s", Margin::Exact, 10.0);
    let title = "the same motion, faster and slower";
    draw(study, title, ("duration of the job", &over), charts, rows)
}
