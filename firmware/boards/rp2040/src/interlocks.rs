//! Emergency stop, door, probe and limit switches, all pulled up: contacts to ground. An image leaves the pins alone whose inputs its
//! scene does not name.

use crate::board::{Door, Limit1, Limit2, Limit3, Probe, Stop};
use crate::pins::BoardPin;
use crate::switches::Switches;
use trirrr_app::inputs::{
    DoorLine, LimitSwitchesOf, MotorLimitLine, ProbeLine, StopLine, WithInterlockPins,
    WithTouchPins, limit_switches,
};

/// Switches of homing beside the contacts.
pub(super) type GuardedSwitches = WithTouchPins<
    WithInterlockPins<
        Switches,
        StopLine<<Stop as BoardPin>::Input>,
        DoorLine<<Door as BoardPin>::Input>,
    >,
    ProbeLine<<Probe as BoardPin>::Input>,
    LimitSwitchesOf<
        <Limit1 as BoardPin>::Input,
        <Limit2 as BoardPin>::Input,
        <Limit3 as BoardPin>::Input,
    >,
>;

/// Pulls the pins up that the scene names.
pub(super) fn build(
    inputs: Switches,
    (stop, door, probe): (Stop, Door, Probe),
    (first, second, third): (Limit1, Limit2, Limit3),
) -> GuardedSwitches {
    WithTouchPins {
        inputs: WithInterlockPins {
            inputs,
            stop: StopLine::at(|| stop.input()),
            door: DoorLine::at(|| door.input()),
        },
        probe: ProbeLine::at(|| probe.input()),
        limits: limit_switches(
            MotorLimitLine::at(|| first.input()),
            MotorLimitLine::at(|| second.input()),
            MotorLimitLine::at(|| third.input()),
        ),
    }
}
