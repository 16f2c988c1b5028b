//! Modal state: settings that hold until another word changes them.
use std::fmt;

/// Modal state of an interpreter. `Display` writes the codes as the `$G` report of GRBL has them.
#[derive(Clone, Debug, PartialEq)]
pub struct Modal {
    /// Motion of a block that names none.
    pub motion: MotionMode,
    /// Length unit of coordinates and feeds.
    pub unit: LengthUnit,
    /// Plane of arcs.
    pub plane: Plane,
    /// Coordinates are distances from the place of the path (G91).
    pub incremental: bool,
    /// I and J are coordinates (G90.1) and not distances from the start of the arc (G91.1).
    pub absolute_centres: bool,
    /// Sense of F.
    pub feed_mode: FeedMode,
    /// Active work coordinate system: 0 for G54, up to 5 for G59.
    pub origin: usize,
    /// Behaviour between two motions.
    pub path: PathMode,
    /// Tolerance of G64 P, m. None: no tolerance was given, or the mode is not G64.
    pub blend_m: Option<f64>,
    /// Mode of the laser.
    pub laser: LaserMode,
    /// Feed of G94, m/s, positive. None: no F was given.
    pub feed_m_s: Option<f64>,
    /// Last S word, at most the full power of the setup.
    pub s: f64,
    /// Number of the last T word.
    pub tool: u32,
}

impl Default for Modal {
    /// State at start-up: G0 G54 G17 G21 G90 G91.1 G94 G64 M5 S0, without a feed.
    fn default() -> Self {
        Self {
            motion: MotionMode::Rapid,
            unit: LengthUnit::Millimetre,
            plane: Plane::Xy,
            incremental: false,
            absolute_centres: false,
            feed_mode: FeedMode::PerMinute,
            origin: 0,
            path: PathMode::Blend,
            blend_m: None,
            laser: LaserMode::Off,
            feed_m_s: None,
            s: 0.0,
            tool: 0,
        }
    }
}

impl fmt::Display for Modal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let motion = match self.motion {
            MotionMode::Rapid => "G0",
            MotionMode::Line => "G1",
            MotionMode::Clockwise => "G2",
            MotionMode::Counterclockwise => "G3",
            MotionMode::None => "G80",
        };
        let unit = match self.unit {
            LengthUnit::Inch => "G20",
            LengthUnit::Millimetre => "G21",
        };
        let distance = if self.incremental { "G91" } else { "G90" };
        let feed = match self.feed_mode {
            FeedMode::InverseTime => "G93",
            FeedMode::PerMinute => "G94",
        };
        let laser = match self.laser {
            LaserMode::Constant => "M3",
            LaserMode::FollowsSpeed => "M4",
            LaserMode::Off => "M5",
        };
        // Six digits hide the rounding of the conversion to metres per second and back.
        let rate = self
            .feed_m_s
            .map_or(0.0, |feed| self.unit.of_metres(feed) * 60.0);
        let rate = (rate * 1e6).round() / 1e6;
        let plane = match self.plane {
            Plane::Xy => "G17",
            Plane::Zx => "G18",
            Plane::Yz => "G19",
        };
        let (origin, tool, s) = (54 + self.origin, self.tool, self.s);
        write!(
            f,
            "{motion} G{origin} {plane} {unit} {distance} {feed} {laser} M9 T{tool} F{rate} S{s}"
        )
    }
}

/// Motion that axis words ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionMode {
    /// G0: as fast as the machine may, tool off.
    Rapid,
    /// G1: straight line at the feed.
    Line,
    /// G2: clockwise arc at the feed.
    Clockwise,
    /// G3: counter-clockwise arc at the feed.
    Counterclockwise,
    /// G80: axis words need a motion code of their own.
    None,
}

impl MotionMode {
    /// Tells motions at the feed from rapids and from none.
    pub(super) fn at_feed(self) -> bool {
        matches!(self, Self::Line | Self::Clockwise | Self::Counterclockwise)
    }
}

/// Plane of arcs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// G17: that of the machine.
    Xy,
    /// G18: its arcs are lines along x, seen from above.
    Zx,
    /// G19: its arcs are lines along y, seen from above.
    Yz,
}

/// Length unit of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// G21.
    Millimetre,
    /// G20.
    Inch,
}

impl LengthUnit {
    /// Length in metres.
    pub(super) fn to_metres(self, length: f64) -> f64 {
        match self {
            Self::Millimetre => length / 1000.0,
            // An inch is 25.4 mm; two exact factors and one rounding less than 0.0254.
            Self::Inch => length * 25.4 / 1000.0,
        }
    }

    /// Length of so many metres in this unit.
    pub(super) fn of_metres(self, metres: f64) -> f64 {
        match self {
            Self::Millimetre => metres * 1000.0,
            Self::Inch => metres * 1000.0 / 25.4,
        }
    }
}

/// Sense of F.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedMode {
    /// G94: length units per minute.
    PerMinute,
    /// G93: one over the minutes that the block takes.
    InverseTime,
}

/// Behaviour between two motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathMode {
    /// G61: the path is visited exactly. Motions end at rest, as with G61.1.
    ExactPath,
    /// G61.1: each motion ends at rest.
    ExactStop,
    /// G64: motions may be blended.
    Blend,
}

/// Mode of the laser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaserMode {
    /// M5.
    Off,
    /// M3: constant power.
    Constant,
    /// M4: power in proportion to the speed.
    FollowsSpeed,
}
