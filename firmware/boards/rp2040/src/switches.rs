//! Inputs of homing: GP13, GP14, GP15 for motors 1, 2, 3, pulled up. An image without homing
//! leaves the pins alone.

use rp2040_hal::gpio::bank0::{Gpio13, Gpio14, Gpio15};
use rp2040_hal::gpio::{FunctionNull, Pin, PullDown};

#[cfg(homing)]
pub(super) use pins::Switches;

#[cfg(not(homing))]
pub(super) use trirrr_app::inputs::NoInputs as Switches;

type Unused<P> = Pin<P, FunctionNull, PullDown>;

#[cfg(not(homing))]
pub(super) fn build(_: Unused<Gpio13>, _: Unused<Gpio14>, _: Unused<Gpio15>) -> Switches {
    Switches
}

#[cfg(homing)]
pub(super) fn build(
    first: Unused<Gpio13>,
    second: Unused<Gpio14>,
    third: Unused<Gpio15>,
) -> Switches {
    Switches::new(
        first.into_pull_up_input(),
        second.into_pull_up_input(),
        third.into_pull_up_input(),
    )
}

#[cfg(homing)]
mod pins {
    use super::{Gpio13, Gpio14, Gpio15, Pin};
    use embedded_hal::digital::InputPin;
    use rp2040_hal::gpio::{FunctionSioInput, PullUp};
    use trirrr_app::inputs::{Closed, Inputs};
    use trirrr_app::scene::{HOMING_ACTIVE_HIGH, Scalar};
    use trirrr_core::tick::Motor;

    type PulledUp<P> = Pin<P, FunctionSioInput, PullUp>;

    /// Switch or stall output of each motor.
    pub(crate) struct Switches(PulledUp<Gpio13>, PulledUp<Gpio14>, PulledUp<Gpio15>);

    impl Switches {
        pub(crate) fn new(
            first: PulledUp<Gpio13>,
            second: PulledUp<Gpio14>,
            third: PulledUp<Gpio15>,
        ) -> Self {
            Self(first, second, third)
        }
    }

    impl Inputs for Switches {
        #[inline(always)]
        fn read(&mut self, _: &[Motor<Scalar>; 3]) -> Closed {
            let Self(first, second, third) = self;
            [first.is_high(), second.is_high(), third.is_high()]
                .map(|Ok(high)| high == HOMING_ACTIVE_HIGH)
        }
    }
}
