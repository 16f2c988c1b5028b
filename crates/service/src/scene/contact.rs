//! A scene of a machine that detects contacts.

use super::Scene;
use crate::contact::{ContactCoefficients, ContactMemory};
use crate::number::ServiceNumber;
use crate::retreat::{NoRetreat, RetreatKind};

/// Scene `S` of a machine that detects contacts, and retreats from them as `R` says. `S` has [feedback](super::WithFeedback), and a
/// model with torques.
#[derive(Clone, Copy, Debug)]
pub struct WithContact<'a, S: Scene, R = NoRetreat> {
    /// Everything else of the scene.
    pub scene: S,
    /// Coefficients in SI units. `None` for a machine that detects no contacts.
    pub contact: Option<&'a ContactCoefficients<S::N>>,
    /// [`NoRetreat`], or [`Retreats`](crate::Retreats).
    pub retreat: R,
}

impl<N: ServiceNumber, S: Scene<N = N>, R: RetreatKind> Scene for WithContact<'_, S, R> {
    super::inner!(update, digital, levels, homing, feedback, interlocks);
    type Contact = ContactMemory<N>;
    type Retreat = R;

    #[inline(always)]
    fn contact(&self) -> Option<&ContactCoefficients<N>> {
        self.contact
    }
}
