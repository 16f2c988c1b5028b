//! Pins of the board in one table, with the resistors and levels that `docs/board.md` asks of the wiring.

use crate::chip::Kind;
use crate::time::Time;
use crate::trace::{Edge, Level, Pin, Trace};
use trirrr_scene::{Drive, DriveKind, EnableLevel, FaultInput, Scene, ToolKind};

/// Step of motor 1, 2, 3.
pub(crate) const STEPS: [Pin; 3] = [Pin('C', 0), Pin('C', 1), Pin('C', 2)];
/// Direction of motor 1, 2, 3.
pub(crate) const DIRECTIONS: [Pin; 3] = [Pin('C', 3), Pin('C', 4), Pin('C', 5)];
/// Set value of amplifier 1, 2, 3.
pub(crate) const SET_VALUES: [Pin; 3] = [Pin('C', 6), Pin('C', 7), Pin('C', 8)];
/// Enable of all drives.
pub(crate) const ENABLE: Pin = Pin('B', 12);
/// Tool: level or PWM.
pub(crate) const fn tool(kind: Kind) -> Pin {
    match kind {
        Kind::Stm32f405 => Pin('A', 5),
        Kind::Stm32g474 => Pin('A', 0),
    }
}
/// Enable of the tool.
pub(crate) const TOOL_ENABLE: Pin = Pin('A', 4);
/// Contact of the emergency stop, to ground while it is released.
pub(crate) const STOP: Pin = Pin('A', 6);
/// Contact of the door, to ground while it is closed.
pub(crate) const DOOR: Pin = Pin('A', 7);

/// Contact of the button, and the level at which it is pressed.
pub(crate) const fn button(kind: Kind) -> (Pin, bool) {
    match kind {
        Kind::Stm32f405 => (Pin('C', 13), false),
        // That of a Nucleo.
        Kind::Stm32g474 => (Pin('C', 13), true),
    }
}

/// Names of the spare outputs.
pub(crate) const SPARE: [&str; 4] = ["output 0", "output 1", "output 2", "output 3"];

/// Pins of the spare outputs.
pub(crate) const fn spare_outputs(kind: Kind) -> [Pin; 4] {
    match kind {
        Kind::Stm32f405 => [Pin('A', 10), Pin('A', 11), Pin('A', 12), Pin('D', 2)],
        Kind::Stm32g474 => [Pin('C', 6), Pin('C', 7), Pin('C', 8), Pin('A', 8)],
    }
}

/// Signals of a dump, with their pins.
pub(crate) const SIGNALS: [(&str, Pin); 13] = [
    ("step 1", STEPS[0]),
    ("step 2", STEPS[1]),
    ("step 3", STEPS[2]),
    ("direction 1", DIRECTIONS[0]),
    ("direction 2", DIRECTIONS[1]),
    ("direction 3", DIRECTIONS[2]),
    ("set value 1", SET_VALUES[0]),
    ("set value 2", SET_VALUES[1]),
    ("set value 3", SET_VALUES[2]),
    ("enable", ENABLE),
    ("tool", tool(Kind::Stm32f405)),
    ("tool of an STM32G474", tool(Kind::Stm32g474)),
    ("tool enable", TOOL_ENABLE),
];

/// An output with the level at which something outside is on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Output {
    pub(crate) name: &'static str,
    pub(crate) pin: Pin,
    pub(crate) on: bool,
}

impl Output {
    /// Returns true if the output is on at a level. A resistor of the wiring pulls a pin that floats to off.
    fn is_on(&self, level: Level) -> bool {
        level == Level::of(self.on)
    }

    /// Returns the time from which on the output has been off, at `since` the earliest; none if it is on.
    pub(crate) fn off_since(&self, trace: &Trace, since: Time) -> Option<Time> {
        let edges = trace.edges(self.pin);
        if self.is_on(trace.level(self.pin)) {
            return None;
        }
        let last_on = edges.iter().rposition(|edge| self.is_on(edge.level));
        let off = last_on.and_then(|last| edges.get(last + 1));
        Some(off.map_or(since, |edge: &Edge| edge.time.max(since)))
    }

    /// Returns true if the output was on at any time from `since` on.
    pub(crate) fn was_on(&self, trace: &Trace, since: Time) -> bool {
        let edges = trace.edges(self.pin);
        let before = edges.iter().rfind(|edge| edge.time <= since);
        before.is_some_and(|edge| self.is_on(edge.level))
            || edges
                .iter()
                .any(|edge| edge.time > since && self.is_on(edge.level))
    }
}

/// Failure of amplifier 1, 2, 3.
const FAILURES: [Pin; 3] = [Pin('C', 0), Pin('C', 1), Pin('C', 2)];

/// Returns the levels at the inputs by which amplifiers report a failure, of those that have none.
pub(crate) fn healthy(scene: &Scene) -> Vec<(Pin, bool)> {
    let drives = scene.drives.iter().flatten().zip(FAILURES);
    let level = |(drive, pin): (&Drive, Pin)| match &drive.kind {
        DriveKind::Bldc(bldc) => match bldc.fault {
            FaultInput::Low => Some((pin, true)),
            FaultInput::High => Some((pin, false)),
            FaultInput::None => None,
        },
        _ => None,
    };
    drives.filter_map(level).collect()
}

fn is_high(level: EnableLevel) -> bool {
    level == EnableLevel::High
}

/// Returns the outputs of a scene that have to be off where the machine is: the enable lines, the tool, the step lines, and the spare
/// outputs.
pub(crate) fn outputs(scene: &Scene, kind: Kind) -> Vec<Output> {
    let mut outputs = Vec::new();
    let mut add = |name, pin, on| outputs.push(Output { name, pin, on });
    match scene.drives.as_ref().map(|[first, ..]| &first.kind) {
        Some(DriveKind::Stepper(stepper)) => {
            add("drives", ENABLE, is_high(stepper.enable));
            for (name, pin) in ["step 1", "step 2", "step 3"].into_iter().zip(STEPS) {
                add(name, pin, true);
            }
        }
        Some(DriveKind::Bldc(bldc)) => add("drives", ENABLE, is_high(bldc.enable)),
        Some(DriveKind::Can(_)) | None => {}
    }
    if let Some(tool) = &scene.tool {
        add("tool", self::tool(kind), !tool.inverted);
        if let ToolKind::Pwm {
            enable: Some(level),
            ..
        } = tool.kind
        {
            add("tool enable", TOOL_ENABLE, is_high(level));
        }
    }
    let spare = SPARE.into_iter().zip(spare_outputs(kind));
    for (name, pin) in spare.take(scene.spare_pins.outputs.len()) {
        add(name, pin, true);
    }
    outputs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pin_that_floats_is_off() {
        let output = Output {
            name: "drives",
            pin: ENABLE,
            on: false,
        };
        let mut trace = Trace::default();
        assert!(!output.was_on(&trace, 0));
        for (time, level) in [(10, Level::High), (20, Level::Low), (50, Level::Floating)] {
            trace.record(time, ENABLE, level);
        }
        assert_eq!(output.off_since(&trace, 30), Some(50));
        assert!(output.was_on(&trace, 30) && !output.was_on(&trace, 50));
        trace.record(60, ENABLE, Level::Low);
        assert_eq!(output.off_since(&trace, 30), None);
    }
}
