//! Emergency stop at PA6 and door at PA7, both pulled up: contacts to ground. An image whose scene names neither leaves the pins alone.

use crate::switches::Switches;
#[cfg(not(all(estop, door)))]
use core::marker::PhantomData;
use stm32f4xx_hal::gpio::Input;
use stm32f4xx_hal::gpio::gpioa::{PA6, PA7};
#[cfg(any(estop, door))]
use trirrr_app::inputs::InterlockPin;
#[cfg(not(all(estop, door)))]
use trirrr_app::inputs::NoInterlockPin;
use trirrr_app::inputs::{DoorLine, StopLine, WithInterlockPins};

/// Switches of homing beside the contacts.
pub(super) type GuardedSwitches =
    WithInterlockPins<Switches, StopLine<PA6<Input>>, DoorLine<PA7<Input>>>;

/// Pulls the pins up that the scene names.
// A scene with one of them leaves the other pin alone.
#[allow(unused_variables)]
pub(super) fn build(inputs: Switches, stop: PA6, door: PA7) -> GuardedSwitches {
    WithInterlockPins {
        inputs,
        #[cfg(estop)]
        stop: InterlockPin(stop.into_pull_up_input()),
        #[cfg(not(estop))]
        stop: NoInterlockPin(PhantomData),
        #[cfg(door)]
        door: InterlockPin(door.into_pull_up_input()),
        #[cfg(not(door))]
        door: NoInterlockPin(PhantomData),
    }
}
