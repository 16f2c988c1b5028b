//! Holds take no longer, and no more way, than is told before the job starts: at whatever tick and pace they come. The service
//! itself plays them, in virtual time.

use std::collections::HashSet;
use trirrr_client::local::{self, HostNumber, LocalService};
use trirrr_core::setpoint::{Quintics, Segment};
// It holds the services of all number types and models: compiled there, they need not be compiled here.
use trirrr_host_sim as _;
use trirrr_protocol::message::{
    Acting, Command, Message, Reply, Request, State, Telemetry, TelemetryFields,
};
use trirrr_scene::{LongestStop, Scene, in_number_type, offer, units};
use trirrr_service::ServiceNumber;

/// Scenes whose job the service plays.
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");

/// Greatest time and way of the holds of a job, in parts of what is told; and their number.
#[derive(Clone, Copy, Debug, Default)]
struct Held {
    time: f64,
    way: f64,
    count: u32,
}

impl Held {
    fn merge(&mut self, other: Self) {
        self.time = self.time.max(other.time);
        self.way = self.way.max(other.way);
        self.count += other.count;
    }
}

/// Repeatable random numbers.
struct Random(u64);

impl Random {
    fn below(&mut self, most: u64) -> u64 {
        let Self(state) = self;
        *state = state.wrapping_mul(6_364_136_223_846_793_005);
        *state = state.wrapping_add(1_442_695_040_888_963_407);
        (*state >> 33) % most
    }

    fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.below(1 << 30) as f64 / f64::from(1 << 30)
    }
}

/// A service that plays the job of a scene.
struct Bench<'a, N: ServiceNumber> {
    machine: &'a mut dyn LocalService<N>,
    sequence: u32,
    moves: Vec<Command<N>>,
    offered: usize,
    ticks: u32,
    sample: Option<Telemetry<N>>,
}

impl<'a, N: ServiceNumber> Bench<'a, N> {
    fn new(machine: &'a mut dyn LocalService<N>, scene: &Scene) -> Self {
        let units = units::<N>(scene).expect("units of a scene that can be read");
        let moves = offer::moves::<N>(scene, &units);
        let command = Command::Hello(local::hello::<N>(scene));
        let request = Request {
            sequence: 0,
            command,
        };
        let Reply::Hello(identity) = machine.answer(&request) else {
            panic!("no identity");
        };
        let mut bench = Self {
            machine,
            sequence: identity.next_sequence,
            moves: moves.iter().map(|each| each.command()).collect(),
            offered: 0,
            ticks: 0,
            sample: None,
        };
        let fields = TelemetryFields::ALL;
        bench.done(Command::Telemetry { every: 1, fields });
        bench.done(Command::Enable);
        while bench.machine.state() != State::Idle {
            bench.tick();
        }
        bench
    }

    fn ask(&mut self, command: Command<N>) -> Reply<N> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        self.machine.answer(&Request { sequence, command })
    }

    fn done(&mut self, command: Command<N>) {
        let reply = self.ask(command);
        assert!(matches!(reply, Reply::Done), "{reply:?}");
    }

    /// Offers moves as long as there is room.
    fn supply(&mut self) {
        while let Some(command) = self.moves.get(self.offered) {
            if !matches!(self.ask(*command), Reply::Done) {
                break;
            }
            self.offered += 1;
            while self.machine.step() {}
        }
    }

    fn tick(&mut self) -> State {
        self.machine.tick();
        self.ticks += 1;
        if self.ticks.is_multiple_of(4) {
            // The host is heard, at 10 Hz and a timeout of 1 s, too.
            self.ask(Command::Status);
            self.supply();
        }
        while self.machine.step() {}
        while let Some(message) = self.machine.outgoing() {
            if let Message::Telemetry(sample) = message {
                self.sample = Some(sample);
            }
        }
        self.machine.state()
    }
}

/// Plays the job once at `percent` of normal speed, with a hold wherever a tick of it was not `seen` yet; and one in the
/// midst of some resumes.
fn play<N: HostNumber>(
    scene: &Scene,
    told: &LongestStop,
    percent: u8,
    seen: &mut HashSet<(u32, u32)>,
    random: &mut Random,
) -> Held {
    let moves = scene.job.moves.iter();
    let segments = moves.map(|each| each.segment(each.duration_ticks, scene.period_s()));
    let segments: Vec<Segment<f64, Quintics>> = segments.collect();
    let whole = 256.0 * f64::from(scene.ramp().ticks);
    let place = |sample: &Telemetry<N>| {
        let part = (sample.part != 0).then_some(f64::from(sample.part) / whole);
        let pose = segments[sample.number as usize]
            .between(sample.at, part)
            .pose;
        pose.position
    };
    let run = |machine: &mut dyn LocalService<N>| {
        let mut bench = Bench::new(machine, scene);
        bench.done(Command::FeedOverride { percent });
        bench.supply();
        bench.done(Command::Start);
        // A tick takes one order.
        while bench.machine.state() == State::Idle {
            bench.tick();
        }
        let mut held = Held::default();
        // Ticks of a resume until the next hold, now and then.
        let mut resumes = None;
        loop {
            let state = bench.tick();
            if state == State::Idle {
                return held;
            }
            assert!(
                matches!(state, State::Running | State::Holding),
                "{state:?}"
            );
            let sample = bench.sample.expect("a sample of each tick");
            let comes = match resumes {
                Some(left) => left == 0,
                None => sample.acting == Acting::Nothing && seen.insert((sample.number, sample.at)),
            };
            resumes = resumes.map(|left: u64| left.saturating_sub(1));
            if !comes {
                if sample.acting == Acting::Nothing {
                    resumes = None;
                }
                continue;
            }
            bench.done(Command::Hold);
            let (mut ticks, mut way, mut last) = (0, 0.0, place(&sample));
            loop {
                let state = bench.tick();
                ticks += 1;
                // A job that is over has no place any more: it was at its end in the tick before.
                if state != State::Idle {
                    let at = place(&bench.sample.expect("a sample of each tick"));
                    way += (at - last).norm();
                    last = at;
                }
                match state {
                    State::Slowing => {}
                    State::Holding | State::Idle => break,
                    state => panic!("{state:?}"),
                }
            }
            held.merge(Held {
                time: f64::from(ticks) * scene.period_s() / told.time_s,
                way: way / told.way_m.max(1e-300),
                count: 1,
            });
            if bench.machine.state() == State::Idle {
                return held;
            }
            bench.done(Command::Resume);
            resumes = (random.below(4) == 0).then(|| random.below(scene.ramp().ticks.into()));
        }
    };
    local::with_machine::<N, _>(scene, run).expect("a scene that can be built")
}

/// Holds of the job of `scene` at these paces: at every tick, or in the first `runs`.
fn hold(scene: &Scene, paces: &[u8], runs: usize) -> Held {
    let told = scene.longest_stop().expect("an admitted job");
    let mut random = Random(11);
    let mut held = Held::default();
    for percent in paces {
        let mut seen = HashSet::new();
        for _ in 0..runs {
            let before = seen.len();
            held.merge(in_number_type!(scene.number, N => {
                play::<N>(scene, &told, *percent, &mut seen, &mut random)
            }));
            if seen.len() == before {
                break;
            }
        }
    }
    let Held { time, way, count } = held;
    println!(
        "{}: time {time:.4} and way {way:.4} of what is told ({told}), {count} holds",
        scene.name
    );
    assert!(
        time <= 1.0 + 1e-9 && way <= 1.0 + 1e-9,
        "{}: {held:?}, {told}",
        scene.name
    );
    held
}

fn read(file: &str) -> Scene {
    Scene::read(format!("{SCENES}/{file}")).unwrap_or_else(|error| panic!("{error}"))
}

/// A random job on the thesis machine, with limits near to what it needs. None if it is not read.
fn random_scene(random: &mut Random) -> Option<Scene> {
    let text = include_str!("../../scenes/thesis.toml");
    let (machine, _) = text.split_once("[limits]").expect("limits");
    let rate = [20, 50, 100, 200, 500][random.below(5) as usize];
    let machine = machine.replacen("tick_rate_hz = 100", &format!("tick_rate_hz = {rate}"), 1);
    let number = ["f64", "f32"][random.below(2) as usize];
    let machine = machine.replacen("number = \"f64\"", &format!("number = \"{number}\""), 1);
    let hold = [0.05, 0.1, 0.3][random.below(3) as usize];
    let mut pose = || {
        let [x, y, alpha] =
            [(0.2, 0.3), (0.18, 0.3), (-0.3, 0.5)].map(|(a, b)| random.within(a, b));
        format!("{{ x_m = {x:?}, y_m = {y:?}, alpha_rad = {alpha:?} }}")
    };
    let poses = [(); 5].map(|()| pose());
    let [start, to @ ..] = &poses;
    let mut job = format!("[job]\nstart = {start}\n");
    let count = 1 + random.below(4) as usize;
    for (index, to) in to.iter().enumerate().take(count) {
        let ticks = 1 + random.below(u64::from(rate as u32));
        let seconds = ticks as f64 / f64::from(rate);
        job += &format!("[[job.move]]\nto = {to}\nduration_s = {seconds:?}\n");
        if index + 1 < count {
            let [vx, vy] = [(); 2].map(|()| random.within(-0.2, 0.2));
            job += &format!(
                "end_velocity = {{ vx_m_s = {vx:?}, vy_m_s = {vy:?}, valpha_rad_s = 0.0 }}\n"
            );
        }
    }
    let read = |limits: &str| {
        let text = format!("{machine}[service]\nhold_ramp_s = {hold:?}\n[limits]\n{limits}\n{job}");
        Scene::parse(&text, "random.toml").ok()
    };
    // A torque that is enough for the job, and then less and less of it.
    let mut last = read("")?;
    let mut torque = 400.0;
    let least = random.below(60);
    for _ in 0..least {
        match read(&format!("torque_nm = {torque:?}")) {
            Some(scene) => last = scene,
            None => break,
        }
        torque *= 0.8;
    }
    Some(last)
}

/// Moves of few ticks, which are one part each: a hold in their midst takes much more way than one at their start.
#[test]
fn holds_keep_what_is_told_on_moves_of_few_ticks() {
    let limits = [
        "rate_rad_s = 2.0\ntorque_nm = 0.1",
        "rate_rad_s = 12.0\ntorque_nm = 4.0",
    ];
    let text = include_str!("../../scenes/thesis.toml").replacen(limits[0], limits[1], 1);
    for (rate, duration) in [(20, 0.7), (10, 1.5), (10, 1.0), (100, 0.15)] {
        let text = text
            .replacen("tick_rate_hz = 100", &format!("tick_rate_hz = {rate}"), 1)
            .replacen("duration_s = 1.0", &format!("duration_s = {duration:?}"), 1);
        let scene = Scene::parse(&text, "short.toml").unwrap_or_else(|error| panic!("{error}"));
        let held = hold(&scene, &[100, 50, 7], usize::MAX);
        assert!(held.way > 0.9 && held.count > 5, "{held:?}");
    }
}

#[test]
fn holds_keep_what_is_told() {
    for file in ["plant-thesis.toml", "thesis-links.toml"] {
        let held = hold(&read(file), &[100, 84, 23], usize::MAX);
        assert!(held.time > 0.9 && held.way > 0.9, "{held:?}");
    }
    // With parts where only a slower pace may brake.
    hold(&read("paths/pick.toml"), &[100, 87], 2);
}

#[test]
fn holds_keep_what_is_told_on_random_jobs() {
    let mut random = Random(5);
    let mut count = 0;
    while count < 8 {
        if let Some(scene) = random_scene(&mut random) {
            hold(&scene, &[100, 1 + random.below(99) as u8], 3);
            count += 1;
        }
    }
}

#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn holds_at_every_tick_keep_what_is_told_on_all_scenes_and_a_thousand_jobs() {
    let mut worst = Held::default();
    let mut scenes = 0;
    let folders = ["", "design", "inputs", "paths"];
    for folder in folders {
        let files = std::fs::read_dir(format!("{SCENES}/{folder}")).expect("a folder");
        let mut files: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
        files.sort();
        for file in files
            .iter()
            .filter(|file| file.extension().is_some_and(|end| end == "toml"))
        {
            let Ok(scene) = Scene::read(file) else {
                continue;
            };
            if scene.longest_stop().is_some_and(|told| told.way_m > 0.0) {
                worst.merge(hold(
                    &scene,
                    &[100, 99, 90, 84, 75, 60, 51, 50, 35, 20, 7, 1],
                    usize::MAX,
                ));
                scenes += 1;
            }
        }
    }
    let mut random = Random(1);
    let mut jobs = 0;
    let (mut drawn, mut tight) = (0, 0);
    while jobs < 1000 {
        drawn += 1;
        if let Some(scene) = random_scene(&mut random) {
            let paces = [100, 1 + random.below(99) as u8, 51 + random.below(49) as u8];
            let held = hold(&scene, &paces, usize::MAX);
            tight += u32::from(held.time > 0.9);
            worst.merge(held);
            jobs += 1;
        }
    }
    println!(
        "{scenes} scenes, {jobs} of {drawn} random jobs, {tight} with a hold of 90 % of the time: {worst:?}"
    );
    assert!(scenes > 20);
}
