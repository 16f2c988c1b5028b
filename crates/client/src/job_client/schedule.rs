//! Times of the next status and of the next order.

use crate::exchange::status_interval;
use std::time::Duration;
use trirrr_protocol::message::Identity;

/// Longest time from one status to the next while the line is idle.
const STATUS_EVERY: Duration = Duration::from_millis(100);

/// Shortest time from one status to the next where there is no news.
const SOON: Duration = Duration::from_millis(20);

/// Times of what comes next, counted from any start.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    /// Time from one status to the next.
    every: Duration,
    /// Time of the next status.
    look: Duration,
    /// Neither moves nor orders before this time.
    pause: Duration,
    /// The machine stands, takes nothing and changes nothing since then.
    idle_since: Option<Duration>,
}

impl Schedule {
    pub(super) fn new() -> Self {
        Self {
            every: STATUS_EVERY,
            look: Duration::ZERO,
            pause: Duration::ZERO,
            idle_since: None,
        }
    }

    /// Limits the time from one status to the next.
    pub(super) fn limit(&mut self, every: Duration) {
        self.every = self.every.min(every);
    }

    /// Asks so often that the host timeout of the machine never ends.
    pub(super) fn adapt_to(&mut self, identity: &Identity) {
        self.every = status_interval(self.every, identity);
    }

    /// Returns the time of the next status.
    pub(super) fn look(&self) -> Duration {
        self.look
    }

    /// Returns the time before which neither moves nor orders are sent.
    pub(super) fn pause(&self) -> Duration {
        self.pause
    }

    /// Takes note of a status that came at `now`.
    pub(super) fn looked(&mut self, now: Duration) {
        self.look = now + self.every;
    }

    /// Asks for the status at `now`.
    pub(super) fn look_at(&mut self, now: Duration) {
        self.look = self.look.min(now);
    }

    /// Asks for the status at `now`, unless the last one came a moment ago: moves that are judged or played are no news, and there
    /// may be a thousand in a second.
    pub(super) fn look_soon(&mut self, now: Duration) {
        let last = self.look.saturating_sub(self.every);
        self.look_at(now.max(last + self.every.min(SOON)));
    }

    /// Asks for the status after a moment, and sends neither moves nor orders before.
    pub(super) fn wait(&mut self, now: Duration) {
        self.pause = now + self.every / 4;
        self.look = self.pause;
    }

    /// Takes note of a machine that has refused something at `now`, and returns for how long it has done nothing else.
    pub(super) fn refused(&mut self, now: Duration) -> Duration {
        now.saturating_sub(*self.idle_since.get_or_insert(now))
    }

    /// Takes note of a machine that does something.
    pub(super) fn goes_on(&mut self) {
        self.idle_since = None;
    }

    /// Ends a pause: a stop is not to wait.
    pub(super) fn hurry(&mut self) {
        self.pause = Duration::ZERO;
    }
}
