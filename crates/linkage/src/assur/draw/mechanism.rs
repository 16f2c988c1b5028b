//! The mechanism drawn to scale at several positions, with the curves of its points.

use super::super::description::{FRAME, JointKind, Linkage, PointRef, SlotPart};
use super::super::solve::Position;
use super::super::track::Track;
use super::pen::{Pen, at, points_of};
use super::{Entry, colour, inputs, joint_points, legend, point_name};
use trirrr_figures::canvas::{CENTRED, Draw, Drawn, Size, page};
use trirrr_figures::labels::Labels;
use trirrr_figures::plane::View;
use trirrr_figures::style::{INK, RGBColor, WHITE, faded};

const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 62.0;
const SIDE: f64 = 640.0;
/// Positions besides the first, spread evenly over the motion.
const MORE: usize = 5;
const BETWEEN: f64 = 0.3;

/// Draws the first position strongly and some others faintly.
pub(super) fn draw(linkage: &Linkage, track: &Track) -> Drawn {
    let start = track.positions.first().map_or(0.0, |position| position.t);
    let title = format!(
        "{}: positions and curves of points, from {}",
        linkage.name,
        inputs(linkage, start)
    );
    let shown = instants(track.positions.len()).len();
    let later = format!("{} later positions", shown.saturating_sub(1));
    draw_titled(linkage, track, &title, ["path of ", &later])
}

/// As [`draw`], with a title, and in the legend the words before traced points and those for positions that are drawn faintly.
pub(super) fn draw_titled(
    linkage: &Linkage,
    track: &Track,
    title: &str,
    [traced, later]: [&str; 2],
) -> Drawn {
    let positions = &track.positions;
    let points = || (0..linkage.links.len()).flat_map(|link| points_of(linkage, link));
    let extent: Vec<[f64; 2]> = positions
        .iter()
        .flat_map(|position| points().map(|point| at(linkage, position, point)))
        .collect();
    let view = View::around(&extent, "m", (LEFT, TOP), SIDE);
    let entries = entries(linkage, track, [traced, later]);
    let widths = entries.iter().map(|(.., text)| Size::Label.width(text));
    let wide = 48.0 + widths.fold(0.0, f64::max);
    let high = 24.0 + 23.0 * entries.len() as f64;
    let beside = LEFT + view.width + 16.0;
    let width = (beside + wide).max(Size::Title.width(title) + 40.0);
    let height = (TOP + view.height + BOTTOM).max(high + TOP + 20.0);
    page(width, height, |canvas| {
        canvas.text(title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        view.grid(canvas, ["x", "y"])?;
        let pen = Pen {
            linkage,
            track,
            view: &view,
            canvas,
        };
        for index in instants(positions.len()).into_iter().skip(1) {
            pen.links(&positions[index], BETWEEN)?;
        }
        if let Some(first) = positions.first() {
            pen.links(first, 1.0)?;
        }
        for &trace in &linkage.traces {
            let path: Vec<_> = positions
                .iter()
                .map(|position| view.at(at(linkage, position, trace)))
                .collect();
            let colour = trace_colour(trace);
            canvas.line(&path, WHITE, 4.0)?;
            canvas.line(&path, colour, 2.0)?;
            if let Some(&start) = path.first() {
                canvas.dot(start, 4.2, colour)?;
            }
        }
        if let Some(first) = positions.first() {
            pen.names(first, &view)?;
        }
        legend(canvas, (beside, TOP + 12.0), &entries)
    })
}

/// Indices of the first position and of some others.
fn instants(positions: usize) -> Vec<usize> {
    let mut indices: Vec<usize> = (0..=MORE)
        .map(|part| part * positions / (MORE + 1))
        .filter(|&index| index < positions)
        .collect();
    indices.dedup();
    indices
}

/// Curves have their link's colour, darker.
fn trace_colour(trace: PointRef) -> RGBColor {
    let RGBColor(r, g, b) = colour(trace.link);
    let darker = |channel: u8| (0.65 * f64::from(channel)) as u8;
    RGBColor(darker(r), darker(g), darker(b))
}

impl Pen<'_, '_> {
    /// The joints' names beside them, and those of the traced points.
    fn names(&self, position: &Position, view: &View) -> Draw {
        let mut labels = Labels::within(view.corner(), view.width, view.height);
        self.avoid(&mut labels, position);
        for joint in &self.linkage.joints {
            let (point, radius) = match &joint.kind {
                // Named at its slot.
                JointKind::Revolute(_) if joint.in_slot == Some(SlotPart::Pin) => continue,
                JointKind::Revolute(pins) => (pins[0], 5.0),
                JointKind::Prismatic(slide) => (slide.slider, 9.0),
            };
            labels.name(&joint.name, self.pixel(position, point), radius);
        }
        for &trace in &self.linkage.traces {
            let at_joint = joint_points(self.linkage, trace.link).contains(&trace);
            if !at_joint {
                let name = point_name(self.linkage, trace);
                labels.name(&name, self.pixel(position, trace), 4.2);
            }
        }
        labels.draw(self.canvas)
    }

    /// Things that names should not cover: links, guides, feet, and less so curves and later positions.
    fn avoid(&self, labels: &mut Labels, position: &Position) {
        let outline = |position: &Position, link: usize| {
            let points = points_of(self.linkage, link).into_iter();
            let mut corners: Vec<_> = points.map(|point| self.pixel(position, point)).collect();
            if corners.len() > 2 {
                corners.push(corners[0]);
            }
            corners
        };
        for link in self.linkage.moving_links() {
            labels.avoid_line(&outline(position, link), 1.0);
            for index in instants(self.track.positions.len()).into_iter().skip(1) {
                labels.avoid_line(&outline(&self.track.positions[index], link), 0.12);
            }
        }
        for joint in &self.linkage.joints {
            match &joint.kind {
                JointKind::Prismatic(slide) => {
                    let ends = [slide.guide, slide.slider].map(|end| self.pixel(position, end));
                    labels.avoid_line(&ends, 0.6);
                    labels.avoid_disc(ends[1], 11.0);
                }
                JointKind::Revolute(pins) => {
                    let (x, y) = self.pixel(position, pins[0]);
                    if pins.iter().any(|pin| pin.link == FRAME) {
                        labels.avoid_disc((x, y + 7.0), 9.0);
                    }
                }
            }
        }
        for &trace in &self.linkage.traces {
            let positions = self.track.positions.iter();
            let path: Vec<_> = positions.map(|at| self.pixel(at, trace)).collect();
            labels.avoid_line(&path, 0.5);
        }
    }
}

/// The legend beside the drawing, where it covers nothing.
fn entries(linkage: &Linkage, track: &Track, [traced, later]: [&str; 2]) -> Vec<Entry> {
    let mut entries: Vec<_> = linkage
        .moving_links()
        .map(|link| (colour(link), 4.2, linkage.links[link].name.clone()))
        .collect();
    for &trace in &linkage.traces {
        let text = format!("{traced}{}", linkage.point_name(trace));
        entries.push((trace_colour(trace), 2.0, text));
    }
    let shown = instants(track.positions.len()).len();
    if shown > 1 {
        entries.push((faded(INK, BETWEEN), 2.4, later.into()));
    }
    entries
}
