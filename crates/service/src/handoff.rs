//! Data that the two halves of the service hand to each other.
//!
//! | from | to | by | what |
//! |---|---|---|---|
//! | background | tick | queue | admitted moves ([`QueuedMove`]); the first is under way |
//! | background | tick | queue | a recovery ([`Recover`]) |
//! | background | tick | queue | orders ([`Order`]) |
//! | background | tick | queues | chains of moves, and where they begin ([`splice`](super::splice)) |
//! | tick | background | queue | where it stands, after each change ([`TickReport`]) |
//! | tick | background | queue | a fault |
//! | tick | background | queue | telemetry samples |
//! | each | the other | [`SharedCounters`] | counters, each with one writer |

use super::feature::Of;
use super::feedback::FeedbackReport;
use super::interlock::ProbeLatch;
use super::pace::{MovePaces, Room};
use super::scene::{QuinticsOf, Scene};
use super::splice::SpliceReport;
use super::tool::Tool;
use crate::offered::Offered;
use core::sync::atomic::{AtomicU32, Ordering, fence};
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::{CurveKind, JointMove, Pose, Segment};
use trirrr_core::to_source;
use trirrr_protocol::message::{
    Acting, AnyMove, DigitalStates, InputStates, Interruption, Move, State, TelemetryFields,
};

/// A move that is admitted, as the tick plays it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueuedMove<N: Number, K: CurveKind> {
    pub(super) segment: Segment<N, K>,
    pub(super) ticks: u32,
    pub(super) number: u32,
    pub(super) tool: Option<Tool<N>>,
    /// Rates at which the pace may change on it.
    pub(super) paces: MovePaces,
    /// Generation of the queue: what was queued before the queue was dropped is not played.
    pub(super) generation: u8,
}

to_source!([N: Number, K: CurveKind] QueuedMove [N, K] in trirrr_service::board {
    segment: Segment<N, K>,
    ticks: u32,
    number: u32,
    tool: Option<Tool<N>>,
    paces: MovePaces,
    generation: u8,
});

impl<N: Number, K: CurveKind> QueuedMove<N, K> {
    /// Move that was admitted with the rates `paces`, in ticks of `period`. None if it is of a kind that is not played.
    pub fn of(admitted: &AnyMove<N>, paces: MovePaces, period: N::Factor) -> Option<Self> {
        Some(Self::new(&Offered::of(admitted)?, paces, 0, period))
    }

    #[inline(always)]
    pub(crate) fn new(
        offered: &Offered<N, K>,
        paces: MovePaces,
        generation: u8,
        period: N::Factor,
    ) -> Self {
        let Move { ticks, number, .. } = offered.common;
        Self {
            segment: Segment::new(&offered.ends(), ticks, period),
            ticks,
            number,
            tool: Tool::of(&offered.common),
            paces,
            generation,
        }
    }
}

/// Order to the tick. The tick takes one order each time it runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Order {
    Start,
    /// The same, until the probe's contact changes.
    Probe {
        away: bool,
    },
    Hold,
    Resume,
    Stop,
    ClearFault,
    Enable,
    Disable,
    /// The machine stands at the pose of the recovery at the head of its queue.
    Place,
    /// Samples of the drives.
    Drives {
        every: u16,
    },
    /// The recovery at the head of its queue.
    Recover,
    Telemetry {
        every: u16,
        fields: TelemetryFields,
    },
    /// The pace that the host asks for, in percent of normal speed.
    FeedOverride {
        percent: u8,
    },
    /// A new scene is in its slot.
    Adopt,
    /// Changes spare outputs.
    Output {
        on: u8,
        off: u8,
    },
    /// Homing; the way from where it ends is the recovery at the head of its queue.
    Home,
}

/// A recovery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recover<N: Number> {
    pub(super) path: JointMove<N>,
    /// The pose at its end.
    pub(super) to: Pose<N>,
}

to_source!([N: Number] Recover [N] in trirrr_service::board { path: JointMove<N>, to: Pose<N> });

/// State of the tick, after something changed.
pub(super) struct TickReport<S: Scene> {
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
    /// Place at which the last job was left.
    pub(super) interrupted: Option<Interruption>,
    /// Pose of the platform; meant in idle only.
    pub(super) pose: Pose<S::N>,
    /// Angles of the motors; meant in idle, fault and cleared only.
    pub(super) angles: [<S::N as Arithmetic>::Angle; 3],
    /// Splices.
    pub(super) splice: Of<QuinticsOf<S>, SpliceReport>,
    /// Feedback.
    pub(super) feedback: Of<S::Feedback, FeedbackReport<S::N>>,
    /// Interlocks, with the state of the probe.
    pub(super) interlocks: Of<S::Interlocks, InputStates>,
    /// Probe.
    pub(super) probe: Of<S::Probe, ProbeLatch<S::N>>,
    /// Spare inputs and outputs.
    pub(super) digital: Of<S::Digital, DigitalStates>,
}

/// Counters, each with one writer. Loads and stores only: not every core has more.
#[derive(Debug, Default)]
pub struct SharedCounters {
    /// Requests heard. By the background.
    pub(super) heard: AtomicU32,
    /// The two rooms of an [`Ahead`]. By the background.
    room: [AtomicU32; 2],
    /// The rest of it.
    rests: AtomicU32,
    /// Ticks since the start. By the tick.
    pub(super) tick: AtomicU32,
    /// Samples dropped. By the tick.
    pub(super) lost: AtomicU32,
    /// Longest tick in counts of the board's timer. By the tick.
    pub(super) longest: AtomicU32,
    /// Ticks in which the queue was dry. By the tick.
    pub(super) dry: AtomicU32,
    /// Ticks that came too late. By the tick.
    pub(super) late: AtomicU32,
    /// Ticks of the longest way to rest. By the tick.
    pub(super) longest_stop: AtomicU32,
}

/// Account of the admitted moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ahead {
    /// Room of all moves of this generation that are admitted.
    pub(super) room: Room,
    /// One more than the number of the last of these moves that ends at rest: there a path can end without room.
    pub(super) rests: u32,
}

impl Ahead {
    /// Returns true if a move ends at rest of those from `number` on.
    pub(super) fn rests_from(&self, number: u32) -> bool {
        self.rests.wrapping_sub(number) as i32 > 0
    }
}

impl SharedCounters {
    pub(super) const fn new() -> Self {
        Self {
            heard: AtomicU32::new(0),
            // Memory that starts as zeros takes no flash.
            room: [const { AtomicU32::new(0) }; 2],
            rests: AtomicU32::new(0),
            tick: AtomicU32::new(0),
            lost: AtomicU32::new(0),
            longest: AtomicU32::new(0),
            dry: AtomicU32::new(0),
            late: AtomicU32::new(0),
            longest_stop: AtomicU32::new(0),
        }
    }

    /// Says what is admitted; after the moves themselves are in their queue. Who sees one of the words sees the moves.
    pub(super) fn set_ahead(&self, ahead: Ahead) {
        fence(Ordering::Release);
        for (shared, room) in self.room.iter().zip(ahead.room.0) {
            shared.store(room, Ordering::Relaxed);
        }
        self.rests.store(ahead.rests, Ordering::Relaxed);
    }

    /// Returns what is admitted. The moves themselves are in their queue by then. While a move is added some of the words may be of
    /// before: the room is more than that up to the last rest, beyond which alone it is asked for, or it is less than there is.
    #[inline]
    pub(super) fn ahead(&self) -> Ahead {
        let rests = self.rests.load(Ordering::Relaxed);
        let [any, half] = &self.room;
        let room = Room([any, half].map(|room| room.load(Ordering::Relaxed)));
        fence(Ordering::Acquire);
        Ahead { room, rests }
    }
}

/// Adds one, for the counter's only writer.
#[inline]
pub(super) fn count(counter: &AtomicU32) {
    let value = counter.load(Ordering::Relaxed);
    counter.store(value.wrapping_add(1), Ordering::Relaxed);
}
