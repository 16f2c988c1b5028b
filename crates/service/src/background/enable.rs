//! Enable and disable, and the pose of a machine that was just measured.

use super::Background;
use crate::built::Coefficients;
use crate::feature::Optional;
use crate::feedback::{FeedbackReport, PoseSearch};
use crate::guard::LimitBreach;
use crate::handoff::{Order, Recover};
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::states::{Transition, Trigger, next};
use core::borrow::Borrow;
use trirrr_core::setpoint::{JointMove, Pose};
use trirrr_protocol::message::{NotEnabled, Refusal, State};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    pub(super) fn enable(&mut self) -> Result<(), Refusal<N>> {
        let state = self.leads(Trigger::Enable)?;
        // An acknowledgement on its way is not taken.
        self.require_released_stop()?;
        self.order(Order::Enable, state)?;
        self.status.not_enabled = None;
        Ok(())
    }

    /// In every state, as a stop: it never makes a machine move.
    pub(super) fn disable(&mut self) -> Result<(), Refusal<N>> {
        match next(self.status.state, Trigger::Disable) {
            // The drives may be off.
            Transition::To(State::Reacting) => self.order(Order::Disable, self.status.state),
            Transition::To(state) => self.order(Order::Disable, state),
            // A retreat is ended.
            _ if self.status.state == State::Reacting => self.stop(),
            _ => Ok(()),
        }
    }

    pub(super) fn sample_drives(&mut self, every: u16) -> Result<(), Refusal<N>> {
        match self.features.measured() {
            Some(_) => self.order(Order::Drives { every }, self.status.state),
            None => Err(Refusal::NoFeedback),
        }
    }

    /// Returns true if a sample of the drives waits, and no older one of the motors.
    #[inline]
    pub(super) fn sends_drives(&self) -> bool {
        let Some(receiver) = self.features.feedback.get() else {
            return false;
        };
        let older = |drives: u32| {
            let motors = self.ends.samples.peek();
            motors.is_none_or(|sample| sample.tick.wrapping_sub(drives) as i32 >= 0)
        };
        receiver
            .samples
            .peek()
            .is_some_and(|sample| older(sample.tick))
    }

    /// Takes in what the tick reported of the drives; the platform was near `pose` last.
    #[inline(always)]
    pub(super) fn apply_feedback(&mut self, report: Option<&FeedbackReport<N>>, pose: Pose<N>) {
        let (Some(report), Some(receiver)) = (report, self.features.feedback.get_mut()) else {
            return;
        };
        if report.refused.is_some() {
            self.status.not_enabled = report.refused;
        }
        if report.asked != receiver.answered {
            receiver.answered = report.asked;
            receiver.search = Some(PoseSearch::new(self.view.angles, pose));
        }
    }

    /// A slice of the search for the pose of a machine that was measured. Returns true if there was any.
    #[inline(always)]
    pub(super) fn place_step(&mut self) -> bool {
        let coefficients = self.features.measured();
        let (Some(receiver), Some(coefficients)) = (self.features.feedback.get_mut(), coefficients)
        else {
            return false;
        };
        let Some(search) = &mut receiver.search else {
            return false;
        };
        let geometry = self.coefficients.borrow().tick.geometry();
        let Some(result) = search.step(coefficients, geometry) else {
            return true;
        };
        receiver.search = None;
        self.place_at(result);
        true
    }

    /// Has the drives close at the pose, or gives up.
    fn place_at(&mut self, result: Result<Pose<N>, NotEnabled<N>>) {
        let result = result.and_then(|pose| match self.clearance(&pose) {
            Some(why) => Err(why),
            None => Ok(pose),
        });
        let sent = match result {
            Ok(to) => {
                let path =
                    JointMove::new(self.view.angles, self.view.angles, 1, self.settings.period);
                self.ends.recoveries.send(Recover { path, to })
                    && self.order(Order::Place, State::Enabling).is_ok()
            }
            Err(why) => {
                self.status.not_enabled = Some(why);
                false
            }
        };
        if !sent {
            // Seven commands wait, or there is no pose: the host may ask again.
            let _ = self.disable();
        }
    }

    /// Reason why the limits do not allow a machine at `pose`.
    fn clearance(&self, pose: &Pose<N>) -> Option<NotEnabled<N>> {
        let Coefficients { tick, .. } = self.coefficients.borrow();
        let position = tick.geometry().position(pose).ok()?;
        let LimitBreach {
            code,
            index: leg,
            value,
            limit,
        } = self.keeps_clear(&position).err()?;
        Some(NotEnabled::Singular {
            what: code.bounded()?,
            leg,
            value,
            limit,
        })
    }
}
