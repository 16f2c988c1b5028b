//! Worker of one machine: the conversation with the machine, and what it publishes.

mod commands;
mod inbox;
mod report;
mod talk;

use crate::command_log::CommandLog;
use crate::control::Control;
use crate::error::ZenohError;
use crate::history::History;
use crate::joint_states::joint_state;
use crate::outlet::Outlet;
use crate::records::{self, BatchHeader, RecordBytes};
use crate::task::Task;
use commands::Order;
use inbox::Incoming;
use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, SystemTime};
use trirrr_client::describe::Units;
use trirrr_client::exchange::{Exchange, Patience};
use trirrr_client::{drive, local};
use trirrr_line::{Line, entropy};
use trirrr_protocol::message::{Acting, Hello, Identity, State, Status, Telemetry, Transmit};
use trirrr_scene::Scene;
use trirrr_service::ServiceNumber;
use zenoh::query::Query;

/// Time from one status to the next, while nothing happens.
const STATUS_EVERY: Duration = Duration::from_millis(100);

/// Time until a request is made again that the machine did not take yet.
const PAUSE: Duration = Duration::from_millis(5);

/// Longest time that samples wait for others of their batch, and most of them.
const BATCH_EVERY: Duration = Duration::from_millis(50);
const BATCH: usize = 256;

/// Longest time from one publication of the state to the next, and shortest.
const STATE_EVERY: Duration = Duration::from_secs(1);
const STATE_PAUSE: Duration = Duration::from_millis(20);

/// Time for which samples of a silent host count no more after a resume: they were taken before.
const RESUMING: Duration = Duration::from_millis(300);

/// Events that are kept.
const EVENTS: usize = 4096;

/// Description of a machine.
pub(crate) struct MachineSetup<'a> {
    pub(crate) name: String,
    pub(crate) scene: &'a Scene,
    pub(crate) is_simulated: bool,
    /// Ticks from one sample to the next.
    pub(crate) telemetry: u16,
    /// Time for which samples are kept, s.
    pub(crate) history_s: u32,
    pub(crate) takes_commands: bool,
    /// Number of this run of the program, drawn for each machine.
    pub(crate) session: u64,
}

/// Worker of one machine.
pub(crate) struct Worker<'a, N: ServiceNumber> {
    setup: MachineSetup<'a>,
    /// Units of the scene's machine, and the same for words.
    machine_units: trirrr_core::units::Units,
    units: Units,
    hello: Hello,
    outlet: Outlet,
    inbox: Receiver<Incoming>,
    sender: Sender<Incoming>,
    /// Time of the last look at the machine, since the start.
    now: Duration,
    is_stopped: bool,

    exchange: Exchange<N>,
    is_greeted: bool,
    is_subscribed: bool,
    /// Time of the next status, and before which nothing else is asked.
    look: Duration,
    pause: Duration,
    is_connected: bool,
    /// Reason why the line is lost.
    lost: Option<String>,
    /// Reason why the machine is another one.
    refused: Option<String>,

    identity: Option<Identity>,
    status: Option<Status<N>>,
    state: Option<(State, Acting)>,
    /// Pose of the last sample: x, y (m), alpha (rad).
    pose: Option<[f64; 3]>,
    last_tick: Option<u32>,

    log: CommandLog,
    control: Control,
    /// Queries that wait for the answer to a command, by client and number.
    queries: BTreeMap<(String, u64), Vec<Query>>,
    orders: VecDeque<Order<N>>,
    /// Order that the exchange has asked.
    asked: Option<Order<N>>,
    task: Option<Task<N>>,
    /// The task has the conversation.
    is_task_on: bool,
    resumed: Option<Duration>,
    /// A machine without a host timeout was told to hold.
    is_told_to_hold: bool,
    executed: u64,

    samples: History<RecordBytes>,
    published: u64,
    flush: Duration,
    events: History<String>,
    state_text: String,
    state_due: Duration,
    state_told: Duration,
}

impl<'a, N: ServiceNumber> Worker<'a, N> {
    /// # Errors
    /// Refused: the scene in its number type.
    pub(crate) fn new(setup: MachineSetup<'a>, outlet: Outlet) -> Result<Self, ZenohError> {
        let scene = setup.scene;
        let machine_units = trirrr_scene::units::<N>(scene)
            .map_err(|error| ZenohError::Refused(format!("scene {}: {error}", scene.name)))?;
        let (sender, inbox) = channel();
        let rate_hz = scene.tick_rate_hz / f64::from(setup.telemetry);
        // From float to integer the cast saturates.
        let room = (rate_hz * f64::from(setup.history_s)).ceil() as usize;
        Ok(Self {
            machine_units,
            units: Units::of_scene(scene, &machine_units),
            hello: local::hello::<N>(scene),
            outlet,
            inbox,
            sender,
            now: Duration::ZERO,
            is_stopped: false,
            exchange: Exchange::new(Patience::default(), entropy()),
            is_greeted: false,
            is_subscribed: false,
            look: Duration::ZERO,
            pause: Duration::ZERO,
            is_connected: false,
            lost: None,
            refused: None,
            identity: None,
            status: None,
            state: None,
            pose: None,
            last_tick: None,
            log: CommandLog::default(),
            control: Control::default(),
            queries: BTreeMap::new(),
            orders: VecDeque::new(),
            asked: None,
            task: None,
            is_task_on: false,
            resumed: None,
            is_told_to_hold: false,
            executed: 0,
            samples: History::new(room),
            published: 0,
            flush: Duration::ZERO,
            events: History::new(EVENTS),
            state_text: String::new(),
            state_due: Duration::ZERO,
            state_told: Duration::ZERO,
            setup,
        })
    }

    fn now(&self) -> Duration {
        self.now
    }

    /// Carries the machine until `stop` is raised.
    ///
    /// # Errors
    /// Refused: the machine was built from another scene, or its port cannot be opened at all.
    pub(crate) fn run(
        &mut self,
        line: &mut dyn Line<N>,
        stop: &AtomicBool,
    ) -> Result<(), ZenohError> {
        self.is_connected = line.is_open();
        drive(self, line, stop).unwrap_or_else(|why| Err(ZenohError::Refused(why.to_string())))
    }

    fn sample(&mut self, sample: &Telemetry<N>) {
        if let Some(last) = self.last_tick
            && (sample.tick.wrapping_sub(last) as i32) <= 0
        {
            self.event("machine", "the machine was switched on anew");
        }
        self.last_tick = Some(sample.tick);
        self.found((sample.state, sample.acting));
        let place = sample.setpoint.pose.position;
        let [x, y] = [place.x, place.y].map(|value| value.to_f64() * self.units.length_m);
        self.pose = Some([x, y, N::angle_to_f64(sample.setpoint.pose.angle)]);
        let number = self.samples.next();
        self.samples
            .push(records::record(number, sample, &self.units));
    }

    /// Publishes samples and the state when it is time.
    fn publish(&mut self) {
        let now = self.now();
        let waiting = self.samples.next() - self.published;
        if waiting > 0 && (now >= self.flush || waiting >= BATCH as u64) {
            self.flush = now + BATCH_EVERY;
            let range = self
                .samples
                .kept(self.published..self.samples.next(), usize::MAX);
            self.published = range.end;
            let batch = self.batch(range);
            self.outlet.telemetry(batch);
            if let Some(last) = self.samples.last() {
                let joints = records::joints(last);
                self.outlet.joints(|| joint_state(since_1970(), &joints));
            }
        }
        if now < self.state_told + STATE_PAUSE {
            return;
        }
        let text = self.state_text();
        if text != self.state_text || now >= self.state_due {
            (self.state_told, self.state_due) = (now, now + STATE_EVERY);
            let full = self.state_now();
            self.outlet.state(&full);
            self.state_text = text;
        }
    }

    fn batch(&self, range: std::ops::Range<u64>) -> Vec<u8> {
        let records = self.samples.items(range);
        let header = BatchHeader {
            session: self.setup.session,
            every: self.setup.telemetry.into(),
            count: records.len() as u32,
        };
        records::batch(header, records)
    }
}

/// Time of this computer. A clock before 1970 tells none.
fn since_1970() -> Duration {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.unwrap_or_default()
}

/// Returns the pose in m and rad.
fn pose_si<N: Transmit>(pose: &trirrr_core::setpoint::Pose<N>, units: &Units) -> [f64; 3] {
    let [x, y] = [pose.position.x, pose.position.y].map(|value| value.to_f64() * units.length_m);
    [x, y, N::angle_to_f64(pose.angle)]
}
