//! Emergency stop at GP19 and door at GP20, both pulled up: contacts to ground. An image whose scene names neither leaves the pins
//! alone.

use crate::drives::Unused;
use crate::switches::Switches;
use rp2040_hal::gpio::bank0::{Gpio19, Gpio20};
use rp2040_hal::gpio::{FunctionSioInput, Pin, PullUp};
use trirrr_app::inputs::{DoorLine, StopLine, WithInterlockPins};

/// Switches of homing beside the contacts.
pub(super) type GuardedSwitches = WithInterlockPins<
    Switches,
    StopLine<Pin<Gpio19, FunctionSioInput, PullUp>>,
    DoorLine<Pin<Gpio20, FunctionSioInput, PullUp>>,
>;

/// Pulls the pins up that the scene names.
pub(super) fn build(
    inputs: Switches,
    stop: Unused<Gpio19>,
    door: Unused<Gpio20>,
) -> GuardedSwitches {
    WithInterlockPins {
        inputs,
        stop: StopLine::at(|| stop.into_pull_up_input()),
        door: DoorLine::at(|| door.into_pull_up_input()),
    }
}
