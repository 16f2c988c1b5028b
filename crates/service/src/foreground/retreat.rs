//! Back on the path, after a contact.

use super::super::feed::{PathPosition, Step};
use super::{Foreground, Path, Target, TickEnds};
use crate::feature::Optional;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::states::Known;
use trirrr_protocol::message::{FaultCode, State};

impl<N: ServiceNumber, S: Scene<N = N>, E: TickEnds<S>> Foreground<'_, S, E> {
    /// A fault of this kind brings the machine to rest: at a contact it is to go back then.
    #[inline]
    pub(super) fn want_retreat(&mut self, code: FaultCode) {
        if let Some(trail) = self.features.trail.get_mut() {
            trail.want(code.is_contact());
        }
    }

    /// Returns true while the machine goes back.
    #[inline]
    pub(super) fn goes_back(&self) -> bool {
        self.features
            .trail
            .get()
            .is_some_and(|trail| trail.is_under_way())
    }

    /// Number of the move that the machine is on, or of the last one: on the way back, of one before.
    #[inline]
    pub(super) fn number_under_way(&self) -> u32 {
        match &self.travel.current {
            Some(current) if self.goes_back() => current.number,
            _ => self.number(),
        }
    }

    /// Begins to go back from rest on the path. Returns false if that is not asked for, or there is no way.
    #[inline]
    pub(super) fn begin_retreat(&mut self) -> bool {
        let ticks = self
            .features
            .contact
            .get()
            .map_or(0, |contact| contact.retreat_ticks());
        let whole = 2 * self.travel.feed.top();
        let PathPosition { tick, part } = self.travel.position;
        let parts = u64::from(tick) * u64::from(whole) + u64::from(part);
        let on_path = matches!(self.travel.path, Path::Move | Path::Ended);
        let (Some(trail), Some(current), State::Reacting, true) = (
            self.features.trail.get_mut(),
            &self.travel.current,
            self.state,
            on_path,
        ) else {
            return false;
        };
        let begins = trail.begin(current, parts, ticks, whole);
        if begins {
            self.travel.path = Path::Move;
            self.travel.feed.end();
        }
        begins
    }

    /// Ends the way back at once: slows down.
    #[inline]
    pub(super) fn stop_retreat(&mut self) {
        if let Some(trail) = self.features.trail.get_mut() {
            trail.stop();
        }
    }

    /// A tick of the way back. At its end the machine stands, as after a stop.
    #[inline(never)]
    pub(super) fn go_back(&mut self) -> Target<N> {
        let levels = self.features.trail.get_mut().and_then(|trail| trail.step());
        let Some([before, level]) = levels else {
            self.end_motion(Known::POSE, self.acting);
            return Target::Setpoint(Self::standing(self.pose));
        };
        self.step_back(before + level);
        let Some(current) = &self.travel.current else {
            return Target::Setpoint(Self::standing(self.pose));
        };
        let mut on_path = current
            .segment
            .between(self.travel.position.tick, self.part());
        on_path.velocity = -on_path.velocity;
        let step = Step {
            level,
            slope: level as i32 - before as i32,
            parts: before + level,
        };
        Target::Setpoint(self.scaled(&on_path, step))
    }

    /// Lowers the position by `parts`, at most a tick, into the move before where the one under way began.
    fn step_back(&mut self, parts: u32) {
        let PathPosition { tick, part } = self.travel.position;
        if let Some(part) = part.checked_sub(parts) {
            self.travel.position.part = part;
            return;
        }
        let ticks = match tick {
            0 => {
                let Some(passed) = self
                    .features
                    .trail
                    .get_mut()
                    .and_then(|trail| trail.take_last())
                else {
                    // The way is not longer than the moves.
                    self.travel.position = PathPosition::START;
                    return;
                };
                self.travel.current = Some(passed.planned);
                passed.ticks
            }
            tick => tick,
        };
        self.travel.position = PathPosition {
            tick: ticks.saturating_sub(1),
            part: (part + 2 * self.travel.feed.top()).saturating_sub(parts),
        };
    }
}
