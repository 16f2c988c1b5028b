//! Moves: what is offered, its admission, and the queue to the tick.

use super::super::curves::PlayedCurves;
use super::super::feed::FeedScale;
use super::super::handoff::{Ahead, QueuedMove};
use super::super::offered::Offered;
use super::super::pace::MovePaces;
use super::super::planner::PathPlanner;
use super::super::tool::Tool;
use super::{Background, ends};
use crate::admission;
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, Scene};
use core::borrow::Borrow;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{CurveKind, Pose, Setpoint};
use trirrr_protocol::message::{
    AnyMove, Event, Move, MoveBatch, QuinticMove, Refusal, State, Verdict, Violation,
};
use trirrr_protocol::wire::checksum;

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Moves for which there is room.
    pub(super) fn room(&self) -> u16 {
        let waiting = self.desk.offered.waiting() + self.ends.moves.len();
        let room = self.ends.moves.capacity().saturating_sub(waiting);
        // The moves that are kept for a cut are reported as over a little later than they are.
        let room = match CurvesOf::<S>::CUTS {
            true => room.min(self.desk.offered.room()),
            false => room,
        };
        room.min(usize::from(u16::MAX)) as u16
    }

    pub(super) fn longest(&self) -> u32 {
        longest_move(self.ends.moves.capacity())
    }

    /// The setpoint where the next move starts, in a state that takes moves.
    pub(super) fn end_of_moves(&self) -> Result<Setpoint<N>, Refusal<N>> {
        let state = self.status.state;
        let takes_moves = matches!(
            state,
            State::Idle | State::Running | State::Slowing | State::Holding
        );
        // Not known for the moment in which the tick drops its queue.
        let end = self.status.end.filter(|_| takes_moves);
        end.ok_or(Refusal::State(state))
    }

    /// An offer of the host was taken: the refusal of the one before is history, and so is a job that was left, unless it was named anew.
    #[inline(never)]
    pub(super) fn count_offer(&mut self) {
        self.status.refused = None;
        if core::mem::take(&mut self.job_is_over) {
            self.status.job = None;
        }
    }

    /// Offers a move that was planned here. Returns false if there is no room.
    #[inline(never)]
    pub(super) fn offer_planned(&mut self, planned: QuinticMove<N>) -> bool {
        let QuinticMove {
            mut common,
            start_acceleration,
            end_acceleration,
        } = planned;
        let Some(accelerations) = CurvesOf::<S>::some([start_acceleration, end_acceleration])
        else {
            return false;
        };
        common.number = self.status.next;
        let (to, velocity) = (common.to, common.end_velocity);
        let offered = self.desk.offered.add(Offered {
            common,
            accelerations,
        });
        if offered {
            self.status.next = self.status.next.wrapping_add(1);
            self.status.end = Some(ends(to, velocity, end_acceleration));
        }
        offered
    }

    /// Takes a move to be judged.
    #[inline(never)]
    pub(super) fn offer(
        &mut self,
        common: &Move<N>,
        given: <CurvesOf<S> as CurveKind>::Accelerations<N>,
    ) -> Result<(), Refusal<N>> {
        let before = self.end_of_moves()?;
        let accelerations = CurvesOf::<S>::given(&given);
        check_finite(common, accelerations)?;
        if common.number != self.status.next {
            return Err(Refusal::MoveNumber {
                expected: self.status.next,
            });
        }
        check_duration(common, self.longest())?;
        if common.from != before.pose {
            return Err(Refusal::StartPose);
        }
        if common.start_velocity != <[N; 3]>::from(before.velocity) {
            return Err(Refusal::StartVelocity);
        }
        let mut end_acceleration = [N::ZERO; 3];
        if let Some([start, end]) = accelerations {
            if start != <[N; 3]>::from(before.acceleration) {
                return Err(Refusal::StartAcceleration);
            }
            end_acceleration = end;
        }
        check_tool(common)?;
        let offered = Offered {
            common: *common,
            accelerations: given,
        };
        if self.room() == 0 || !self.desk.offered.add(offered) {
            return Err(Refusal::QueueFull);
        }
        self.count_offer();
        self.status.next = self.status.next.wrapping_add(1);
        self.status.end = Some(ends(common.to, common.end_velocity, end_acceleration));
        Ok(())
    }

    /// Takes the moves of a batch to be judged: all of them, or none.
    #[inline(always)]
    pub(super) fn offer_batch(&mut self, batch: Option<&MoveBatch<N>>) -> Result<(), Refusal<N>> {
        batch.map_or(Err(Refusal::NoBatches), |batch| self.offer_all(batch))
    }

    #[inline(never)]
    fn offer_all(&mut self, batch: &MoveBatch<N>) -> Result<(), Refusal<N>> {
        let start = self.end_of_moves()?;
        if batch.number != self.status.next {
            return Err(Refusal::MoveNumber {
                expected: self.status.next,
            });
        }
        // A setpoint has a length that is known beforehand.
        let expected = checksum(&start).unwrap_or_default();
        if batch.check != expected {
            return Err(Refusal::Check { expected });
        }
        let mut count = 0;
        for each in batch.moves(&start) {
            check_offer(&each, self.longest())?;
            Offered::<N, CurvesOf<S>>::of(&each).ok_or(Refusal::NoQuintics)?;
            count += 1;
        }
        if self.room() < count {
            return Err(Refusal::QueueFull);
        }
        for each in batch.moves(&start) {
            let taken = Offered::of(&each).is_some_and(|offered| self.desk.offered.add(offered));
            if taken {
                self.count_offer();
                self.status.next = self.status.next.wrapping_add(1);
                self.status.end = Some(each.end());
            }
        }
        Ok(())
    }

    /// Does one step of the admission. Returns true if there is more to do.
    #[inline(never)]
    pub(super) fn check_step(&mut self) -> bool {
        let Some(offered) = self.desk.offered.peek() else {
            return false;
        };
        if !self.admission.checking {
            let path = &self.coefficients.borrow().path;
            self.admission.judgement.offer(path, offered);
            self.admission.checking = true;
            return true;
        }
        match self
            .admission
            .judgement
            .step(&self.coefficients.borrow().path)
        {
            admission::Verdict::Undecided => {
                if let Some(violation) = self.admission.judgement.violation()
                    && self.desk.planner.is_active()
                {
                    // The planner has no use for the shortest duration, which is still looked for.
                    self.refuse_of_path(&violation);
                }
                true
            }
            admission::Verdict::Admitted => {
                if self.takes_admitted() {
                    self.admit();
                }
                // Else it stays admitted until there is room.
                self.desk.offered.peek().is_some() && self.takes_admitted()
            }
            admission::Verdict::Refused(violation) if self.desk.planner.is_active() => {
                self.refuse_of_path(&violation);
                true
            }
            admission::Verdict::Refused(violation) => {
                self.refuse(violation);
                false
            }
            // The admission has nothing to judge: it is offered again.
            admission::Verdict::Nothing => {
                self.admission.checking = false;
                true
            }
        }
    }

    #[inline(never)]
    fn admit(&mut self) {
        let Some(offered) = self.desk.offered.admit() else {
            return;
        };
        self.admission.checking = false;
        self.desk.planner.keep();
        let planned = self.queued(&offered, self.admission.judgement.paces());
        let QueuedMove { ticks, number, .. } = planned;
        self.features.admit(number, self.view.generation);
        if !self.ends.moves.send(planned) {
            return;
        }
        let measure = FeedScale::new(self.settings.ramp.ticks).room_measure();
        self.admission
            .admitted
            .add_move(&planned.paces, ticks, &measure);
        if offered.common.ends_at_rest() {
            self.admission.rests = number.wrapping_add(1);
        }
        self.ends.shared.set_ahead(Ahead {
            room: self.admission.admitted.room,
            rests: self.admission.rests,
        });
        self.status.admitted = number.wrapping_add(1);
        self.push_event(Event::Verdict(Verdict {
            number,
            violation: None,
        }));
    }

    /// An admitted move, as the tick plays it.
    #[inline]
    pub(super) fn queued(
        &self,
        offered: &Offered<N, CurvesOf<S>>,
        paces: MovePaces,
    ) -> QueuedMove<N, CurvesOf<S>> {
        QueuedMove::new(offered, paces, self.view.generation, self.settings.period)
    }

    /// The oldest offered move is not admitted: it and all behind it are dropped, and the next to
    /// offer takes its place.
    fn refuse(&mut self, violation: Violation<N>) {
        self.withdraw();
        self.features.drop_outputs();
        self.tell_refused(violation);
    }

    /// Tells the host that there is no move, or none like the next, for this reason.
    #[inline(never)]
    pub(super) fn tell_refused(&mut self, violation: Violation<N>) {
        let verdict = Verdict {
            number: self.status.next,
            violation: Some(violation),
        };
        self.status.refused = Some(verdict);
        self.push_event(Event::Verdict(verdict));
    }

    /// Drops all moves that are not judged. The changes of outputs with them stay: a path makes another move of that number.
    pub(super) fn withdraw(&mut self) {
        let Some(offered) = self.desk.offered.refuse() else {
            return;
        };
        self.admission.checking = false;
        self.features.drop_levels();
        // Where the refused one is a cubic, a quintic behind a quintic starts anew.
        let [acceleration, _] = offered.quintic().unwrap_or([[N::ZERO; 3]; 2]);
        let Move {
            from,
            start_velocity,
            number,
            ..
        } = offered.common;
        self.status.next = number;
        self.status.end = Some(ends(from, start_velocity, acceleration));
    }
}

/// Returns the longest move in ticks for a queue of `capacity` moves: as many as fit are counted modulo
/// 2^31 together.
pub const fn longest_move(capacity: usize) -> u32 {
    (1 << 31) / (capacity as u32 + 1) - 1
}

/// Checks what a service asks of an offered move whatever its state, before the admission: finite values,
/// a duration of 1 to `longest` ticks, a tool that is one.
///
/// # Errors
/// [`Refusal::NotFinite`], [`Refusal::Duration`], [`Refusal::Tool`].
pub fn check_offer<N: Number>(offered: &AnyMove<N>, longest: u32) -> Result<(), Refusal<N>> {
    let common = offered.common();
    check_finite(common, offered.accelerations())?;
    check_duration(common, longest)?;
    check_tool(common)
}

fn check_duration<N: Number>(offered: &Move<N>, longest: u32) -> Result<(), Refusal<N>> {
    match offered.ticks {
        ticks if ticks != 0 && ticks <= longest => Ok(()),
        _ => Err(Refusal::Duration { longest }),
    }
}

fn check_tool<N: Number>(offered: &Move<N>) -> Result<(), Refusal<N>> {
    match Tool::is_one(offered.tool_power, offered.tool_speed) {
        true => Ok(()),
        false => Err(Refusal::Tool),
    }
}

/// Returns true if the pose is finite.
pub(super) fn is_pose<N: Number>(pose: &Pose<N>) -> bool {
    pose.position.x.is_finite() && pose.position.y.is_finite() && N::angle_is_finite(pose.angle)
}

fn check_finite<N: Number>(
    offered: &Move<N>,
    accelerations: Option<[[N; 3]; 2]>,
) -> Result<(), Refusal<N>> {
    let all = |values: &[N; 3]| values.iter().all(|value| value.is_finite());
    let finite = is_pose(&offered.from)
        && is_pose(&offered.to)
        && all(&offered.start_velocity)
        && all(&offered.end_velocity)
        && accelerations.is_none_or(|both| both.iter().all(all))
        && offered.tool_power.is_finite()
        && offered.tool_speed.is_finite();
    finite.then_some(()).ok_or(Refusal::NotFinite)
}
