//! Ends of the tick: where its moves and orders come from, and where its reports go.

use super::super::handoff::{Ahead, Order, QueuedMove, Recover, SharedCounters, TickReport};
use super::super::queue::{Receiver, Sender};
use super::Foreground;
use crate::feature::Feature;
use crate::interlock::InterlockReadings;
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, QuinticsOf, Scene};
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::{Fault, Telemetry};

/// Ends of a tick of the scene `S`: [those of a background](ForegroundEnds), or [a job of its own](crate::features::OwnJob). A type, so that a
/// tick has the code of one of them.
pub trait TickEnds<S: Scene>: Sized {
    /// Chains of moves that take the place of what is queued.
    type Splices: Feature;

    /// The pace along a path may change: there is something that slows it down.
    const CHANGES_PACE: bool;

    /// All moves of a path are there before it begins, and the last ends at rest: the path can come to rest wherever it is.
    const IS_WHOLE: bool;

    /// Counters that a background reads, if there is one.
    fn shared(&self) -> Option<&SharedCounters>;

    /// The next move.
    fn next_move(&self) -> Option<&QueuedMove<S::N, CurvesOf<S>>>;

    /// The same, taken out.
    fn take_move(&mut self) -> Option<QueuedMove<S::N, CurvesOf<S>>>;

    /// Moves that wait, and places for moves.
    fn fill(&self) -> [usize; 2];

    /// Account of what is admitted.
    fn ahead(&self) -> Ahead;

    /// Drops all moves, unless a generation tells those that are over.
    fn drop_moves(&mut self);

    /// The recovery that waits or is under way.
    fn recovery(&self) -> Option<&Recover<S::N>>;

    /// The same, taken out.
    fn take_recovery(&mut self) -> Option<Recover<S::N>>;

    /// Takes an order, and obeys it. Returns true if a path started in this tick.
    fn take_order(tick: &mut Foreground<'_, S, Self>) -> bool;

    /// Takes what contacts tell, those that give orders.
    fn sense(&mut self, readings: InterlockReadings);

    /// Tells of a fault, which is the first.
    fn tell_fault(&mut self, fault: Fault<S::N>);

    /// Reports what changed in the tick, and samples it.
    fn report(tick: &mut Foreground<'_, S, Self>, setpoint: &Setpoint<S::N>);
}

/// The ends that belong to the tick of a machine with a background.
pub struct ForegroundEnds<'q, S: Scene> {
    pub(crate) moves: Receiver<'q, QueuedMove<S::N, CurvesOf<S>>>,
    pub(crate) recoveries: Receiver<'q, Recover<S::N>>,
    pub(crate) orders: Receiver<'q, Order>,
    pub(crate) reports: Sender<'q, TickReport<S>>,
    pub(crate) faults: Sender<'q, Fault<S::N>>,
    pub(crate) samples: Sender<'q, Telemetry<S::N>>,
    pub(crate) shared: &'q SharedCounters,
}

impl<N: ServiceNumber, S: Scene<N = N>> TickEnds<S> for ForegroundEnds<'_, S> {
    type Splices = QuinticsOf<S>;
    const CHANGES_PACE: bool = true;
    const IS_WHOLE: bool = false;

    #[inline(always)]
    fn shared(&self) -> Option<&SharedCounters> {
        Some(self.shared)
    }

    #[inline(always)]
    fn next_move(&self) -> Option<&QueuedMove<N, CurvesOf<S>>> {
        self.moves.peek()
    }

    #[inline(always)]
    fn take_move(&mut self) -> Option<QueuedMove<N, CurvesOf<S>>> {
        self.moves.receive()
    }

    #[inline(always)]
    fn fill(&self) -> [usize; 2] {
        [self.moves.len(), self.moves.capacity()]
    }

    #[inline(always)]
    fn ahead(&self) -> Ahead {
        self.shared.ahead()
    }

    #[inline(always)]
    fn drop_moves(&mut self) {}

    #[inline(always)]
    fn recovery(&self) -> Option<&Recover<N>> {
        self.recoveries.peek()
    }

    #[inline(always)]
    fn take_recovery(&mut self) -> Option<Recover<N>> {
        self.recoveries.receive()
    }

    #[inline(always)]
    fn take_order(tick: &mut Foreground<'_, S, Self>) -> bool {
        tick.take_queued_order()
    }

    #[inline(always)]
    fn sense(&mut self, _: InterlockReadings) {}

    #[inline(always)]
    fn tell_fault(&mut self, fault: Fault<N>) {
        // There is room: the one before was taken before it was cleared.
        self.faults.send(fault);
    }

    #[inline(always)]
    fn report(tick: &mut Foreground<'_, S, Self>, setpoint: &Setpoint<N>) {
        tick.report();
        tick.sample(setpoint);
    }
}
