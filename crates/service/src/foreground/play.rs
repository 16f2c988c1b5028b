//! Along the path, tick by tick.

use super::super::feed::{PathPosition, Step};
use super::super::guard::LimitBreach;
use super::super::handoff::Ahead;
use super::super::homing::Progress;
use super::super::pace::{FULL, MovePaces, Pace};
use super::{Foreground, Part, Path, Target, TickEnds};
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::states::{Known, Trigger};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::{Acting, State};

impl<N: ServiceNumber, S: Scene<N = N>, E: TickEnds<S>> Foreground<'_, S, E> {
    /// Advances the path by one tick and returns its target. `started`: this is the first tick of a path, and the target is its
    /// start.
    #[inline]
    pub(super) fn advance(&mut self, started: bool) -> Target<N> {
        self.finish_path();
        if self.features.is_homing() {
            return self.look_for_motors();
        }
        match self.state {
            State::Idle => return Target::Setpoint(Self::standing(self.pose)),
            State::Fault if self.output.is_on() => return self.stand(),
            State::Fault | State::Cleared | State::Unhomed => return Target::Still,
            State::Reacting if self.travel.path == Path::None => return self.switch(),
            State::Disabled | State::Enabling | State::Disabling => return self.switch(),
            State::Reacting if self.goes_back() => return self.go_back(),
            _ => {}
        }
        let step = if started {
            self.travel.feed.steady()
        } else {
            let step = self.step_length();
            self.travel.position = self.travel.feed.take(step, self.travel.position);
            self.change_over();
            step
        };
        let target = self.target(step);
        if E::CHANGES_PACE && self.travel.feed.is_at_rest() {
            self.come_to_rest();
        }
        target
    }

    /// A tick of homing. The recovery to the start pose follows in the tick in which it is done.
    fn look_for_motors(&mut self) -> Target<N> {
        let Some(cycle) = self.features.homing() else {
            return Target::Still;
        };
        match cycle.advance(&self.output.motors) {
            Progress::Moving(joints) => Target::Joints(joints),
            Progress::Done => {
                self.travel.path = Path::Joints;
                self.travel.part = Part::WHOLE;
                self.begin();
                self.change(Trigger::Found, Acting::Nothing);
                self.target(self.travel.feed.steady())
            }
            Progress::Stopped => {
                self.ends.take_recovery();
                self.end_motion(Known::NOTHING, self.acting);
                Target::Still
            }
            Progress::Failed { code, motor, limit } => {
                self.latch(LimitBreach {
                    code,
                    index: Some(motor),
                    value: limit,
                    limit,
                });
                Target::Still
            }
        }
    }

    /// Ends the path that was at its end a tick ago, unless more was queued in time.
    #[inline]
    fn finish_path(&mut self) {
        match self.travel.path {
            Path::Ended => {
                let stopping = matches!(self.state, State::Stopping | State::Reacting);
                if !stopping && self.next_move().is_some() {
                    // The end of the last is the start of the next: this tick goes on from there.
                    let enough = self.has_enough();
                    self.take_next();
                    if !enough {
                        self.travel.feed.end();
                        self.change(Trigger::StandsDry, Acting::QueueDry);
                    }
                    return;
                }
                if self.begin_retreat() {
                    return;
                }
                // Behind a door that was opened the end of the path was reached without the tool.
                let acting = match stopping || self.job.left.is_some() {
                    true => self.acting,
                    false => Acting::Nothing,
                };
                self.tell_left();
                self.travel.current = None;
                self.features.end_moves();
                self.travel.path = Path::None;
                self.travel.position = PathPosition::START;
                self.travel.feed.end();
                self.travel.held = false;
                if stopping {
                    self.drop_queue();
                }
                self.end_motion(Known::POSE, acting);
            }
            Path::JointsEnded => {
                if let Some(recovery) = self.ends.take_recovery() {
                    self.pose = recovery.to;
                }
                self.travel.path = Path::None;
                self.travel.feed.end();
                self.supply.set_lost(false);
                self.end_motion(Known::POSE, Acting::Nothing);
            }
            _ => {}
        }
    }

    /// Chooses how far this tick goes: towards the pace that the host asks for where the state and the queue allow, else
    /// towards rest.
    #[inline]
    fn step_length(&mut self) -> Step {
        let steady = self.travel.feed.steady();
        if !E::CHANGES_PACE {
            return steady;
        }
        let goes_on = self.state == State::Running && self.acting == Acting::Nothing;
        match goes_on && self.travel.feed.is_at_goal() && self.reaches(steady) {
            true => steady,
            false => self.change_pace(),
        }
    }

    /// Chooses as [`step_length`](Self::step_length) does where the pace may change.
    // A call: few ticks have it.
    #[inline(never)]
    fn change_pace(&mut self) -> Step {
        match self.state {
            State::Running => {
                let faster = self.faster();
                if self.reaches(faster) {
                    if faster.slope == 0 && self.travel.feed.is_at_goal() {
                        self.change(Trigger::AtPace, Acting::Nothing);
                    }
                    return faster;
                }
                if !self.gets_no_more() {
                    self.change(Trigger::RunsDry, Acting::QueueDry);
                } else if let steady = self.travel.feed.steady()
                    && self.reaches(steady)
                {
                    return steady;
                }
            }
            State::Recovering => return self.faster(),
            State::Holding if !self.travel.held && self.has_enough() => {
                self.change(Trigger::GoesOn, Acting::Resume);
                let faster = self.faster();
                return match self.reaches(faster) {
                    true => faster,
                    false => self.travel.feed.steady(),
                };
            }
            State::Holding if !self.travel.held => {
                self.change(Trigger::RunsDry, Acting::QueueDry);
            }
            _ => {}
        }
        self.across(|paces| self.travel.feed.slower(paces))
    }

    fn faster(&self) -> Step {
        // At its goal the pace does not change, whatever the rates.
        match self.travel.feed.is_at_goal() {
            true => self.travel.feed.steady(),
            false => self.across(|paces| self.travel.feed.faster(paces, self.travel.position.part)),
        }
    }

    /// A step at the rates of this tick: where it goes over into another part, at the lesser ones of both.
    fn across(&self, step: impl Fn(&[Pace; 2]) -> Step) -> Step {
        let Part { index, end, pace } = self.travel.part;
        let next = match &self.travel.current {
            Some(current) if end < self.clip(current.ticks) => Some(current.paces.of(index + 1)),
            _ => self.next_move().map(|next| next.paces.of(0)),
        };
        let paces = [pace, next.unwrap_or(pace)];
        self.travel
            .feed
            .across(self.travel.position, end, paces, step)
    }

    /// Room to stop in ahead of the whole tick of the position, see [`FeedScale::can_stop`]; none if a move ahead ends at
    /// rest: there the path can end without.
    #[inline]
    fn room(&self) -> Option<impl Fn(usize) -> i32> {
        if E::IS_WHOLE {
            return None;
        }
        let ahead = self.ahead();
        // The end of the move under way counts, unless the path stands there.
        let next = match self.travel.path {
            Path::Ended => self.job.begun,
            _ => self.job.begun.wrapping_sub(1),
        };
        (!ahead.rests_from(next)).then_some(self.room_beyond(ahead))
    }

    /// Room to stop in, whether the path rests or not.
    #[inline]
    fn room_beyond(&self, ahead: Ahead) -> impl Fn(usize) -> i32 {
        let within = self
            .travel
            .part
            .end
            .saturating_sub(self.travel.position.tick);
        move |x: usize| {
            let rate = self.travel.part.pace.braking()[x];
            self.travel.passed.room.left(&ahead.room, x)
                + self.travel.feed.room_measure().of(rate, within) as i32
        }
    }

    /// Returns `true` if the path could still come to rest on what is admitted.
    #[inline]
    fn reaches(&self, step: Step) -> bool {
        let part = self.travel.position.part;
        self.room()
            .is_none_or(|room| self.travel.feed.can_stop(step, part, room))
    }

    /// Returns `true` if there is enough to leave a hold for. Enough is room for a ramp down from the pace that the host asks
    /// for, or all that can come.
    fn has_enough(&self) -> bool {
        let part = self.travel.position.part;
        let enough = || {
            self.room()
                .is_none_or(|room| self.travel.feed.is_enough(part, room))
        };
        !self.waits_for_chain() && (self.gets_no_more() || enough())
    }

    /// Over the end of a move into the next, or to the end of the path. At most one end lies in a
    /// tick, for a move has a tick at least.
    #[inline]
    fn change_over(&mut self) {
        match self.travel.path {
            Path::Move => {
                if self.travel.position.tick < self.travel.part.end {
                    return;
                }
                let ticks = self
                    .travel
                    .current
                    .as_ref()
                    .map_or(0, |current| current.ticks);
                if self.travel.position.tick < self.clip(ticks) {
                    self.begin_part(self.travel.part.index + 1);
                    return;
                }
                if self.change_to_chain() {
                    return;
                }
                if self.job.done != self.job.begun {
                    self.job.done = self.job.begun;
                    self.note_change();
                }
                let more = self.next_move().is_some();
                if self.rests_here(more) {
                    self.land(ticks);
                    self.travel.path = Path::Ended;
                } else if more {
                    self.take_next();
                }
                // Else it stands at the very end of what is admitted and waits for more.
            }
            Path::Joints => {
                let ticks = self
                    .ends
                    .recovery()
                    .map_or(0, |recovery| recovery.path.ticks());
                if self.travel.position.tick >= ticks {
                    self.land(ticks);
                    self.travel.path = Path::JointsEnded;
                }
            }
            _ => {}
        }
    }

    /// Returns true if the path rests at the end of the move under way: it is the last end at rest, and there is no `more`, or too
    /// little of it to stop in from this pace.
    #[inline(never)]
    fn rests_here(&self, more: bool) -> bool {
        if E::IS_WHOLE {
            return !more;
        }
        let ahead = self.ahead();
        let stand = Step {
            parts: 0,
            ..self.travel.feed.steady()
        };
        let part = self.travel.position.part;
        ahead.rests == self.job.begun
            && !(more
                && self
                    .travel
                    .feed
                    .can_stop(stand, part, self.room_beyond(ahead)))
    }

    /// A path that ends at rest ends there, even if the tick would have gone further.
    fn land(&mut self, tick: u32) {
        self.travel.position = PathPosition { tick, part: 0 };
        self.travel.feed.land();
    }

    /// The next move takes the place of the one that ended.
    // A call, as what else happens at the ends of moves and of states: several sites have it, and no tick
    // but few.
    #[inline(never)]
    fn take_next(&mut self) {
        let ticks = self
            .travel
            .current
            .as_ref()
            .map_or(0, |current| current.ticks);
        self.travel.position.tick = self.travel.position.tick.saturating_sub(ticks);
        self.features.keep_move(self.travel.current.as_ref(), ticks);
        self.begin_next();
    }

    /// Takes the next move out of its queue. Returns false if there is none.
    pub(super) fn begin_next(&mut self) -> bool {
        self.travel.current = self.receive_move();
        let Some(current) = &self.travel.current else {
            return false;
        };
        let number = current.number;
        self.features.begin_move(number, self.job.generation);
        self.job.begun = number.wrapping_add(1);
        self.travel.path = Path::Move;
        self.begin_part(0);
        true
    }

    /// Part `index` of the move begins.
    #[inline(never)]
    fn begin_part(&mut self, index: u32) {
        let Some(current) = &self.travel.current else {
            return;
        };
        let begin = match index {
            0 => 0,
            _ => self.travel.part.end,
        };
        let pace = current.paces.of(index);
        let end = self.clip(MovePaces::end_of(current.ticks, index));
        self.travel.part = Part { index, end, pace };
        if E::IS_WHOLE || self.is_cut_ahead() {
            return;
        }
        self.travel
            .passed
            .add(&pace, end - begin, &self.travel.feed.room_measure());
    }

    /// Returns what this path position asks of the machine, at the speed after `step`.
    #[inline]
    fn target(&self, step: Step) -> Target<N> {
        let position = self.travel.position;
        match self.travel.path {
            Path::Move | Path::Ended => {
                let Some(current) = &self.travel.current else {
                    return Target::Setpoint(Self::standing(self.pose));
                };
                let on_path = current.segment.between(position.tick, self.part());
                // At normal speed the position is a whole tick, and the setpoint the segment's own.
                if !E::CHANGES_PACE || (position.part == 0 && step.is_normal(&self.travel.feed)) {
                    return Target::Setpoint(on_path);
                }
                Target::Setpoint(self.scaled(&on_path, step))
            }
            Path::Joints | Path::JointsEnded => {
                let Some(recovery) = self.ends.recovery() else {
                    return Target::Still;
                };
                let mut joints = recovery.path.between(position.tick, self.part());
                if !E::CHANGES_PACE {
                    return Target::Joints(joints);
                }
                let (speed, change) = self.speed(step);
                for (acceleration, rate) in joints.accelerations.iter_mut().zip(&mut joints.rates) {
                    *acceleration = *acceleration * speed * speed;
                    if let Some(change) = &change {
                        *acceleration += change.of(*rate);
                    }
                    *rate *= speed;
                }
                Target::Joints(joints)
            }
            Path::None => Target::Setpoint(Self::standing(self.pose)),
        }
    }

    /// Part of a tick at which the path position is; none at a whole tick.
    #[inline]
    pub(super) fn part(&self) -> Option<N> {
        let part = self.travel.position.part;
        (part != 0).then(|| N::fraction(part, &self.travel.counts.part))
    }

    /// u and u' after `step`.
    fn speed(&self, step: Step) -> (N, Option<PaceChange<N>>) {
        let change = (step.slope != 0).then(|| {
            let levels = step.slope.unsigned_abs();
            PaceChange {
                slope: match step.slope > 0 {
                    true => self.travel.slope,
                    false => -self.travel.slope,
                },
                share: (levels != u32::from(FULL))
                    .then(|| N::fraction(levels, &self.travel.counts.change)),
            }
        });
        let speed = match step.level == self.travel.feed.top() {
            true => N::ONE,
            false => N::fraction(step.level, &self.travel.counts.level),
        };
        (speed, change)
    }

    /// q' u and q'' u^2 + q' u'.
    #[inline(never)]
    pub(super) fn scaled(&self, on_path: &Setpoint<N>, step: Step) -> Setpoint<N> {
        let (speed, change) = self.speed(step);
        let mut acceleration = on_path.acceleration * speed * speed;
        if let Some(change) = change {
            acceleration += on_path.velocity.map(|velocity| change.of(velocity));
        }
        Setpoint {
            pose: on_path.pose,
            velocity: on_path.velocity * speed,
            acceleration,
        }
    }

    /// The speed along the path is 0 from now on, until something is done about it.
    #[inline(never)]
    fn come_to_rest(&mut self) {
        if self.begin_retreat() {
            return;
        }
        match self.state {
            State::Slowing => _ = self.change(Trigger::Rests, self.acting),
            State::Stopping | State::Reacting => {
                let on_path = matches!(self.travel.path, Path::Move | Path::Ended);
                if !on_path {
                    self.ends.take_recovery();
                }
                self.drop_queue();
                // In a recovery the platform's pose is not known.
                let known = match on_path {
                    true => Known::POSE,
                    false => Known::ANGLES,
                };
                self.end_motion(known, self.acting);
            }
            _ => {}
        }
    }
}

/// u', not zero.
struct PaceChange<N: Number> {
    /// The greatest that there is, with its sign.
    slope: N::Factor,
    /// Part of it; none for all of it.
    share: Option<N>,
}

impl<N: Number> PaceChange<N> {
    /// Acceleration that it gives to the coordinate with `rate` at normal speed.
    fn of(&self, rate: N) -> N {
        let whole = rate.scaled(self.slope);
        match self.share {
            Some(share) => whole * share,
            None => whole,
        }
    }
}
