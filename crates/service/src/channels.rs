//! The memory of a service, and how it comes apart into its two halves.

use super::background::{self, Background, OfferedMoves, RequestWindow, Stand};
use super::coefficients::Coefficients;
use super::contact::ContactChannels;
use super::foreground::{self, Foreground};
use super::handoff::{Order, QueuedMove, Recover, ReportOf, SharedCounters};
use super::offered::Offered;
use super::queue::{Receiver, Sender};
use super::scene::{Scene, Setup, Slot};
use super::service::Service;
use super::settings::Settings;
use super::splice::{SpliceChannels, SplicesOf};
use crate::digital::DigitalKind;
use crate::feedback::Feedback;
use crate::levels::LevelKind;
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

/// The queues between the two halves: all the memory of a service besides the halves themselves.
///
/// `MOVES` - 1 moves have room, those not yet judged and the one under way included; `SAMPLES` - 1 telemetry samples.
/// `S` is the [kind of scene](Scene).
pub struct Channels<S: Scene, const MOVES: usize, const SAMPLES: usize> {
    moves: Queue<QueuedMove<S::N, S::Curves>, MOVES>,
    offered: Deque<Offered<S::N, S::Curves>, MOVES>,
    recoveries: Queue<Recover<S::N>, 2>,
    orders: Queue<Order, ORDERS>,
    splices: SplicesOf<S>,
    reports: Queue<ReportOf<S>, REPORTS>,
    faults: Queue<Fault<S::N>, 2>,
    samples: Queue<Telemetry<S::N>, SAMPLES>,
    events: Queue<Event<S::N>, EVENTS>,
    setups: S::Slot,
    feedback: S::Feedback,
    contact: S::Contact,
    levels: S::Levels,
    digital: S::Digital,
    planner: S::Planner,
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

impl<N: ServiceNumber, S: Scene<N = N>, const MOVES: usize, const SAMPLES: usize>
    Channels<S, MOVES, SAMPLES>
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
            splices: <SplicesOf<S>>::EMPTY,
            setups: S::Slot::EMPTY,
            feedback: S::Feedback::EMPTY,
            contact: S::Contact::EMPTY,
            levels: S::Levels::EMPTY,
            digital: S::Digital::EMPTY,
            planner: S::Planner::EMPTY,
            window: RequestWindow::EMPTY,
            shared: SharedCounters::new(),
        }
    }

    /// Builds the service of `scene` for one thread, see [`Service`]. Otherwise as
    /// [`Channels::split`].
    ///
    /// # Errors
    /// As [`Channels::split`].
    pub fn service(
        &mut self,
        scene: S,
        pose: Pose<N>,
        settings: Settings<N>,
    ) -> Result<Service<'_, S>, ServiceError> {
        let (foreground, background) = self.split(scene, pose, settings)?;
        Ok(Service::new(foreground, background))
    }

    /// Builds the service of `scene`, its machine standing at `pose`, at rest, with nothing queued:
    /// the half that ticks and the half that talks. A machine that has to be homed only counts its
    /// angles from there.
    ///
    /// # Errors
    /// A machine or a limit that cannot be built; a pose in which it cannot stand.
    pub fn split(
        &mut self,
        scene: S,
        pose: Pose<N>,
        settings: Settings<N>,
    ) -> Result<(Foreground<'_, S>, Background<'_, S>), ServiceError> {
        let coefficients = scene.coefficients(&settings)?;
        let Coefficients { tick, limits, .. } = coefficients.borrow();
        let geometry = tick.geometry();
        let position = geometry.position(&pose).map_err(ServiceError::Pose)?;
        let stand = Stand {
            angles: geometry.motor_angles(&position),
            pose,
        };
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
        let (setups_in, setups_out) = self.setups.split();
        let (splices_in, splices_out) = self.splices.split();
        let (feedback_in, feedback_out) = self.feedback.split(scene.feedback());
        let (contact_in, contact_out) = self.contact.split(scene.contact());
        let (store, player) = self.levels.split(settings.period, scene.levels());
        let (digital_in, digital_out) = self.digital.split(scene.digital());
        let shared = &self.shared;
        self.planner.set_up(settings.planning);
        let foreground = Foreground::new(
            setup,
            stand.angles,
            (scene.homing(), scene.interlocks()),
            &settings,
            foreground::ForegroundEnds {
                moves: Receiver::new(moves_out),
                recoveries: Receiver::new(recoveries_out),
                orders: Receiver::new(orders_out),
                setups: setups_out,
                splices: splices_out,
                feedback: feedback_out,
                contact: contact_out,
                levels: player,
                digital: digital_out,
                reports: Sender::new(reports_in),
                faults: Sender::new(faults_in),
                samples: Sender::new(samples_in),
                shared,
            },
        );
        let background = Background::new(
            scene,
            coefficients,
            stand,
            settings,
            background::BackgroundEnds {
                moves: Sender::new(moves_in),
                recoveries: Sender::new(recoveries_in),
                orders: Sender::new(orders_in),
                setups: setups_in,
                splices: splices_in,
                feedback: feedback_in,
                contact: contact_in,
                levels: store,
                digital: digital_in,
                reports: Receiver::new(reports_out),
                faults: Receiver::new(faults_out),
                samples: Receiver::new(samples_out),
                shared,
                planner: &mut self.planner,
                window: &mut self.window,
                offered: OfferedMoves::new(self.offered.as_mut_view()),
                events: (Sender::new(events_in), Receiver::new(events_out)),
            },
        );
        Ok((foreground, background))
    }
}

impl<S: Scene, const MOVES: usize, const SAMPLES: usize> Default for Channels<S, MOVES, SAMPLES> {
    fn default() -> Self {
        Self::new()
    }
}
