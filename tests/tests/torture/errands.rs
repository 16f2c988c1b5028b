//! A host that sends moves, goals and orders at random over a bad line, and a machine that is watched in every tick.

use std::time::Duration;
use trirrr_bench::device::{
    Device, DeviceRoom, MessageDecoder, RAMP_TICKS, TICK_RATE_HZ, hello, home, message_frame,
    request_frame,
};
use trirrr_bench::faulty_link::{FaultyLink, Random};
use trirrr_bench::job::near;
use trirrr_bench::trajectory_checker::TrajectoryChecker;
use trirrr_client::Patience;
use trirrr_client::Turn;
use trirrr_client::exchange::Exchange;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Tick;
use trirrr_protocol::message::{
    AnyMove, Command, Cut, Goal, Message, Move, QuinticMove, Reply, Request, State, Status,
};
use trirrr_service::admission::{Path, Retarget, RetargetTask, Retargeted};
use trirrr_service::paces::Ramp;
use trirrr_tests::instant::{Instant, State as PlatformState};

/// Of 100 frames, how many are damaged.
const PERCENT: u64 = 20;

/// Ticks in which the host is busy, and ticks in which it leaves the machine in idle.
const BUSY: u64 = 5000;
const LEAVING: u64 = 5000;

/// Moves that are ahead before the host offers more, or another goal. So a retarget has room for all shapes, as the planner
/// of the test.
const AHEAD: u32 = 5;
const AHEAD_OF_GOALS: u32 = 40;
const QUEUE: usize = 64;

/// Counts of a session.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errands {
    pub(crate) sessions: u64,
    pub(crate) ticks: u64,
    pub(crate) frames: u64,
    pub(crate) damaged: u64,
    pub(crate) goals: u64,
    /// Goals that came while another was open.
    pub(crate) replaced: u64,
    pub(crate) refused_goals: u64,
    pub(crate) cuts: u64,
    /// Cuts at another pace than normal speed, or at rest.
    pub(crate) slow_cuts: u64,
    /// Cuts of what a retarget had planned.
    pub(crate) chains_cut: u64,
    /// Goals that were planned behind the moves.
    pub(crate) behind: u64,
    pub(crate) holds: u64,
    pub(crate) stops: u64,
    pub(crate) largest_part: f64,
}

impl Errands {
    pub(crate) fn add(&mut self, other: &Self) {
        self.sessions += other.sessions;
        self.ticks += other.ticks;
        self.frames += other.frames;
        self.damaged += other.damaged;
        self.goals += other.goals;
        self.replaced += other.replaced;
        self.refused_goals += other.refused_goals;
        self.cuts += other.cuts;
        self.slow_cuts += other.slow_cuts;
        self.chains_cut += other.chains_cut;
        self.behind += other.behind;
        self.holds += other.holds;
        self.stops += other.stops;
        self.largest_part = self.largest_part.max(other.largest_part);
    }
}

type Machine = Dynamic<f64>;

/// Goal that the machine has taken and not begun to move to. Another may wait to take its place.
struct OpenGoal {
    goal: Goal<f64>,
    /// Number of the next move, and the setpoint where it begins, while nothing is planned.
    next: u32,
    end: Option<Setpoint<f64>>,
}

/// Both ends of one session and the line between them.
pub(crate) struct ErrandSession<'q> {
    device: Device<'q>,
    /// Slices of background work between two ticks.
    steps: usize,
    exchange: Exchange<f64>,
    decoder: MessageDecoder,
    to_device: FaultyLink,
    to_host: FaultyLink,
    checker: TrajectoryChecker<f64>,
    tick: Tick<Machine>,
    path: Path<Machine>,
    side: bool,
    random: Random,
    /// The last status that the host got, unless it has sent something since.
    status: Option<Status<f64>>,
    greeted: bool,
    /// Nothing is said before this tick.
    pause: u64,
    /// Sequence number of the last request that the machine executed.
    executed: Option<u32>,
    /// In the order of their moves.
    open: Vec<OpenGoal>,
    /// The machine planned, or a cut was ahead, as it got the last request.
    was_planning: bool,
    cut: Option<Cut>,
    /// Numbers of moves that a retarget has planned.
    planned: Vec<u32>,
    tally: Errands,
    seed: u64,
}

fn limits() -> LimitParameters {
    LimitParameters {
        rate_rad_s: Some([3.0; 3]),
        acceleration_rad_s2: Some([200.0; 3]),
        torque_nm: Some([1.5; 3]),
        ..LimitParameters::default()
    }
}

fn platform(setpoint: &Setpoint<f64>) -> PlatformState {
    let pose = &setpoint.pose;
    PlatformState {
        pose: [pose.position.x, pose.position.y, pose.angle],
        velocity: setpoint.velocity.into(),
        acceleration: setpoint.acceleration.into(),
    }
}

fn standing() -> Setpoint<f64> {
    Setpoint {
        pose: home(),
        velocity: [0.0; 3].into(),
        acceleration: [0.0; 3].into(),
    }
}

impl ErrandSession<'_> {
    /// Runs the session of `seed` to its end.
    pub(crate) fn run(seed: u64) -> Errands {
        let mut random = Random::new(seed);
        let mut channels = DeviceRoom::<f64, QUEUE>::new();
        let patience = Patience {
            answer: Duration::from_millis(10),
            attempts: 1000,
        };
        let period = 1.0 / TICK_RATE_HZ;
        let built = Limits::build(&limits()).expect("limits");
        let mut device = Device::enabled(&mut channels, limits(), 0);
        // From the first tick on each has a sample.
        device.service.submit(&Command::telemetry(1));
        let session = ErrandSession {
            device,
            // Slow boards plan too late, and again.
            steps: [2, 10, 60, 1000][random.below(4) as usize],
            exchange: Exchange::new(patience, seed as u32),
            decoder: MessageDecoder::new(),
            to_device: FaultyLink::new(random.bits(), PERCENT),
            to_host: FaultyLink::new(random.bits(), PERCENT),
            checker: TrajectoryChecker::new(&[], 0, RAMP_TICKS, period),
            tick: Tick::build(&example()).expect("the thesis machine"),
            path: Path::build(&example(), built, Ramp::within(RAMP_TICKS, None), period)
                .expect("the thesis machine"),
            side: Instant::of(&example(), &platform(&standing())).side,
            random,
            status: None,
            greeted: false,
            pause: 0,
            executed: None,
            open: Vec::new(),
            was_planning: false,
            cut: None,
            planned: Vec::new(),
            tally: Errands {
                sessions: 1,
                ..Errands::default()
            },
            seed,
        };
        session.play()
    }

    fn play(mut self) -> Errands {
        for tick in 0..BUSY + LEAVING {
            self.tally.ticks += 1;
            self.work_at_device();
            self.listen_at_host(tick);
            self.talk_at_host(tick);
        }
        let state = self.device.service.state();
        assert_eq!(state, State::Idle, "session {}: no way out", self.seed);
        for link in [&self.to_device, &self.to_host] {
            self.tally.frames += link.frames();
            self.tally.damaged += link.damaged();
        }
        self.tally
    }

    fn work_at_device(&mut self) {
        self.device.tick();
        self.follow_status();
        while let Some(message) = self.device.service.outgoing() {
            if let Message::Telemetry(sample) = &message {
                self.know(sample.number);
                let tick = &self.tick;
                let motors = |setpoint: &Setpoint<f64>| Some(tick.evaluate(setpoint).ok()?.motors);
                if let Err(why) = self.checker.see(sample, motors) {
                    panic!("session {}: {why}", self.seed);
                }
                let instant = Instant::of(&example(), &platform(&sample.setpoint));
                let part = instant.part_of(&limits(), self.side);
                assert!(
                    part <= 1.0,
                    "session {}: {part} of a limit: {sample:?}",
                    self.seed
                );
                self.tally.largest_part = self.tally.largest_part.max(part);
            }
            self.to_host.send(&message_frame(&message));
        }
        for _ in 0..self.steps {
            if !self.device.service.step() {
                break;
            }
        }
        while let Some(bytes) = self.to_device.receive() {
            self.was_planning = self.device.service.status().planning;
            let (mut requests, mut replies) = (Vec::new(), Vec::new());
            self.device.receive(
                &bytes,
                |request| requests.push(*request),
                |message| replies.push(message.clone()),
            );
            for (request, message) in requests.iter().zip(&replies) {
                self.note(request, message);
                self.to_host.send(&message_frame(message));
            }
        }
    }

    /// Notes what the machine has executed, once.
    fn note(&mut self, request: &Request<f64>, message: &Message<f64>) {
        let Message::Reply { reply, .. } = message else {
            return;
        };
        let is_new = self
            .executed
            .is_none_or(|last| request.sequence.wrapping_sub(last) as i32 > 0);
        if *reply != Reply::Done || !is_new {
            return;
        }
        self.executed = Some(request.sequence);
        // While a goal is planned, and until its cut, there is none of these but another goal in its place.
        match request.command {
            _ if self.was_planning => {}
            Command::Move(Move { number, .. })
            | Command::Quintic(QuinticMove {
                common: Move { number, .. },
                ..
            }) => self.goals_are_over(number),
            Command::Retarget(_) => {
                let next = self.device.service.status().next;
                self.goals_are_over(next);
            }
            _ => {}
        }
        match request.command {
            Command::Move(each) => self.checker.add(&AnyMove::Cubic(each)),
            Command::Quintic(each) => self.checker.add(&AnyMove::Quintic(each)),
            Command::Retarget(goal) => {
                self.tally.goals += 1;
                let Status { next, end, .. } = self.device.service.status();
                self.tally.replaced += u64::from(self.was_planning);
                self.open.retain(|open| open.next != next);
                self.open.push(OpenGoal { goal, next, end });
            }
            Command::Hold => self.tally.holds += 1,
            Command::Stop => self.tally.stops += 1,
            _ => {}
        }
    }

    /// Takes in what the machine has dropped, and a cut.
    fn follow_status(&mut self) {
        let status = self.device.service.status();
        self.checker.drop_from(status.next);
        if let Some(fault) = status.fault {
            panic!("session {}: {fault:?}", self.seed);
        }
        if let Some(open) = self.open.last_mut()
            && status.next <= open.next
        {
            (open.next, open.end) = (status.next, status.end);
            if status.refused.is_some() {
                self.tally.refused_goals += 1;
                self.open.pop();
            }
        }
        let Some(cut) = status.cut.filter(|cut| self.cut != Some(*cut)) else {
            return;
        };
        self.cut = Some(cut);
        self.tally.cuts += 1;
        self.tally.chains_cut += u64::from(self.planned.contains(&cut.number));
        let at = self
            .checker
            .cut(&cut)
            .unwrap_or_else(|why| panic!("session {}: {why}", self.seed));
        self.tally.slow_cuts += u64::from(self.checker.is_slow());
        // Those before it had another take their place.
        self.open.retain(|open| open.next >= cut.next);
        let open = self.open.remove(0);
        self.plan(&at, &open.goal, cut.next);
    }

    /// A move that the host has not offered is of a goal that was planned behind the moves.
    fn know(&mut self, number: u32) {
        // Before the first move the number is that before 0.
        if number == u32::MAX || self.checker.has(number) {
            return;
        }
        self.goal_is_behind(number + 1);
    }

    /// No goal is open any more: one was planned behind the moves if there are moves of it before this number.
    fn goals_are_over(&mut self, number: u32) {
        self.goal_is_behind(number);
        self.open.clear();
    }

    /// The first goal that is open was planned behind the moves, if there are moves of it before this number.
    fn goal_is_behind(&mut self, number: u32) {
        if self.open.first().is_some_and(|open| number > open.next) {
            let OpenGoal { goal, next, end } = self.open.remove(0);
            self.tally.behind += 1;
            self.plan(&end.expect("a start"), &goal, next);
        }
    }

    /// Plans what the machine has to have planned.
    fn plan(&mut self, start: &Setpoint<f64>, goal: &Goal<f64>, first: u32) {
        let target = Setpoint {
            pose: goal.to,
            velocity: goal.velocity.into(),
            acceleration: [0.0; 3].into(),
        };
        let mut retarget = Retarget::<Machine>::over(self.path, start, &target);
        retarget.plan(&RetargetTask {
            least: goal.least_ticks,
            ..RetargetTask::new(start, &target)
        });
        let count = loop {
            match retarget.step() {
                Retargeted::Undecided => {}
                Retargeted::Planned(count) => break count,
                Retargeted::Refused(refusal) => panic!("session {}: {refusal:?}", self.seed),
            }
        };
        let (mut at, mut number, mut ticks) = (*start, first, 0);
        for index in 0..count {
            let each = retarget.planned(index).expect("a move");
            // One chain, with continuous velocity and acceleration.
            assert_eq!(each.common.from, at.pose);
            assert_eq!(each.common.start_velocity, <[f64; 3]>::from(at.velocity));
            assert_eq!(each.start_acceleration, <[f64; 3]>::from(at.acceleration));
            at = Setpoint {
                pose: each.common.to,
                velocity: each.common.end_velocity.into(),
                acceleration: each.end_acceleration.into(),
            };
            self.checker.add(&AnyMove::Quintic(each).numbered(number));
            self.planned.push(number);
            number += 1;
            ticks += each.common.ticks;
        }
        assert_eq!(at, target);
        assert!(ticks >= goal.least_ticks);
    }

    fn listen_at_host(&mut self, tick: u64) {
        while let Some(bytes) = self.to_host.receive() {
            let mut line = bytes.as_slice();
            while let Some(frame) = self.decoder.take::<Message<f64>>(&mut line) {
                let Ok(message) = frame else {
                    continue;
                };
                let Some((Request { command, .. }, reply)) = self.exchange.receive(&message) else {
                    continue;
                };
                self.greeted |= matches!(reply, Reply::Hello(_));
                self.status = match reply {
                    Reply::Status(status) => Some(status),
                    _ => None,
                };
                if !matches!(command, Command::Status) {
                    self.pause = tick + self.random.below(30);
                }
            }
        }
    }

    fn talk_at_host(&mut self, tick: u64) {
        let now = Duration::from_secs_f64(tick as f64 / TICK_RATE_HZ);
        loop {
            match self.exchange.poll(now) {
                Turn::Send(request) => self.to_device.send(&request_frame(&request)),
                Turn::Wait(_) => return,
                Turn::Reconnect => panic!("session {}: silent", self.seed),
                Turn::Done(()) if tick < self.pause => return,
                Turn::Done(()) => match self.status {
                    _ if !self.greeted => self.exchange.greet(hello(), now),
                    None => self.exchange.ask(Command::Status, now),
                    Some(status) => {
                        let command = match tick < BUSY {
                            true => self.errand(&status),
                            false if status.state == State::Idle => Command::Status,
                            false => Command::Stop,
                        };
                        self.exchange.ask(command, now);
                    }
                },
            }
        }
    }

    /// Draws the next command.
    fn errand(&mut self, status: &Status<f64>) -> Command<f64> {
        let waits = status.state == State::Idle
            && status.admitted == status.next
            && status.next != status.done;
        let ahead = status.next.wrapping_sub(status.done);
        match (self.random.below(100), status.end) {
            (0..50, _) if waits => Command::Start,
            (0..35, Some(end)) if ahead < AHEAD => self.some_move(status.next, &end),
            (0..70, _) if ahead < AHEAD_OF_GOALS => Command::Retarget(self.some_goal()),
            (70..76, _) => Command::Hold,
            (76..88, _) => Command::Resume,
            (88..95, _) => {
                let percent = self.random.below(60) as u8;
                let percent = if percent > 30 { 100 } else { 5 + 3 * percent };
                Command::FeedOverride { percent }
            }
            (95..96, _) => Command::Stop,
            _ => Command::Status,
        }
    }

    fn some_goal(&mut self) -> Goal<f64> {
        let velocity = match self.random.below(4) {
            0 => self.some_velocity(0.02),
            _ => [0.0; 3],
        };
        Goal {
            to: near(&mut self.random, home()),
            velocity,
            cut: self.random.below(8) > 0,
            least_ticks: self.random.below(400).saturating_sub(250) as u32,
        }
    }

    fn some_velocity(&mut self, size: f64) -> [f64; 3] {
        [0; 3].map(|_| (2.0 * self.random.fraction() - 1.0) * size)
    }

    /// A move from the end of the last, short or long, at rest at its end or not.
    fn some_move(&mut self, number: u32, end: &Setpoint<f64>) -> Command<f64> {
        let end_velocity = match self.random.below(2) {
            0 => self.some_velocity(0.02),
            _ => [0.0; 3],
        };
        let common = Move {
            start_velocity: end.velocity.into(),
            end_velocity,
            ..Move::rest_to_rest(
                number,
                end.pose,
                near(&mut self.random, home()),
                60 + self.random.below(200) as u32,
            )
        };
        match self.random.below(2) {
            0 => Command::Move(common),
            _ => Command::Quintic(QuinticMove {
                common,
                start_acceleration: end.acceleration.into(),
                end_acceleration: match end_velocity == [0.0; 3] {
                    true => [0.0; 3],
                    false => self.some_velocity(0.5),
                },
            }),
        }
    }
}
