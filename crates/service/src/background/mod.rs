//! The half that talks and judges, below the tick.

mod contact;
mod control;
mod digital;
mod enable;
mod features;
mod interlock;
mod levels;
mod moves;
mod offers;

pub use moves::{check_offer, longest_move};
mod parts;
mod path;
mod receive;
mod retarget;
mod splice;
mod window;

use super::curves::PlayedCurves;
use super::handoff::{Ahead, Order, QueuedMove, Recover, SharedCounters, TickReport};
use super::pace::{Room, RoomCount};
use super::planner::PathPlanner;
use super::queue::{BothEnds, Receiver, Sender};
use super::settings::Settings;
use crate::admission::{Aiming, Judgement};
use crate::feature::{Feature, Optional};
use crate::number::ServiceNumber;
use crate::scene::{ChangesOf, CoefficientsOf, CurvesOf, PartOf, PlannerOf, Scene};
use core::sync::atomic::{AtomicU32, Ordering};
pub(super) use features::BackgroundFeatures;
use nalgebra::Vector3;
pub(super) use offers::OfferedMoves;
pub(super) use splice::Retargeting;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_protocol::message::{
    Acting, DigitalStates, Event, Fault, InputStates, Message, MessageRef, Refusal, State, Status,
    Telemetry,
};
pub(super) use window::RequestWindow;

/// The half of the service that receives commands, judges moves and has what is to be sent.
pub struct Background<'q, S: Scene> {
    machine: S::Machine,
    update: S::Update,
    settings: Settings<S::N>,
    coefficients: CoefficientsOf<S>,
    admission: Admission<S::N, CurvesOf<S>>,
    /// The retarget that is being planned.
    aim: <CurvesOf<S> as PlayedCurves>::Aim<S::N>,
    ends: BackgroundEnds<'q, S>,
    features: BackgroundFeatures<'q, S>,
    /// Memory that the background works in.
    desk: Desk<'q, S>,

    greeted: bool,
    /// The last message was an event: a sample that waits comes before the next.
    was_event: bool,

    /// Status for the host, kept as it is sent. The state is the tick's, as far as known.
    /// It includes what the orders that the tick has not taken yet will make of it.
    /// The tick's counters and the room are those of the last time that somebody asked.
    status: Status<S::N>,
    view: TickView<S::N>,
    /// The job that was named last was left: offers without a name are of another.
    job_is_over: bool,
}

/// Admission of the offered moves.
struct Admission<N: ServiceNumber, K: PlayedCurves> {
    judgement: Judgement<N, K>,
    /// The oldest of the offered moves is with it.
    checking: bool,
    /// Room of all admitted moves.
    admitted: RoomCount,
    /// As in [`Ahead`].
    rests: u32,
}

/// State of the tick, as far as known.
struct TickView<N: Number> {
    /// The last state event.
    reported: (State, Acting, u32),
    generation: u8,
    /// Number of the first move that was not begun.
    begun: u32,
    /// Room of all parts that the tick has begun.
    passed: Room,
    angles: [N::Angle; 3],
    /// Orders so far, modulo 256.
    orders_sent: u8,
    /// Orders that have to be taken before a report has the state that the last of them makes; none where all reports have it.
    awaited: Option<u8>,
    /// The same of the angles.
    adopting: Option<u8>,
}

/// A pose at which moves end, at rest.
fn at_rest<N: Number>(pose: Pose<N>) -> Setpoint<N> {
    ends(pose, [N::ZERO; 3], [N::ZERO; 3])
}

/// A pose at which moves end, with its velocity, and the acceleration that a quintic goes on from.
fn ends<N: Number>(pose: Pose<N>, velocity: [N; 3], acceleration: [N; 3]) -> Setpoint<N> {
    Setpoint {
        pose,
        velocity: Vector3::from(velocity),
        acceleration: Vector3::from(acceleration),
    }
}

/// The ends that belong to the background.
pub(super) struct BackgroundEnds<'q, S: Scene> {
    pub(super) moves: Sender<'q, QueuedMove<S::N, CurvesOf<S>>>,
    pub(super) recoveries: Sender<'q, Recover<S::N>>,
    pub(super) orders: Sender<'q, Order>,
    pub(super) reports: Receiver<'q, TickReport<S>>,
    pub(super) faults: Receiver<'q, Fault<S::N>>,
    pub(super) samples: Receiver<'q, Telemetry<S::N>>,
    pub(super) shared: &'q SharedCounters,
}

/// Memory that the background works in.
pub(super) struct Desk<'q, S: Scene> {
    pub(super) planner: &'q mut PlannerOf<S>,
    pub(super) window: &'q mut RequestWindow<S>,
    pub(super) offered: OfferedMoves<'q, S::N, CurvesOf<S>>,
    pub(super) events: BothEnds<'q, Event<S::N>>,
}

impl<'q, N: ServiceNumber, S: Scene<N = N>> Background<'q, S> {
    pub(super) fn new(
        (machine, update): (S::Machine, S::Update),
        coefficients: CoefficientsOf<S>,
        (angles, inputs): ([N::Angle; 3], InputStates),
        settings: Settings<N>,
        (ends, features, desk): (
            BackgroundEnds<'q, S>,
            BackgroundFeatures<'q, S>,
            Desk<'q, S>,
        ),
    ) -> Self {
        let digital = features.digital.get().filter(|digital| digital.exist());
        let digital = digital.map(|_| DigitalStates::default());
        Self {
            machine,
            update,
            settings,
            coefficients,
            admission: Admission {
                judgement: Judgement::new(),
                checking: false,
                admitted: RoomCount::NOTHING,
                rests: 0,
            },
            aim: Aiming::<N>::NONE,
            ends,
            features,
            desk,
            greeted: false,
            was_event: false,
            status: Status {
                tick: 0,
                state: State::Disabled,
                acting: Acting::Nothing,
                fault: None,
                next: 0,
                admitted: 0,
                done: 0,
                piece: 0,
                planning: false,
                room: 0,
                refused: None,
                end: None,
                lost: 0,
                longest_tick: 0,
                dry_ticks: 0,
                late_ticks: 0,
                longest_stop: 0,
                feed_percent: 100,
                cut: None,
                interrupted: None,
                job: None,
                not_enabled: None,
                inputs,
                probe: None,
                digital,
            },
            view: TickView {
                reported: (State::Disabled, Acting::Nothing, 0),
                generation: 0,
                begun: 0,
                passed: Room::NONE,
                angles,
                orders_sent: 0,
                awaited: None,
                adopting: None,
            },
            job_is_over: false,
        }
    }

    /// A slice of background work, bounded: what the tick reported, then one step of the admission.
    /// Returns true if there is more to do at once.
    pub fn step(&mut self) -> bool {
        self.drain_reports();
        self.contact_step();
        match self.splice_step() {
            Some(more) => more,
            None => {
                self.place_step() || self.retarget_step() || self.check_step() || self.path_step()
            }
        }
    }

    /// Returns the message to send next: events and samples in turn.
    pub fn outgoing(&mut self) -> Option<Message<N, PartOf<S>>> {
        self.drain_reports();
        if self.is_event_next() {
            return self.desk.events.1.receive().map(Message::Event);
        }
        if self.sends_drives()
            && let Some(receiver) = self.features.feedback.get_mut()
        {
            return receiver.samples.receive().map(Message::Drives);
        }
        self.ends.samples.receive().map(Message::Telemetry)
    }

    /// Hands on what is to be sent next, as [`Background::outgoing`], from where it lies: a sample is
    /// not copied. Returns false if there was nothing.
    pub fn send_next(&mut self, send: impl FnOnce(&MessageRef<'_, N, PartOf<S>>)) -> bool {
        self.drain_reports();
        if self.is_event_next()
            && let Some(event) = self.desk.events.1.peek()
        {
            send(&MessageRef::Event(event));
            self.desk.events.1.discard();
        } else if self.sends_drives()
            && let Some(receiver) = self.features.feedback.get_mut()
            && let Some(sample) = receiver.samples.peek()
        {
            send(&MessageRef::Drives(sample));
            receiver.samples.discard();
        } else if let Some(sample) = self.ends.samples.peek() {
            send(&MessageRef::Telemetry(sample));
            self.ends.samples.discard();
        } else {
            return false;
        }
        true
    }

    /// Returns true if the next message is an event. Where samples wait too, they take turns: none starves the other.
    fn is_event_next(&mut self) -> bool {
        let waits = self.desk.events.1.peek().is_some();
        let sampled = self.ends.samples.peek().is_some() || self.sends_drives();
        self.was_event = waits && !(self.was_event && sampled);
        self.was_event
    }

    /// The next telemetry sample.
    pub fn sample(&mut self) -> Option<Telemetry<N>> {
        self.ends.samples.receive()
    }

    /// Returns the current status.
    pub fn status(&mut self) -> Status<N> {
        self.drain_reports();
        self.status.tick = self.ends.shared.tick.load(Ordering::Relaxed);
        self.status.room = self.room();
        self.status.planning = self.is_planning();
        self.status.lost = self.ends.shared.lost.load(Ordering::Relaxed);
        let counted = |counter: &AtomicU32| counter.load(Ordering::Relaxed);
        self.status.longest_tick = counted(&self.ends.shared.longest);
        self.status.dry_ticks = counted(&self.ends.shared.dry);
        self.status.late_ticks = counted(&self.ends.shared.late);
        self.status.longest_stop = counted(&self.ends.shared.longest_stop);
        self.status
    }

    /// Takes in what the tick reported.
    fn drain_reports(&mut self) {
        while let Some(report) = self.ends.reports.receive() {
            self.apply_report(&report);
        }
    }

    #[inline(never)]
    fn apply_report(&mut self, report: &TickReport<S>) {
        // Few orders are in flight.
        let is_ahead = |order: &u8| (report.orders.wrapping_sub(*order) as i8) < 0;
        self.view.awaited = self.view.awaited.filter(is_ahead);
        if ChangesOf::<S>::EXISTS {
            self.view.adopting = self.view.adopting.filter(is_ahead);
        }
        self.view.begun = report.begun;
        self.view.passed = report.passed;
        // An older report must not overwrite the angles predicted for changed encoder offsets in flight.
        if !ChangesOf::<S>::EXISTS || self.view.adopting.is_none() {
            self.view.angles = report.angles;
        }
        self.apply_splice(report.splice.get());
        self.apply_feedback(report.feedback.get(), report.pose);
        self.apply_interlocks(report.interlocks.get(), report.probe.get());
        self.apply_digital(report.digital.get());
        let over = report.generation != self.view.generation;
        if over {
            self.start_over(report);
        }
        if report.state.has_fault() {
            if let Some(fault) = self.ends.faults.receive() {
                self.status.fault = Some(fault);
                self.push_event(Event::Fault(fault));
            }
        } else {
            self.status.fault = None;
        }
        self.status.done = report.done;
        self.status.interrupted = report.interrupted;
        self.desk.offered.release(report.done);
        let reported = (report.state, report.acting, report.done);
        if self.view.reported != reported {
            self.view.reported = reported;
            self.push_event(Event::State {
                state: report.state,
                acting: report.acting,
                done: report.done,
            });
        }
        // An older report must not overwrite the state predicted for an order in flight.
        if over || self.view.awaited.is_none() {
            (self.status.state, self.status.acting) = (report.state, report.acting);
            if self.status.end.is_none() && self.status.state == State::Idle {
                self.status.end = Some(at_rest(report.pose));
            }
        }
    }

    /// The tick dropped its queue: so does the background.
    fn start_over(&mut self, report: &TickReport<S>) {
        self.view.generation = report.generation;
        self.desk.offered.clear();
        self.job_is_over = true;
        self.features.withdraw();
        self.admission.checking = false;
        self.aim = Aiming::<N>::NONE;
        self.desk.planner.drop_path();
        self.drop_splice();
        self.status.next = report.begun;
        self.status.admitted = report.begun;
        self.admission.admitted = RoomCount::NOTHING;
        self.admission.rests = report.begun;
        self.ends.shared.set_ahead(Ahead {
            room: Room::NONE,
            rests: self.admission.rests,
        });
        self.publish_generation();
        self.status.end = None;
    }

    /// An event on its way to the host. Where there is no room it is dropped: the status has it.
    fn push_event(&mut self, event: Event<N>) {
        self.desk.events.0.send(event);
    }

    /// Sends an order and, until the tick has taken it, counts on what it will make of the state. One that leaves the state as it is keeps no
    /// report back: a host may send one in each tick.
    fn order(&mut self, order: Order, state: State) -> Result<(), Refusal<N>> {
        self.order_as(order, state, self.status.acting)
    }

    /// The same of an order that also makes the reason for which the machine stands or goes on.
    #[inline(never)]
    fn order_as(&mut self, order: Order, state: State, acting: Acting) -> Result<(), Refusal<N>> {
        if !self.ends.orders.send(order) {
            return Err(Refusal::Busy);
        }
        self.view.orders_sent = self.view.orders_sent.wrapping_add(1);
        if (self.status.state, self.status.acting) != (state, acting) {
            (self.status.state, self.status.acting) = (state, acting);
            self.view.awaited = Some(self.view.orders_sent);
        }
        Ok(())
    }
}
