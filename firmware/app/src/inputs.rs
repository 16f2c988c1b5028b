//! From the machine to the tick: homing switches, or drives that report a stall.

use crate::scene::Scalar;
use trirrr_core::number::Arithmetic;
use trirrr_core::tick::Motor;

/// Joint angle in the scene's number type.
pub(crate) type Angle = <Scalar as Arithmetic>::Angle;

/// One flag for each motor, set while the switch is closed or the drive stalls.
#[cfg(homing)]
pub type Closed = [bool; 3];

/// Nothing: the scene has no homing.
#[cfg(not(homing))]
pub type Closed = ();

/// Source of a tick's inputs.
pub trait Inputs {
    /// Reads all inputs. `motors` were commanded in the tick before: pins ignore them, simulated switches
    /// close by them.
    fn read(&mut self, motors: &[Motor<Scalar>; 3]) -> Closed;

    /// Follows a new zero of the joint angles: all are greater `by` so much from now on, without a motion.
    /// Only simulated switches have to know.
    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        let _ = by;
    }
}

/// Inputs of a scene without homing.
#[cfg(not(homing))]
pub struct NoInputs;

#[cfg(not(homing))]
impl Inputs for NoInputs {
    #[inline(always)]
    fn read(&mut self, _: &[Motor<Scalar>; 3]) -> Closed {}
}

/// Inputs of this image: those of the board, and around them the wrappers of a test image.
#[cfg(not(any(feature = "fault-injection", feature = "ruled-switches")))]
mod image {
    use trirrr_protocol::message::Board;

    pub(crate) type Wired<I> = I;

    #[inline(always)]
    pub(crate) fn wire<I>(inputs: I, _: &Board) -> Wired<I> {
        inputs
    }
}

#[cfg(all(feature = "fault-injection", not(feature = "ruled-switches")))]
mod image {
    use crate::fault_injection::FaultInjection;
    use trirrr_protocol::message::Board;

    pub(crate) type Wired<I> = FaultInjection<I>;

    pub(crate) fn wire<I>(inputs: I, board: &Board) -> Wired<I> {
        FaultInjection::new(inputs, board)
    }
}

#[cfg(feature = "ruled-switches")]
mod image {
    use crate::ruled_switches::RuledInputs;
    use trirrr_protocol::message::Board;

    pub(crate) type Wired<I> = RuledInputs<I>;

    pub(crate) fn wire<I>(inputs: I, _: &Board) -> Wired<I> {
        RuledInputs::new(inputs)
    }
}

pub(crate) use image::{Wired, wire};
