//! Linkage as the file describes it, with its groups.

use super::groups::Group;
pub(super) use super::parts::names;
pub use super::parts::{
    FRAME, Joint, JointDrive, JointKind, LinkBody, MotionSpan, PointRef, Prismatic,
};
use nalgebra::Vector2;

/// A planar linkage that can be solved: it has as many drives as degrees of freedom, and its links
/// are ordered into groups.
#[derive(Clone, Debug)]
pub struct Linkage {
    /// Names the folder that is written.
    pub name: String,
    /// One line for the summary and the figures.
    pub description: String,
    /// The links; the first is the frame.
    pub links: Vec<LinkBody>,
    /// The joints, in the order of the file.
    pub joints: Vec<Joint>,
    /// Drives, as many as degrees of freedom.
    pub drives: Vec<JointDrive>,
    /// Points whose curves are wanted.
    pub traces: Vec<PointRef>,
    /// Duration and steps of the motion that is solved.
    pub motion: MotionSpan,
    /// The groups in solving order; together they hold every link but the frame.
    pub groups: Vec<Group>,
}

impl Linkage {
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

    /// The names of `joints`, with commas.
    pub fn joint_names(&self, joints: &[usize]) -> String {
        names(joints.iter().map(|&joint| self.joints[joint].name.as_str()))
    }
}
