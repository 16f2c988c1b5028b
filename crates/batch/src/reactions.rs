//! Forces in the nine joints, of slices of states.

use crate::lanes::Float;
use crate::states::{FailedRow, LengthError, StateRows, check_length, each_row};
use trirrr_core::machine::{BuildError, Parameters};
use trirrr_core::model::{Model, ModelKind, ModelVisitor, OfKind};
use trirrr_core::reaction::Reactions;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_core::tick::Tick;

/// Forces in the joints of one state, N: leg, joint A, B or C, x or y in the fixed frame. Each acts on the outer of the two bodies.
pub type ReactionRow<F> = [[[F; 2]; 3]; 3];

/// A machine whose joint forces are found for slices of states, without friction.
pub struct BatchReactions<F> {
    ticks: Box<dyn ReactionTick<F>>,
}

/// Tick of one model, and the forces in its joints.
trait ReactionTick<F>: Send + Sync {
    fn forces(&self, setpoint: &Setpoint<F>) -> Result<ReactionRow<F>, Status>
    where
        F: Float;
}

impl<F: Float> BatchReactions<F> {
    /// Builds the leanest model of the machine that has torques.
    ///
    /// # Errors
    /// First quantity of the parameters that is refused.
    pub fn build(parameters: &Parameters) -> Result<Self, BuildError> {
        let kind = ModelKind::of(parameters, true);
        let ticks = kind.visit(BuildReactions {
            machine: kind.with(parameters),
        })?;
        Ok(Self { ticks })
    }

    /// Evaluates every state on all threads of rayon's current pool. Returns the rows without results, in their order.
    ///
    /// # Errors
    /// [`LengthError`]: nothing is evaluated.
    pub fn evaluate(
        &self,
        states: StateRows<'_, F>,
        results: &mut [ReactionRow<F>],
    ) -> Result<Vec<FailedRow>, LengthError> {
        check_length("forces of the results", results.len(), states.rows()?)?;
        Ok(each_row(results, |row| self.ticks.forces(&states.one(row))))
    }
}

struct BuildReactions<'a> {
    machine: OfKind<'a>,
}

impl<F: Float> ModelVisitor<F> for BuildReactions<'_> {
    type Output = Result<Box<dyn ReactionTick<F>>, BuildError>;

    fn visit<M: Model<N = F>>(self) -> Self::Output {
        Ok(Box::new(ModelReactions::<M> {
            tick: Tick::build(self.machine)?,
            reactions: Reactions::build(self.machine.parameters),
        }))
    }
}

struct ModelReactions<M: Model> {
    tick: Tick<M>,
    reactions: Reactions<M::N>,
}

impl<F: Float, M: Model<N = F>> ReactionTick<F> for ModelReactions<M> {
    fn forces(&self, setpoint: &Setpoint<F>) -> Result<ReactionRow<F>, Status> {
        let motion = self.tick.evaluate(setpoint)?;
        let legs = self.reactions.forces(&motion)?;
        Ok(legs.map(|leg| [leg.base, leg.elbow, leg.platform].map(Into::into)))
    }
}
