//! Emergency stop at PA6 and door at PA7, both pulled up: contacts to ground. An image whose scene names neither leaves the pins alone.

use crate::switches::Switches;
use stm32f4xx_hal::gpio::Input;
use stm32f4xx_hal::gpio::gpioa::{PA6, PA7};
use trirrr_app::inputs::{DoorLine, StopLine, WithInterlockPins};

/// Switches of homing beside the contacts.
pub(super) type GuardedSwitches =
    WithInterlockPins<Switches, StopLine<PA6<Input>>, DoorLine<PA7<Input>>>;

/// Pulls the pins up that the scene names.
pub(super) fn build(inputs: Switches, stop: PA6, door: PA7) -> GuardedSwitches {
    WithInterlockPins {
        inputs,
        stop: StopLine::at(|| stop.into_pull_up_input()),
        door: DoorLine::at(|| door.into_pull_up_input()),
    }
}
