//! A scene of a machine that plays power lists.

use super::Scene;
use crate::contact::ContactCoefficients;
use crate::feedback::FeedbackCoefficients;
use crate::homing::Plan;
use crate::levels::LevelRing;
use crate::number::ServiceNumber;

/// Scene `S` of a machine that plays power lists, with memory for `BYTES` levels: a power of two, at most 32,768.
#[derive(Clone, Copy, Debug)]
pub struct WithLevels<S, const BYTES: usize> {
    /// Everything else of the scene.
    pub scene: S,
    /// Levels for which there is room, at most `BYTES`; 0 of a machine that plays no power lists.
    pub room: u16,
}

impl<N: ServiceNumber, S: Scene<N = N>, const BYTES: usize> Scene for WithLevels<S, BYTES> {
    super::inner_machine!();
    type Levels = LevelRing<N, BYTES>;
    type Homing = S::Homing;
    type Feedback = S::Feedback;
    type Contact = S::Contact;
    type Retreat = S::Retreat;
    type Interlocks = S::Interlocks;

    #[inline(always)]
    fn levels(&self) -> u16 {
        (BYTES as u16).min(self.room)
    }

    fn homing(&self) -> S::Homing {
        self.scene.homing()
    }

    #[inline(always)]
    fn plan(&self) -> Option<Plan<N>> {
        self.scene.plan()
    }

    #[inline(always)]
    fn interlocks(&self) -> S::Interlocks {
        self.scene.interlocks()
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
