//! Position polygons: the vectors of each independent loop, head to tail.

use super::super::description::Linkage;
use super::super::loops::{LoopVector, independent_loops, vectors};
use super::super::track::Track;
use super::arrow::arrow;
use super::{colour, drawn_position, inputs, joint_points, legend, point_name};
use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, Size, page};
use trirrr_figures::labels::Labels;
use trirrr_figures::plane::View;
use trirrr_figures::style::{INK, RGBColor, faded};

const LEFT: f64 = 88.0;
const TOP: f64 = 84.0;
const SIDE: f64 = 360.0;
const GAP: f64 = 104.0;
const BETWEEN: f64 = 96.0;
/// Polygons in one row.
const COLUMNS: usize = 3;

/// The guides, and ways along them.
const ALONG: RGBColor = INK;

/// One polygon: its heading and its vectors.
struct PositionPolygon {
    heading: String,
    vectors: Vec<LoopVector>,
}

/// Draws a polygon for every independent loop, at the position of the other polygons.
pub(super) fn draw(linkage: &Linkage, track: &Track) -> Drawn {
    let Some(position) = drawn_position(track) else {
        return page(SIDE, SIDE, |_| Ok(()));
    };
    let loops = independent_loops(linkage);
    let polygons = loops.iter().enumerate().map(|(index, closed)| {
        let links: Vec<usize> = closed.steps.iter().map(|step| step.0).collect();
        PositionPolygon {
            heading: format!("loop {}: {}", index + 1, linkage.link_names(&links)),
            vectors: vectors(linkage, position, closed),
        }
    });
    let polygons: Vec<PositionPolygon> = polygons.collect();
    let title = format!(
        "{}: position polygons at {}",
        linkage.name,
        inputs(linkage, position.t)
    );
    // The names of joints at the corners of the polygons.
    let mut names: Vec<(String, [f64; 2])> = Vec::new();
    for link in linkage.file_links() {
        for point in joint_points(linkage, link) {
            let at: [f64; 2] = position.point(linkage, point).position.into();
            let near = 1e-6 * linkage.size();
            let is_known =
                |(_, other): &(_, [f64; 2])| f64::hypot(at[0] - other[0], at[1] - other[1]) <= near;
            if !names.iter().any(is_known) {
                names.push((point_name(linkage, point), at));
            }
        }
    }
    // Places from left to right, row by row; every panel has the width that its heading needs.
    let mut placed: Vec<(&PositionPolygon, View)> = Vec::new();
    let (mut left, mut top, mut lowest, mut right) = (LEFT, TOP, TOP, LEFT);
    for (index, polygon) in polygons.iter().enumerate() {
        if index > 0 && index % COLUMNS == 0 {
            (left, top) = (LEFT, lowest + BETWEEN);
        }
        let corners = polygon.vectors.iter().flat_map(|vector| vector.ends);
        let corners: Vec<_> = corners.collect();
        let view = View::around(&corners, "m", (left, top), SIDE);
        lowest = f64::max(lowest, top + view.height);
        let wide = view.width.max(Size::Label.width(&polygon.heading));
        right = f64::max(right, left + wide);
        left += wide + GAP;
        placed.push((polygon, view));
    }
    let shown: Vec<usize> = linkage
        .file_links()
        .filter(|link| {
            let mut all = polygons.iter().flat_map(|polygon| &polygon.vectors);
            all.any(|vector| vector.link == Some(*link))
        })
        .collect();
    let mut entries: Vec<_> = shown
        .iter()
        .map(|&link| (colour(link), 2.6, linkage.links[link].name.clone()))
        .collect();
    let mut all = polygons.iter().flat_map(|polygon| &polygon.vectors);
    if all.any(|vector| vector.link.is_none()) {
        entries.push((faded(ALONG, 0.45), 2.6, "along a guide".into()));
    }
    let widest = entries
        .iter()
        .map(|(_, _, text)| Size::Label.width(text))
        .fold(0.0, f64::max);
    let beside = right + 24.0;
    let width = (beside + widest + 60.0).max(Size::Title.width(&title) + 40.0);
    let height = (lowest + 66.0).max(TOP + 24.0 * (entries.len() + 1) as f64);
    page(width, height, |canvas| {
        canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for (polygon, view) in &placed {
            panel(canvas, polygon, view, &names)?;
        }
        legend(canvas, (beside, TOP + 10.0), &entries)
    })
}

fn panel(
    canvas: &Canvas<'_>,
    polygon: &PositionPolygon,
    view: &View,
    names: &[(String, [f64; 2])],
) -> Draw {
    let (left, top) = view.corner();
    let half = 0.5 * view.width.max(Size::Label.width(&polygon.heading));
    canvas.text(
        &polygon.heading,
        (left + half, top - 16.0),
        Size::Label,
        CENTRED,
        INK,
    )?;
    view.grid(canvas, ["x", "y"])?;
    let mut labels = Labels::within(view.corner(), view.width, view.height);
    for vector in &polygon.vectors {
        let [from, to] = vector.ends.map(|end| view.at(end));
        let shade = match vector.link {
            Some(link) => colour(link),
            None => faded(ALONG, 0.45),
        };
        arrow(canvas, from, to, shade, 2.6)?;
        labels.avoid_line(&[from, to], 1.0);
    }
    let corners: Vec<_> = polygon
        .vectors
        .iter()
        .flat_map(|vector| vector.ends)
        .collect();
    for (name, at) in names {
        let near = |corner: &&[f64; 2]| {
            let ((x, y), (u, v)) = (view.at(**corner), view.at(*at));
            (x - u).hypot(y - v) < 0.5
        };
        if corners.iter().any(|corner| near(&corner)) {
            labels.name(name, view.at(*at), 4.0);
        }
    }
    labels.draw(canvas)
}
