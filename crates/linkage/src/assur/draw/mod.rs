//! Figures of a linkage as SVG: positions with the curves of its points, rates and accelerations
//! against the input, loads of drives, polygons of velocities and accelerations, and of the positions in each loop.

mod arrow;
mod curves;
mod loops;
mod mechanism;
mod pen;
mod polygon;

use super::description::{FRAME, JointKind, Linkage, PointRef};
use super::loops::independent_loops;
use super::solve::Position;
use super::track::Track;
use trirrr_figures::canvas::{Canvas, Draw, Drawn, RIGHT_OF, Size};
use trirrr_figures::style::{CURVES, INK, RGBColor};

/// The frame and what is fixed to it.
const GROUND: RGBColor = RGBColor(80, 80, 80);

/// Every figure with its file's name. The track must have a position.
pub(super) fn figures(linkage: &Linkage, track: &Track) -> Vec<(&'static str, Drawn)> {
    let mut figures = vec![
        ("mechanism.svg", mechanism::draw(linkage, track)),
        ("links.svg", curves::links(linkage, track)),
    ];
    if !linkage.traces.is_empty() {
        figures.push(("points.svg", curves::points(linkage, track)));
    }
    figures.push(("polygons.svg", polygon::draw(linkage, track)));
    if linkage.has_masses() {
        figures.push(("loads.svg", curves::loads(linkage, track)));
    }
    if !independent_loops(linkage).is_empty() {
        figures.push(("loops.svg", loops::draw(linkage, track)));
    }
    figures
}

/// Both solutions of an arm, the elbow on the left strongly.
pub(super) fn inverse(linkage: &Linkage, track: &Track) -> Drawn {
    let title = format!("{}: both solutions of the inverse", linkage.name);
    mechanism::draw_titled(linkage, track, &title, ["", "elbow on the right"])
}

/// The points that joints take hold of, each once, for a link.
fn joint_points(linkage: &Linkage, link: usize) -> Vec<PointRef> {
    let mut points: Vec<PointRef> = Vec::new();
    for joint in &linkage.joints {
        if let Some(point) = joint.point_on(link)
            && !points.contains(&point)
        {
            points.push(point);
        }
    }
    points
}

/// Name of a point at a joint: of its pin, or of the joint whose slider it is. The start of a guide has its own name.
fn point_name(linkage: &Linkage, point: PointRef) -> String {
    let joints = || linkage.joints.iter();
    let pin = joints().find(|joint| match &joint.kind {
        JointKind::Revolute(pins) => pins.contains(&point),
        JointKind::Prismatic(_) => false,
    });
    let slider = || {
        joints().find(|joint| match &joint.kind {
            JointKind::Prismatic(slide) => slide.slider == point,
            JointKind::Revolute(_) => false,
        })
    };
    match pin.or_else(slider) {
        Some(joint) => joint.name.clone(),
        None => linkage.links[point.link].points[point.point].0.clone(),
    }
}

/// The position at which polygons are drawn: an eighth of the motion, where little stands still.
fn drawn_position(track: &Track) -> Option<&Position> {
    track.positions.get(track.positions.len() / 8)
}

/// The colour of a link.
fn colour(link: usize) -> RGBColor {
    match link {
        FRAME => GROUND,
        link => CURVES[(link - 1) % CURVES.len()],
    }
}

/// The values of the drives at a time, short.
fn inputs(linkage: &Linkage, t: f64) -> String {
    let values = linkage.drives.iter().map(|drive| {
        let name = &linkage.joints[drive.joint].name;
        let [value, ..] = drive.at(t);
        let (value, unit, decimals) = match drive.slides {
            true => (value, "m", 1e4),
            false => (value.to_degrees(), "deg", 1e1),
        };
        // No negative zero.
        let rounded = (value * decimals).round() / decimals + 0.0;
        let rounded = rounded.to_string().replace('-', "\u{2212}");
        format!("{name} = {rounded} {unit}")
    });
    values.collect::<Vec<_>>().join(", ")
}

/// A line and its meaning: colour, width, text.
type Entry = (RGBColor, f64, String);

/// Draws `entries` below one another, the first line's start at `(x, y)`.
fn legend(canvas: &Canvas<'_>, (x, y): (f64, f64), entries: &[Entry]) -> Draw {
    for (row, (colour, width, text)) in entries.iter().enumerate() {
        let y = y + 23.0 * row as f64;
        canvas.line(&[(x, y), (x + 24.0, y)], *colour, *width)?;
        canvas.text(text, (x + 33.0, y), Size::Label, RIGHT_OF, INK)?;
    }
    Ok(())
}
