//! Spare outputs and inputs at pins.

use crate::inputs::{Angle, Closed, Inputs, Interlocked};
use crate::outputs::OutputPart;
use crate::scene::{INPUTS_ACTIVE_HIGH, INPUTS_NAMED, Scalar};
use core::convert::Infallible;
use embedded_hal::digital::{InputPin, OutputPin};
use trirrr_core::tick::Motor;

/// Eight output pins. Those that the scene does not name are [`NoPin`](crate::pins::NoPin).
pub trait OutputBits {
    /// Sets the pins of `changed` to the levels in `bits`.
    fn put(&mut self, changed: u8, bits: u8);
}

/// Eight input pins, of which the scene may name fewer.
pub trait InputBits {
    /// Returns the levels, a bit for each pin, set while it is high.
    fn levels(&mut self) -> u8;
}

macro_rules! for_pins {
    ($($pin:ident $index:tt),*) => {
        impl<$($pin: OutputPin<Error = Infallible>),*> OutputBits for ($($pin,)*) {
            #[inline(always)]
            fn put(&mut self, changed: u8, bits: u8) {
                $(
                    if changed >> $index & 1 != 0 {
                        // A pin of the chip itself does not fail.
                        let Ok(()) = match bits >> $index & 1 {
                            0 => self.$index.set_low(),
                            _ => self.$index.set_high(),
                        };
                    }
                )*
            }
        }

        impl<$($pin: InputPin<Error = Infallible>),*> InputBits for ($($pin,)*) {
            #[inline(always)]
            fn levels(&mut self) -> u8 {
                let mut bits = 0;
                $(
                    let Ok(is_high) = self.$index.is_high();
                    bits |= u8::from(is_high) << $index;
                )*
                bits
            }
        }
    };
}

for_pins!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7);

/// Spare outputs at the pins `P`, which are high while they are on.
pub struct SpareOutputs<P> {
    pins: P,
    on: u8,
}

impl<P> SpareOutputs<P> {
    /// Takes pins that are low.
    pub fn new(pins: P) -> Self {
        Self { pins, on: 0 }
    }
}

impl<P: OutputBits> OutputPart for SpareOutputs<P> {
    #[inline]
    fn switch(&mut self, outputs: u8) {
        let changed = self.on ^ outputs;
        if changed != 0 {
            self.on = outputs;
            self.pins.put(changed, outputs);
        }
    }
}

/// Inputs beside spare ones at the pins `P`.
pub struct WithSpareInputs<I, P> {
    inputs: I,
    pins: P,
}

impl<I: Inputs, P: InputBits> WithSpareInputs<I, P> {
    /// Joins the inputs with spare ones.
    pub fn new(inputs: I, pins: P) -> Self {
        Self { inputs, pins }
    }
}

impl<I: Inputs, P: InputBits> Inputs for WithSpareInputs<I, P> {
    #[inline(always)]
    fn read(&mut self, motors: &[Motor<Scalar>; 3]) -> Closed {
        self.inputs.read(motors)
    }

    #[inline(always)]
    fn interlocks(&mut self) -> Interlocked {
        self.inputs.interlocks()
    }

    #[inline(always)]
    fn digital(&mut self) -> u8 {
        (self.pins.levels() ^ !INPUTS_ACTIVE_HIGH) & INPUTS_NAMED
    }

    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        self.inputs.shift(by);
    }
}
