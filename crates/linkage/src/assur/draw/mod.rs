//! Figures of a linkage as SVG: positions with the curves of its points, rates and accelerations
//! against the input, velocity and acceleration polygons.

mod curves;
mod mechanism;
mod polygon;

use super::description::{FRAME, Linkage, PointRef};
use super::track::Track;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::style::CURVES;
use trirrr_figures::style::RGBColor;

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
    figures
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
