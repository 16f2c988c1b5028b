//! Inputs of the tick: switches of homing, emergency stop, door, probe and limit switches, and spare inputs, all pulled up. An image leaves the pins
//! alone whose inputs its scene does not name.

use crate::board::InputPins;
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

/// Pulls the pins up that the scene names.
pub(crate) fn build(pins: InputPins) -> BoardInputs {
    #[cfg(homing)]
    let homing = {
        trirrr_app::inputs::HomingSwitches(
            pins.homing_1.pulled_up(),
            pins.homing_2.pulled_up(),
            pins.homing_3.pulled_up(),
        )
    };
    #[cfg(not(homing))]
    let homing = trirrr_app::inputs::NoInputs;
    #[cfg(interlocks)]
    let inputs = GuardedInputs {
        homing,
        contacts: (
            StopLine::at(|| pins.stop.pulled_up()),
            DoorLine::at(|| pins.door.pulled_up()),
            ProbeLine::at(|| pins.probe.pulled_up()),
        ),
        limits: LimitSwitches::at(
            || pins.limit_1.pulled_up(),
            || pins.limit_2.pulled_up(),
            || pins.limit_3.pulled_up(),
        ),
    };
    #[cfg(not(interlocks))]
    let inputs = homing;
    #[cfg(digital)]
    let inputs = crate::digital::inputs(
        inputs,
        (
            pins.input_1,
            pins.input_2,
            pins.input_3,
            pins.input_4,
            pins.input_5,
            pins.input_6,
            pins.input_7,
            pins.input_8,
        ),
    );
    #[cfg(not(any(homing, interlocks, digital)))]
    let InputPins {} = pins;
    inputs
}
