//! Numbers of GRBL's errors and alarms.

use trirrr_toolpath::gcode::RefusalKind;

/// A number is none.
pub(crate) const NUMBER: u8 = 2;
/// A `$` command is not known or not supported.
pub(crate) const STATEMENT: u8 = 3;
/// A number is negative.
pub(crate) const NEGATIVE: u8 = 4;
/// The command needs a machine that stands idle.
pub(crate) const NOT_IDLE: u8 = 8;
/// The machine is locked.
pub(crate) const LOCKED: u8 = 9;
/// A line is too long.
pub(crate) const OVERFLOW: u8 = 11;
/// A jog goes out of reach.
pub(crate) const TRAVEL: u8 = 15;
/// A jog without `=`, or with a code that a jog has not.
pub(crate) const JOG: u8 = 16;
/// The door is open.
pub(crate) const DOOR: u8 = 13;
/// There is no feed.
pub(crate) const FEED: u8 = 22;
/// A code needs axis words.
pub(crate) const NO_AXES: u8 = 26;
/// A word that no code of the line uses.
pub(crate) const UNUSED: u8 = 36;
/// A motion with the probe has no length, or is none.
pub(crate) const TARGET: u8 = 33;

/// A fault of the machine.
pub(crate) const ALARM_FAULT: u8 = 1;
/// A motion beyond what the machine can do. The position is known.
pub(crate) const ALARM_TRAVEL: u8 = 2;
/// The probe is not as a motion with it needs it.
pub(crate) const ALARM_PROBE: u8 = 4;
/// A motion with the probe, or a wait for an input, has ended without a contact.
pub(crate) const ALARM_NO_CONTACT: u8 = 5;
/// Homing failed.
pub(crate) const ALARM_HOMING: u8 = 8;

/// Number for a line that the interpreter refuses.
pub(crate) fn number(kind: RefusalKind) -> u8 {
    match kind {
        RefusalKind::Letter => 1,
        RefusalKind::Number => NUMBER,
        RefusalKind::Negative => NEGATIVE,
        RefusalKind::TooLong => OVERFLOW,
        RefusalKind::Unsupported => 20,
        RefusalKind::ModalGroup => 21,
        RefusalKind::NoFeed => FEED,
        RefusalKind::NotWhole => 23,
        RefusalKind::AxisConflict => 24,
        RefusalKind::Repeated => 25,
        RefusalKind::NoAxes => NO_AXES,
        RefusalKind::LineNumber => 27,
        RefusalKind::MissingWord => 28,
        RefusalKind::NoSystem => 29,
        RefusalKind::FixedFrame => 30,
        RefusalKind::NoMotionMode => 31,
        RefusalKind::ArcTarget => TARGET,
        RefusalKind::ArcRadius => 34,
        RefusalKind::NoCentre => 35,
        RefusalKind::Unused => UNUSED,
        RefusalKind::TooLarge => 38,
    }
}
