//! Emergency stop at PA6 and door at PA7, both pulled up: contacts to ground. An image whose scene names neither leaves the pins alone.

use stm32f4xx_hal::gpio::Input;
use stm32f4xx_hal::gpio::gpioa::{PA6, PA7};
use trirrr_app::inputs::{InterlockPin, WithInterlockPins};
use trirrr_app::scene::DOOR_OPEN_HIGH;

#[cfg(estop)]
type Stop = InterlockPin<PA6<Input>, true>;
#[cfg(not(estop))]
type Stop = ();

#[cfg(door)]
type Door = InterlockPin<PA7<Input>, DOOR_OPEN_HIGH>;
#[cfg(not(door))]
type Door = ();

/// Inputs `I` beside the contacts.
pub(super) type Guarded<I> = WithInterlockPins<I, Stop, Door>;

/// Pulls the pins up that the scene names.
// A scene with one of them leaves the other pin alone.
#[allow(unused_variables)]
pub(super) fn build<I>(inputs: I, stop: PA6, door: PA7) -> Guarded<I> {
    WithInterlockPins {
        inputs,
        #[cfg(estop)]
        stop: InterlockPin(stop.into_pull_up_input()),
        #[cfg(not(estop))]
        stop: (),
        #[cfg(door)]
        door: InterlockPin(door.into_pull_up_input()),
        #[cfg(not(door))]
        door: (),
    }
}
