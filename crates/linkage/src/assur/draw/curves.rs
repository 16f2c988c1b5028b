//! Rates and accelerations against the input.

use super::super::description::{JointDrive, JointKind, Linkage};
use super::super::loads::drive_loads;
use super::super::solve::Position;
use super::super::study::turning;
use super::super::track::Track;
use crate::motion::{LinkMotion, PointMotion};
use nalgebra::Vector2;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::panel::{Curve, Panel, draw_over};
use trirrr_figures::scale::{Axis, Margin};
use trirrr_figures::style::CURVES;

/// The axis below: the first drive where it runs evenly, otherwise time.
struct InputAxis {
    title: String,
    axis: Axis,
    of: Box<dyn Fn(&Position) -> f64>,
}

impl InputAxis {
    fn new(linkage: &Linkage, track: &Track) -> Self {
        let end = track.positions.last().map_or(0.0, |position| position.t);
        let even = linkage
            .drives
            .first()
            .filter(|drive| drive.acceleration == 0.0 && drive.rate != 0.0)
            .copied();
        let Some(drive) = even else {
            return Self {
                title: "time".into(),
                axis: Axis::time(0.0, end),
                of: Box::new(|position| position.t),
            };
        };
        let name = &linkage.joints[drive.joint].name;
        let of = move |t: f64| match drive.slides {
            true => drive.at(t)[0],
            false => drive.at(t)[0].to_degrees(),
        };
        let (low, high) = (f64::min(of(0.0), of(end)), f64::max(of(0.0), of(end)));
        let (title, axis) = match drive.slides {
            true => (
                format!("driven slide {name}"),
                Axis::new(low, high, "m", Margin::Exact, 10.0),
            ),
            false => (format!("driven angle {name}"), degrees(low, high)),
        };
        Self {
            title,
            axis,
            of: Box::new(move |position| of(position.t)),
        }
    }

    fn curve(&self, track: &Track, label: String, value: impl Fn(&Position) -> f64) -> Curve {
        let points = track.positions.iter();
        Curve {
            label: label.into(),
            points: points.map(|p| ((self.of)(p), value(p))).collect(),
            ..Curve::default()
        }
    }
}

/// An axis in degrees with ticks that divide a turn.
fn degrees(low: f64, high: f64) -> Axis {
    const STEPS: [f64; 9] = [1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0];
    let span = high - low;
    if span < 8.0 {
        return Axis::new(low, high, "deg", Margin::Exact, 8.0);
    }
    let step = STEPS
        .into_iter()
        .find(|step| span / step <= 12.5)
        .unwrap_or(360.0 * (span / 3600.0).ceil());
    let hair = 1e-6 * step;
    let first = ((low - hair) / step).ceil() as i64;
    let last = ((high + hair) / step).floor() as i64;
    let tick = |count: i64| {
        let value = count as f64 * step;
        (value, format!("{value:.0}").replace('-', "\u{2212}"))
    };
    Axis {
        low,
        high,
        ticks: (first..=last).map(tick).collect(),
        unit: "deg".into(),
    }
}

/// Name and value of each curve.
type Curves<'a> = Vec<(String, Box<dyn Fn(&Position) -> f64 + 'a>)>;

/// Draws each quantity with its unit in as many panels as the colours allow.
fn draw(
    linkage: &Linkage,
    track: &Track,
    what: &str,
    quantities: Vec<(&'static str, &'static str, Curves)>,
) -> Drawn {
    let input = InputAxis::new(linkage, track);
    let mut panels = Vec::new();
    for (quantity, unit, curves) in quantities {
        let mut curves = curves
            .into_iter()
            .map(|(label, value)| input.curve(track, label, value))
            .peekable();
        while curves.peek().is_some() {
            panels.push(Panel {
                quantity,
                unit,
                from_zero: false,
                curves: curves.by_ref().take(CURVES.len()).collect(),
                ..Panel::default()
            });
        }
    }
    let title = format!("{}: {what}", linkage.name);
    draw_over(&title, &input.title, &input.axis, &panels)
}

/// Angular velocity and acceleration of the links that turn, and of the sliders along their
/// guides.
pub(super) fn links(linkage: &Linkage, track: &Track) -> Drawn {
    let turning = turning(linkage, track);
    let sliding: Vec<usize> = (0..linkage.joints.len())
        .filter(|&joint| matches!(linkage.joints[joint].kind, JointKind::Prismatic(_)))
        .collect();
    let of_links = |value: fn(&LinkMotion<f64>) -> f64| -> Curves {
        let curve = |links: &Vec<usize>| {
            let first = links[0];
            let value = move |position: &Position| value(&position.states[first].motion);
            (linkage.link_names(links), Box::new(value) as _)
        };
        turning.iter().map(curve).collect()
    };
    let of_slides = |index: usize| -> Curves {
        let curve = |&joint: &usize| {
            let value = move |position: &Position| {
                let slide = position.slide(linkage, joint);
                slide.map_or(0.0, |slide| slide[index])
            };
            (linkage.joints[joint].name.clone(), Box::new(value) as _)
        };
        sliding.iter().map(curve).collect()
    };
    let quantities = vec![
        ("angular velocity", "rad/s", of_links(|link| link.rate)),
        (
            "angular acceleration",
            "rad/s\u{b2}",
            of_links(|link| link.acceleration),
        ),
        ("sliding velocity", "m/s", of_slides(1)),
        ("sliding acceleration", "m/s\u{b2}", of_slides(2)),
    ];
    draw(linkage, track, "rates of links and sliders", quantities)
}

/// Velocity and acceleration of the traced points.
pub(super) fn points(linkage: &Linkage, track: &Track) -> Drawn {
    let of_points = |vector: fn(&PointMotion<f64>) -> Vector2<f64>| -> Curves {
        let each = linkage.traces.iter().flat_map(|&point| {
            let name = linkage.point_name(point);
            ["x", "y"]
                .into_iter()
                .enumerate()
                .map(move |(axis, letter)| {
                    let value =
                        move |position: &Position| vector(&position.point(linkage, point))[axis];
                    (format!("{name} {letter}"), Box::new(value) as _)
                })
        });
        each.collect()
    };
    let quantities = vec![
        ("velocity", "m/s", of_points(|point| point.velocity)),
        (
            "acceleration",
            "m/s\u{b2}",
            of_points(|point| point.acceleration),
        ),
    ];
    let what = "velocity and acceleration of points";
    draw(linkage, track, what, quantities)
}

/// Torques and forces of the drives.
pub(super) fn loads(linkage: &Linkage, track: &Track) -> Drawn {
    let of_drives = |slides: bool| -> Curves {
        let drives = linkage.drives.iter().enumerate();
        let chosen = drives.filter(|(_, drive)| drive.slides == slides);
        let curve = |(index, drive): (usize, &JointDrive)| {
            let value = move |position: &Position| {
                drive_loads(linkage, position).map_or(0.0, |loads| loads[index])
            };
            (
                linkage.joints[drive.joint].name.clone(),
                Box::new(value) as _,
            )
        };
        chosen.map(curve).collect()
    };
    let quantities = vec![
        ("torque of the drive", "N m", of_drives(false)),
        ("force of the drive", "N", of_drives(true)),
    ];
    draw(linkage, track, "loads of the drives", quantities)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_divide_a_turn() {
        let labels = |low, high| -> Vec<String> {
            let axis = degrees(low, high);
            axis.ticks.into_iter().map(|(_, label)| label).collect()
        };
        let turn = labels(0.0, 360.0);
        assert_eq!(turn.first().unwrap(), "0");
        assert_eq!(turn.get(1).unwrap(), "30");
        assert_eq!(turn.last().unwrap(), "360");
        assert_eq!(labels(-30.0, 30.0).first().unwrap(), "\u{2212}30");
        assert_eq!(labels(0.0, 3600.0).len(), 11);
    }
}
