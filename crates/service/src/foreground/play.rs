//! Along the path, tick by tick.

use super::super::feed::{PathPosition, Step};
use super::super::guard::LimitBreach;
use super::super::homing::{Homing, Progress};
use super::super::scene::Scene;
use super::{Foreground, Path, Target};
use crate::number::ServiceNumber;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::{Acting, State};

impl<N: ServiceNumber, S: Scene<N = N>> Foreground<'_, S> {
    /// One tick further; `started`: the path was begun in this tick, and this is its start.
    #[inline]
    pub(super) fn advance(&mut self, started: bool) -> Target<N> {
        self.finish_path();
        if self.homing.is_under_way() {
            return self.look_for_motors();
        }
        match self.state {
            State::Idle => return Target::Setpoint(Self::standing(self.pose)),
            State::Fault | State::Cleared | State::Unhomed => return Target::Still,
            _ => {}
        }
        let step = if started {
            self.feed.faster()
        } else {
            let step = self.step_length();
            self.position = self.feed.take(step, self.position);
            self.change_over();
            step
        };
        let target = self.target(step);
        if self.feed.is_at_rest() {
            self.come_to_rest();
        }
        target
    }

    /// A tick of homing. The recovery to the start pose follows in the tick in which it is done.
    fn look_for_motors(&mut self) -> Target<N> {
        match self.homing.advance(&self.output.motors) {
            Progress::Moving(joints) => Target::Joints(joints),
            Progress::Done => {
                self.path = Path::Joints;
                self.begin();
                self.transition_to(State::Recovering, Acting::Nothing);
                self.target(self.feed.faster())
            }
            Progress::Stopped => {
                self.recoveries.discard();
                self.transition_to(State::Unhomed, self.acting);
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
        match self.path {
            Path::Ended => {
                let stopping = matches!(self.state, State::Stopping);
                if !stopping && self.moves.has_second() {
                    // The end of the last is the start of the next: this tick goes on from there.
                    self.take_next();
                    return;
                }
                self.leave();
                self.path = Path::None;
                self.position = PathPosition::START;
                self.feed.end();
                self.held = false;
                if stopping {
                    self.drop_queue();
                }
                let acting = if stopping {
                    self.acting
                } else {
                    Acting::Nothing
                };
                self.transition_to(State::Idle, acting);
            }
            Path::JointsEnded => {
                if let Some(recovery) = self.recoveries.receive() {
                    self.pose = recovery.to;
                }
                self.path = Path::None;
                self.feed.end();
                self.transition_to(State::Idle, Acting::Nothing);
            }
            _ => {}
        }
    }

    /// Chooses how far this tick goes: towards normal speed where the state and the queue allow, else
    /// towards rest.
    #[inline]
    fn step_length(&mut self) -> Step {
        match self.state {
            State::Running => {
                let faster = self.feed.faster();
                if self.reaches(faster) {
                    if faster.is_normal(&self.feed) && self.acting != Acting::Nothing {
                        self.transition_to(State::Running, Acting::Nothing);
                    }
                    return faster;
                }
                self.transition_to(State::Slowing, Acting::QueueDry);
            }
            State::Recovering => return self.feed.faster(),
            State::Holding if !self.held && self.has_enough() => {
                self.feed.aim(self.position.part);
                self.transition_to(State::Running, Acting::Resume);
                return self.feed.faster();
            }
            State::Holding if !self.held && self.acting != Acting::QueueDry => {
                self.transition_to(State::Holding, Acting::QueueDry);
            }
            _ => {}
        }
        self.feed.slower()
    }

    /// Ticks of the path between its position in whole ticks and the end of what is admitted; none if
    /// it ends at rest and so needs no room to stop.
    #[inline]
    fn left(&self) -> Option<u32> {
        let ahead = self.shared.ahead();
        let left = ahead.left(self.played);
        (!ahead.ends_at_rest).then(|| left.saturating_sub(self.position.tick))
    }

    /// Returns `true` if the path could still come to rest on what is admitted.
    #[inline]
    fn reaches(&self, step: Step) -> bool {
        let part = self.position.part;
        self.left()
            .is_none_or(|left| self.feed.can_stop(step, left, part))
    }

    /// Returns `true` if there is enough to leave a hold for. Enough is room for a ramp down from normal
    /// speed, or all that the queue can hold.
    fn has_enough(&self) -> bool {
        let part = self.position.part;
        self.moves.is_full()
            || self
                .left()
                .is_none_or(|left| self.feed.is_enough(left, part))
    }

    /// Over the end of a move into the next, or to the end of the path. At most one end lies in a
    /// tick, for a move has a tick at least.
    #[inline]
    fn change_over(&mut self) {
        match self.path {
            Path::Move => {
                let ticks = self.moves.peek().map_or(0, |planned| planned.ticks);
                if self.position.tick < ticks {
                    return;
                }
                if self.done != self.begun {
                    self.done = self.begun;
                    self.unreported = true;
                }
                if self.moves.has_second() {
                    self.take_next();
                } else if self.shared.ahead().ends_at_rest {
                    self.position = PathPosition {
                        tick: ticks,
                        part: 0,
                    };
                    self.path = Path::Ended;
                }
                // Else it stands at the very end of what is admitted and waits for more.
            }
            Path::Joints => {
                let ticks = self
                    .recoveries
                    .peek()
                    .map_or(0, |recovery| recovery.path.ticks());
                if self.position.tick >= ticks {
                    self.position = PathPosition {
                        tick: ticks,
                        part: 0,
                    };
                    self.path = Path::JointsEnded;
                }
            }
            _ => {}
        }
    }

    /// The move under way is over.
    fn leave(&mut self) {
        let ticks = self.moves.peek().map_or(0, |planned| planned.ticks);
        self.played = self.played.wrapping_add(ticks);
        self.position.tick = self.position.tick.saturating_sub(ticks);
        self.moves.discard();
    }

    /// The next move takes the place of the one that ended.
    // A call, as what else happens at the ends of moves and of states: several sites have it, and no tick
    // but few.
    #[inline(never)]
    fn take_next(&mut self) {
        self.leave();
        if let Some(next) = self.moves.peek() {
            self.begun = next.number.wrapping_add(1);
            self.path = Path::Move;
        }
    }

    /// Returns what this path position asks of the machine, at the speed after `step`.
    #[inline]
    fn target(&self, step: Step) -> Target<N> {
        let position = self.position;
        match self.path {
            Path::Move | Path::Ended => {
                let Some(planned) = self.moves.peek() else {
                    return Target::Setpoint(Self::standing(self.pose));
                };
                let on_path = planned.segment.between(position.tick, self.part());
                // At normal speed the position is a whole tick, and the setpoint the segment's own.
                if position.part == 0 && step.is_normal(&self.feed) {
                    return Target::Setpoint(on_path);
                }
                Target::Setpoint(self.scaled(&on_path, step))
            }
            Path::Joints | Path::JointsEnded => {
                let Some(recovery) = self.recoveries.peek() else {
                    return Target::Still;
                };
                let mut joints = recovery.path.between(position.tick, self.part());
                let (speed, change) = self.speed(step);
                for (acceleration, rate) in joints.accelerations.iter_mut().zip(&mut joints.rates) {
                    *acceleration = *acceleration * speed * speed;
                    if let Some(change) = change {
                        *acceleration += rate.scaled(change);
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
    fn part(&self) -> Option<N> {
        let part = self.position.part;
        (part != 0).then(|| N::fraction(part, &self.ramp[1]))
    }

    /// u and u' after `step`.
    fn speed(&self, step: Step) -> (N, Option<N::Factor>) {
        let change = match step.slope {
            0 => None,
            1.. => Some(self.slope),
            _ => Some(-self.slope),
        };
        let speed = match step.level == self.feed.ramp() {
            true => N::ONE,
            false => N::fraction(step.level, &self.ramp[0]),
        };
        (speed, change)
    }

    /// q' u and q'' u^2 + q' u'.
    fn scaled(&self, on_path: &Setpoint<N>, step: Step) -> Setpoint<N> {
        let (speed, change) = self.speed(step);
        let mut acceleration = on_path.acceleration * speed * speed;
        if let Some(change) = change {
            acceleration += on_path.velocity.map(|velocity| velocity.scaled(change));
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
        match self.state {
            State::Slowing => self.transition_to(State::Holding, self.acting),
            State::Stopping => {
                let on_path = matches!(self.path, Path::Move | Path::Ended);
                if !on_path {
                    self.recoveries.discard();
                }
                self.drop_queue();
                // In a recovery the platform's pose is not known.
                let state = if on_path { State::Idle } else { State::Cleared };
                self.transition_to(state, self.acting);
            }
            _ => {}
        }
    }
}
