//! Emergency stop at GP19 and door at GP20, both pulled up: contacts to ground. An image whose scene names neither leaves the pins
//! alone.

use crate::drives::Unused;
use crate::switches::Switches;
#[cfg(not(all(estop, door)))]
use core::marker::PhantomData;
use rp2040_hal::gpio::bank0::{Gpio19, Gpio20};
use rp2040_hal::gpio::{FunctionSioInput, Pin, PullUp};
#[cfg(any(estop, door))]
use trirrr_app::inputs::InterlockPin;
#[cfg(not(all(estop, door)))]
use trirrr_app::inputs::NoInterlockPin;
use trirrr_app::inputs::{DoorLine, StopLine, WithInterlockPins};

/// Switches of homing beside the contacts.
pub(super) type GuardedSwitches = WithInterlockPins<
    Switches,
    StopLine<Pin<Gpio19, FunctionSioInput, PullUp>>,
    DoorLine<Pin<Gpio20, FunctionSioInput, PullUp>>,
>;

/// Pulls the pins up that the scene names.
// A scene with one of them leaves the other pin alone.
#[allow(unused_variables)]
pub(super) fn build(
    inputs: Switches,
    stop: Unused<Gpio19>,
    door: Unused<Gpio20>,
) -> GuardedSwitches {
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
