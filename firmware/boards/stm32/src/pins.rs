//! Pins as the functions of a board take them: as they are, inverted by the wiring, or one of several alike.
//!
//! Drives and switches come in arrays, so a pin of any number has one type. It is its bit: a number would be checked at each use, and
//! the tick must not be able to panic.
// An image uses those of its scene's functions.
#![allow(dead_code)]

use crate::gpio::{InputMode, OutputMode, Pin, PortRegisters, Pull};
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use trirrr_boards::BoardPin;

/// Pin of an STM32, which pulls an input either way.
pub(crate) trait PulledPin: BoardPin {
    /// Makes the pin an input. What is pulled is the level that a function reads while nothing is connected.
    fn input(self, pull: Pull) -> Self::Input;
}

impl<const P: char, const N: u8> BoardPin for Pin<P, N> {
    const INVERTED: bool = false;
    type Plain = Self;
    type Output = Pin<P, N, OutputMode>;
    type Input = Pin<P, N, InputMode>;

    fn plain(self) -> Self {
        self
    }

    fn output(self, high: bool) -> Self::Output {
        self.into_push_pull_output_in_state(high.into())
    }

    fn pulled_up(self) -> Self::Input {
        self.input(Pull::Up)
    }
}

impl<const P: char, const N: u8> PulledPin for Pin<P, N> {
    fn input(self, pull: Pull) -> Self::Input {
        self.into_input().internal_resistor(pull)
    }
}

/// Pin behind which the wiring inverts the level.
pub(crate) struct Inverted<P>(pub(crate) P);

impl<const P: char, const N: u8> BoardPin for Inverted<Pin<P, N>> {
    const INVERTED: bool = true;
    type Plain = Pin<P, N>;
    type Output = AnyOutput;
    type Input = AnyInput;

    fn plain(self) -> Self::Plain {
        self.0
    }

    fn output(self, high: bool) -> AnyOutput {
        let AnyOutput { port, high, low } = AnyOutput::from(self.0.output(!high));
        AnyOutput {
            port,
            high: low,
            low: high,
        }
    }

    fn pulled_up(self) -> AnyInput {
        self.input(Pull::Up)
    }
}

impl<const P: char, const N: u8> PulledPin for Inverted<Pin<P, N>> {
    fn input(self, pull: Pull) -> AnyInput {
        let pull = match pull {
            Pull::Up => Pull::Down,
            Pull::Down => Pull::Up,
            Pull::None => Pull::None,
        };
        AnyInput {
            inverted: true,
            ..self.0.input(pull).into()
        }
    }
}

/// Output of port `P`.
pub(crate) struct PortOutput<const P: char>(u16);

impl<const P: char, const N: u8> From<Pin<P, N, OutputMode>> for PortOutput<P> {
    fn from(_: Pin<P, N, OutputMode>) -> Self {
        Self(const { 1 << N })
    }
}

impl<const P: char> PortOutput<P> {
    /// Writes BSRR: ones of the lower half set pins, ones of the upper half clear pins.
    #[inline(always)]
    fn write(&mut self, bits: u32) {
        const { PortRegisters::of::<P>() }.write(bits);
    }
}

impl<const P: char> ErrorType for PortOutput<P> {
    type Error = Infallible;
}

impl<const P: char> OutputPin for PortOutput<P> {
    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.write(u32::from(self.0) << 16);
        Ok(())
    }

    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.write(self.0.into());
        Ok(())
    }
}

/// Output of any port, of either level.
pub(crate) struct AnyOutput {
    port: PortRegisters,
    /// Bits of BSRR for the level that a function calls high,
    high: u32,
    /// and for the one that it calls low.
    low: u32,
}

impl<const P: char, const N: u8> From<Pin<P, N, OutputMode>> for AnyOutput {
    fn from(_: Pin<P, N, OutputMode>) -> Self {
        Self {
            port: const { PortRegisters::of::<P>() },
            high: const { 1 << N },
            low: const { 1 << (N + 16) },
        }
    }
}

impl AnyOutput {
    #[inline(always)]
    fn write(&mut self, bits: u32) {
        self.port.write(bits);
    }
}

impl ErrorType for AnyOutput {
    type Error = Infallible;
}

impl OutputPin for AnyOutput {
    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.write(self.low);
        Ok(())
    }

    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.write(self.high);
        Ok(())
    }
}

/// Input of port `P`.
pub(crate) struct PortInput<const P: char>(u16);

impl<const P: char, const N: u8> From<Pin<P, N, InputMode>> for PortInput<P> {
    fn from(_: Pin<P, N, InputMode>) -> Self {
        Self(const { 1 << N })
    }
}

impl<const P: char> PortInput<P> {
    #[inline(always)]
    pub(crate) fn is_high(&self) -> bool {
        const { PortRegisters::of::<P>() }.levels() & u32::from(self.0) != 0
    }
}

/// Input of any port, of either level.
pub(crate) struct AnyInput {
    port: PortRegisters,
    bit: u16,
    inverted: bool,
}

impl<const P: char, const N: u8> From<Pin<P, N, InputMode>> for AnyInput {
    fn from(_: Pin<P, N, InputMode>) -> Self {
        Self {
            port: const { PortRegisters::of::<P>() },
            bit: const { 1 << N },
            inverted: false,
        }
    }
}

impl AnyInput {
    #[inline(always)]
    pub(crate) fn is_high(&self) -> bool {
        (self.port.levels() & u32::from(self.bit) != 0) != self.inverted
    }
}

impl ErrorType for AnyInput {
    type Error = Infallible;
}

impl InputPin for AnyInput {
    #[inline(always)]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(AnyInput::is_high(self))
    }

    #[inline(always)]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!AnyInput::is_high(self))
    }
}
