//! Velocity and acceleration polygons at one position.
//!
//! From the pole, which is every point that stands still, an arrow leads to the end of each
//! point's velocity. Between the ends of two points of one link lies their relative velocity,
//! which is perpendicular to the line between the points. In the acceleration polygon it is drawn
//! in its two parts: towards the first point (normal) and across (tangential).

use super::super::description::{FRAME, Joint, Linkage, PointRef};
use super::super::solve::Position;
use super::super::track::Track;
use super::arrow::arrow;
use super::{colour, drawn_position, inputs, joint_points, legend, point_name};
use nalgebra::Vector2;
use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, Size, page};
use trirrr_figures::labels::Labels;
use trirrr_figures::plane::View;
use trirrr_figures::style::{INK, faded};

const LEFT: f64 = 88.0;
const TOP: f64 = 84.0;
const SIDE: f64 = 430.0;
const GAP: f64 = 110.0;

/// One polygon: what it shows and its vectors.
struct Polygon {
    title: &'static str,
    unit: &'static str,
    /// Name and end of the vector of each point that moves.
    ends: Vec<(String, [f64; 2])>,
    /// Per relative vector: link, its corners from end to end.
    between: Vec<(usize, Vec<[f64; 2]>)>,
}

/// Draws both polygons.
pub(super) fn draw(linkage: &Linkage, track: &Track) -> Drawn {
    let Some(position) = drawn_position(track) else {
        return page(SIDE, SIDE, |_| Ok(()));
    };
    let polygons = [
        polygon(linkage, position, false),
        polygon(linkage, position, true),
    ];
    let mut left = LEFT;
    let views = polygons.each_ref().map(|polygon| {
        let ends = polygon.ends.iter().map(|(_, end)| *end);
        let corners = polygon
            .between
            .iter()
            .flat_map(|(_, corners)| corners)
            .copied();
        let points: Vec<_> = ends.chain(corners).chain([[0.0; 2]]).collect();
        let view = View::around(&points, polygon.unit, (left, TOP), SIDE);
        left += view.width + GAP;
        view
    });
    let beside = left - GAP + 16.0;
    let links = linkage.moving_links().len();
    let names = linkage.links[linkage.file_links()]
        .iter()
        .map(|link| Size::Label.width(&link.name));
    let widest = names.fold(Size::Label.width("of a point"), f64::max);
    let title = format!("{} at {}", linkage.name, inputs(linkage, position.t));
    let width = (beside + widest + 60.0).max(Size::Title.width(&title) + 40.0);
    let height = views.iter().fold(0.0, |h, view| f64::max(h, view.height));
    let height = (TOP + height + 66.0).max(TOP + 24.0 * (links + 3) as f64);
    page(width, height, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for (polygon, view) in polygons.iter().zip(&views) {
            draw_polygon(canvas, polygon, view)?;
        }
        let mut entries = vec![(faded(INK, 0.55), 2.6, "of a point".to_owned())];
        let several = |&link: &usize| shown_points(linkage, link).len() > 1;
        entries.extend(linkage.moving_links().filter(several).map(|link| {
            let text = format!("within {}", linkage.links[link].name);
            (colour(link), 2.6, text)
        }));
        legend(canvas, (beside, TOP + 10.0), &entries)
    })
}

fn polygon(linkage: &Linkage, position: &Position, acceleration: bool) -> Polygon {
    let vector = |point: PointRef| {
        let motion = position.point(linkage, point);
        if acceleration {
            motion.acceleration
        } else {
            motion.velocity
        }
    };
    let mut ends: Vec<(String, [f64; 2])> = Vec::new();
    let mut between = Vec::new();
    for link in linkage.moving_links() {
        let points = shown_points(linkage, link);
        for &(ref name, point) in &points {
            let end: [f64; 2] = vector(point).into();
            let known = |(other, at): &(String, [f64; 2])| other == name && near(*at, end);
            if !ends.iter().any(known) {
                ends.push((name.clone(), end));
            }
        }
        let state = &position.states[link].motion;
        for pair in points.windows(2) {
            let (from, to) = (pair[0].1, pair[1].1);
            let mut corners = vec![vector(from).into()];
            if acceleration {
                let arm: Vector2<f64> = position
                    .point(linkage, to)
                    .relative_to(&position.point(linkage, from))
                    .position;
                let normal = vector(from) - arm * (state.rate * state.rate);
                corners.push(normal.into());
            }
            corners.push(vector(to).into());
            between.push((link, corners));
        }
    }
    // What stands still but for rounding is at the pole.
    let largest = ends
        .iter()
        .map(|(_, end)| f64::hypot(end[0], end[1]))
        .fold(0.0, f64::max);
    ends.retain(|(_, end)| f64::hypot(end[0], end[1]) > 1e-9 * largest);
    Polygon {
        title: if acceleration {
            "acceleration polygon (normal, then tangential)"
        } else {
            "velocity polygon"
        },
        unit: if acceleration { "m/s\u{b2}" } else { "m/s" },
        ends,
        between,
    }
}

/// The points of a link with the names of the joints there, and the traced ones with their own.
fn shown_points(linkage: &Linkage, link: usize) -> Vec<(String, PointRef)> {
    let mut points: Vec<(String, PointRef)> = Vec::new();
    let mut at_joints = joint_points(linkage, link);
    // From the frame outwards.
    let on_frame = |point: &PointRef| {
        let held = |joint: &Joint| joint.point_on(link) == Some(*point);
        let mut at_point = linkage.joints.iter().filter(|joint| held(joint));
        at_point.any(|joint| joint.links().contains(&FRAME))
    };
    at_joints.sort_by_key(|point| !on_frame(point));
    for point in at_joints {
        points.push((point_name(linkage, point), point));
    }
    for &trace in linkage.traces.iter().filter(|trace| trace.link == link) {
        if !points.iter().any(|(_, point)| *point == trace) {
            let name = linkage.links[link].points[trace.point].0.clone();
            points.push((name, trace));
        }
    }
    points
}

fn near(a: [f64; 2], b: [f64; 2]) -> bool {
    let distance = f64::hypot(a[0] - b[0], a[1] - b[1]);
    distance <= 1e-9 * (f64::hypot(a[0], a[1]) + f64::hypot(b[0], b[1]))
}

fn draw_polygon(canvas: &Canvas<'_>, polygon: &Polygon, view: &View) -> Draw {
    let (left, top) = view.corner();
    let middle = (left + view.width / 2.0, top - 16.0);
    canvas.text(polygon.title, middle, Size::Label, CENTRED, INK)?;
    view.grid(canvas, ["x", "y"])?;
    let pole = view.at([0.0; 2]);
    for (_, end) in &polygon.ends {
        arrow(canvas, pole, view.at(*end), faded(INK, 0.55), 1.8)?;
    }
    for (link, corners) in &polygon.between {
        for pair in corners.windows(2) {
            arrow(
                canvas,
                view.at(pair[0]),
                view.at(pair[1]),
                colour(*link),
                2.2,
            )?;
        }
    }
    canvas.joint(pole, 5.0, INK)?;
    let mut labels = Labels::within(view.corner(), view.width, view.height);
    for (_, end) in &polygon.ends {
        labels.avoid_line(&[pole, view.at(*end)], 1.0);
    }
    for (_, corners) in &polygon.between {
        let corners: Vec<_> = corners.iter().map(|corner| view.at(*corner)).collect();
        labels.avoid_line(&corners, 1.0);
    }
    labels.name("pole", pole, 5.0);
    for (name, end) in &polygon.ends {
        labels.name(name, view.at(*end), 3.0);
    }
    labels.draw(canvas)
}
