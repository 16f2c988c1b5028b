//! Figures of a linkage as SVG: positions with the curves of its points, rates and accelerations
//! against the input, velocity and acceleration polygons.

mod curves;
mod mechanism;
mod polygon;

use super::description::{FRAME, Linkage, PointRef};
use super::track::Track;
use trirrr_figures::canvas::{Canvas, Draw, Drawn, RIGHT_OF, Size};
use trirrr_figures::style::{CURVES, INK, RGBColor, WHITE};

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

/// Names beside points; of several at one place, each is written under the one before.
struct Labels {
    /// Names nearer to each other than this are at one place.
    near: (f64, f64),
    /// From the point to the name.
    offset: (f64, f64),
    taken: Vec<(f64, f64)>,
}

impl Labels {
    fn write(&mut self, canvas: &Canvas<'_>, text: &str, (x, y): (f64, f64)) -> Draw {
        let near = |other: &&(f64, f64)| {
            (other.0 - x).abs() < self.near.0 && (other.1 - y).abs() < self.near.1
        };
        let row = self.taken.iter().filter(near).count() as f64;
        self.taken.push((x, y));
        let at = (x + self.offset.0, y - self.offset.1 - 15.0 * row);
        for (dx, dy) in [(-1.2, 0.0), (1.2, 0.0), (0.0, -1.2), (0.0, 1.2)] {
            let around = (at.0 + dx, at.1 + dy);
            canvas.text(text, around, Size::Label, RIGHT_OF, WHITE)?;
        }
        canvas.text(text, at, Size::Label, RIGHT_OF, INK)
    }
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
