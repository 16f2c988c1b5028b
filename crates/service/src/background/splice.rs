//! Retargets that cut the motion under way.
//!
//! The background asks the tick for its place, plans from a place that lies as far ahead as the last plans took, and
//! orders the cut. An order that comes too late is repeated from a place farther ahead; after some of them, and where the
//! queued moves end before, the goal is planned behind these moves.
//!
//! A goal that comes while a cut is ahead takes its place. Where the machine moves the cut is soon done, and the goal is planned from
//! behind it. Where the machine holds before the cut another chain begins at the same place: it is planned and proven while the
//! machine could still go on along the old one, and the tick stands while the two are exchanged.

use super::super::feed::FeedScale;
use super::super::handoff::Ahead;
use super::super::offered::Offered;
use super::super::pace::{Room, RoomCount};
use super::super::splice::{CHAIN, CutOrder, Place, SpliceOrder, SpliceReport};
use super::Background;
use super::retarget::target;
use crate::admission::{Aiming, Blocked, RetargetTask, Retargeted};
use crate::feature::Optional;
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, Scene};
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
    /// The cut is ahead, and another goal is to take its place.
    Replacing,
    /// Waits until the tick gives the chain of the cut ahead back.
    Withdrawing,
    /// Waits until the cut ahead is done: no chain begins there for the goal.
    Following,
    /// Waits for room behind the moves.
    Behind,
}

/// A retarget that cuts, and what is known for the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Retargeting<N: Number> {
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
    /// A cut is ahead while the goal is worked on.
    replaces: bool,
    /// The tick has given the chain of that cut back, and waits.
    withdrawn: bool,
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
            replaces: false,
            withdrawn: false,
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
        let Some(retargeting) = self.features.retargeting.get_mut() else {
            return false;
        };
        retargeting.goal = *goal;
        retargeting.tries = 0;
        retargeting.replaces = matches!(
            retargeting.phase,
            Phase::Ahead | Phase::Replacing | Phase::Following
        );
        retargeting.phase = match retargeting.replaces {
            true => Phase::Replacing,
            false => Phase::Waiting,
        };
        true
    }

    /// Returns true if another goal may take the place of the one that is worked on: nothing is planned for it at present, and the wait
    /// may be as long as a hold.
    #[inline(always)]
    pub(super) fn may_replace_goal(&self) -> bool {
        self.features.retargeting.get().is_some_and(|work| {
            matches!(
                work.phase,
                Phase::Ahead | Phase::Replacing | Phase::Following | Phase::Behind
            )
        })
    }

    /// Returns true while a retarget is planned, or its cut is ahead.
    #[inline(always)]
    pub(super) fn is_retargeting(&self) -> bool {
        let splice = self.features.retargeting.get();
        self.aim.is_under_way() || splice.is_some_and(|splice| splice.phase != Phase::None)
    }

    /// Name of the state of the retarget that cuts.
    #[cfg(test)]
    pub(crate) fn retarget_phase(&self) -> std::string::String {
        let phase = self.features.retargeting.get().map(|work| work.phase);
        std::format!("{phase:?}")
    }

    /// Gives up a retarget whose moves were dropped.
    #[inline(always)]
    pub(super) fn drop_splice(&mut self) {
        if let Some(retargeting) = self.features.retargeting.get_mut() {
            retargeting.phase = Phase::None;
            (retargeting.replaces, retargeting.withdrawn) = (false, false);
        }
    }

    /// Says whose account of the admitted moves is shared.
    #[inline(always)]
    pub(super) fn publish_generation(&self) {
        if let Some(splices) = self.features.splices.get() {
            splices.publish(self.view.generation);
        }
    }

    /// Returns true if admitted moves may go to the tick: there is room, and no cut move is before them.
    #[inline(always)]
    pub(super) fn takes_admitted(&mut self) -> bool {
        if let Some(retargeting) = self.features.retargeting.get_mut()
            && retargeting.drains
        {
            retargeting.drains = self.ends.moves.len() != 0;
            if retargeting.drains {
                return false;
            }
        }
        self.ends.moves.has_room()
    }

    /// One step of a retarget that cuts: returns whether there is more to do at once. None where other work may go on.
    #[inline(always)]
    pub(super) fn splice_step(&mut self) -> Option<bool> {
        let retargeting = self.features.retargeting.get()?;
        match retargeting.phase {
            Phase::None | Phase::Ahead | Phase::Following => None,
            _ => self.splice_work(),
        }
    }

    #[inline(never)]
    fn splice_work(&mut self) -> Option<bool> {
        let retargeting = self.features.retargeting.get()?;
        let is_answered = retargeting.orders == retargeting.report.orders;
        match retargeting.phase {
            Phase::None | Phase::Ahead | Phase::Following => None,
            Phase::Replacing if self.status.state != State::Holding => None,
            Phase::Replacing => {
                let at = retargeting.at;
                self.plan_from(at, 0)
            }
            Phase::Withdrawing if is_answered => {
                let accepted = retargeting.report.accepted;
                let retargeting = self.features.retargeting.get_mut()?;
                retargeting.withdrawn = accepted;
                match accepted {
                    // Its queue, once it is empty.
                    true => retargeting.chain = 1 - retargeting.chain.min(1),
                    // The machine goes on: soon the cut is done.
                    false => return self.follow(),
                }
                self.enter(Phase::Planning)
            }
            Phase::Waiting => self.locate(),
            Phase::Locating if is_answered => self.choose_place(),
            Phase::Locating => None,
            Phase::Planning => Some(self.plan_chain()),
            Phase::Ordered if is_answered => {
                match retargeting.report.accepted {
                    true => self.accept_chain(),
                    false => self.try_again(),
                }
                Some(true)
            }
            // No move is admitted that the chain may replace.
            Phase::Ordered | Phase::Withdrawing => Some(false),
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
        self.features.retargeting.get_mut()?.phase = phase;
        Some(true)
    }

    /// Asks the tick for its place.
    fn locate(&mut self) -> Option<bool> {
        let retargeting = self.features.retargeting.get_mut()?;
        let splices = self.features.splices.get_mut()?;
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
            number: self.view.begun.wrapping_sub(1),
            tick: self.features.retargeting.get()?.report.tick,
        };
        let lead = match state {
            State::Running | State::Slowing => self.features.retargeting.get()?.lead,
            // It stands there: from the next tick on the path, or from farther ahead where no motion begins there.
            State::Holding => 1 << self.features.retargeting.get()?.tries,
            _ => return self.enter(Phase::Behind),
        };
        self.plan_from(from, lead)
    }

    /// Begins to plan from so many ticks behind a place.
    fn plan_from(&mut self, from: Place, lead: u32) -> Option<bool> {
        let place = self.desk.offered.place_behind(from, lead);
        let most = place.as_ref().map_or(0, |(_, _, kept)| {
            self.desk
                .offered
                .capacity()
                .saturating_sub(*kept)
                .min(CHAIN)
        });
        let (Some((at, offered, _)), true) = (&place, most != 0) else {
            return match self.features.retargeting.get()?.replaces {
                true => self.follow(),
                false => self.enter(Phase::Behind),
            };
        };
        let ticks = offered.common.ticks;
        let start = Segment::new(&offered.ends(), ticks, self.settings.period).at(at.tick);
        let since = self.ends.shared.tick.load(Ordering::Relaxed);
        let retargeting = self.features.retargeting.get_mut()?;
        retargeting.at = *at;
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

    /// One step of the plan. Returns whether there is more to do at once.
    fn plan_chain(&mut self) -> bool {
        match self.aim.step(&self.coefficients.borrow().path) {
            Some(Retargeted::Undecided) => {}
            Some(Retargeted::Planned(count)) if count != 0 => return self.order_chain(count),
            Some(Retargeted::Refused(refusal)) => {
                let from_there = matches!(refusal.blocked, Blocked::Start | Blocked::Stop);
                let tries = self
                    .features
                    .retargeting
                    .get()
                    .map_or(TRIES, |work| work.tries);
                if from_there && tries < TRIES {
                    self.try_again();
                    return true;
                }
                self.tell_refused(refusal.violation);
                self.aim = Aiming::<N>::NONE;
                let replaces = self
                    .features
                    .retargeting
                    .get()
                    .is_some_and(|work| work.replaces);
                self.drop_splice();
                if replaces {
                    // The goal before it counts.
                    self.enter(Phase::Ahead);
                }
            }
            _ => self.try_again(),
        }
        true
    }

    /// Waits until the cut ahead is done, to plan from behind it.
    fn follow(&mut self) -> Option<bool> {
        self.aim = Aiming::<N>::NONE;
        self.enter(Phase::Following)
    }

    /// Plans from farther ahead, or behind the moves.
    fn try_again(&mut self) {
        self.aim = Aiming::<N>::NONE;
        let Some(retargeting) = self.features.retargeting.get_mut() else {
            return;
        };
        if retargeting.replaces {
            retargeting.phase = Phase::Following;
            return;
        }
        retargeting.lead = (2 * retargeting.lead).min(MOST_LEAD);
        retargeting.tries += 1;
        retargeting.phase = match retargeting.tries < TRIES {
            true => Phase::Waiting,
            false => Phase::Behind,
        };
    }

    /// Move `index` of the chain.
    fn planned_offer(&self, index: usize, first: u32) -> Option<Offered<N, CurvesOf<S>>> {
        let mut planned = self.aim.planned(index)?;
        planned.common.number = first.wrapping_add(index as u32);
        Offered::of_quintic(&planned)
    }

    /// Queues the chain and orders the cut. Returns whether there is more to do at once.
    #[inline(never)]
    fn order_chain(&mut self, count: usize) -> bool {
        let first = self.status.next;
        let feed = FeedScale::new(self.settings.ramp.ticks);
        let measure = feed.room_measure();
        let mut room = RoomCount::behind_any(&measure);
        // Of a chain that does not end at rest no move is the last at rest.
        let mut rests = self.status.done;
        let now = self.ends.shared.tick.load(Ordering::Relaxed);
        for index in 0..count {
            let Some(offered) = self.planned_offer(index, first) else {
                self.try_again();
                return true;
            };
            let paces = self.aim.paces(index);
            room.add_move(paces, offered.common.ticks, &measure);
            if offered.common.ends_at_rest() {
                rests = offered.common.number.wrapping_add(1);
            }
        }
        let ahead = Ahead {
            room: room.room,
            rests,
        };
        // A machine that comes to rest before the cut has to get there: until then nobody gives more.
        if !ahead.rests_from(first) && !feed.can_start(|x| Room::NONE.left(&ahead.room, x)) {
            self.try_again();
            return true;
        }
        if let Some(more) = self.give_chain_back() {
            return more;
        }
        for index in 0..count {
            if let Some(offered) = self.planned_offer(index, first) {
                let queued = self.queued(&offered, *self.aim.paces(index));
                if let (Some(retargeting), Some(splices)) = (
                    self.features.retargeting.get(),
                    self.features.splices.get_mut(),
                ) && let Some(chain) = splices.chains.get_mut(retargeting.chain)
                {
                    chain.send(queued);
                }
            }
        }
        let generation = self.view.generation;
        let (Some(retargeting), Some(splices)) = (
            self.features.retargeting.get_mut(),
            self.features.splices.get_mut(),
        ) else {
            return false;
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
            ahead,
            chain: retargeting.chain,
            generation,
        }));
        true
    }

    /// Has the tick give the chain of the cut ahead back, and waits until its queue is empty. None where that is so, or no cut is ahead;
    /// else whether there is more to do at once.
    fn give_chain_back(&mut self) -> Option<bool> {
        let retargeting = self.features.retargeting.get_mut()?;
        let splices = self.features.splices.get_mut()?;
        if !retargeting.replaces {
            return None;
        }
        if retargeting.withdrawn {
            let waits = splices.chains.get(retargeting.chain)?.len() != 0;
            return waits.then_some(false);
        }
        splices.orders.send(SpliceOrder::Withdraw);
        retargeting.orders = retargeting.orders.wrapping_add(1);
        self.enter(Phase::Withdrawing)
    }

    /// The tick has accepted the order: what is queued behind the place is not played any more.
    #[inline(never)]
    fn accept_chain(&mut self) {
        let Some(&Retargeting {
            at, moves, first, ..
        }) = self.features.retargeting.get()
        else {
            return;
        };
        self.desk.offered.cut_behind(at.number);
        self.features.drop_levels();
        self.admission.checking = false;
        for index in 0..moves {
            let Some(offered) = self.planned_offer(index, first) else {
                break;
            };
            self.desk.offered.add_admitted(offered);
            self.push_event(Event::Verdict(Verdict {
                number: offered.common.number,
                violation: None,
            }));
        }
        self.aim = Aiming::<N>::NONE;
        self.status.next = first.wrapping_add(moves as u32);
        self.status.admitted = self.status.next;
        if let Some(retargeting) = self.features.retargeting.get_mut() {
            self.status.end = Some(retargeting.target());
            retargeting.phase = Phase::Ahead;
            (retargeting.replaces, retargeting.withdrawn) = (false, false);
            retargeting.chain = 1 - retargeting.chain.min(1);
        }
    }

    /// Takes in what the tick reports of splices.
    #[inline(always)]
    pub(super) fn apply_splice(&mut self, report: Option<&SpliceReport>) {
        let (Some(report), Some(retargeting)) = (report, self.features.retargeting.get_mut())
        else {
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
            .features
            .retargeting
            .get()
            .is_some_and(|work| work.phase == Phase::Ordered)
        {
            self.accept_chain();
        }
        self.view.generation = self.view.generation.wrapping_add(1);
        let Some(retargeting) = self.features.retargeting.get_mut() else {
            return;
        };
        retargeting.cuts = cuts;
        retargeting.phase = Phase::None;
        if retargeting.replaces {
            retargeting.replaces = false;
            retargeting.phase = Phase::Waiting;
            self.aim = Aiming::<N>::NONE;
        }
        retargeting.drains = true;
        let Place { number, tick: at } = retargeting.at;
        let next = retargeting.first;
        (self.admission.admitted, self.admission.rests) = (retargeting.room, retargeting.rests);
        self.status.cut = Some(Cut { number, at, next });
        self.ends.shared.set_ahead(Ahead {
            room: self.admission.admitted.room,
            rests: self.admission.rests,
        });
        self.publish_generation();
    }
}
