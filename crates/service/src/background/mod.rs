//! The half that talks and judges, below the tick.

mod contact;
mod control;
mod digital;
mod enable;
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

pub(super) use super::contact::BackgroundContact;
use super::digital::BackgroundDigital;
use super::feedback::BackgroundFeedback;
use super::handoff::{Ahead, Order, QueuedMove, Recover, ReportOf, SharedCounters};
use super::interlock::InterlockKind;
use super::levels::BackgroundLevels;
use super::offered::PlayedCurves;
use super::pace::{Room, RoomCount};
use super::planner::PathPlanner;
use super::queue::{BothEnds, Receiver, Sender};
use super::scene::{Scene, Setup, Slot};
use super::settings::Settings;
use super::splice::{BackgroundSplices, Optional};
use crate::admission::{Aiming, Judgement};
use crate::number::ServiceNumber;
use core::sync::atomic::{AtomicU32, Ordering};
use nalgebra::Vector3;
pub(super) use offers::OfferedMoves;
pub(super) use splice::Retargeting;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_protocol::message::{
    Acting, Content, DigitalStates, Event, Fault, Message, MessageRef, Refusal, State, Status,
    Telemetry,
};
pub(super) use window::RequestWindow;

/// The half of the service that receives commands, judges moves and has what is to be sent.
pub struct Background<'q, S: Scene> {
    scene: S,
    settings: Settings<S::N>,
    coefficients: S::Coefficients,
    judgement: Judgement<S::N, S::Curves>,
    /// The retarget that is being planned.
    aim: <S::Curves as PlayedCurves>::Aim<S::N>,
    /// Cut by which it begins.
    retargeting: <S::Curves as PlayedCurves>::Retargeting<S::N>,

    /// Planner of paths.
    planner: &'q mut S::Planner,

    moves: Sender<'q, QueuedMove<S::N, S::Curves>>,
    recoveries: Sender<'q, Recover<S::N>>,
    orders: Sender<'q, Order>,
    setups: <S::Slot as Slot<Setup<S::Model>>>::Put<'q>,
    splices: BackgroundSplices<'q, S>,
    feedback: BackgroundFeedback<'q, S>,
    contact: BackgroundContact<'q, S>,
    levels: BackgroundLevels<'q, S>,
    digital: BackgroundDigital<'q, S>,
    reports: Receiver<'q, ReportOf<S>>,
    faults: Receiver<'q, Fault<S::N>>,
    samples: Receiver<'q, Telemetry<S::N>>,
    shared: &'q SharedCounters,

    offered: OfferedMoves<'q, S::N, S::Curves>,
    /// Events that wait to be sent; both ends are here.
    events: BothEnds<'q, Event<S::N>>,

    greeted: bool,
    window: &'q mut RequestWindow<S>,
    /// The last message was an event: a sample that waits comes before the next.
    was_event: bool,

    /// Status for the host, kept as it is sent. The state is the tick's, as far as known.
    /// It includes what the orders that the tick has not taken yet will make of it.
    /// The tick's counters and the room are those of the last time that somebody asked.
    status: Status<S::N>,
    /// The last state event.
    reported: (State, Acting, u32),
    generation: u8,
    begun: u32,
    /// Room of all parts that the tick has begun.
    passed: Room,
    angles: [<S::N as Arithmetic>::Angle; 3],
    orders_sent: u8,
    orders_taken: u8,
    /// Room of all admitted moves.
    admitted: RoomCount,
    /// As in [`Ahead`].
    rests: u32,
    /// The oldest of the offered moves is with the admission.
    checking: bool,
    /// The job that was named last was left: offers without a name are of another.
    job_is_over: bool,
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

/// Pose of the platform at the start, and the angles of the motors there.
pub(super) struct Stand<N: Number> {
    pub(super) angles: [N::Angle; 3],
    pub(super) pose: Pose<N>,
}

/// The ends that belong to the background.
pub(super) struct BackgroundEnds<'q, S: Scene> {
    pub(super) moves: Sender<'q, QueuedMove<S::N, S::Curves>>,
    pub(super) recoveries: Sender<'q, Recover<S::N>>,
    pub(super) orders: Sender<'q, Order>,
    pub(super) setups: <S::Slot as Slot<Setup<S::Model>>>::Put<'q>,
    pub(super) splices: BackgroundSplices<'q, S>,
    pub(super) feedback: BackgroundFeedback<'q, S>,
    pub(super) contact: BackgroundContact<'q, S>,
    pub(super) levels: BackgroundLevels<'q, S>,
    pub(super) digital: BackgroundDigital<'q, S>,
    pub(super) reports: Receiver<'q, ReportOf<S>>,
    pub(super) faults: Receiver<'q, Fault<S::N>>,
    pub(super) samples: Receiver<'q, Telemetry<S::N>>,
    pub(super) shared: &'q SharedCounters,
    pub(super) planner: &'q mut S::Planner,
    pub(super) window: &'q mut RequestWindow<S>,
    pub(super) offered: OfferedMoves<'q, S::N, S::Curves>,
    pub(super) events: BothEnds<'q, Event<S::N>>,
}

impl<'q, N: ServiceNumber, S: Scene<N = N>> Background<'q, S> {
    pub(super) fn new(
        scene: S,
        coefficients: S::Coefficients,
        stand: Stand<N>,
        settings: Settings<N>,
        ends: BackgroundEnds<'q, S>,
    ) -> Self {
        let inputs = scene.interlocks().states();
        let digital = scene.digital().are_named().then(DigitalStates::default);
        Self {
            scene,
            settings,
            coefficients,
            judgement: Judgement::new(),
            aim: Aiming::<N>::NONE,
            planner: ends.planner,
            retargeting: S::Curves::retargeting(stand.pose),
            moves: ends.moves,
            recoveries: ends.recoveries,
            orders: ends.orders,
            setups: ends.setups,
            splices: ends.splices,
            feedback: ends.feedback,
            contact: ends.contact,
            levels: ends.levels,
            digital: ends.digital,
            reports: ends.reports,
            faults: ends.faults,
            samples: ends.samples,
            shared: ends.shared,
            offered: ends.offered,
            events: ends.events,
            greeted: false,
            window: ends.window,
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
            reported: (State::Disabled, Acting::Nothing, 0),
            generation: 0,
            begun: 0,
            passed: Room::NONE,
            angles: stand.angles,
            orders_sent: 0,
            orders_taken: 0,
            admitted: RoomCount::NOTHING,
            rests: 0,
            checking: false,
            job_is_over: false,
        }
    }

    /// A slice of background work, bounded: what the tick reported, then one step of the admission.
    /// Whether there is more to do at once.
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
    pub fn outgoing(&mut self) -> Option<Message<N, S::Part>> {
        self.drain_reports();
        if self.is_event_next() {
            return self.events.1.receive().map(Message::Event);
        }
        if self.sends_drives()
            && let Some(receiver) = self.feedback.get_mut()
        {
            return receiver.samples.receive().map(Message::Drives);
        }
        self.samples.receive().map(Message::Telemetry)
    }

    /// Hands on what is to be sent next, as [`Background::outgoing`], from where it lies: a sample is
    /// not copied. Whether there was anything.
    pub fn send_next(&mut self, send: impl FnOnce(&MessageRef<'_, N, S::Part>)) -> bool {
        self.drain_reports();
        if self.is_event_next()
            && let Some(event) = self.events.1.peek()
        {
            send(&MessageRef::Event(event));
            self.events.1.discard();
        } else if self.sends_drives()
            && let Some(receiver) = self.feedback.get_mut()
            && let Some(sample) = receiver.samples.peek()
        {
            send(&MessageRef::Drives(sample));
            receiver.samples.discard();
        } else if let Some(sample) = self.samples.peek() {
            send(&MessageRef::Telemetry(sample));
            self.samples.discard();
        } else {
            return false;
        }
        true
    }

    /// Returns true if the next message is an event. Where samples wait too, they take turns: none starves the other.
    fn is_event_next(&mut self) -> bool {
        let waits = self.events.1.peek().is_some();
        let sampled = self.samples.peek().is_some() || self.sends_drives();
        self.was_event = waits && !(self.was_event && sampled);
        self.was_event
    }

    /// The next telemetry sample.
    pub fn sample(&mut self) -> Option<Telemetry<N>> {
        self.samples.receive()
    }

    /// Returns the current status.
    pub fn status(&mut self) -> Status<N> {
        self.drain_reports();
        self.status.tick = self.shared.tick.load(Ordering::Relaxed);
        self.status.room = self.room();
        self.status.planning = self.is_planning();
        self.status.lost = self.shared.lost.load(Ordering::Relaxed);
        let counted = |counter: &AtomicU32| counter.load(Ordering::Relaxed);
        self.status.longest_tick = counted(&self.shared.longest);
        self.status.dry_ticks = counted(&self.shared.dry);
        self.status.late_ticks = counted(&self.shared.late);
        self.status.longest_stop = counted(&self.shared.longest_stop);
        self.status
    }

    /// Takes in what the tick reported.
    fn drain_reports(&mut self) {
        while let Some(report) = self.reports.receive() {
            self.apply_report(&report);
        }
    }

    #[inline(never)]
    fn apply_report(&mut self, report: &ReportOf<S>) {
        self.orders_taken = report.orders;
        self.begun = report.begun;
        self.passed = report.passed;
        // An older report must not overwrite the angles predicted for changed encoder offsets in flight.
        if !S::Replacement::IS_READ || self.orders_taken == self.orders_sent {
            self.angles = report.angles;
        }
        self.apply_splice(report.splice.get());
        self.apply_feedback(report.feedback.get(), report.pose);
        self.apply_interlocks(report.interlocks.get());
        self.apply_digital(report.digital.get());
        let over = report.generation != self.generation;
        if over {
            self.start_over(report);
        }
        if report.state.has_fault() {
            if let Some(fault) = self.faults.receive() {
                self.status.fault = Some(fault);
                self.push_event(Event::Fault(fault));
            }
        } else {
            self.status.fault = None;
        }
        self.status.done = report.done;
        self.status.interrupted = report.interrupted;
        self.offered.release(report.done);
        let reported = (report.state, report.acting, report.done);
        if self.reported != reported {
            self.reported = reported;
            self.push_event(Event::State {
                state: report.state,
                acting: report.acting,
                done: report.done,
            });
        }
        // An older report must not overwrite the state predicted for an order in flight.
        if over || self.orders_taken == self.orders_sent {
            (self.status.state, self.status.acting) = (report.state, report.acting);
            if self.status.end.is_none() && self.status.state == State::Idle {
                self.status.end = Some(at_rest(report.pose));
            }
        }
    }

    /// The tick dropped its queue: so does the background.
    fn start_over(&mut self, report: &ReportOf<S>) {
        self.generation = report.generation;
        self.offered.clear();
        self.job_is_over = true;
        self.drop_levels();
        self.drop_outputs();
        self.checking = false;
        self.aim = Aiming::<N>::NONE;
        self.planner.drop_path();
        self.drop_splice();
        self.status.next = report.begun;
        self.status.admitted = report.begun;
        self.admitted = RoomCount::NOTHING;
        self.rests = report.begun;
        self.shared.set_ahead(Ahead {
            room: Room::NONE,
            rests: self.rests,
        });
        self.publish_generation();
        self.status.end = None;
    }

    /// An event on its way to the host. Where there is no room it is dropped: the status has it.
    fn push_event(&mut self, event: Event<N>) {
        self.events.0.send(event);
    }

    /// Sends an order and, until the tick reports, counts on what it will make of the state.
    fn order(&mut self, order: Order, state: State) -> Result<(), Refusal<N>> {
        if !self.orders.send(order) {
            return Err(Refusal::Busy);
        }
        self.orders_sent = self.orders_sent.wrapping_add(1);
        self.status.state = state;
        Ok(())
    }
}
