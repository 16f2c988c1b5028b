//! Emergency stop and door, both pulled up: contacts to ground. An image whose scene names neither leaves the pins alone.

use crate::board::{Door, Stop};
use crate::gpio::Pull;
use crate::pins::BoardPin;
use crate::switches::Switches;
use trirrr_app::inputs::{DoorLine, StopLine, WithInterlockPins};

/// Switches of homing beside the contacts.
pub(super) type GuardedSwitches = WithInterlockPins<
    Switches,
    StopLine<<Stop as BoardPin>::Input>,
    DoorLine<<Door as BoardPin>::Input>,
>;

/// Pulls the pins up that the scene names.
pub(super) fn build(inputs: Switches, stop: Stop, door: Door) -> GuardedSwitches {
    WithInterlockPins {
        inputs,
        stop: StopLine::at(|| stop.input(Pull::Up)),
        door: DoorLine::at(|| door.input(Pull::Up)),
    }
}
