//! Effect of a status in each phase.

use super::JobClient;
use super::phase::Phase;
use crate::JobFailure;
use crate::approach::{short_way, straight_way};
use crate::describe::Units;
use crate::wake::WakeStep;
use std::time::Duration;
use trirrr_protocol::message::{Command, Move, Recovery, Request, State, Status, Transmit};

impl<N: Transmit> JobClient<N> {
    /// Takes a status, and changes the phase if the status asks for it.
    pub(super) fn on_status(&mut self, sequence: u32, status: Status<N>, now: Duration) {
        let is_overtaken = |taken: u32| taken.wrapping_sub(sequence) as i32 > 0;
        if self.last_taken.is_some_and(is_overtaken) {
            // It knows less than the answer that overtook it.
            return self.schedule.look_at(now);
        }
        self.schedule.looked(now);
        let behind = |request: &&Request<N>| request.sequence.wrapping_sub(sequence) as i32 > 0;
        let flying = self.exchange.open().filter(behind);
        self.progress.update(
            &status,
            flying.filter_map(|request| request.command.offered()),
        );
        let before = self.status.replace(status);
        let counts = |of: &Status<N>| (of.state, of.piece, of.next, of.admitted, of.done);
        let stands = before.is_some_and(|before| counts(&before) == counts(&status));
        if !stands || status.state != State::Idle {
            self.schedule.goes_on();
        }
        if before.is_none() {
            self.dry_before = status.dry_ticks;
        }
        let next = match (&self.phase, before) {
            (Phase::Ending(_) | Phase::Finished(_), _) => None,
            // A stop that came behind the end.
            (Phase::Streaming, _) if self.is_played(&status) && self.left(&status).is_none() => {
                Some(Phase::Finished(Ok(())))
            }
            _ if self.user.has_stopped && has_ended(status.state) => {
                let stopped = failed(self.stopped(&status));
                Some(self.complaint(&status).unwrap_or(stopped))
            }
            (Phase::Meeting, _) | (_, None) => Some(self.on_meeting(&status)),
            (Phase::Surveying, Some(before)) => Some(self.on_survey(&before, &status)),
            (Phase::Awaiting, Some(before)) => self.on_the_way(&before, &status),
            (Phase::Underway, _) => self.on_way(&status),
            (_, Some(before)) => self.on_path(&before, &status),
        };
        if let Some(next) = next {
            self.enter(next);
        }
    }

    /// First status of the machine: it has to be idle and empty, or to be brought to that.
    fn on_meeting(&mut self, status: &Status<N>) -> Phase<N> {
        if let Some((taken, first_move)) = self.approach.attachment
            && let Some(identity) = &self.identity
        {
            match &status.job {
                None => return failed(JobFailure::Restarted(identity.board.start)),
                Some(job)
                    if job.label != self.label
                        || first_move.is_some_and(|first| first != job.first_move) =>
                {
                    return failed(JobFailure::OtherJob(job.label));
                }
                Some(job) => self.progress.count_from(job),
            }
            self.is_named = true;
            // Fewer, and the machine has dropped some.
            let found = self.progress.taken(status);
            self.progress.resume_behind(found.max(taken));
            let next = self.on_survey(status, status);
            self.has_joined = !matches!(next, Phase::Finished(_));
            return next;
        }
        if let Some(fault) = status.fault {
            return match self.approach.recovery_s {
                Some(_) => {
                    // The machine drops its moves with the fault.
                    self.progress.restart_count();
                    Phase::Waking(Command::ClearFault)
                }
                None => failed(JobFailure::Fault(fault)),
            };
        }
        if let Some(recovering) = self.recovering(status) {
            return recovering;
        }
        let is_free = status.state == State::Idle && status.next == status.done;
        match self.approach.wake.next(status) {
            WakeStep::Order(order) => Phase::Waking(order),
            // Another client has begun this; with a recovery the user takes over.
            WakeStep::Wait if self.approach.recovery_s.is_some() => Phase::Awaiting,
            WakeStep::Ready if is_free => self.at_start(status),
            _ => failed(JobFailure::Occupied(status.state)),
        }
    }

    /// Status of a machine that is known already.
    fn on_survey(&mut self, before: &Status<N>, status: &Status<N>) -> Phase<N> {
        if self.approach.way.is_some() {
            return self.on_way(status).unwrap_or(Phase::Underway);
        }
        if let Some(complaint) = self.complaint(status) {
            return complaint;
        }
        if self.progress.has_taken() == 0 {
            if let Some(recovering) = self.recovering(status) {
                return recovering;
            }
            match self.approach.wake.next(status) {
                WakeStep::Order(order) => return Phase::Waking(order),
                WakeStep::Wait => return Phase::Awaiting,
                WakeStep::Failed(_) => {
                    let occupied = JobFailure::Occupied(status.state);
                    return failed(status.not_enabled.map_or(occupied, JobFailure::NotEnabled));
                }
                WakeStep::Ready => {}
            }
        }
        self.interruption(before, status)
            .unwrap_or_else(|| self.at_start(status))
    }

    /// Status of a machine on its way to the start of the job.
    fn on_the_way(&mut self, before: &Status<N>, status: &Status<N>) -> Option<Phase<N>> {
        let complaint = self.complaint(status);
        if let Some(next) = complaint.or_else(|| self.recovering(status)) {
            return Some(next);
        }
        let step = self.approach.wake.next(status);
        if step == WakeStep::Wait {
            return None;
        }
        // Switched on, it has begun no way yet.
        if std::mem::take(&mut self.approach.is_enabling) {
            return Some(self.on_survey(before, status));
        }
        match step {
            WakeStep::Ready => {}
            WakeStep::Order(order)
                if order != Command::Home || self.approach.recovery_s.is_some() =>
            {
                return Some(Phase::Waking(order));
            }
            // The machine came to rest before it arrived.
            _ => return Some(failed(self.stopped(status))),
        }
        let interruption = self.interruption(before, status);
        interruption.or_else(|| Some(self.at_start(status)))
    }

    /// Status of a machine that plays the job.
    fn on_path(&mut self, before: &Status<N>, status: &Status<N>) -> Option<Phase<N>> {
        if let Some(end) = self
            .complaint(status)
            .or_else(|| self.interruption(before, status))
        {
            return Some(end);
        }
        self.progress.resume_behind(self.progress.taken(status));
        if matches!(
            status.state,
            State::Disabled | State::Unhomed | State::Cleared
        ) {
            return Some(failed(self.stopped(status)));
        }
        self.is_played(status).then_some(Phase::Finished(Ok(())))
    }

    /// Phase of a machine that stands where the job may start, or plays it already.
    fn at_start(&mut self, status: &Status<N>) -> Phase<N> {
        self.progress.resume_behind(self.progress.taken(status));
        if let Some(way) = self.way_from(status) {
            return Phase::Waking(Command::Move(way));
        }
        match self.is_played(status) {
            true => Phase::Finished(Ok(())),
            false => Phase::Preparing,
        }
    }

    /// Way to the start of the job, for a machine that stands elsewhere and has nothing of a job.
    fn way_from(&self, status: &Status<N>) -> Option<Move<N>> {
        let is_free = status.state == State::Idle && status.next == status.done;
        if !is_free || self.progress.has_taken() != 0 || self.approach.attachment.is_some() {
            return None;
        }
        let (stands, start) = (status.end?.pose, self.progress.start()?);
        let units = Units::of(self.identity.as_ref()?);
        let is_near = stands == start || short_way(&stands, &start, &units).is_some();
        (!is_near).then(|| straight_way(status.next, &stands, &start, &units))
    }

    /// Status of a machine that judges the straight way to the start of the job, or is on it.
    fn on_way(&mut self, status: &Status<N>) -> Option<Phase<N>> {
        let way = self.approach.way?;
        if let Some(fault) = status.fault {
            return Some(failed(JobFailure::Fault(fault)));
        }
        let verdict = status
            .refused
            .filter(|verdict| verdict.number == way.number);
        if let Some(violation) = verdict.and_then(|verdict| verdict.violation) {
            self.approach.way = None;
            let enough = violation.shortest.map(|shortest| shortest.enough);
            return Some(match enough.filter(|enough| *enough > way.ticks) {
                Some(ticks) => Phase::Waking(Command::Move(Move { ticks, ..way })),
                None => failed(JobFailure::NoWay {
                    from: way.from,
                    to: way.to,
                    ticks: way.ticks,
                    violation,
                }),
            });
        }
        match status.state {
            State::Idle if status.next == status.done => {
                self.approach.way = None;
                // The way is no part of the job.
                self.progress.restart_count();
                Some(Phase::Surveying)
            }
            State::Idle if status.admitted == status.next => Some(Phase::Waking(Command::Start)),
            State::Disabled | State::Unhomed | State::Cleared => Some(failed(self.stopped(status))),
            _ => None,
        }
    }

    /// Way to the start of the job for a machine that stands beside it, and was not on this way yet.
    pub(super) fn beside(&mut self) -> Option<Recovery<N>> {
        let status = self.status.as_ref()?;
        let is_free = status.state == State::Idle && status.next == status.done;
        if !is_free
            || self.progress.has_taken() != 0
            || std::mem::replace(&mut self.approach.is_near, true)
        {
            return None;
        }
        let units = Units::of(self.identity.as_ref()?);
        short_way(&status.end?.pose, &self.progress.start()?, &units)
    }

    fn is_played(&self, status: &Status<N>) -> bool {
        status.state == State::Idle && self.progress.done(status) == self.progress.items()
    }

    /// End of the job by a fault, or by a move that the machine does not admit.
    fn complaint(&self, status: &Status<N>) -> Option<Phase<N>> {
        // The machine reports an acknowledged fault until its tick has heard of it.
        let is_latched = !self.approach.wake.has_cleared || status.state == State::Fault;
        if let Some(fault) = status.fault.filter(|_| is_latched) {
            return Some(failed(JobFailure::Fault(fault)));
        }
        // A refusal from before the first offer is of another job.
        let verdict = status.refused.filter(|_| self.progress.has_taken() > 0)?;
        let index = match self.progress.is_path() {
            // The piece at which the path was given up is the next one.
            true => self.progress.taken(status),
            false => self.progress.index(verdict.number)?,
        };
        let violation = verdict.violation?;
        Some(Phase::Ending(JobFailure::Inadmissible { index, violation }))
    }

    /// End of the job by a machine that has started anew, or has stopped and dropped moves.
    fn interruption(&self, before: &Status<N>, status: &Status<N>) -> Option<Phase<N>> {
        let taken = self.progress.taken(status);
        // Ticks only go forwards.
        let went_back = status.tick.wrapping_sub(before.tick) > u32::MAX / 2;
        if let Some(identity) = &self.identity
            && (went_back || taken > self.progress.items())
        {
            return Some(failed(JobFailure::Restarted(identity.board.start)));
        }
        // A job that was left on its way to rest may count as passed to its end.
        let is_left = has_ended(status.state) && self.left(status).is_some();
        // A piece at which a path was given up is no longer counted: its verdict says so.
        let has_dropped = taken < self.progress.has_taken();
        (has_dropped || is_left).then(|| failed(self.stopped(status)))
    }

    /// Failure of a job on a machine that has stopped.
    fn stopped(&self, status: &Status<N>) -> JobFailure<N> {
        // On the way to its start the machine has nothing of the job.
        let done = match self.is_named {
            true => self.done_of(status),
            false => 0,
        };
        match self.user.has_stopped {
            true => JobFailure::Stopped { done },
            false => JobFailure::Dropped {
                done,
                acting: status.acting,
            },
        }
    }

    /// Way to the start of the job, for a machine that stands without moves of another job.
    fn recovering(&self, status: &Status<N>) -> Option<Phase<N>> {
        let is_free =
            matches!(status.state, State::Idle | State::Cleared) && status.next == status.done;
        let seconds = self.approach.recovery_s.filter(|_| is_free)?;
        let ticks = (seconds * self.identity.as_ref()?.tick_rate_hz).round();
        Some(Phase::Waking(Command::Recover(Recovery {
            to: self.progress.start()?,
            // The cast saturates, and the machine refuses so many.
            ticks: ticks.max(1.0) as u32,
        })))
    }
}

/// Returns true if a machine in `state` stands, and plays no job.
fn has_ended(state: State) -> bool {
    state.is_at_rest() && state != State::Holding
}

fn failed<N: Transmit>(failure: JobFailure<N>) -> Phase<N> {
    Phase::Finished(Err(failure))
}
