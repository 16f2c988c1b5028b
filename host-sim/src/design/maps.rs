//! Figures of a study.

use super::study::Study;
use crate::terminal::digits;
use trirrr_core::machine::Parameters;
use trirrr_design::ratios::Ratios;
use trirrr_design::workspace::CellGrid;
use trirrr_figures::canvas::{BELOW, CENTRED, Canvas, Draw, Drawn, RIGHT_OF, Size, page};
use trirrr_figures::panel::{Curve, Panel, draw_over};
use trirrr_figures::plane::View;
use trirrr_figures::scale::{Axis, Margin};
use trirrr_figures::style::{BLUE, FRAME, GREEN, INK, ORANGE, PURPLE, RGBColor, VERMILLION, faded};
use trirrr_scene::record::Record;

const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 150.0;
const SIDE: f64 = 560.0;

/// Shades of a map of values.
const LEVELS: usize = 8;

/// All figures, by their names. One that cannot be drawn is left out.
pub(super) fn all(study: &Study) -> Vec<(&'static str, String)> {
    let value_map =
        |title: &str, unit: &str, of: fn(&Ratios) -> f64| values(study, title, unit, of);
    let figures: [(&str, Drawn); 9] = [
        ("geometry", geometry(study)),
        ("workspace", workspace(study)),
        (
            "singularities",
            value_map("least distance to a singularity", "scale-free", |ratios| {
                ratios.distances[0].min(ratios.distances[1])
            }),
        ),
        (
            "rates",
            value_map(
                "rate of the fastest motor at 1 m/s of D",
                "rad/s",
                Ratios::rate_per_speed,
            ),
        ),
        (
            "forces",
            value_map(
                "largest torque for 1 N on D",
                "N m",
                Ratios::torque_per_force,
            ),
        ),
        (
            "accuracy",
            value_map(
                "offset of D for 0.1 degrees of each motor",
                "mm",
                |ratios| 1e3 * ratios.offset_per_error() * 0.1_f64.to_radians(),
            ),
        ),
        ("angles", angles(study)),
        ("durations", durations(study)),
        ("modes", modes(study)),
    ];
    let drawn = figures
        .into_iter()
        .filter_map(|(name, drawn)| Some((name, drawn.ok()?)));
    drawn.collect()
}

/// Points that all maps show.
fn shown(study: &Study) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = study.path.clone();
    let bases = study.scene.parameters.legs.iter();
    points.extend(bases.map(|leg| <[f64; 2]>::from(leg.base_m)));
    let grid = &study.reach.grid;
    for row in 0..grid.size[1] {
        for column in 0..grid.size[0] {
            if study.reach.cells[row * grid.size[0] + column].within > 0.0 {
                points.push(grid.centre_m(column, row));
            }
        }
    }
    points
}

/// A page with a map, a legend below it, and the bases of the legs in it.
fn map(
    study: &Study,
    title: &str,
    draw: impl FnOnce(&Canvas<'_>, &View) -> Draw,
    legend: impl FnOnce(&Canvas<'_>, f64) -> Draw,
) -> Drawn {
    let view = View::around(&shown(study), "m", (LEFT, TOP), SIDE);
    let title = format!("{}: {title}", study.scene.name);
    let width = (LEFT + view.width + 40.0)
        .max(Size::Title.width(&title) + 40.0)
        .max(600.0);
    page(width, TOP + view.height + BOTTOM, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        draw(canvas, &view)?;
        view.grid(canvas, ["x of D", "y of D"])?;
        for leg in &study.scene.parameters.legs {
            canvas.joint(view.at(leg.base_m.into()), 5.0, INK)?;
        }
        let path: Vec<_> = study.path.iter().map(|point| view.at(*point)).collect();
        canvas.line(&path, PURPLE, 1.6)?;
        legend(canvas, TOP + view.height + 66.0)
    })
}

/// Cells of `grid`, with colours by their number.
fn cells(
    canvas: &Canvas<'_>,
    view: &View,
    grid: &CellGrid,
    colour: impl Fn(usize) -> Option<RGBColor>,
) -> Draw {
    view.cells(
        canvas,
        (grid.size, grid.cell_m),
        |column, row| grid.centre_m(column, row),
        |column, row| colour(row * grid.size[0] + column),
    )
}

fn entry(canvas: &Canvas<'_>, top: f64, row: f64, colour: RGBColor, text: &str) -> Draw {
    let y = top + 20.0 * row;
    let corners = [
        (LEFT, y - 6.0),
        (LEFT + 30.0, y - 6.0),
        (LEFT + 30.0, y + 6.0),
        (LEFT, y + 6.0),
    ];
    canvas.polygon(&corners, colour)?;
    canvas.text(text, (LEFT + 42.0, y), Size::Tick, RIGHT_OF, INK)
}

fn workspace(study: &Study) -> Drawn {
    let (reached, works, open) = (faded(BLUE, 0.18), faded(GREEN, 0.5), faded(ORANGE, 0.8));
    let apart = faded(GREEN, 0.22);
    map(
        study,
        "where it works",
        |canvas, view| {
            cells(canvas, view, &study.work.grid, |index| {
                let (work, reach) = (study.work.cells[index], study.reach.cells[index]);
                match () {
                    () if study.connected[index] => Some(works),
                    () if work.within > 0.5 => Some(apart),
                    () if work.undecided > 0.1 => Some(open),
                    () if reach.within > 0.5 => Some(reached),
                    () => None,
                }
            })?;
            if let Some(disc) = study.disc {
                let points: Vec<_> = (0..=96)
                    .map(|index| {
                        let (sin, cos) =
                            (f64::from(index) / 96.0 * std::f64::consts::TAU).sin_cos();
                        let [x, y] = disc.centre_m;
                        view.at([x + disc.radius_m * cos, y + disc.radius_m * sin])
                    })
                    .collect();
                canvas.line(&points, INK, 1.4)?;
            }
            if let Some(each) = study.rectangle {
                let ([x, y], [width, height]) = (each.low_m, each.size_m);
                let corners = [
                    [x, y],
                    [x + width, y],
                    [x + width, y + height],
                    [x, y + height],
                    [x, y],
                ];
                canvas.line(&corners.map(|corner| view.at(corner)), INK, 1.4)?;
            }
            Ok(())
        },
        |canvas, top| {
            entry(
                canvas,
                top,
                0.0,
                works,
                "proven: reached from the start, distances kept; largest circle and rectangle in it",
            )?;
            entry(
                canvas,
                top,
                1.0,
                apart,
                "proven, but not connected with the start",
            )?;
            entry(canvas, top, 2.0, open, "undecided")?;
            entry(
                canvas,
                top,
                3.0,
                reached,
                "the legs reach it, too near to a singularity or beyond one",
            )
        },
    )
}

fn values(study: &Study, title: &str, unit: &str, of: fn(&Ratios) -> f64) -> Drawn {
    let (grid, ratios) = &study.ratios;
    let found: Vec<Option<f64>> = ratios.iter().map(|each| each.as_ref().map(of)).collect();
    let mut sorted: Vec<f64> = found.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    // Levels that hold equally many cells each: ratios grow without bound towards singularities.
    let edge = |level: usize| {
        let index = (level * sorted.len() / LEVELS).min(sorted.len().saturating_sub(1));
        sorted.get(index).copied().unwrap_or(0.0)
    };
    let level = |value: f64| (1..LEVELS).filter(|level| value >= edge(*level)).count();
    let colour = |level: usize| faded(VERMILLION, 0.08 + 0.92 * level as f64 / (LEVELS - 1) as f64);
    map(
        study,
        &format!("{title} ({unit})"),
        |canvas, view| {
            cells(canvas, view, grid, |index| {
                found[index].map(|value| colour(level(value)))
            })
        },
        |canvas, top| {
            for index in 0..LEVELS {
                let (column, row) = (index % 4, index / 4);
                let (x, y) = (LEFT + 150.0 * column as f64, top + 22.0 * row as f64);
                let corners = [
                    (x, y - 6.0),
                    (x + 24.0, y - 6.0),
                    (x + 24.0, y + 6.0),
                    (x, y + 6.0),
                ];
                canvas.polygon(&corners, colour(index))?;
                let text = format!("from {}", digits(edge(index)));
                canvas.text(&text, (x + 32.0, y), Size::Tick, RIGHT_OF, INK)?;
            }
            let most = sorted.last().copied().unwrap_or(0.0);
            let text = format!("each shade has as many cells; up to {}", digits(most));
            canvas.text(&text, (LEFT, top + 44.0), Size::Tick, RIGHT_OF, INK)
        },
    )
}

/// The machine at the start of its job, with the names of its joints and lengths.
fn geometry(study: &Study) -> Drawn {
    let Record { legs, pose, .. } = &study.start;
    let d = [pose[0], pose[1]];
    let mut points = vec![d];
    for leg in legs {
        points.extend([leg.base, leg.elbow(), leg.platform_joint()]);
    }
    let view = View::around(&points, "m", (LEFT, TOP), SIDE);
    let title = format!(
        "{}: joints, links and signs, at the start",
        study.scene.name
    );
    let width = (LEFT + view.width + 40.0)
        .max(Size::Title.width(&title) + 40.0)
        .max(600.0);
    page(width, TOP + view.height + BOTTOM, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        view.grid(canvas, ["x", "y"])?;
        let corners: Vec<_> = legs
            .iter()
            .map(|leg| view.at(leg.platform_joint()))
            .collect();
        canvas.polygon(&corners, faded(GREEN, 0.35))?;
        for (index, leg) in legs.iter().enumerate() {
            let number = index + 1;
            let places = [leg.base, leg.elbow(), leg.platform_joint()];
            let [a, b, c] = places.map(|place| view.at(place));
            canvas.line(&[a, b], BLUE, 4.0)?;
            canvas.line(&[b, c], VERMILLION, 4.0)?;
            canvas.dashed(c, view.at(d), FRAME)?;
            for (joint, name) in [(a, "A"), (b, "B"), (c, "C")] {
                canvas.joint(joint, 6.0, INK)?;
                let at = (joint.0 + 12.0, joint.1 - 12.0);
                canvas.text(&format!("{name}{number}"), at, Size::Label, CENTRED, INK)?;
            }
        }
        canvas.dot(view.at(d), 4.0, PURPLE)?;
        let (x, y) = view.at(d);
        canvas.text("D", (x + 11.0, y + 12.0), Size::Label, CENTRED, PURPLE)?;
        let top = TOP + view.height + 66.0;
        entry(
            canvas,
            top,
            0.0,
            BLUE,
            "proximal link, A to B: proximal_m, turned by the motor at A",
        )?;
        entry(
            canvas,
            top,
            1.0,
            VERMILLION,
            "distal link, B to C: distal_m",
        )?;
        entry(
            canvas,
            top,
            2.0,
            faded(GREEN, 0.35),
            "platform: C is joint_radius_m from D, at joint_angle_rad + alpha; alpha is its angle",
        )?;
        let signs = elbows(&study.scene.parameters);
        let text = format!(
            "elbow 1: B lies to the left of the way from A to C; -1: to the right. Here {signs}"
        );
        canvas.text(&text, (LEFT, top + 62.0), Size::Tick, RIGHT_OF, INK)
    })
}

fn elbows(parameters: &Parameters) -> String {
    let signs = parameters.legs.each_ref().map(|leg| leg.elbow.sign());
    let [one, two, three] = signs;
    format!("{one}, {two}, {three}")
}

fn angles(study: &Study) -> Drawn {
    let curve = |label: &'static str, bound: usize| Curve {
        label: label.into(),
        points: study
            .alphas
            .iter()
            .map(|row| (row.degrees, 1e4 * row.area_m2[bound]))
            .collect(),
    };
    let panel = Panel {
        quantity: "area within the limits, cm^2",
        unit: "",
        from_zero: true,
        curves: vec![curve("at most", 1), curve("at least", 0)],
    };
    let axis = Axis::new(-180.0, 180.0, "", Margin::Exact, 12.0);
    let title = format!("{}: area over the angle of the platform", study.scene.name);
    draw_over(&title, "alpha, degrees", &axis, &[panel])
}

fn durations(study: &Study) -> Drawn {
    let points = |of: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..study.durations.len())
            .map(|index| (study.durations[index].0, of(index)))
            .collect()
    };
    let torque = |motor: usize| Curve {
        label: format!("motor {}", motor + 1).into(),
        points: points(&|index| study.durations[index].1.torque_peak_nm[motor]),
    };
    let panels = [
        Panel {
            quantity: "peak torque",
            unit: "N m",
            from_zero: true,
            curves: (0..3).map(torque).collect(),
        },
        Panel {
            quantity: "work of the motors",
            unit: "J",
            from_zero: true,
            curves: vec![Curve {
                label: "all".into(),
                points: points(&|index| study.durations[index].1.work_j),
            }],
        },
    ];
    let times = study.durations.iter().map(|(seconds, _)| *seconds);
    let (low, high) = times.fold((f64::INFINITY, 0.0_f64), |(low, high), seconds| {
        (low.min(seconds), high.max(seconds))
    });
    let axis = Axis::new(low, high, "s", Margin::Exact, 10.0);
    let title = format!("{}: the same motion, faster and slower", study.scene.name);
    draw_over(&title, "duration of the job", &axis, &panels)
}

/// Peak torques of the modes, side by side.
fn modes(study: &Study) -> Drawn {
    let most = study
        .modes
        .iter()
        .filter(|row| row.is_feasible())
        .filter_map(|row| row.result.figures)
        .map(|figures| super::study::largest(figures.torque_peak_nm))
        .fold(1e-12, f64::max);
    let title = format!(
        "{}: peak torque of the eight working modes",
        study.scene.name
    );
    let (height, slot) = (220.0, 84.0);
    let width = (LEFT + 8.0 * slot + 30.0).max(Size::Title.width(&title) + 40.0);
    page(width, TOP + height + 70.0, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        let floor = TOP + height;
        canvas.line(
            &[(LEFT - 10.0, floor), (LEFT + 8.0 * slot, floor)],
            FRAME,
            1.2,
        )?;
        for (index, row) in study.modes.iter().enumerate() {
            let left = LEFT + slot * index as f64;
            canvas.text(
                &row.result.name(),
                (left + 30.0, floor + 8.0),
                Size::Label,
                BELOW,
                INK,
            )?;
            let (Some(figures), true) = (row.result.figures, row.is_feasible()) else {
                canvas.text(
                    "no",
                    (left + 30.0, floor - 10.0),
                    Size::Tick,
                    CENTRED,
                    VERMILLION,
                )?;
                continue;
            };
            for (motor, colour) in [BLUE, ORANGE, GREEN].into_iter().enumerate() {
                let torque = figures.torque_peak_nm[motor];
                let (from, top) = (
                    left + 20.0 * motor as f64,
                    floor - (height - 30.0) * torque / most,
                );
                let corners = [
                    (from, floor),
                    (from + 16.0, floor),
                    (from + 16.0, top),
                    (from, top),
                ];
                canvas.polygon(&corners, colour)?;
            }
            let peak = digits(super::study::largest(figures.torque_peak_nm));
            canvas.text(
                &format!("{peak} N m"),
                (left + 30.0, floor + 30.0),
                Size::Tick,
                BELOW,
                INK,
            )?;
        }
        Ok(())
    })
}
