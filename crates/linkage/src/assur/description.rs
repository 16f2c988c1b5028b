//! A mechanism as its file describes it, names resolved to indices.

use super::groups::Group;

/// The index of the frame, the link that stands still.
pub const FRAME: usize = 0;

/// A planar linkage that can be solved: it has as many drives as degrees of freedom, and its links
/// are ordered into groups.
#[derive(Clone, Debug)]
pub struct Linkage {
    /// Names the folder that is written.
    pub name: String,
    /// One line for the summary and the figures.
    pub description: String,
    /// The links; the first is the frame.
    pub links: Vec<Link>,
    /// The joints, in the order of the file.
    pub joints: Vec<Joint>,
    /// What moves it; as many as it has degrees of freedom.
    pub drives: Vec<Drive>,
    /// Points whose curves are wanted.
    pub traces: Vec<PointRef>,
    /// What the drives are followed over.
    pub motion: Motion,
    /// The groups in solving order; together they hold every link but the frame.
    pub groups: Vec<Group>,
}

/// A rigid body with a frame of its own.
#[derive(Clone, Debug)]
pub struct Link {
    /// What the file calls it.
    pub name: String,
    /// Its points: name and position in the link's frame, m.
    pub points: Vec<(String, [f64; 2])>,
    /// Roughly where its frame is at the start: x, y (m), angle (rad).
    pub guess: Option<[f64; 3]>,
}

/// A point of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointRef {
    /// Index of the link.
    pub link: usize,
    /// Index among the link's points.
    pub point: usize,
}

/// What joins links.
#[derive(Clone, Debug)]
pub struct Joint {
    /// What the file calls it.
    pub name: String,
    /// What it leaves free.
    pub kind: JointKind,
    /// The branch asked for, for the dyad whose inner joint this is: +1 or -1.
    pub branch: Option<f64>,
}

/// Both kinds of joint.
#[derive(Clone, Debug)]
pub enum JointKind {
    /// A pin through one point of each of two or more links.
    Revolute(Vec<PointRef>),
    /// A slider on a guide.
    Prismatic(Prismatic),
}

/// A slider on a guide: its point runs along a line of the guide's link, at a distance, and the
/// slider does not turn against it.
#[derive(Clone, Copy, Debug)]
pub struct Prismatic {
    /// The point that the guide's line starts from.
    pub guide: PointRef,
    /// Direction of the line in the frame of the guide's link, rad.
    pub direction: f64,
    /// The slider's point.
    pub slider: PointRef,
    /// Distance of the slider's point to the left of the line, m.
    pub offset: f64,
    /// Angle of the slider's frame from the frame of the guide's link, rad.
    pub angle: f64,
}

/// A prescribed motion in a joint: start + rate t + acceleration t^2 / 2.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    /// Index of the joint.
    pub joint: usize,
    /// The link that the motion is measured from.
    pub base: usize,
    /// The link that is driven.
    pub link: usize,
    /// In a prismatic joint: along the guide, in m. Otherwise an angle in rad.
    pub slides: bool,
    /// At t = 0: rad or m.
    pub start: f64,
    /// At t = 0: rad/s or m/s.
    pub rate: f64,
    /// rad/s^2 or m/s^2.
    pub acceleration: f64,
}

/// What the drives are followed over.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Seconds from the first position to the last.
    pub duration: f64,
    /// Steps from the first position to the last.
    pub steps: u32,
}

impl Drive {
    /// Value, rate and acceleration at the time `t`.
    pub fn at(&self, t: f64) -> [f64; 3] {
        [
            self.start + t * (self.rate + 0.5 * self.acceleration * t),
            self.rate + self.acceleration * t,
            self.acceleration,
        ]
    }
}

impl Joint {
    /// The links it joins.
    pub fn links(&self) -> Vec<usize> {
        match &self.kind {
            JointKind::Revolute(pins) => pins.iter().map(|pin| pin.link).collect(),
            JointKind::Prismatic(slide) => vec![slide.guide.link, slide.slider.link],
        }
    }

    /// How many joints between two links it counts for: a pin through k links for k - 1.
    pub fn simple_joints(&self) -> usize {
        match &self.kind {
            JointKind::Revolute(pins) => pins.len() - 1,
            JointKind::Prismatic(_) => 1,
        }
    }

    /// `R` or `P`.
    pub fn letter(&self) -> char {
        match self.kind {
            JointKind::Revolute(_) => 'R',
            JointKind::Prismatic(_) => 'P',
        }
    }

    /// The point of `link` that the joint takes hold of.
    pub fn point_on(&self, link: usize) -> Option<PointRef> {
        match &self.kind {
            JointKind::Revolute(pins) => pins.iter().find(|pin| pin.link == link).copied(),
            JointKind::Prismatic(slide) => [slide.guide, slide.slider]
                .into_iter()
                .find(|point| point.link == link),
        }
    }
}

impl Linkage {
    /// A point in the frame of its link, m.
    pub fn local(&self, point: PointRef) -> [f64; 2] {
        self.links[point.link].points[point.point].1
    }

    /// `link.point`.
    pub fn point_name(&self, point: PointRef) -> String {
        let link = &self.links[point.link];
        format!("{}.{}", link.name, link.points[point.point].0)
    }

    /// The size that lengths are measured by, m: the greatest distance of two points of one link.
    pub fn size(&self) -> f64 {
        let spread = |link: &Link| {
            let points = &link.points;
            let distances = points.iter().enumerate().flat_map(|(i, (_, a))| {
                points[..i]
                    .iter()
                    .map(|(_, b)| f64::hypot(a[0] - b[0], a[1] - b[1]))
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

/// With commas.
pub(super) fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
