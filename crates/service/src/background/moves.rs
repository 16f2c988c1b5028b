//! Moves: what is offered, its admission, and the queue to the tick.

use super::super::feed::FeedScale;
use super::super::handoff::{Ahead, QueuedMove};
use super::super::offered::Offered;
use super::super::scene::Scene;
use super::super::tool::Tool;
use super::{Background, ends};
use crate::admission;
use crate::number::ServiceNumber;
use core::borrow::Borrow;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{CurveKind, Pose, Segment};
use trirrr_protocol::message::{AnyMove, Event, Move, Refusal, State, Verdict};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
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
    pub(super) fn offer(
        &mut self,
        common: &Move<N>,
        given: <S::Curves as CurveKind>::Accelerations<N>,
    ) -> Result<(), Refusal<N>> {
        match self.status.state {
            State::Idle | State::Running | State::Slowing | State::Holding => {}
            state => return Err(Refusal::State(state)),
        }
        // Not known for the moment in which the tick drops its queue.
        let before = self.status.end.ok_or(Refusal::State(self.status.state))?;
        let accelerations = S::Curves::given(&given);
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
        if self.room() == 0 || !self.offered.0.send(offered) {
            return Err(Refusal::QueueFull);
        }
        self.status.refused = None;
        self.status.next = self.status.next.wrapping_add(1);
        self.status.end = Some(ends(common.to, common.end_velocity, end_acceleration));
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
        let Move { ticks, number, .. } = offered.common;
        let planned = QueuedMove {
            segment: Segment::new(&offered.ends(), ticks, self.settings.period),
            ticks,
            number,
            tool: Tool::of(&offered.common),
            paces: self.judgement.paces(),
            generation: self.generation,
        };
        if !self.moves.send(planned) {
            return;
        }
        let measure = FeedScale::new(self.settings.ramp.ticks).room_measure();
        self.admitted.add_move(&planned.paces, ticks, &measure);
        if offered.common.ends_at_rest() {
            self.rests = number.wrapping_add(1);
        }
        self.shared.set_ahead(Ahead {
            room: self.admitted.room,
            rests: self.rests,
        });
        self.status.admitted = number.wrapping_add(1);
        self.push_event(Event::Verdict(Verdict {
            number,
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
        let verdict = Verdict {
            number,
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
    match Tool::is_one(offered) {
        true => Ok(()),
        false => Err(Refusal::Tool),
    }
}

fn check_finite<N: Number>(
    offered: &Move<N>,
    accelerations: Option<[[N; 3]; 2]>,
) -> Result<(), Refusal<N>> {
    let pose = |pose: &Pose<N>| {
        pose.position.x.is_finite() && pose.position.y.is_finite() && N::angle_is_finite(pose.angle)
    };
    let all = |values: &[N; 3]| values.iter().all(|value| value.is_finite());
    let finite = pose(&offered.from)
        && pose(&offered.to)
        && all(&offered.start_velocity)
        && all(&offered.end_velocity)
        && accelerations.is_none_or(|both| both.iter().all(all))
        && offered.tool_power.is_finite()
        && offered.tool_speed.is_finite();
    finite.then_some(()).ok_or(Refusal::NotFinite)
}
