//! Emergency stop at GP19 and door at GP20, both pulled up: contacts to ground. An image whose scene names neither leaves the pins
//! alone.

use rp2040_hal::gpio::bank0::{Gpio19, Gpio20};
use rp2040_hal::gpio::{FunctionNull, FunctionSioInput, Pin, PullDown, PullUp};
use trirrr_app::inputs::{InterlockPin, WithInterlockPins};
use trirrr_app::scene::DOOR_OPEN_HIGH;

type Unused<P> = Pin<P, FunctionNull, PullDown>;
type PulledUp<P> = Pin<P, FunctionSioInput, PullUp>;

#[cfg(estop)]
type Stop = InterlockPin<PulledUp<Gpio19>, true>;
#[cfg(not(estop))]
type Stop = ();

#[cfg(door)]
type Door = InterlockPin<PulledUp<Gpio20>, DOOR_OPEN_HIGH>;
#[cfg(not(door))]
type Door = ();

/// Inputs `I` beside the contacts.
pub(super) type Guarded<I> = WithInterlockPins<I, Stop, Door>;

/// Pulls the pins up that the scene names.
// A scene with one of them leaves the other pin alone.
#[allow(unused_variables)]
pub(super) fn build<I>(inputs: I, stop: Unused<Gpio19>, door: Unused<Gpio20>) -> Guarded<I> {
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
