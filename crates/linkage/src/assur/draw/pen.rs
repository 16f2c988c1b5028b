//! Links, guides, slots, sliders and pins of a linkage at one position.

use super::super::description::{FRAME, JointKind, Linkage, PointRef, Prismatic};
use super::super::solve::Position;
use super::super::track::Track;
use super::{GROUND, colour, joint_points};
use trirrr_figures::canvas::{Canvas, Draw};
use trirrr_figures::panel::range;
use trirrr_figures::plane::View;
use trirrr_figures::style::{FRAME as GREY, INK, RGBColor, WHITE, faded};

/// Place of a point, m.
pub(super) fn at(linkage: &Linkage, position: &Position, point: PointRef) -> [f64; 2] {
    position.point(linkage, point).position.into()
}

/// The points of a link that are drawn: those at joints and those traced.
pub(super) fn points_of(linkage: &Linkage, link: usize) -> Vec<PointRef> {
    let mut points = joint_points(linkage, link);
    let traced = linkage.traces.iter().filter(|trace| trace.link == link);
    for &trace in traced {
        if !points.contains(&trace) {
            points.push(trace);
        }
    }
    points
}

/// Draws a linkage at one position.
pub(super) struct Pen<'a, 'c> {
    pub(super) linkage: &'a Linkage,
    pub(super) track: &'a Track,
    pub(super) view: &'a View,
    pub(super) canvas: &'a Canvas<'c>,
}

impl Pen<'_, '_> {
    pub(super) fn pixel(&self, position: &Position, point: PointRef) -> (f64, f64) {
        self.view.at(at(self.linkage, position, point))
    }

    /// Every link as the polygon of its points, every slider as a block, every pin as a ring.
    pub(super) fn links(&self, position: &Position, strength: f64) -> Draw {
        for (index, joint) in self.linkage.joints.iter().enumerate() {
            let JointKind::Prismatic(slide) = &joint.kind else {
                continue;
            };
            match (joint.in_slot, slide.guide.link) {
                (Some(_), FRAME) if strength < 1.0 => {}
                (Some(_), _) => self.slot(position, index, slide, strength)?,
                (None, FRAME) if strength < 1.0 => {}
                (None, _) => self.guide(position, slide, strength)?,
            }
        }
        for link in self.linkage.moving_links() {
            let corners: Vec<_> = points_of(self.linkage, link)
                .into_iter()
                .map(|point| self.pixel(position, point))
                .collect();
            let shade = faded(colour(link), strength);
            let width = if strength < 1.0 { 2.4 } else { 4.2 };
            if corners.len() > 2 {
                let inside = faded(colour(link), 0.3 * strength);
                self.outlined(corners, inside, shade, 0.7 * width)?;
            } else if corners.len() == 2 {
                self.canvas.line(&corners, shade, width)?;
            }
        }
        for joint in &self.linkage.joints {
            match &joint.kind {
                // The pin of a slot is drawn as a pin.
                JointKind::Prismatic(_) if joint.in_slot.is_some() => {}
                JointKind::Prismatic(slide) => self.block(position, slide, strength)?,
                JointKind::Revolute(pins) => {
                    let at = self.pixel(position, pins[0]);
                    let on_frame = pins.iter().any(|pin| pin.link == FRAME);
                    let radius = if strength < 1.0 { 3.2 } else { 5.0 };
                    if on_frame {
                        self.foot(at)?;
                    }
                    self.canvas.joint(at, radius, faded(INK, strength))?;
                }
            }
        }
        Ok(())
    }

    fn foot(&self, (x, y): (f64, f64)) -> Draw {
        let foot = [(x, y), (x - 9.0, y + 14.0), (x + 9.0, y + 14.0)];
        self.canvas.polygon(&foot, GROUND)
    }

    /// The slider at its point, along the guide.
    fn block(&self, position: &Position, slide: &Prismatic, strength: f64) -> Draw {
        let (x, y) = self.pixel(position, slide.slider);
        let u = slide.along(&position.states);
        let (half_length, half_width) = if strength < 1.0 {
            (9.0, 5.5)
        } else {
            (13.0, 8.0)
        };
        // The page's y axis points down.
        let corner = |along: f64, across: f64| {
            let (along, across) = (along * half_length, across * half_width);
            (
                x + along * u[0] + across * u[1],
                y - along * u[1] + across * u[0],
            )
        };
        let corners = [
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ];
        let own = colour(slide.slider.link);
        let shades = [0.45 * strength, strength].map(|strength| faded(own, strength));
        self.outlined(corners.to_vec(), shades[0], shades[1], 1.6)
    }

    fn outlined(
        &self,
        mut corners: Vec<(f64, f64)>,
        inside: RGBColor,
        line: RGBColor,
        width: f64,
    ) -> Draw {
        self.canvas.polygon(&corners, inside)?;
        corners.push(corners[0]);
        self.canvas.line(&corners, line, width)
    }

    /// A slot as long as the way of its pin over the motion, and the line from its link to it.
    fn slot(&self, position: &Position, joint: usize, slide: &Prismatic, strength: f64) -> Draw {
        let ways = self.track.positions.iter();
        let ways = ways.filter_map(|at| at.slide(self.linkage, joint));
        let (least, most) = range(ways.map(|slide| slide[0]));
        let [from_x, from_y] = at(self.linkage, position, slide.guide);
        let u = slide.along(&position.states);
        let start = [from_x - slide.offset * u[1], from_y + slide.offset * u[0]];
        let along = |s: f64| self.view.at([start[0] + s * u[0], start[1] + s * u[1]]);
        let shade = faded(colour(slide.guide.link), 0.7 * strength);
        if slide.guide.link != FRAME {
            let near = if least.abs() < most.abs() {
                least
            } else {
                most
            };
            self.canvas.line(&[along(0.0), along(near)], shade, 2.0)?;
        }
        let (outer, inner) = if strength < 1.0 {
            (9.0, 6.0)
        } else {
            (16.0, 12.0)
        };
        let ends = [along(least), along(most)];
        self.canvas.line(&ends, shade, outer)?;
        self.canvas.line(&ends, WHITE, inner)
    }

    /// The line that each slider's point runs along: dashed where it stands still, otherwise from
    /// the guide's point to the slider's.
    fn guide(&self, position: &Position, slide: &Prismatic, strength: f64) -> Draw {
        let [x, y] = at(self.linkage, position, slide.slider);
        let u = slide.along(&position.states);
        if slide.guide.link == FRAME {
            let reach = 0.25 * self.linkage.size();
            let end = |sign: f64| {
                self.view
                    .at([x + sign * reach * u[0], y + sign * reach * u[1]])
            };
            return self.canvas.dashed(end(-1.0), end(1.0), GREY);
        }
        let [from_x, from_y] = at(self.linkage, position, slide.guide);
        let start = [from_x - slide.offset * u[1], from_y + slide.offset * u[0]];
        let line = [self.view.at(start), self.view.at([x, y])];
        let shade = faded(colour(slide.guide.link), 0.7 * strength);
        self.canvas.line(&line, shade, 2.0)
    }
}
