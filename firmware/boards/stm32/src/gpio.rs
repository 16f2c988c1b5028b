//! Pins and ports.
// An image uses those of its scene's functions.
#![allow(dead_code)]

use core::convert::Infallible;
use core::marker::PhantomData;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin, PinState};
use stm32_metapac::gpio::Gpio;
use stm32_metapac::gpio::regs::Bsrr;
use stm32_metapac::gpio::vals::{Moder, Ospeedr, Pupdr};
use stm32_metapac::{GPIOA, GPIOB, GPIOC, GPIOD, GPIOE};

pub(crate) use self::ChipPin as Pin;
use crate::chip;

/// Switches the ports of these letters on.
pub(crate) fn switch_on(letters: &[u8]) {
    let bits = letters.iter().map(|letter| 1 << (letter - b'A'));
    chip::switch_ports_on(bits.fold(0, |ports, port| ports | port));
}

/// Registers of a port.
#[derive(Clone, Copy)]
pub(crate) struct PortRegisters(Gpio);

impl PortRegisters {
    /// The port of this letter.
    pub(crate) const fn of<const P: char>() -> Self {
        Self(match P {
            'A' => GPIOA,
            'B' => GPIOB,
            'C' => GPIOC,
            'D' => GPIOD,
            'E' => GPIOE,
            _ => panic!("a pin of another port is refused when the board file is read"),
        })
    }

    /// Writes BSRR: ones of the lower half set pins, ones of the upper half clear pins. Only for pins that the caller owns.
    #[inline(always)]
    pub(crate) fn write(self, bits: u32) {
        self.0.bsrr().write_value(Bsrr(bits));
    }

    /// Levels of all pins.
    #[inline(always)]
    pub(crate) fn levels(self) -> u32 {
        self.0.idr().read().0
    }
}

/// Pull of an input.
#[derive(Clone, Copy)]
pub(crate) enum Pull {
    None,
    Up,
    Down,
}

/// Modes of a pin: as in a reset,
pub(crate) struct AnalogMode;
/// an input,
pub(crate) struct InputMode;
/// an output,
pub(crate) struct OutputMode;
/// or a pin of a peripheral.
pub(crate) struct AlternateMode;

/// Pin of a port that is switched on.
pub(crate) struct ChipPin<const P: char, const N: u8, M = AnalogMode>(PhantomData<M>);

impl<const P: char, const N: u8> ChipPin<P, N> {
    /// The pin: there is one of it, in the struct of a board's pins.
    pub(crate) fn of_its_port() -> Self {
        Self(PhantomData)
    }

    /// Makes the pin an output with this level from the beginning.
    pub(crate) fn into_push_pull_output_in_state(
        self,
        state: PinState,
    ) -> ChipPin<P, N, OutputMode> {
        const { PortRegisters::of::<P>() }.write(match state {
            PinState::High => const { 1 << N },
            PinState::Low => const { 1 << (N + 16) },
        });
        self.into_mode(Moder::OUTPUT)
    }

    /// Makes the pin an input.
    pub(crate) fn into_input(self) -> ChipPin<P, N, InputMode> {
        self.into_mode(Moder::INPUT)
    }

    /// Hands the pin to the peripheral of this alternate function.
    pub(crate) fn into_alternate<const A: u8>(self) -> ChipPin<P, N, AlternateMode> {
        let functions = const { PortRegisters::of::<P>() }
            .0
            .afr(const { N as usize / 8 });
        functions.modify(|w| w.set_afr(const { N as usize % 8 }, A));
        self.into_mode(Moder::ALTERNATE)
    }

    fn into_mode<T>(self, mode: Moder) -> ChipPin<P, N, T> {
        const { PortRegisters::of::<P>() }
            .0
            .moder()
            .modify(|w| w.set_moder(const { N as usize }, mode));
        ChipPin(PhantomData)
    }
}

impl<const P: char, const N: u8, M> ChipPin<P, N, M> {
    /// Sets the pull.
    pub(crate) fn internal_resistor(self, pull: Pull) -> Self {
        let pull = match pull {
            Pull::None => Pupdr::FLOATING,
            Pull::Up => Pupdr::PULL_UP,
            Pull::Down => Pupdr::PULL_DOWN,
        };
        const { PortRegisters::of::<P>() }
            .0
            .pupdr()
            .modify(|w| w.set_pupdr(const { N as usize }, pull));
        self
    }

    /// Lets edges of an output be as steep as can be.
    pub(crate) fn very_fast(self) -> Self {
        const { PortRegisters::of::<P>() }
            .0
            .ospeedr()
            .modify(|w| w.set_ospeedr(const { N as usize }, Ospeedr::VERY_HIGH_SPEED));
        self
    }
}

impl<const P: char, const N: u8, M> ErrorType for ChipPin<P, N, M> {
    type Error = Infallible;
}

impl<const P: char, const N: u8> OutputPin for ChipPin<P, N, OutputMode> {
    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        const { PortRegisters::of::<P>() }.write(const { 1 << (N + 16) });
        Ok(())
    }

    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        const { PortRegisters::of::<P>() }.write(const { 1 << N });
        Ok(())
    }
}

impl<const P: char, const N: u8> InputPin for ChipPin<P, N, InputMode> {
    #[inline(always)]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(const { PortRegisters::of::<P>() }.levels() & const { 1 << N } != 0)
    }

    #[inline(always)]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}
