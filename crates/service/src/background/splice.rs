//! Retargets that cut the motion under way.
//!
//! The background asks the tick for its place, plans from a place that lies as far ahead as the last plans took, and
//! orders the cut. An order that comes too late is repeated from a place farther ahead; after some of them, and where the
//! queued moves end before, the goal is planned behind these moves.

use super::super::feed::FeedScale;
use super::super::handoff::Ahead;
use super::super::offered::Offered;
use super::super::pace::RoomCount;
use super::super::scene::Scene;
use super::super::splice::{CHAIN, CutOrder, Optional, Place, SpliceOrder, SpliceReport};
use super::Background;
use super::retarget::target;
use crate::admission::{Aiming, Blocked, RetargetTask, Retargeted};
use crate::number::ServiceNumber;
use core::borrow::Borrow;
use core::sync::atomic::Ordering;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Segment, Setpoint};
use trirrr_protocol::message::{Cut, Event, Goal, State, Verdict};

/// Fewest ticks from the place of the tick to that of a cut.
const LEAST_LEAD: u32 = 8;

/// Most ticks likewise.
const MOST_LEAD: u32 = 1 << 20;

/// Plans that may be late before the goal is planned behind the moves.
const TRIES: u8 = 6;

/// State of a retarget that cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// None is under way.
    None,
    /// Waits until the queue of its chain is empty.
    Waiting,
    /// Waits for the place of the tick.
    Locating,
    /// Plans.
    Planning,
    /// Waits for the tick to accept the order.
    Ordered,
    /// The cut is ahead.
    Ahead,
    /// Waits for room behind the moves.
    Behind,
}

/// A retarget that cuts, and what is known for the next.
#[derive(Clone, Copy, Debug)]
pub struct Retargeting<N: Number> {
    phase: Phase,
    goal: Goal<N>,
    /// Ticks from the place of the tick to that of the cut.
    lead: u32,
    /// Plans that were late or had no motion.
    tries: u8,
    /// The tick's counter as the plan began.
    since: u32,
    /// Queue of the next chain.
    chain: usize,
    at: Place,
    /// Moves of the chain, and the number of its first.
    moves: usize,
    first: u32,
    room: RoomCount,
    rests: u32,
    /// Orders sent, and cuts done, modulo 256.
    orders: u8,
    cuts: u8,
    report: SpliceReport,
    /// Cut moves are still in the common queue.
    drains: bool,
}

impl<N: Number> Retargeting<N> {
    pub(crate) fn new(pose: Pose<N>) -> Self {
        Self {
            phase: Phase::None,
            goal: Goal {
                to: pose,
                velocity: [N::ZERO; 3],
                cut: true,
                least_ticks: 0,
            },
            lead: LEAST_LEAD,
            tries: 0,
            since: 0,
            chain: 0,
            at: Place { number: 0, tick: 0 },
            moves: 0,
            first: 0,
            room: RoomCount::NOTHING,
            rests: 0,
            orders: 0,
            cuts: 0,
            report: SpliceReport::default(),
            drains: false,
        }
    }

    fn target(&self) -> Setpoint<N> {
        target(&self.goal)
    }
}

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Begins a retarget that cuts. Returns false in services without.
    #[inline(always)]
    pub(super) fn begin_splice(&mut self, goal: &Goal<N>) -> bool {
        let Some(retargeting) = self.retargeting.get_mut() else {
            return false;
        };
        retargeting.goal = *goal;
        retargeting.tries = 0;
        retargeting.phase = Phase::Waiting;
        true
    }

    /// Returns true while a retarget is planned, or its cut is ahead.
    #[inline(always)]
    pub(super) fn is_retargeting(&self) -> bool {
        let splice = self.retargeting.get();
        self.aim.is_under_way() || splice.is_some_and(|splice| splice.phase != Phase::None)
    }

    /// Gives up a retarget whose moves were dropped.
    #[inline(always)]
    pub(super) fn drop_splice(&mut self) {
        if let Some(retargeting) = self.retargeting.get_mut() {
            retargeting.phase = Phase::None;
        }
    }

    /// Says whose account of the admitted moves is shared.
    #[inline(always)]
    pub(super) fn publish_generation(&self) {
        if let Some(splices) = self.splices.get() {
            splices.publish(self.generation);
        }
    }

    /// Returns true if admitted moves may go to the tick: there is room, and no cut move is before them.
    #[inline(always)]
    pub(super) fn takes_admitted(&mut self) -> bool {
        if let Some(retargeting) = self.retargeting.get_mut()
            && retargeting.drains
        {
            retargeting.drains = self.moves.len() != 0;
            if retargeting.drains {
                return false;
            }
        }
        self.moves.has_room()
    }

    /// One step of a retarget that cuts: returns whether there is more to do at once. None where other work may go on.
    #[inline(always)]
    pub(super) fn splice_step(&mut self) -> Option<bool> {
        let retargeting = self.retargeting.get()?;
        match retargeting.phase {
            Phase::None | Phase::Ahead => None,
            _ => self.splice_work(),
        }
    }

    #[inline(never)]
    fn splice_work(&mut self) -> Option<bool> {
        let retargeting = self.retargeting.get()?;
        let is_answered = retargeting.orders == retargeting.report.orders;
        match retargeting.phase {
            Phase::None | Phase::Ahead => None,
            Phase::Waiting => self.locate(),
            Phase::Locating if is_answered => self.choose_place(),
            Phase::Locating => None,
            Phase::Planning => {
                self.plan_chain();
                Some(true)
            }
            Phase::Ordered if is_answered => {
                match retargeting.report.accepted {
                    true => self.accept_chain(),
                    false => self.try_again(),
                }
                Some(true)
            }
            // No move is admitted that the chain may replace.
            Phase::Ordered => Some(false),
            Phase::Behind => {
                let before = self.status.end?;
                if self.room() == 0 {
                    return None;
                }
                let goal = retargeting.goal;
                self.drop_splice();
                self.aim_from(&before, &goal);
                Some(true)
            }
        }
    }

    fn enter(&mut self, phase: Phase) -> Option<bool> {
        self.retargeting.get_mut()?.phase = phase;
        Some(true)
    }

    /// Asks the tick for its place.
    fn locate(&mut self) -> Option<bool> {
        let retargeting = self.retargeting.get_mut()?;
        let splices = self.splices.get_mut()?;
        let chain = splices.chains.get(retargeting.chain)?;
        if chain.len() != 0 || !splices.orders.send(SpliceOrder::Locate) {
            return None;
        }
        retargeting.orders = retargeting.orders.wrapping_add(1);
        self.enter(Phase::Locating)
    }

    /// Chooses the place of the cut, and begins to plan from there.
    fn choose_place(&mut self) -> Option<bool> {
        let state = self.status.state;
        let from = Place {
            number: self.begun.wrapping_sub(1),
            tick: self.retargeting.get()?.report.tick,
        };
        let lead = match state {
            State::Running | State::Slowing => self.retargeting.get()?.lead,
            // It stands there: from the next tick on the path.
            State::Holding => 1,
            _ => return self.enter(Phase::Behind),
        };
        let Some((at, offered, kept)) = self.offered.place_behind(from, lead) else {
            return self.enter(Phase::Behind);
        };
        let most = self.offered.capacity().saturating_sub(kept).min(CHAIN);
        if most == 0 {
            return self.enter(Phase::Behind);
        }
        let ticks = offered.common.ticks;
        let start = Segment::new(&offered.ends(), ticks, self.settings.period).at(at.tick);
        let since = self.shared.tick.load(Ordering::Relaxed);
        let retargeting = self.retargeting.get_mut()?;
        retargeting.at = at;
        retargeting.since = since;
        let task = RetargetTask {
            start,
            target: retargeting.target(),
            most,
            least: retargeting.goal.least_ticks,
        };
        self.aim.aim(&self.coefficients.borrow().path, &task);
        self.enter(Phase::Planning)
    }

    /// One step of the plan.
    fn plan_chain(&mut self) {
        match self.aim.step(&self.coefficients.borrow().path) {
            Some(Retargeted::Undecided) => {}
            Some(Retargeted::Planned(count)) if count != 0 => self.order_chain(count),
            Some(Retargeted::Refused(refusal)) => {
                let from_there = matches!(refusal.blocked, Blocked::Start | Blocked::Stop);
                let tries = self.retargeting.get().map_or(TRIES, |work| work.tries);
                if from_there && tries < TRIES {
                    return self.try_again();
                }
                self.tell_refused(refusal.violation);
                self.aim = Aiming::<N>::NONE;
                self.drop_splice();
            }
            _ => self.try_again(),
        }
    }

    /// Plans from farther ahead, or behind the moves.
    fn try_again(&mut self) {
        self.aim = Aiming::<N>::NONE;
        let Some(retargeting) = self.retargeting.get_mut() else {
            return;
        };
        retargeting.lead = (2 * retargeting.lead).min(MOST_LEAD);
        retargeting.tries += 1;
        retargeting.phase = match retargeting.tries < TRIES {
            true => Phase::Waiting,
            false => Phase::Behind,
        };
    }

    /// Move `index` of the chain.
    fn planned_offer(&self, index: usize, first: u32) -> Option<Offered<N, S::Curves>> {
        let mut planned = self.aim.planned(index)?;
        planned.common.number = first.wrapping_add(index as u32);
        Offered::of_quintic(&planned)
    }

    /// Queues the chain and orders the cut.
    #[inline(never)]
    fn order_chain(&mut self, count: usize) {
        let first = self.status.next;
        let measure = FeedScale::new(self.settings.ramp.ticks).room_measure();
        let mut room = RoomCount::behind_any(&measure);
        // Of a chain that does not end at rest no move is the last at rest.
        let mut rests = self.status.done;
        let now = self.shared.tick.load(Ordering::Relaxed);
        for index in 0..count {
            let Some(offered) = self.planned_offer(index, first) else {
                return self.try_again();
            };
            let queued = self.queued(&offered, self.aim.paces(index));
            room.add_move(&queued.paces, queued.ticks, &measure);
            if offered.common.ends_at_rest() {
                rests = queued.number.wrapping_add(1);
            }
            let (Some(retargeting), Some(splices)) =
                (self.retargeting.get(), self.splices.get_mut())
            else {
                return;
            };
            if let Some(chain) = splices.chains.get_mut(retargeting.chain) {
                chain.send(queued);
            }
        }
        let generation = self.generation;
        let (Some(retargeting), Some(splices)) =
            (self.retargeting.get_mut(), self.splices.get_mut())
        else {
            return;
        };
        let took = now.wrapping_sub(retargeting.since);
        retargeting.lead = LEAST_LEAD + took.saturating_add(took / 2).min(MOST_LEAD);
        retargeting.moves = count;
        retargeting.first = first;
        retargeting.room = room;
        retargeting.rests = rests;
        retargeting.orders = retargeting.orders.wrapping_add(1);
        retargeting.phase = Phase::Ordered;
        // There is room: the order before was taken.
        splices.orders.send(SpliceOrder::Cut(CutOrder {
            at: retargeting.at,
            first,
            ahead: Ahead {
                room: room.room,
                rests,
            },
            chain: retargeting.chain,
            generation,
        }));
    }

    /// The tick has accepted the order: what is queued behind the place is not played any more.
    #[inline(never)]
    fn accept_chain(&mut self) {
        let Some(&Retargeting {
            at, moves, first, ..
        }) = self.retargeting.get()
        else {
            return;
        };
        self.offered.cut_behind(at.number);
        self.drop_levels();
        self.checking = false;
        for index in 0..moves {
            let Some(offered) = self.planned_offer(index, first) else {
                break;
            };
            self.offered.add_admitted(offered);
            self.push_event(Event::Verdict(Verdict {
                number: offered.common.number,
                violation: None,
            }));
        }
        self.aim = Aiming::<N>::NONE;
        self.status.next = first.wrapping_add(moves as u32);
        self.status.admitted = self.status.next;
        if let Some(retargeting) = self.retargeting.get_mut() {
            self.status.end = Some(retargeting.target());
            retargeting.phase = Phase::Ahead;
            retargeting.chain = 1 - retargeting.chain.min(1);
        }
    }

    /// Takes in what the tick reports of splices.
    #[inline(always)]
    pub(super) fn apply_splice(&mut self, report: Option<&SpliceReport>) {
        let (Some(report), Some(retargeting)) = (report, self.retargeting.get_mut()) else {
            return;
        };
        retargeting.report = *report;
        if report.cuts != retargeting.cuts {
            self.finish_cut(report.cuts);
        }
    }

    /// The cut is done.
    #[inline(never)]
    fn finish_cut(&mut self, cuts: u8) {
        if self
            .retargeting
            .get()
            .is_some_and(|work| work.phase == Phase::Ordered)
        {
            self.accept_chain();
        }
        self.generation = self.generation.wrapping_add(1);
        let Some(retargeting) = self.retargeting.get_mut() else {
            return;
        };
        retargeting.cuts = cuts;
        retargeting.phase = Phase::None;
        retargeting.drains = true;
        let Place { number, tick: at } = retargeting.at;
        let next = retargeting.first;
        (self.admitted, self.rests) = (retargeting.room, retargeting.rests);
        self.status.cut = Some(Cut { number, at, next });
        self.shared.set_ahead(Ahead {
            room: self.admitted.room,
            rests: self.rests,
        });
        self.publish_generation();
    }
}
