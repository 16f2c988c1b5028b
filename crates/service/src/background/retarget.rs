//! Retargets: moves to a goal, planned here and then judged and queued as if the host had offered them.

use super::super::offered::Offered;
use super::super::scene::Scene;
use super::{Background, ends};
use crate::admission::{Aiming, Retargeted};
use crate::number::ServiceNumber;
use core::borrow::Borrow;
use trirrr_core::setpoint::CurveKind;
use trirrr_protocol::message::{Event, Goal, QuinticMove, Refusal, State, Verdict, Violation};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Takes a goal; none where the image plays no quintics.
    #[inline(always)]
    pub(super) fn retarget(&mut self, goal: Option<&Goal<N>>) -> Result<(), Refusal<N>> {
        let none = [[N::ZERO; 3]; 2];
        match (goal, S::Curves::some(none)) {
            (Some(goal), Some(_)) => self.aim_at(goal),
            _ => Err(Refusal::NoQuintics),
        }
    }

    #[inline(never)]
    fn aim_at(&mut self, goal: &Goal<N>) -> Result<(), Refusal<N>> {
        let state = self.status.state;
        let takes_moves = matches!(
            state,
            State::Idle | State::Running | State::Slowing | State::Holding
        );
        // The end is not known for the moment in which the tick drops its queue.
        let before = self.status.end.filter(|_| takes_moves);
        let before = before.ok_or(Refusal::State(state))?;
        let (x, y) = (goal.to.position.x, goal.to.position.y);
        let all = goal.velocity.iter().all(|value| value.is_finite());
        if !(x.is_finite() && y.is_finite() && N::angle_is_finite(goal.to.angle) && all) {
            return Err(Refusal::NotFinite);
        }
        // It starts where the moves end: they have to stay.
        if self.offered.1.peek().is_some() {
            return Err(Refusal::Undecided);
        }
        let room = self.room();
        if room == 0 {
            return Err(Refusal::QueueFull);
        }
        self.status.refused = None;
        let target = ends(goal.to, goal.velocity, [N::ZERO; 3]);
        let path = &self.coefficients.borrow().path;
        self.aim.aim(path, &before, &target, usize::from(room));
        Ok(())
    }

    /// One step of the plan. Whether there was one to do.
    #[inline(always)]
    pub(super) fn retarget_step(&mut self) -> bool {
        if !self.aim.is_under_way() {
            return false;
        }
        match self.aim.step(&self.coefficients.borrow().path) {
            None => return false,
            Some(Retargeted::Undecided) => return true,
            Some(Retargeted::Planned(count)) => self.take_planned(count),
            Some(Retargeted::Refused(refusal)) => self.refuse_goal(refusal.violation),
        }
        self.aim = Aiming::<N>::NONE;
        true
    }

    /// Offers the moves: there has been room since the goal was taken.
    #[inline(never)]
    fn take_planned(&mut self, count: usize) {
        for index in 0..count {
            let Some(QuinticMove {
                mut common,
                start_acceleration,
                end_acceleration,
            }) = self.aim.planned(index)
            else {
                return;
            };
            let Some(accelerations) = S::Curves::some([start_acceleration, end_acceleration])
            else {
                return;
            };
            common.number = self.status.next;
            let (to, velocity) = (common.to, common.end_velocity);
            if !self.offered.0.send(Offered {
                common,
                accelerations,
            }) {
                return;
            }
            self.status.next = self.status.next.wrapping_add(1);
            self.status.end = Some(ends(to, velocity, end_acceleration));
        }
    }

    #[inline(never)]
    fn refuse_goal(&mut self, violation: Violation<N>) {
        let verdict = Verdict {
            number: self.status.next,
            violation: Some(violation),
        };
        self.status.refused = Some(verdict);
        self.push_event(Event::Verdict(verdict));
    }
}
