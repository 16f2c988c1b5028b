//! Homing switches that close by rule, for tests in an emulator, which has none. Only images of a scene with
//! homing that are built with the feature `ruled-switches` hold them.

use crate::inputs::{Angle, Closed, Inputs, Interlocked};
use crate::scene::{HOMING, Scalar};
use core::hint::black_box;
use trirrr_core::tick::Motor;
use trirrr_image::RuledSwitches;
use trirrr_protocol::message::Board;

/// Switches of the scene that are ruled, in the place of those of the board.
pub(crate) struct RuledInputs(RuledSwitches<'static, Scalar>);

impl RuledInputs {
    pub(crate) fn new(_: &Board) -> Self {
        Self(RuledSwitches::new(&HOMING))
    }

    pub(crate) fn read(&mut self, inputs: &mut impl Inputs, motors: &[Motor<Scalar>; 3]) -> Closed {
        // The pins of an emulator say nothing. They are read all the same, for the tick's length.
        black_box(inputs.read(motors));
        self.0.closed(motors)
    }

    pub(crate) fn interlocks(&mut self, read: Interlocked) -> Interlocked {
        read
    }

    pub(crate) fn shift(&mut self, by: [Angle; 3]) {
        self.0.shift(by);
    }
}
