//! Inputs of the tick: switches of homing, emergency stop, door, probe and limit switches, and spare inputs, all pulled up. An image leaves the pins
//! alone whose inputs its scene does not name.

#[cfg(interlocks)]
use crate::board::{Door, Limit1, Limit2, Limit3, Probe, Stop};
#[cfg(homing)]
use crate::board::{Homing1, Homing2, Homing3};
#[cfg(any(homing, interlocks))]
use crate::wiring::BoardPin;
#[cfg(interlocks)]
use trirrr_app::inputs::{DoorLine, GuardedInputs, LimitSwitches, ProbeLine, StopLine};

/// Pin `P` as an input that is pulled up.
#[cfg(any(homing, interlocks))]
type PulledUp<P> = <P as BoardPin>::Input;

#[cfg(homing)]
type Switches =
    trirrr_app::inputs::HomingSwitches<PulledUp<Homing1>, PulledUp<Homing2>, PulledUp<Homing3>>;
#[cfg(not(homing))]
type Switches = trirrr_app::inputs::NoInputs;

#[cfg(interlocks)]
type Guarded = GuardedInputs<
    Switches,
    (
        StopLine<PulledUp<Stop>>,
        DoorLine<PulledUp<Door>>,
        ProbeLine<PulledUp<Probe>>,
    ),
    LimitSwitches<PulledUp<Limit1>, PulledUp<Limit2>, PulledUp<Limit3>>,
>;
#[cfg(not(interlocks))]
type Guarded = Switches;

/// Inputs of this image.
#[cfg(digital)]
pub(crate) type BoardInputs = crate::digital::SensedInputs<Guarded>;
#[cfg(not(digital))]
pub(crate) type BoardInputs = Guarded;

/// Pins of the inputs.
pub(crate) struct InputPins {
    #[cfg(homing)]
    pub(crate) homing: (Homing1, Homing2, Homing3),
    #[cfg(interlocks)]
    pub(crate) contacts: (Stop, Door, Probe),
    #[cfg(interlocks)]
    pub(crate) limits: (Limit1, Limit2, Limit3),
    #[cfg(digital)]
    pub(crate) spare: crate::digital::InputPins,
}

/// Pulls the pins up that the scene names.
pub(crate) fn build(pins: InputPins) -> BoardInputs {
    #[cfg(homing)]
    let homing = {
        let (first, second, third) = pins.homing;
        trirrr_app::inputs::HomingSwitches(first.pulled_up(), second.pulled_up(), third.pulled_up())
    };
    #[cfg(not(homing))]
    let homing = trirrr_app::inputs::NoInputs;
    #[cfg(interlocks)]
    let inputs = {
        let (stop, door, probe) = pins.contacts;
        let (first, second, third) = pins.limits;
        GuardedInputs {
            homing,
            contacts: (
                StopLine::at(|| stop.pulled_up()),
                DoorLine::at(|| door.pulled_up()),
                ProbeLine::at(|| probe.pulled_up()),
            ),
            limits: LimitSwitches::at(
                || first.pulled_up(),
                || second.pulled_up(),
                || third.pulled_up(),
            ),
        }
    };
    #[cfg(not(interlocks))]
    let inputs = homing;
    #[cfg(digital)]
    let inputs = crate::digital::inputs(inputs, pins.spare);
    #[cfg(not(any(homing, interlocks, digital)))]
    let _ = pins;
    inputs
}
