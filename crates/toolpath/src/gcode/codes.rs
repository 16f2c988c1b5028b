//! G and M codes that are supported, and reasons for those that are not.
use super::modal::{self, FeedMode, LaserMode, LengthUnit, MotionMode, PathMode};

/// G code with an effect, or one that states what holds anyway.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum GeneralCode {
    Once(OnceCode),
    Motion(MotionMode),
    /// G17 to G19.
    Plane(modal::Plane),
    Distance {
        incremental: bool,
    },
    Centres {
        absolute: bool,
    },
    Feed(FeedMode),
    Unit(LengthUnit),
    /// G40: no compensation for the width of the tool.
    Compensation,
    /// G43, G49: the length of the tool, which words of Z know already, and no such length.
    ToolLength {
        of_table: bool,
    },
    Origin(usize),
    Path(PathMode),
}

/// G code that acts in its block alone (group 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OnceCode {
    /// G4.
    Dwell,
    /// G10.
    SetOrigin,
    /// G28.
    Home,
    /// G53.
    FixedFrame,
    /// G92.
    Shift,
    /// G92.1.
    ClearShift,
}

impl OnceCode {
    /// Tells codes that take the axis words of their block for themselves.
    pub(super) fn takes_axes(self) -> bool {
        matches!(self, Self::SetOrigin | Self::Home | Self::Shift)
    }
}

/// M code with an effect, or one that states what holds anyway.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MiscCode {
    /// M0, M1.
    Pause,
    /// M2, M30.
    End(ProgramEnd),
    Laser(LaserMode),
    /// M7 to M9: the machine has no coolant.
    Coolant,
    /// M62 to M65.
    Output {
        on: bool,
        with_motion: bool,
    },
    /// M66.
    Input,
    /// M6.
    ToolChange,
}

/// Code that ended a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramEnd {
    /// M2.
    M2,
    /// M30.
    M30,
    /// `%` after words.
    Percent,
}

/// Looks a G code up by ten times its number. Returns the reason if the code is refused.
pub(super) fn general(tenths: u32) -> Result<GeneralCode, &'static str> {
    use GeneralCode as G;
    Ok(match tenths {
        0 => G::Motion(MotionMode::Rapid),
        10 => G::Motion(MotionMode::Line),
        20 => G::Motion(MotionMode::Clockwise),
        30 => G::Motion(MotionMode::Counterclockwise),
        800 => G::Motion(MotionMode::None),
        40 => G::Once(OnceCode::Dwell),
        100 => G::Once(OnceCode::SetOrigin),
        280 => G::Once(OnceCode::Home),
        530 => G::Once(OnceCode::FixedFrame),
        920 => G::Once(OnceCode::Shift),
        921 => G::Once(OnceCode::ClearShift),
        170 => G::Plane(modal::Plane::Xy),
        180 => G::Plane(modal::Plane::Zx),
        190 => G::Plane(modal::Plane::Yz),
        200 | 700 => G::Unit(LengthUnit::Inch),
        210 | 710 => G::Unit(LengthUnit::Millimetre),
        400 => G::Compensation,
        430 => G::ToolLength { of_table: true },
        490 => G::ToolLength { of_table: false },
        540 => G::Origin(0),
        550 => G::Origin(1),
        560 => G::Origin(2),
        570 => G::Origin(3),
        580 => G::Origin(4),
        590 => G::Origin(5),
        610 => G::Path(PathMode::ExactPath),
        611 => G::Path(PathMode::ExactStop),
        640 => G::Path(PathMode::Blend),
        900 => G::Distance { incremental: false },
        910 => G::Distance { incremental: true },
        901 => G::Centres { absolute: true },
        911 => G::Centres { absolute: false },
        930 => G::Feed(FeedMode::InverseTime),
        940 => G::Feed(FeedMode::PerMinute),
        _ => return Err(no_general(tenths)),
    })
}

/// Modal group of a G code. Codes of one group exclude each other in a block.
pub(super) fn group(code: GeneralCode) -> u32 {
    match code {
        GeneralCode::Once(_) => 0,
        // Posts of many controls end cycles in the line of a motion.
        GeneralCode::Motion(MotionMode::None) => 9,
        GeneralCode::Motion(_) => 1,
        GeneralCode::Plane(_) => 2,
        GeneralCode::Distance { .. } => 3,
        GeneralCode::Centres { .. } => 4,
        GeneralCode::Feed(_) => 5,
        GeneralCode::Unit(_) => 6,
        GeneralCode::Compensation => 7,
        GeneralCode::ToolLength { .. } => 8,
        GeneralCode::Origin(_) => 12,
        GeneralCode::Path(_) => 13,
    }
}

/// Reason to refuse another plane than that of x and y.
pub(super) const OTHER_PLANE: &str = "the machine moves in the plane of x and y; arcs need G17";

/// Reason to refuse the length of a tool.
pub(super) const NO_LENGTH: &str = "there is no compensation for the tool's length; use G49";

fn no_general(tenths: u32) -> &'static str {
    match tenths {
        50..60 => "splines are not supported; write the curve as G1, G2 or G3",
        171..200 => OTHER_PLANE,
        281 | 301 => "positions are not stored by programs; set the goal of G28 in the setup",
        300 => "there is no second home; use G28, or G53 G0 with coordinates",
        380..390 => "jobs do not probe; `trirrr grbl` takes G38.2 to G38.5 from a sender",
        410..=429 => "there is no compensation for the tool's width; offset the path and use G40",
        431..440 => NO_LENGTH,
        591..600 => "there are six coordinate systems; use G54 to G59",
        730 | 760 | 810..900 => "canned cycles are not supported; write the motions as G0 and G1",
        922 | 923 => "the offset of G92 cannot be suspended; use G92.1, and G92 again",
        950 => "the tool does not turn; use G94 (units per minute) or G93 (inverse time)",
        _ => "the code is not supported; remove it, or use another post-processor (GRBL, LinuxCNC)",
    }
}

/// Looks an M code up by ten times its number. Returns the reason if the code is refused.
pub(super) fn miscellaneous(tenths: u32) -> Result<MiscCode, &'static str> {
    Ok(match tenths {
        0 | 10 => MiscCode::Pause,
        20 => MiscCode::End(ProgramEnd::M2),
        300 => MiscCode::End(ProgramEnd::M30),
        30 => MiscCode::Laser(LaserMode::Constant),
        40 => MiscCode::Laser(LaserMode::FollowsSpeed),
        50 => MiscCode::Laser(LaserMode::Off),
        70 | 80 | 90 => MiscCode::Coolant,
        620 | 630 => MiscCode::Output {
            on: tenths == 620,
            with_motion: true,
        },
        640 | 650 => MiscCode::Output {
            on: tenths == 640,
            with_motion: false,
        },
        660 => MiscCode::Input,
        670 | 680 => return Err("outputs have two levels: M62 to M65; the tool has power: S"),
        60 => MiscCode::ToolChange,
        980 | 990 => return Err("subprograms are not supported; write their blocks out"),
        _ => {
            return Err(
                "the code is not supported; remove it, or use another post-processor (GRBL, LinuxCNC)",
            );
        }
    })
}

/// Modal group of an M code, in the same mask as those of G codes.
pub(super) fn miscellaneous_group(code: MiscCode) -> u32 {
    match code {
        MiscCode::Pause | MiscCode::End(_) => 20,
        MiscCode::Laser(_) => 21,
        MiscCode::Coolant => 22,
        MiscCode::Output { .. } => 23,
        MiscCode::Input => 24,
        MiscCode::ToolChange => 25,
    }
}
