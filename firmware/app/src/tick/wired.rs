//! Inputs of this image: those of the board, and what a test image makes of them.

#[cfg(all(feature = "fault-injection", not(feature = "ruled-switches")))]
pub(crate) use super::fault_injection::FaultInjection as Wired;
#[cfg(feature = "ruled-switches")]
pub(crate) use super::ruled_switches::RuledInputs as Wired;
#[cfg(not(any(feature = "fault-injection", feature = "ruled-switches")))]
pub(crate) use bare::Wired;

#[cfg(not(any(feature = "fault-injection", feature = "ruled-switches")))]
mod bare {
    use crate::inputs::{Angle, Closed, Inputs, Interlocked};
    use crate::scene::Scalar;
    use trirrr_core::tick::Motor;
    use trirrr_protocol::message::Board;

    /// The inputs as they are.
    pub(crate) struct Wired;

    impl Wired {
        #[inline(always)]
        pub(crate) fn new(_: &Board) -> Self {
            Self
        }

        #[inline(always)]
        pub(crate) fn read(
            &mut self,
            inputs: &mut impl Inputs,
            motors: &[Motor<Scalar>; 3],
        ) -> Closed {
            inputs.read(motors)
        }

        #[inline(always)]
        pub(crate) fn interlocks(&mut self, read: Interlocked) -> Interlocked {
            read
        }

        #[inline(always)]
        pub(crate) fn shift(&mut self, _: [Angle; 3]) {}
    }
}
