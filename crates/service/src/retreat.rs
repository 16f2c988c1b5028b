//! Retreats: after a contact the machine goes back on its path.
//!
//! The tick keeps the last moves of the job. A machine that has come to rest because of a contact plays them backward: the way
//! on which it came is free. With the path's time s running backward at the pace u, the velocity is -q' u and the
//! acceleration q'' u^2 - q' u': those of a motion forward whose pace changes by -u'. So the rates that the admission has proven
//! hold with their roles exchanged: a retreat speeds up at the rate of slowing down, and the other way round.

use crate::handoff::QueuedMove;
use crate::number::ServiceNumber;
use crate::pace::{MovePaces, Pace};
use heapless::Deque;
use trirrr_core::setpoint::CurveKind;

/// Moves that are kept.
const KEPT: usize = 16;

/// The last moves of a job, and the way back on them.
pub(crate) struct Trail<N: ServiceNumber, K: CurveKind> {
    /// The oldest at the front.
    moves: Deque<PassedMove<N, K>, KEPT>,
    /// A contact is the reason for which the machine comes to rest.
    wanted: bool,
    way: Option<WayBack>,
}

/// Move that was played.
pub(crate) struct PassedMove<N: ServiceNumber, K: CurveKind> {
    pub(crate) planned: QueuedMove<N, K>,
    /// Ticks after which the path went over into the next move.
    pub(crate) ticks: u32,
}

impl<N: ServiceNumber, K: CurveKind> Trail<N, K> {
    /// Trail without moves.
    pub(crate) fn new() -> Self {
        Self {
            moves: Deque::new(),
            wanted: false,
            way: None,
        }
    }

    /// Forgets the moves: a path begins, or is over.
    pub(crate) fn clear(&mut self) {
        self.moves.clear();
        self.wanted = false;
        self.way = None;
    }

    /// Keeps a move that was played for `ticks`, in the place of the oldest.
    pub(crate) fn keep(&mut self, planned: QueuedMove<N, K>, ticks: u32) {
        if self.moves.is_full() {
            self.moves.pop_front();
        }
        // There is room.
        let _ = self.moves.push_back(PassedMove { planned, ticks });
    }

    /// Takes the move before the one under way.
    pub(crate) fn take_last(&mut self) -> Option<PassedMove<N, K>> {
        self.moves.pop_back()
    }

    /// A contact brings the machine to rest, or another fault.
    pub(crate) fn want(&mut self, wanted: bool) {
        self.wanted = wanted;
    }

    /// Plans the way back from rest by `ticks` of path, `whole` parts each, at most to the oldest move kept. The machine rests
    /// `parts` beyond the start of `current`. Returns false where there is no way, or nobody wants one.
    pub(crate) fn begin(
        &mut self,
        current: &QueuedMove<N, K>,
        parts: u64,
        ticks: u32,
        whole: u32,
    ) -> bool {
        if !self.wanted {
            return false;
        }
        self.wanted = false;
        let wanted = u64::from(ticks) * u64::from(whole);
        let (mut length, mut rate) = (parts, rate_of(current));
        for passed in self.moves.iter().rev() {
            if length >= wanted {
                break;
            }
            length += u64::from(passed.ticks) * u64::from(whole);
            rate = rate.min(rate_of(&passed.planned));
        }
        self.way = WayBack::over(length.min(wanted), rate, whole / 4);
        self.way.is_some()
    }

    /// Takes the levels of the next tick of the way back: those at its start and at its end.
    pub(crate) fn step(&mut self) -> Option<[u32; 2]> {
        let levels = self.way.as_mut()?.step();
        if levels.is_none() {
            self.way = None;
        }
        levels
    }

    /// Ends the way back as soon as it can.
    pub(crate) fn stop(&mut self) {
        if let Some(way) = &mut self.way {
            way.stop();
        }
    }

    /// Returns true while the machine goes back.
    pub(crate) fn is_under_way(&self) -> bool {
        self.way.is_some()
    }
}

/// Rate at which the pace may change backward on a move, at up to half of normal speed: a quarter of the way from rest to
/// normal speed, in u^2.
fn rate_of<N: ServiceNumber, K: CurveKind>(planned: &QueuedMove<N, K>) -> u32 {
    let quarter = |[rest, normal]: [u8; 2]| (3 * u32::from(rest) + u32::from(normal)) / 4;
    let of = |Pace { slower, faster }| quarter(slower).min(quarter(faster));
    let parts = 0..1 << MovePaces::parts_log2(planned.ticks);
    let rates = parts.map(|index| of(planned.paces.of(index)));
    rates.min().unwrap_or(0)
}

/// Pace of a retreat: up, steady, down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct WayBack {
    /// Levels by which a tick changes the pace.
    rate: u32,
    /// Ticks of speeding up, and of slowing down,
    up: u32,
    /// and those between.
    steady: u32,
    /// Ticks that are over.
    tick: u32,
}

impl WayBack {
    /// Way of at most `length` parts at `rate` levels a tick, up to the level `most`. `None` where not even one tick up and one
    /// down fit in.
    fn over(length: u64, rate: u32, most: u32) -> Option<Self> {
        if rate == 0 {
            return None;
        }
        // Speeding up from 0 to k times the rate takes k^2 rates of parts, and so does slowing down.
        let by_length = (length / (2 * u64::from(rate))).isqrt();
        let up = by_length.min(u64::from(most / rate)) as u32;
        let of_ramps = 2 * u64::from(rate) * u64::from(up) * u64::from(up);
        let of_tick = 2 * u64::from(rate) * u64::from(up);
        let steady = (length - of_ramps).checked_div(of_tick)?;
        Some(Self {
            rate,
            up,
            steady: steady as u32,
            tick: 0,
        })
    }

    /// Slows down from now on.
    fn stop(&mut self) {
        let Self {
            up, steady, tick, ..
        } = *self;
        self.up = up.min(tick);
        self.steady = steady.min(tick.saturating_sub(up));
    }

    fn step(&mut self) -> Option<[u32; 2]> {
        let last = (2 * self.up).saturating_add(self.steady);
        if self.tick >= last {
            return None;
        }
        let level = |tick: u32| self.rate * tick.min(last - tick).min(self.up);
        let levels = [level(self.tick), level(self.tick + 1)];
        self.tick += 1;
        Some(levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// From rest to rest, never beyond the length nor faster than allowed, and little of the length is left.
        #[test]
        fn a_way_back_ends_at_rest_within_its_length(
            length in 0u64..1 << 44,
            rate in 0u32..=128,
            ramp in 1u32..=2000,
            stops in 0u32..=4000,
        ) {
            let top = 128 * ramp;
            let length = length % (u64::from(top) * 20_000);
            let Some(mut way) = WayBack::over(length, rate, top / 2) else {
                // Not even two ticks fit.
                prop_assert!(rate == 0 || length < 2 * u64::from(rate) || top / 2 < rate);
                return Ok(());
            };
            // Stopped at any time, it ends sooner: by the ramp from its pace.
            let mut stopped = way;
            let mut pace = 0;
            for _ in 0..stops {
                let Some([_, to]) = stopped.step() else { break };
                pace = to;
            }
            stopped.stop();
            let mut ticks = 0;
            while let Some([from, to]) = stopped.step() {
                prop_assert!(from == pace && to < from && from - to == rate);
                pace = to;
                ticks += 1;
            }
            prop_assert!(pace == 0 && ticks <= way.up);
            let (mut before, mut gone) = (0, 0u64);
            while let Some([from, to]) = way.step() {
                prop_assert_eq!(from, before);
                prop_assert!(to.abs_diff(from) <= rate && to <= top / 2);
                gone += u64::from(from + to);
                before = to;
            }
            prop_assert_eq!(before, 0);
            prop_assert!(gone <= length);
            // A tick at the pace, or one more level of the triangle.
            let highest = u64::from(way.rate) * u64::from(way.up);
            let lacks = 2 * highest + 4 * (highest + u64::from(rate));
            prop_assert!(length - gone <= lacks, "{} of {length}", length - gone);
        }
    }
}
