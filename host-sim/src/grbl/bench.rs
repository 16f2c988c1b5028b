//! Sender, dialect, driver and the true machine in virtual time, with lines between driver and machine that take a random time.

use super::driver::{MachineDriver, place_of};
use super::path::MOTIONS;
use super::reach::SceneReach;
use crate::job_file::JobFileArgs;
use std::collections::VecDeque;
use std::time::Duration;
use trirrr_client::local::{self, HostNumber, LocalService};
use trirrr_client::{Dialogue, Patience, Turn};
use trirrr_grbl::{Dialect, MachineFacts};
use trirrr_jobs::{gcode_job, job_scene};
use trirrr_protocol::message::{Message, Request, State};
use trirrr_scene::Scene;
use trirrr_service::board::InterlockReadings;

/// Longest way of a frame, ticks.
pub(super) const LATENCY: usize = 5;

/// Slices of the work below a tick.
const SLICES: u32 = 400;

/// xorshift64*.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn below(&mut self, most: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % most
    }
}

/// One direction of the line to the machine. Frames keep their order, and each takes a random time.
struct Line<T>(VecDeque<(u64, T)>);

impl<T> Line<T> {
    fn put(&mut self, item: T, tick: u64, random: &mut Random) {
        let earliest = tick + 1 + random.below(LATENCY) as u64;
        let at = self
            .0
            .back()
            .map_or(earliest, |(before, _)| earliest.max(*before));
        self.0.push_back((at, item));
    }

    /// Next one that has arrived.
    fn take(&mut self, tick: u64) -> Option<T> {
        match self.0.front() {
            Some((at, _)) if *at <= tick => self.0.pop_front().map(|(_, item)| item),
            _ => None,
        }
    }
}

/// Machine, driver and dialect, with a line that takes a random time.
pub(super) struct Bench<'a, N: HostNumber> {
    machine: &'a mut dyn LocalService<N>,
    driver: MachineDriver<N>,
    dialect: Dialect,
    reach: &'a SceneReach<'a>,
    pub(super) random: Random,
    pub(super) tick: u64,
    /// Milliseconds from one tick of the machine to the next.
    pub(super) period: u64,
    requests: Line<Request<N>>,
    messages: Line<Message<N>>,
    pub(super) door: bool,
    pub(super) input: bool,
    pub(super) said: String,
    pub(super) place: [f64; 2],
    /// Tick of the last motion.
    pub(super) moved: u64,
    /// First tick that slowed down since the last byte, and the place before it.
    pub(super) slowed: Option<(u64, [f64; 2])>,
}

impl<N: HostNumber> Bench<'_, N> {
    fn now(&self) -> Duration {
        Duration::from_millis(self.tick)
    }

    /// A millisecond.
    fn pass(&mut self) {
        self.tick += 1;
        self.machine.sense(InterlockReadings {
            door: self.door,
            ..InterlockReadings::default()
        });
        self.machine.sense_digital(u8::from(self.input));
        let before = self.place;
        if self.tick.is_multiple_of(self.period) {
            self.machine.tick();
        }
        if matches!(self.machine.state(), State::Slowing | State::Stopping) {
            self.slowed.get_or_insert((self.tick, before));
        }
        if let Some(played) = self.machine.motion() {
            let position = &played.0.pose.position;
            let place = [position.x, position.y].map(N::to_f64);
            if place != self.place {
                (self.place, self.moved) = (place, self.tick);
            }
        }
        let _ = (0..SLICES).all(|_| self.machine.step());
        let (tick, now) = (self.tick, self.now());
        while let Some(message) = self.machine.outgoing() {
            self.messages.put(message, tick, &mut self.random);
        }
        while let Some(request) = self.requests.take(tick) {
            let reply = self.machine.answer(&request);
            let sequence = request.sequence;
            let answer = Message::Reply { sequence, reply };
            self.messages.put(answer, tick, &mut self.random);
        }
        while let Some(message) = self.messages.take(tick) {
            self.driver.receive(&message, now);
        }
        while let Turn::Send(request) = self.driver.poll(now) {
            self.requests.put(request, tick, &mut self.random);
        }
        if let Some(reason) = self.driver.take_refused() {
            self.dialect.refused(&reason);
        }
        let view = self.driver.view();
        for act in self.dialect.step(self.now(), &view, self.reach) {
            self.driver.take(act);
        }
        self.said += &String::from_utf8(self.dialect.take_output()).expect("text");
    }

    pub(super) fn pass_for(&mut self, ticks: usize) {
        (0..ticks).for_each(|_| self.pass());
    }

    pub(super) fn send(&mut self, bytes: &[u8]) {
        self.dialect.bytes(bytes);
    }

    /// Answers so far.
    pub(super) fn answers(&self) -> usize {
        let is_answer = |line: &&str| *line == "ok" || line.starts_with("error:");
        self.said.lines().filter(is_answer).count()
    }

    /// State of a report.
    pub(super) fn state(&mut self) -> String {
        let before = self.said.len();
        self.send(b"?");
        self.pass();
        let report = self.said[before..]
            .lines()
            .find_map(|line| line.strip_prefix('<'));
        let report = report.expect("a report");
        report.split('|').next().expect("a state").to_owned()
    }

    /// Waits for `what` at most so many ticks.
    pub(super) fn until(&mut self, ticks: usize, what: impl Fn(&mut Self) -> bool) {
        for _ in 0..ticks {
            if what(self) {
                return;
            }
            self.pass();
        }
        let state = self.state();
        panic!(
            "it does not come in {state} at {:?}: {}",
            self.place,
            self.told()
        );
    }

    /// Lines that were said, without reports.
    pub(super) fn told(&self) -> String {
        let lines = self.said.lines().filter(|line| !line.starts_with('<'));
        lines.collect::<Vec<_>>().join("\n")
    }
}

/// Plays with the machine of `scene`, just switched on and unlocked.
pub(super) fn with_bench<N: HostNumber, T>(
    scene: &Scene,
    seed: u64,
    play: impl FnOnce(&mut Bench<'_, N>) -> T,
) -> T {
    let units = trirrr_scene::units::<N>(scene).unwrap();
    let reach = SceneReach::new(scene).unwrap();
    let facts = MachineFacts {
        name: scene.name.clone(),
        travel_m: [0.2, 0.2],
        has_homing: false,
        motions: MOTIONS,
        z: Default::default(),
        outputs: 1,
        inputs: 1,
    };
    let hello = local::hello::<N>(scene);
    let driver = MachineDriver::new(scene, units, hello, Patience::default(), 7, 1e-5);
    let start = place_of(&scene.job.start);
    local::with_machine_switched_on::<N, _>(scene, |machine| {
        let mut bench = Bench {
            machine,
            driver,
            dialect: Dialect::new(facts, start),
            reach: &reach,
            random: Random(seed),
            tick: 0,
            period: 1,
            requests: Line(VecDeque::new()),
            messages: Line(VecDeque::new()),
            door: false,
            input: false,
            said: String::new(),
            place: [0.0; 2],
            moved: 0,
            slowed: None,
        };
        bench.dialect.connect();
        bench.send(b"$X\n");
        bench.until(2000, |bench| bench.answers() == 1);
        play(&mut bench)
    })
    .unwrap()
}

/// The job of `lines` from `place` on, as `trirrr check` plans it; none if it refuses.
pub(super) fn planned(mut machine: Scene, place: [f64; 2], lines: &str) -> Option<Scene> {
    machine.job.start.position = place.into();
    let job = gcode_job(
        lines.as_bytes(),
        &machine,
        &JobFileArgs::default().options(),
    );
    let mut scene = job_scene("job.nc", &machine);
    scene.take_path(&job.ok()?.path).ok()?;
    Some(scene)
}
