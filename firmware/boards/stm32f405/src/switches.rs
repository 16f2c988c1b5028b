//! Inputs of homing: PB13, PB14, PB15 for motors 1, 2, 3, pulled up. An image without homing
//! leaves the pins alone.

use stm32f4xx_hal::gpio::gpiob::{PB13, PB14, PB15};

#[cfg(homing)]
pub(super) use inputs::Switches;

#[cfg(not(homing))]
pub(super) use trirrr_app::inputs::NoInputs as Switches;

#[cfg(not(homing))]
pub(super) fn build(_: PB13, _: PB14, _: PB15) -> Switches {
    Switches
}

#[cfg(homing)]
pub(super) fn build(first: PB13, second: PB14, third: PB15) -> Switches {
    Switches::new([
        first.into_pull_up_input().into(),
        second.into_pull_up_input().into(),
        third.into_pull_up_input().into(),
    ])
}

#[cfg(homing)]
mod inputs {
    use crate::pins::InputB;
    use trirrr_app::inputs::{Closed, Inputs};
    use trirrr_app::scene::{HOMING_ACTIVE_HIGH, Scalar};
    use trirrr_core::tick::Motor;

    /// Switch or stall output of each motor.
    pub(crate) struct Switches([InputB; 3]);

    impl Switches {
        pub(crate) fn new(pins: [InputB; 3]) -> Self {
            Self(pins)
        }
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
