//! Values of a scene.

use super::{Adjustable, Compiled, Machine, Scene};
use crate::contact::ContactCoefficients;
use crate::digital::DigitalParameters;
use crate::feedback::FeedbackCoefficients;
use crate::homing::HomingCoefficients;
use crate::interlock::InterlockParameters;

/// Values of a scene of the kind `S`. Those of features that the kind lacks are not looked at.
pub struct SceneParts<'p, S: Scene> {
    /// Machine.
    pub machine: S::Machine,
    /// Place of a new image of the program.
    pub update: S::Update,
    /// Levels of power for which there is room; 0 of a machine that plays no power lists.
    pub levels: u16,
    /// Homing in the units of the machine. `None` for a machine that knows the angles of its motors.
    pub homing: Option<&'p HomingCoefficients<S::N>>,
    /// Feedback in the units of the machine. `None` for drives that tell nothing.
    pub feedback: Option<&'p FeedbackCoefficients<S::N>>,
    /// Contact detection in SI units. `None` for a machine that detects no contacts.
    pub contact: Option<&'p ContactCoefficients<S::N>>,
    /// Emergency stop, door, limit switches and probe. Those without their parameter count for nothing.
    pub interlocks: InterlockParameters,
    /// Spare inputs and outputs; none of a machine without any.
    pub digital: DigitalParameters,
}

impl<S: Scene<Update: Default>> SceneParts<'_, S> {
    /// Takes a machine, and no values of features.
    pub fn of(machine: S::Machine) -> Self {
        Self {
            machine,
            update: Default::default(),
            levels: 0,
            homing: None,
            feedback: None,
            contact: None,
            interlocks: InterlockParameters::default(),
            digital: DigitalParameters::default(),
        }
    }
}

impl<M, K, P, S> From<Adjustable<M, K, P>> for SceneParts<'_, S>
where
    S: Scene<Machine = Adjustable<M, K, P>, Update: Default>,
    Adjustable<M, K, P>: Machine<N = S::N>,
{
    fn from(machine: Adjustable<M, K, P>) -> Self {
        Self::of(machine)
    }
}

impl<'a, M, K, P, S> From<Compiled<'a, M, K, P>> for SceneParts<'_, S>
where
    M: trirrr_core::model::Model<N: crate::admission::Enclose>,
    S: Scene<Machine = Compiled<'a, M, K, P>, Update: Default>,
    Compiled<'a, M, K, P>: Machine<N = S::N>,
{
    fn from(machine: Compiled<'a, M, K, P>) -> Self {
        Self::of(machine)
    }
}
