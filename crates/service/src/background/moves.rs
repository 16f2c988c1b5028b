//! Moves: what is offered, its admission, and the queue to the tick.

use super::super::handoff::QueuedMove;
use super::super::scene::Scene;
use super::super::tool::Tool;
use super::{Background, ends};
use crate::admission;
use crate::admission::Enclose;
use core::borrow::Borrow;
use nalgebra::Vector3;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Hermite, Pose, RestToRest, Segment};
use trirrr_protocol::message::{Event, Move, Refusal, State, Verdict};

impl<N: Enclose, S: Scene<N = N>> Background<'_, S> {
    /// Moves for which there is room.
    pub(super) fn room(&self) -> u8 {
        let waiting = self.offered.0.len() + self.moves.len();
        self.offered.0.capacity().saturating_sub(waiting).min(255) as u8
    }

    fn longest(&self) -> u32 {
        longest_move(self.offered.0.capacity())
    }

    /// Takes a move to be judged.
    #[inline(never)]
    pub(super) fn offer(&mut self, offered: &Move<N>) -> Result<(), Refusal<N>> {
        match self.status.state {
            State::Idle | State::Running | State::Slowing | State::Holding => {}
            state => return Err(Refusal::State(state)),
        }
        // Not known for the moment in which the tick drops its queue.
        let end = self.status.end.ok_or(Refusal::State(self.status.state))?;
        check_finite(offered)?;
        if offered.number != self.status.next {
            return Err(Refusal::MoveNumber {
                expected: self.status.next,
            });
        }
        check_duration(offered, self.longest())?;
        if offered.from != end.pose {
            return Err(Refusal::StartPose);
        }
        if offered.start_velocity != <[N; 3]>::from(end.velocity) {
            return Err(Refusal::StartVelocity);
        }
        check_tool(offered)?;
        if self.room() == 0 || !self.offered.0.send(*offered) {
            return Err(Refusal::QueueFull);
        }
        self.status.refused = None;
        self.status.next = self.status.next.wrapping_add(1);
        self.status.end = Some(ends(offered.to, offered.end_velocity));
        Ok(())
    }

    /// One step of the admission. Whether there is more to do.
    #[inline(never)]
    pub(super) fn check_step(&mut self) -> bool {
        let Some(offered) = self.offered.1.peek() else {
            return false;
        };
        if !self.checking {
            let path = &self.coefficients.borrow().path;
            self.judgement.offer(path, offered);
            self.checking = true;
            return true;
        }
        match self.judgement.step(&self.coefficients.borrow().path) {
            admission::Verdict::Undecided => true,
            admission::Verdict::Admitted => {
                if self.moves.has_room() {
                    self.admit();
                }
                // Else it stays admitted until there is room.
                self.offered.1.peek().is_some() && self.moves.has_room()
            }
            admission::Verdict::Refused(violation) => {
                self.refuse(violation);
                false
            }
            // The admission has nothing to judge: it is offered again.
            admission::Verdict::Nothing => {
                self.checking = false;
                true
            }
        }
    }

    #[inline(never)]
    fn admit(&mut self) {
        let Some(offered) = self.offered.1.receive() else {
            return;
        };
        self.checking = false;
        let planned = QueuedMove {
            segment: segment(&offered, self.settings.period),
            ticks: offered.ticks,
            number: offered.number,
            tool: Tool::of(&offered),
            generation: self.generation,
        };
        if !self.moves.send(planned) {
            return;
        }
        self.ahead = self.ahead.and(offered.ticks, offered.ends_at_rest());
        self.shared.set_ahead(self.ahead);
        self.status.admitted = offered.number.wrapping_add(1);
        self.push_event(Event::Verdict(Verdict {
            number: offered.number,
            violation: None,
        }));
    }

    /// The oldest offered move is not admitted: it and all behind it are dropped, and the next to
    /// offer takes its place.
    fn refuse(&mut self, violation: trirrr_protocol::message::Violation<N>) {
        let Some(offered) = self.offered.1.receive() else {
            return;
        };
        while self.offered.1.receive().is_some() {}
        self.checking = false;
        self.status.next = offered.number;
        self.status.end = Some(ends(offered.from, offered.start_velocity));
        let verdict = Verdict {
            number: offered.number,
            violation: Some(violation),
        };
        self.status.refused = Some(verdict);
        self.push_event(Event::Verdict(verdict));
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
pub fn check_offer<N: Number>(offered: &Move<N>, longest: u32) -> Result<(), Refusal<N>> {
    check_finite(offered)?;
    check_duration(offered, longest)?;
    check_tool(offered)
}

fn check_duration<N: Number>(offered: &Move<N>, longest: u32) -> Result<(), Refusal<N>> {
    match offered.ticks {
        ticks if ticks != 0 && ticks <= longest => Ok(()),
        _ => Err(Refusal::Duration { longest }),
    }
}

fn check_tool<N: Number>(offered: &Move<N>) -> Result<(), Refusal<N>> {
    match Tool::is_one(offered) {
        true => Ok(()),
        false => Err(Refusal::Tool),
    }
}

/// The move as the tick plays it.
fn segment<N: Number>(offered: &Move<N>, period: N::Factor) -> Segment<N> {
    let (from, to, ticks) = (offered.from, offered.to, offered.ticks);
    if offered.is_rest_to_rest() {
        return Segment::RestToRest(RestToRest::new(from, to, ticks, period));
    }
    let start = Vector3::from(offered.start_velocity);
    let end = Vector3::from(offered.end_velocity);
    Segment::Hermite(Hermite::new(from, start, to, end, ticks, period))
}

fn check_finite<N: Number>(offered: &Move<N>) -> Result<(), Refusal<N>> {
    let pose = |pose: &Pose<N>| {
        pose.position.x.is_finite() && pose.position.y.is_finite() && N::angle_is_finite(pose.angle)
    };
    let all = |values: &[N; 3]| values.iter().all(|value| value.is_finite());
    let finite = pose(&offered.from)
        && pose(&offered.to)
        && all(&offered.start_velocity)
        && all(&offered.end_velocity)
        && offered.tool_power.is_finite()
        && offered.tool_speed.is_finite();
    finite.then_some(()).ok_or(Refusal::NotFinite)
}
