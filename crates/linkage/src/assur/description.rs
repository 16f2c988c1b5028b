//! Linkage as the file describes it, with its groups.

use super::groups::Group;
pub(super) use super::parts::names;
pub use super::parts::{
    FRAME, Joint, JointDrive, JointKind, LinkBody, MotionSpan, PointRef, Prismatic, SlotPart,
};
use nalgebra::Vector2;
use std::ops::Range;

/// A planar linkage that can be solved: it has as many drives as degrees of freedom, and its links
/// are ordered into groups.
#[derive(Clone, Debug)]
pub struct Linkage {
    /// Names the folder that is written.
    pub name: String,
    /// One line for the summary and the figures.
    pub description: String,
    /// The links: first the frame, last the blocks of pins in slots.
    pub links: Vec<LinkBody>,
    /// The joints, in the order of the file; that of a pin in a slot is followed by the pin of its block.
    pub joints: Vec<Joint>,
    /// Drives, as many as degrees of freedom.
    pub drives: Vec<JointDrive>,
    /// Points whose curves are wanted.
    pub traces: Vec<PointRef>,
    /// Gravity in the plane, m/s^2.
    pub gravity_m_s2: Vector2<f64>,
    /// Duration and steps of the motion that is solved.
    pub motion: MotionSpan,
    /// The groups in solving order; together they hold every link but the frame.
    pub groups: Vec<Group>,
}

impl Linkage {
    /// The links of the file, the frame first. Blocks of pins in slots come after them.
    pub fn file_links(&self) -> Range<usize> {
        let blocks = self.links.iter().filter(|link| link.is_block);
        0..self.links.len() - blocks.count()
    }

    /// The links of the file that move.
    pub(super) fn moving_links(&self) -> Range<usize> {
        FRAME + 1..self.file_links().end
    }

    /// Returns the pin of the block whose slider `joint` is; `None` for a joint that is no slot.
    pub(super) fn pin_of_slot(&self, joint: usize) -> Option<usize> {
        let JointKind::Prismatic(slide) = &self.joints[joint].kind else {
            return None;
        };
        let is_pin = |other: &Joint| {
            other.in_slot == Some(SlotPart::Pin) && other.point_on(slide.slider.link).is_some()
        };
        self.joints.iter().position(is_pin)
    }

    /// A point in the frame of its link, m.
    pub fn local(&self, point: PointRef) -> Vector2<f64> {
        self.links[point.link].points[point.point].1
    }

    /// `link.point`.
    pub fn point_name(&self, point: PointRef) -> String {
        let link = &self.links[point.link];
        format!("{}.{}", link.name, link.points[point.point].0)
    }

    /// The size that lengths are measured by, m: the greatest distance of two points of one link.
    pub fn size(&self) -> f64 {
        let spread = |link: &LinkBody| {
            let points = &link.points;
            let distances = points.iter().enumerate().flat_map(|(i, (_, a))| {
                points[..i]
                    .iter()
                    .map(|(_, b)| f64::hypot(a.x - b.x, a.y - b.y))
            });
            distances.fold(0.0, f64::max)
        };
        let size = self.links.iter().map(spread).fold(0.0, f64::max);
        if size > 0.0 { size } else { 1.0 }
    }

    /// The names of `links`, with commas.
    pub fn link_names(&self, links: &[usize]) -> String {
        names(links.iter().map(|&link| self.links[link].name.as_str()))
    }

    /// The names of `joints`, with commas; of a pin in a slot with the part.
    pub fn joint_names(&self, joints: &[usize]) -> String {
        let name = |&joint: &usize| {
            let Joint { name, in_slot, .. } = &self.joints[joint];
            match in_slot {
                Some(SlotPart::Slot) => format!("{name} (slot)"),
                Some(SlotPart::Pin) => format!("{name} (pin)"),
                None => name.clone(),
            }
        };
        let all: Vec<String> = joints.iter().map(name).collect();
        all.join(", ")
    }
}
