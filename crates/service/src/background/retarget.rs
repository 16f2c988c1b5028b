//! Retargets: moves to a goal, planned here and then judged and queued as if the host had offered them.

use super::moves::is_pose;
use super::{Background, ends};
use crate::admission::{Aiming, RetargetTask, Retargeted};
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, Scene};
use core::borrow::Borrow;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{CurveKind, Setpoint};
use trirrr_protocol::message::{Goal, Refusal, State};

/// The setpoint at a goal.
pub(super) fn target<N: Number>(goal: &Goal<N>) -> Setpoint<N> {
    ends(goal.to, goal.velocity, [N::ZERO; 3])
}

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Takes a goal; none where the image plays no quintics.
    #[inline(always)]
    pub(super) fn retarget(&mut self, goal: Option<&Goal<N>>) -> Result<(), Refusal<N>> {
        let none = [[N::ZERO; 3]; 2];
        match (goal, CurvesOf::<S>::some(none)) {
            (Some(goal), Some(_)) => self.aim_at(goal),
            _ => Err(Refusal::NoQuintics),
        }
    }

    #[inline(never)]
    fn aim_at(&mut self, goal: &Goal<N>) -> Result<(), Refusal<N>> {
        let state = self.status.state;
        let moves = matches!(state, State::Running | State::Slowing | State::Holding);
        let cuts = goal.cut && moves;
        if self.is_retargeting() && !(cuts && self.may_replace_goal()) {
            return Err(Refusal::Retargeting);
        }
        let before = self.end_of_moves()?;
        let all = goal.velocity.iter().all(|value| value.is_finite());
        if !(is_pose(&goal.to) && all) {
            return Err(Refusal::NotFinite);
        }
        if cuts && self.begin_splice(goal) {
            self.count_offer();
            return Ok(());
        }
        // It starts where the moves end: they have to stay.
        if self.desk.offered.peek().is_some() {
            return Err(Refusal::Undecided);
        }
        if self.room() == 0 {
            return Err(Refusal::QueueFull);
        }
        self.count_offer();
        self.aim_from(&before, goal);
        Ok(())
    }

    /// Begins to plan behind the moves that are queued.
    pub(super) fn aim_from(&mut self, before: &Setpoint<N>, goal: &Goal<N>) {
        let task = RetargetTask {
            start: *before,
            target: target(goal),
            most: usize::from(self.room()),
            least: goal.least_ticks,
        };
        self.aim.aim(&self.coefficients.borrow().path, &task);
    }

    /// Does one step of the plan. Returns true if there was one to do.
    #[inline(always)]
    pub(super) fn retarget_step(&mut self) -> bool {
        if !self.aim.is_under_way() {
            return false;
        }
        match self.aim.step(&self.coefficients.borrow().path) {
            None => return false,
            Some(Retargeted::Undecided) => return true,
            Some(Retargeted::Planned(count)) => self.take_planned(count),
            Some(Retargeted::Refused(refusal)) => self.tell_refused(refusal.violation),
        }
        self.aim = Aiming::<N>::NONE;
        true
    }

    /// Offers the moves: there has been room since the goal was taken.
    #[inline(never)]
    fn take_planned(&mut self, count: usize) {
        for index in 0..count {
            let Some(planned) = self.aim.planned(index) else {
                return;
            };
            if !self.offer_planned(planned) {
                return;
            }
        }
    }
}
