//! Homing switches that close by rule, for tests in an emulator, which has none. Only images of a scene with
//! homing that are built with the feature `ruled-switches` hold them.

use crate::inputs::{Angle, Closed, Inputs, Interlocked};
use crate::scene::{HOMING, Scalar};
use core::hint::black_box;
use trirrr_core::tick::Motor;
use trirrr_image::RuledSwitches;
use trirrr_protocol::message::Board;

/// Inputs `I` of a board, read and then replaced by the ruled switches of the scene.
pub(crate) struct RuledInputs<I> {
    inputs: I,
    switches: RuledSwitches<'static, Scalar>,
}

/// Wraps the inputs of a board.
pub(crate) fn wire<I>(inputs: I, _: &Board) -> RuledInputs<I> {
    RuledInputs {
        inputs,
        switches: RuledSwitches::new(&HOMING),
    }
}

impl<I: Inputs> Inputs for RuledInputs<I> {
    fn read(&mut self, motors: &[Motor<Scalar>; 3]) -> Closed {
        // The pins of an emulator say nothing. They are read all the same, for the tick's length.
        black_box(self.inputs.read(motors));
        self.switches.closed(motors)
    }

    fn interlocks(&mut self) -> Interlocked {
        self.inputs.interlocks()
    }

    fn digital(&mut self) -> u8 {
        self.inputs.digital()
    }

    fn shift(&mut self, by: [Angle; 3]) {
        self.switches.shift(by);
    }
}
