//! A scene of a machine with an emergency stop or a door.

use super::Scene;
use crate::contact::ContactCoefficients;
use crate::feedback::FeedbackCoefficients;
use crate::homing::Plan;
use crate::interlock::{InterlockParameters, Interlocks};
use crate::number::ServiceNumber;

/// Scene `S` of a machine with an emergency stop (`STOP`), a door (`DOOR`), or both.
#[derive(Clone, Copy, Debug)]
pub struct WithInterlocks<S, const STOP: bool, const DOOR: bool> {
    /// Everything else of the scene.
    pub scene: S,
    /// Inputs that the scene names. Those without their parameter count for nothing.
    pub parameters: InterlockParameters,
}

impl<N: ServiceNumber, S: Scene<N = N>, const STOP: bool, const DOOR: bool> Scene
    for WithInterlocks<S, STOP, DOOR>
{
    super::inner_scene!();
    type Homing = S::Homing;
    type Feedback = S::Feedback;
    type Contact = S::Contact;
    type Retreat = S::Retreat;
    type Interlocks = Interlocks<STOP, DOOR>;

    fn homing(&self) -> S::Homing {
        self.scene.homing()
    }

    #[inline(always)]
    fn plan(&self) -> Option<Plan<N>> {
        self.scene.plan()
    }

    fn interlocks(&self) -> Interlocks<STOP, DOOR> {
        Interlocks::new(&self.parameters)
    }

    #[inline(always)]
    fn feedback(&self) -> Option<&FeedbackCoefficients<N>> {
        self.scene.feedback()
    }

    #[inline(always)]
    fn contact(&self) -> Option<&ContactCoefficients<N>> {
        self.scene.contact()
    }
}
