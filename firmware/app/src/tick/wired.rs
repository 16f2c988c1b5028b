//! Inputs of this image: those of the board, and around them the wrapper of a test image.

#[cfg(all(feature = "fault-injection", not(feature = "ruled-switches")))]
pub(crate) use super::fault_injection::{FaultInjection as Wired, wire};
#[cfg(feature = "ruled-switches")]
pub(crate) use super::ruled_switches::{RuledInputs as Wired, wire};
#[cfg(not(any(feature = "fault-injection", feature = "ruled-switches")))]
pub(crate) use bare::{Wired, wire};

#[cfg(not(any(feature = "fault-injection", feature = "ruled-switches")))]
mod bare {
    use trirrr_protocol::message::Board;

    pub(crate) type Wired<I> = I;

    #[inline(always)]
    pub(crate) fn wire<I>(inputs: I, _: &Board) -> Wired<I> {
        inputs
    }
}
