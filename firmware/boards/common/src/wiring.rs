//! Pins as the functions of a scene take them, on every board.
use core::convert::Infallible;
use embedded_hal::digital::{InputPin, OutputPin};
use trirrr_app::pins::NoPin;

/// Pin of a board file. What inverts its level is the wiring, which the pin takes back.
pub trait BoardPin {
    /// The wiring inverts the level.
    const INVERTED: bool;
    /// The pin itself, for a peripheral.
    type Plain;
    /// The pin as an output.
    type Output: OutputPin<Error = Infallible>;
    /// The pin as an input.
    type Input: InputPin<Error = Infallible>;

    /// Hands out the pin itself.
    fn plain(self) -> Self::Plain;

    /// Makes the pin an output, with this level from the beginning.
    fn output(self, high: bool) -> Self::Output;

    /// Makes the pin an input that reads as high while nothing is connected.
    fn pulled_up(self) -> Self::Input;
}

impl BoardPin for NoPin {
    const INVERTED: bool = false;
    type Plain = Self;
    type Output = Self;
    type Input = Self;

    fn plain(self) -> Self {
        self
    }

    fn output(self, _: bool) -> Self {
        self
    }

    fn pulled_up(self) -> Self {
        self
    }
}
