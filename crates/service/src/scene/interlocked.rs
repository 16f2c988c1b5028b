//! A scene of a machine with an emergency stop, a door, limit switches or a probe.

use super::Scene;
use crate::contact::ContactCoefficients;
use crate::feedback::FeedbackCoefficients;
use crate::homing::Plan;
use crate::interlock::{InterlockParameters, Interlocks, ProbeMemory};
use crate::number::ServiceNumber;
use core::marker::PhantomData;

/// Scene `S` of a machine with the inputs `INPUTS` of [`input_bits`](crate::input_bits), and with a probe `P`: a
/// [`ProbeLatch`](crate::ProbeLatch), or `()`.
#[derive(Clone, Copy, Debug)]
pub struct WithInterlocks<S, const INPUTS: u8, P> {
    /// Everything else of the scene.
    pub scene: S,
    /// Inputs that the scene names. Those without their parameter count for nothing.
    pub parameters: InterlockParameters,
    /// Kind of the probe.
    pub probe: PhantomData<P>,
}

impl<N: ServiceNumber, S: Scene<N = N>, const INPUTS: u8, P: ProbeMemory<N>> Scene
    for WithInterlocks<S, INPUTS, P>
{
    super::inner_scene!();
    type Homing = S::Homing;
    type Feedback = S::Feedback;
    type Contact = S::Contact;
    type Retreat = S::Retreat;
    type Interlocks = Interlocks<N, INPUTS, P>;

    fn homing(&self) -> S::Homing {
        self.scene.homing()
    }

    #[inline(always)]
    fn plan(&self) -> Option<Plan<N>> {
        self.scene.plan()
    }

    fn interlocks(&self) -> Interlocks<N, INPUTS, P> {
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
