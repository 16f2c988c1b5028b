//! Inputs of homing for motors 1, 2, 3, pulled up. An image without homing leaves the pins alone.

#[cfg(homing)]
pub(super) use inputs::{Switches, build};

#[cfg(not(homing))]
pub(super) use trirrr_app::inputs::NoInputs as Switches;

#[cfg(homing)]
mod inputs {
    use crate::board::{Homing1, Homing2, Homing3, HomingInput};
    use crate::gpio::Pull;
    use crate::pins::BoardPin;
    use trirrr_app::inputs::{Closed, Inputs};
    use trirrr_app::scene::{HOMING_ACTIVE_HIGH, Scalar};
    use trirrr_core::tick::Motor;

    /// Switch or stall output of each motor.
    pub(crate) struct Switches([HomingInput; 3]);

    /// Pulls the pins up.
    // An inverted pin has the type of the array already.
    #[allow(clippy::useless_conversion)]
    pub(crate) fn build(first: Homing1, second: Homing2, third: Homing3) -> Switches {
        Switches([
            first.input(Pull::Up).into(),
            second.input(Pull::Up).into(),
            third.input(Pull::Up).into(),
        ])
    }

    impl Inputs for Switches {
        #[inline(always)]
        fn read(&mut self, _: &[Motor<Scalar>; 3]) -> Closed {
            self.0
                .each_ref()
                .map(|pin| pin.is_high() == HOMING_ACTIVE_HIGH)
        }
    }
}
