//! Parts of a linkage: links, joints, drives, with names resolved to indices.

use nalgebra::Vector2;

/// Mass of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMass {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass in the link's frame, m.
    pub com_m: Vector2<f64>,
    /// Moment of inertia about the centre of mass, kg m^2.
    pub inertia_kgm2: f64,
}

impl BodyMass {
    /// A link without mass.
    pub const NONE: Self = Self {
        mass_kg: 0.0,
        com_m: Vector2::new(0.0, 0.0),
        inertia_kgm2: 0.0,
    };
}

/// The index of the frame, the link that stands still.
pub const FRAME: usize = 0;

/// A rigid body with a frame of its own.
#[derive(Clone, Debug)]
pub struct LinkBody {
    /// Name in the file.
    pub name: String,
    /// Its points: name and position in the link's frame, m.
    pub points: Vec<(String, Vector2<f64>)>,
    /// Roughly where its frame is at the start: x, y (m), angle (rad).
    pub guess: Option<[f64; 3]>,
    /// Its mass.
    pub mass: BodyMass,
    /// `true` for the block of a pin in a slot, which the file does not have.
    pub is_block: bool,
}

/// A point of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointRef {
    /// Index of the link.
    pub link: usize,
    /// Index among the link's points.
    pub point: usize,
}

/// Joint between links.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name in the file.
    pub name: String,
    /// Revolute or prismatic, with the points that the joint holds.
    pub kind: JointKind,
    /// The branch asked for, for the dyad whose inner joint this is: +1 or -1.
    pub branch: Option<f64>,
    /// Part that the joint has in a pin in a slot.
    pub in_slot: Option<SlotPart>,
}

/// Parts of a pin in a slot: a block turns on the pin and slides in the slot. Both joints of the block have
/// the name of the file's joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotPart {
    /// The block's slider in the slot. It stands in the place of the file's joint.
    Slot,
    /// The block's pin. It stands right behind.
    Pin,
}

/// Both kinds of joint that are solved.
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
pub struct JointDrive {
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

/// Duration and steps of the motion that is solved.
#[derive(Clone, Copy, Debug)]
pub struct MotionSpan {
    /// Seconds from the first position to the last.
    pub duration: f64,
    /// Steps from the first position to the last.
    pub steps: u32,
}

impl JointDrive {
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

    /// Returns the number of joints between two links: k - 1 for a pin through k links.
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

/// With commas.
pub(super) fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
