//! Data that the two halves of the service hand to each other.
//!
//! | from | to | by | what |
//! |---|---|---|---|
//! | background | tick | queue | admitted moves ([`QueuedMove`]); the first is under way |
//! | background | tick | queue | a recovery ([`Recover`]) |
//! | background | tick | queue | orders ([`Order`]) |
//! | tick | background | queue | where it stands, after each change ([`TickReport`]) |
//! | tick | background | queue | a fault |
//! | tick | background | queue | telemetry samples |
//! | each | the other | [`SharedCounters`] | counters, each with one writer |

use super::pace::{MovePaces, Room};
use super::tool::Tool;
use core::sync::atomic::{AtomicU32, Ordering};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{CurveKind, JointMove, Pose, Segment};
use trirrr_protocol::message::{Acting, State};

/// A move that is admitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct QueuedMove<N: Number, K: CurveKind> {
    pub(super) segment: Segment<N, K>,
    pub(super) ticks: u32,
    pub(super) number: u32,
    pub(super) tool: Option<Tool<N>>,
    /// Rates at which the pace may change on it.
    pub(super) paces: MovePaces,
    /// Generation of the queue: what was queued before the queue was dropped is not played.
    pub(super) generation: u8,
}

/// Order to the tick. The tick takes one order each time it runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Order {
    Start,
    Hold,
    Resume,
    Stop,
    ClearFault,
    /// The recovery at the head of its queue.
    Recover,
    Telemetry {
        every: u16,
    },
    /// The pace that the host asks for, in percent of normal speed.
    FeedOverride {
        percent: u8,
    },
    /// A new scene is in its slot.
    Adopt,
    /// Homing; the way from where it ends is the recovery at the head of its queue.
    Home,
}

/// A recovery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Recover<N: Number> {
    pub(super) path: JointMove<N>,
    /// The pose at its end.
    pub(super) to: Pose<N>,
}

/// State of the tick, after something changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TickReport<N: Number> {
    /// Orders taken so far, modulo 256.
    pub(super) orders: u8,
    pub(super) generation: u8,
    pub(super) state: State,
    pub(super) acting: Acting,
    /// Number of the first move that was not begun,
    pub(super) begun: u32,
    /// and of the first that is not over.
    pub(super) done: u32,
    /// Room of all parts of moves of this generation that were begun.
    pub(super) passed: Room,
    /// Pose of the platform; meant in idle only.
    pub(super) pose: Pose<N>,
    /// Angles of the motors; meant in idle, fault and cleared only.
    pub(super) angles: [N::Angle; 3],
}

/// Counters, each with one writer. Loads and stores only: not every core has more.
#[derive(Debug, Default)]
pub(super) struct SharedCounters {
    /// Requests heard. By the background.
    pub(super) heard: AtomicU32,
    /// Room on the admitted moves at half of normal speed. By the background.
    half_room: AtomicU32,
    /// The rest of an [`Ahead`] in one word. By the background.
    ahead: AtomicU32,
    /// Ticks since the start. By the tick.
    pub(super) tick: AtomicU32,
    /// Samples dropped. By the tick.
    pub(super) lost: AtomicU32,
    /// Longest tick in counts of the board's timer. By the tick.
    pub(super) longest: AtomicU32,
}

/// Account of the admitted moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ahead {
    /// Room of all moves of this generation that are admitted.
    pub(super) room: Room,
    /// True if the last of these moves ends at rest.
    pub(super) ends_at_rest: bool,
}

impl Ahead {
    pub(super) const NOTHING: Self = Self {
        room: Room::NONE,
        ends_at_rest: true,
    };
}

impl SharedCounters {
    pub(super) const fn new() -> Self {
        Self {
            heard: AtomicU32::new(0),
            // At rest is 0: memory that starts as zeros takes no flash.
            half_room: AtomicU32::new(0),
            ahead: AtomicU32::new(0),
            tick: AtomicU32::new(0),
            lost: AtomicU32::new(0),
            longest: AtomicU32::new(0),
        }
    }

    /// Says what is admitted; after the moves themselves are in their queue. Who sees the second word sees the first.
    pub(super) fn set_ahead(&self, ahead: Ahead) {
        let Room([room, half_room]) = ahead.room;
        self.half_room.store(half_room, Ordering::Relaxed);
        let word = room << 1 | u32::from(!ahead.ends_at_rest);
        self.ahead.store(word, Ordering::Release);
    }

    /// Returns what is admitted. The moves themselves are in their queue by then. Between the two words of a move that ends
    /// moving the room is that of before.
    #[inline]
    pub(super) fn ahead(&self) -> Ahead {
        let word = self.ahead.load(Ordering::Acquire);
        Ahead {
            room: Room([word >> 1, self.half_room.load(Ordering::Relaxed)]),
            ends_at_rest: word & 1 == 0,
        }
    }
}

/// Adds one, for the counter's only writer.
#[inline]
pub(super) fn count(counter: &AtomicU32) {
    let value = counter.load(Ordering::Relaxed);
    counter.store(value.wrapping_add(1), Ordering::Relaxed);
}
