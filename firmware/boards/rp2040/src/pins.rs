//! Pins as the functions of a board take them: as they are, or inverted by the wiring, which the pin itself takes back.

// An image uses those of its scene's functions.
#![allow(dead_code)]

use core::convert::Infallible;
use embedded_hal::digital::{InputPin, OutputPin, PinState};
use rp2040_hal::gpio::{
    DynPinId, FunctionNull, FunctionSioInput, FunctionSioOutput, InputOverride, OutputOverride,
    Pin, PinId, PullDown, PullUp, ValidFunction,
};
use rp2040_hal::gpio::{FunctionSio, SioInput, SioOutput};
use rp2040_hal::pac::{UART0, UART1};
use trirrr_app::pins::NoPin;

/// Serial ports of the chip, of which [`Pins`](crate::board::Pins) takes those of the board file.
pub(crate) struct Ports {
    pub(crate) uart0: UART0,
    pub(crate) uart1: UART1,
}

/// Output of any pin, for arrays.
pub(crate) type AnyOutput = Pin<DynPinId, FunctionSioOutput, PullDown>;

/// Pin of a board file.
pub(crate) trait BoardPin {
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

    /// Makes the pin an input that a function reads as high while nothing is connected.
    fn input(self) -> Self::Input;
}

impl<I: PinId> BoardPin for Pin<I, FunctionNull, PullDown>
where
    I: ValidFunction<FunctionSio<SioOutput>> + ValidFunction<FunctionSio<SioInput>>,
{
    const INVERTED: bool = false;
    type Plain = Self;
    type Output = Pin<I, FunctionSioOutput, PullDown>;
    type Input = Pin<I, FunctionSioInput, PullUp>;

    fn plain(self) -> Self {
        self
    }

    fn output(self, high: bool) -> Self::Output {
        self.into_push_pull_output_in_state(PinState::from(high))
    }

    fn input(self) -> Self::Input {
        self.into_pull_up_input()
    }
}

/// Makes the pin an input that a function reads as high while nothing is connected.
pub(crate) fn pulled_up<P: BoardPin>(pin: P) -> P::Input {
    pin.input()
}

/// Pin behind which the wiring inverts the level.
pub(crate) struct Inverted<P>(pub(crate) P);

impl<I: PinId> BoardPin for Inverted<Pin<I, FunctionNull, PullDown>>
where
    I: ValidFunction<FunctionSio<SioOutput>> + ValidFunction<FunctionSio<SioInput>>,
{
    const INVERTED: bool = true;
    type Plain = Pin<I, FunctionNull, PullDown>;
    type Output = Pin<I, FunctionSioOutput, PullDown>;
    type Input = Pin<I, FunctionSioInput, PullDown>;

    fn plain(self) -> Self::Plain {
        self.0
    }

    fn output(mut self, high: bool) -> Self::Output {
        // Before the pin is an output. What is written to it is then the level of the function.
        self.0.set_output_override(OutputOverride::Invert);
        self.0.into_push_pull_output_in_state(PinState::from(high))
    }

    fn input(mut self) -> Self::Input {
        self.0.set_input_override(InputOverride::Invert);
        self.0.into_pull_down_input()
    }
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

    fn input(self) -> Self {
        self
    }
}
