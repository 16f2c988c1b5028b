//! The memory of a service, and how it comes apart into its two halves.

use super::background::{
    Background, BackgroundEnds, BackgroundFeatures, Desk, OfferedMoves, RequestWindow, Retargeting,
};
use super::built::Coefficients;
use super::contact::ContactMemory;
use super::digital::DigitalPorts;
use super::feature::{ChannelMemory, Feature};
use super::feedback::DriveFeedback;
use super::foreground::{Foreground, ForegroundEnds, TickFeatures};
use super::handoff::{Order, QueuedMove, Recover, SharedCounters, TickReport};
use super::homing::Cycle;
use super::interlock::{Interlocks, ProbeLatch};
use super::levels::LevelRing;
use super::offered::Offered;
use super::queue::{Receiver, Sender};
use super::retreat::Trail;
use super::scene::{
    ChangesOf, CurvesOf, Machine, ModelOf, PlannerOf, QuinticsOf, Scene, SceneParts, Setup,
    SetupSlot,
};
use super::service::Service;
use super::settings::Settings;
use super::splice::SpliceQueues;
use crate::number::ServiceNumber;
use crate::planner::PathPlanner;
use core::borrow::Borrow;
use core::fmt;
use heapless::Deque;
use heapless::spsc::Queue;
use trirrr_core::machine::BuildError;
use trirrr_core::setpoint::Pose;
use trirrr_core::status::Status;
use trirrr_protocol::message::{Event, Fault, Telemetry};

/// Orders on their way to the tick, and one place that stays empty.
const ORDERS: usize = 8;

/// Reports on their way from the tick, and one place that stays empty. Where they are full the tick
/// reports later.
const REPORTS: usize = 4;

/// Events that wait to be sent, and one place that stays empty.
const EVENTS: usize = 12;

/// Memory of the feature `F`.
type MemoryOf<F, T> = <F as Feature>::Memory<T>;

/// The queues between the two halves: all the memory of a service besides the halves themselves.
///
/// `MOVES` - 1 moves have room, those not yet judged and the one under way included; `SAMPLES` - 1 telemetry samples.
/// `LEVELS` levels of power have room where the scene plays power lists: a power of two, at most 32,768. `S` is the
/// [kind of scene](Scene).
pub struct Channels<S: Scene, const MOVES: usize, const SAMPLES: usize, const LEVELS: usize = 0> {
    moves: Queue<QueuedMove<S::N, CurvesOf<S>>, MOVES>,
    offered: Deque<Offered<S::N, CurvesOf<S>>, MOVES>,
    recoveries: Queue<Recover<S::N>, 2>,
    orders: Queue<Order, ORDERS>,
    reports: Queue<TickReport<S>, REPORTS>,
    faults: Queue<Fault<S::N>, 2>,
    samples: Queue<Telemetry<S::N>, SAMPLES>,
    events: Queue<Event<S::N>, EVENTS>,
    splices: MemoryOf<QuinticsOf<S>, SpliceQueues<S::N, CurvesOf<S>>>,
    setups: MemoryOf<ChangesOf<S>, SetupSlot<ModelOf<S>>>,
    levels: MemoryOf<S::Levels, LevelRing<S::N, LEVELS>>,
    feedback: MemoryOf<S::Feedback, DriveFeedback<S::N>>,
    contact: MemoryOf<S::Contact, ContactMemory<S::N>>,
    digital: MemoryOf<S::Digital, DigitalPorts>,
    planner: PlannerOf<S>,
    window: RequestWindow<S>,
    shared: SharedCounters,
}

/// Reason for which a service cannot be built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ServiceError {
    /// The machine or its limits.
    Build(BuildError),
    /// The machine cannot stand at the pose.
    Pose(Status),
}

impl fmt::Display for ServiceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Build(error) => error.fmt(f),
            Self::Pose(status) => write!(f, "the machine cannot stand at its first pose: {status}"),
        }
    }
}

impl core::error::Error for ServiceError {}

impl From<BuildError> for ServiceError {
    fn from(error: BuildError) -> Self {
        Self::Build(error)
    }
}

impl<N: ServiceNumber, S, const MOVES: usize, const SAMPLES: usize, const LEVELS: usize>
    Channels<S, MOVES, SAMPLES, LEVELS>
where
    S: Scene<N = N>,
{
    /// Empty queues.
    pub const fn new() -> Self {
        Self {
            moves: Queue::new(),
            offered: Deque::new(),
            recoveries: Queue::new(),
            orders: Queue::new(),
            reports: Queue::new(),
            faults: Queue::new(),
            samples: Queue::new(),
            events: Queue::new(),
            splices: ChannelMemory::EMPTY,
            setups: ChannelMemory::EMPTY,
            levels: ChannelMemory::EMPTY,
            feedback: ChannelMemory::EMPTY,
            contact: ChannelMemory::EMPTY,
            digital: ChannelMemory::EMPTY,
            planner: PlannerOf::<S>::EMPTY,
            window: RequestWindow::EMPTY,
            shared: SharedCounters::new(),
        }
    }

    /// Builds the service of `scene` for one thread, see [`Service`]. Otherwise as
    /// [`Channels::split`].
    ///
    /// # Errors
    /// As [`Channels::split`].
    pub fn service<'q>(
        &'q mut self,
        scene: impl Into<SceneParts<'q, S>>,
        pose: Pose<N>,
        settings: Settings<N>,
    ) -> Result<Service<'q, S>, ServiceError> {
        let (foreground, background) = self.split(scene, pose, settings)?;
        Ok(Service::new(foreground, background))
    }

    /// Builds the service of `scene`, its machine standing at `pose`, at rest, with nothing queued:
    /// the half that ticks and the half that talks. A machine that has to be homed only counts its
    /// angles from there.
    ///
    /// # Errors
    /// A machine or a limit that cannot be built; a pose in which it cannot stand.
    pub fn split<'q>(
        &'q mut self,
        scene: impl Into<SceneParts<'q, S>>,
        pose: Pose<N>,
        settings: Settings<N>,
    ) -> Result<(Foreground<'q, S>, Background<'q, S>), ServiceError> {
        let scene: SceneParts<'q, S> = scene.into();
        let coefficients = scene.machine.coefficients(&settings)?;
        let Coefficients { tick, limits, .. } = coefficients.borrow();
        let geometry = tick.geometry();
        let position = geometry.position(&pose).map_err(ServiceError::Pose)?;
        let angles = geometry.motor_angles(&position);
        let setup = Setup {
            tick: *tick,
            limits: *limits,
            pose,
            shift: None,
        };

        let (moves_in, moves_out) = self.moves.split();
        let (recoveries_in, recoveries_out) = self.recoveries.split();
        let (faults_in, faults_out) = self.faults.split();
        let (orders_in, orders_out) = self.orders.split();
        let (reports_in, reports_out) = self.reports.split();
        let (samples_in, samples_out) = self.samples.split();
        let (events_in, events_out) = self.events.split();
        let (splices_in, splices_out) =
            QuinticsOf::<S>::split(&mut self.splices, SpliceQueues::split);
        let (setups_in, setups_out) = ChangesOf::<S>::split(&mut self.setups, SetupSlot::split);
        let (levels_in, levels_out) =
            S::Levels::split(&mut self.levels, |ring: &mut LevelRing<_, _>| {
                ring.split(settings.period, scene.levels)
            });
        let (feedback_in, feedback_out) =
            S::Feedback::split(&mut self.feedback, |memory: &mut DriveFeedback<_>| {
                memory.split(scene.feedback)
            });
        let (contact_in, contact_out) =
            S::Contact::split(&mut self.contact, |memory: &mut ContactMemory<_>| {
                memory.split(scene.contact)
            });
        let (digital_in, digital_out) =
            S::Digital::split(&mut self.digital, |ports: &mut DigitalPorts| {
                ports.split(scene.digital)
            });
        let of_tick = TickFeatures::<S> {
            splices: splices_out,
            setups: setups_out,
            shifted: ChangesOf::<S>::of(|| None),
            levels: levels_out,
            homing: S::Homing::of(|| {
                let cycle = |homing| Cycle::new(homing, ChangesOf::<S>::of(|| None));
                scene.homing.map(cycle)
            }),
            feedback: feedback_out,
            contact: contact_out,
            trail: S::Retreat::of(Trail::new),
            interlocks: S::Interlocks::of(|| Interlocks::new(&scene.interlocks)),
            probe: S::Probe::of(|| {
                let probe = scene.interlocks.probe;
                ProbeLatch::new(probe.map(|probe| probe.debounce_ticks))
            }),
            digital: digital_out,
        };
        let of_background = BackgroundFeatures::<S> {
            splices: splices_in,
            retargeting: QuinticsOf::<S>::of(|| Retargeting::new(pose)),
            setups: setups_in,
            levels: levels_in,
            homing: S::Homing::of(|| scene.homing),
            feedback: feedback_in,
            contact: contact_in,
            digital: digital_in,
        };
        let inputs = of_tick.input_states();
        let shared = &self.shared;
        self.planner.set_up(settings.planning);
        let foreground = Foreground::new(
            setup,
            angles,
            &settings,
            ForegroundEnds {
                moves: Receiver::new(moves_out),
                recoveries: Receiver::new(recoveries_out),
                orders: Receiver::new(orders_out),
                reports: Sender::new(reports_in),
                faults: Sender::new(faults_in),
                samples: Sender::new(samples_in),
                shared,
            },
            of_tick,
        );
        let ends = BackgroundEnds {
            moves: Sender::new(moves_in),
            recoveries: Sender::new(recoveries_in),
            orders: Sender::new(orders_in),
            reports: Receiver::new(reports_out),
            faults: Receiver::new(faults_out),
            samples: Receiver::new(samples_out),
            shared,
        };
        let desk = Desk {
            planner: &mut self.planner,
            window: &mut self.window,
            offered: OfferedMoves::new(self.offered.as_mut_view()),
            events: (Sender::new(events_in), Receiver::new(events_out)),
        };
        let background = Background::new(
            (scene.machine, scene.update),
            coefficients,
            (angles, inputs),
            settings,
            (ends, of_background, desk),
        );
        Ok((foreground, background))
    }
}

impl<S: Scene, const MOVES: usize, const SAMPLES: usize, const LEVELS: usize> Default
    for Channels<S, MOVES, SAMPLES, LEVELS>
{
    fn default() -> Self {
        Self::new()
    }
}
