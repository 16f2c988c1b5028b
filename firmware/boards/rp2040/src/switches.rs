//! Inputs of homing for motors 1, 2, 3, pulled up. An image without homing leaves the pins alone.

#[cfg(homing)]
pub(super) use inputs::{Switches, build};

#[cfg(not(homing))]
pub(super) use trirrr_app::inputs::NoInputs as Switches;

#[cfg(homing)]
mod inputs {
    use crate::board::{Homing1, Homing2, Homing3};
    use crate::pins::BoardPin;
    use embedded_hal::digital::InputPin;
    use trirrr_app::inputs::{Closed, Inputs};
    use trirrr_app::scene::{HOMING_ACTIVE_HIGH, Scalar};
    use trirrr_core::tick::Motor;

    type PulledUp<P> = <P as BoardPin>::Input;

    /// Switch or stall output of each motor.
    pub(crate) struct Switches(PulledUp<Homing1>, PulledUp<Homing2>, PulledUp<Homing3>);

    /// Pulls the pins up.
    pub(crate) fn build(first: Homing1, second: Homing2, third: Homing3) -> Switches {
        Switches(first.input(), second.input(), third.input())
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
