//! From the machine to the tick: homing switches, or drives that report a stall.

use crate::scene::Scalar;
use crate::service::ImageScene;
use trirrr_core::number::Arithmetic;
use trirrr_core::tick::Motor;
use trirrr_service::{Homing, Scene};

/// Joint angle in the scene's number type.
pub type Angle = <Scalar as Arithmetic>::Angle;

/// One flag for each motor, set while the switch is closed or the drive stalls; `()` without homing.
pub type Closed = <<ImageScene as Scene>::Homing as Homing<Scalar>>::Inputs;

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

// Inputs of this image: those of the board, and around them the wrapper of a test image.
#[cfg(all(feature = "fault-injection", not(feature = "ruled-switches")))]
pub(crate) use crate::fault_injection::{FaultInjection as Wired, wire};
#[cfg(feature = "ruled-switches")]
pub(crate) use crate::ruled_switches::{RuledInputs as Wired, wire};
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
