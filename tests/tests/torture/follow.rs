//! A machine that follows poses with velocities, and its client, in virtual time: the machine never waits for what cannot come.

use std::f64::consts::TAU;
use std::time::Duration;
use trirrr_bench::faulty_link::Random;
use trirrr_client::local::{self, HostNumber, LocalService};
use trirrr_client::{Dialogue, GoalClient, Patience, Turn, UserCommand};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Acting, Goal, Message, State};
use trirrr_scene::{NumberType, Scene, offer};
use trirrr_service::ServiceNumber;

/// Scenes with quintics, of three sizes and kinds of limits.
const SCENES: [&str; 5] = [
    "scenes/engraving.toml",
    "scenes/paths/onboard.toml",
    "scenes/paths/pick.toml",
    "scenes/paths/hourglass.toml",
    "scenes/plotter.toml",
];

/// Longest wait of the machine for a plan, and of the client for the end, s.
const PATIENCE_S: f64 = 5.0;

/// Count of curves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Followed {
    pub(crate) curves: u64,
    /// Goals that the machine has taken, those of them in motion, and those without a motion.
    pub(crate) goals: u64,
    pub(crate) moving: u64,
    pub(crate) refused: u64,
    pub(crate) cuts: u64,
    /// Curves that end at their last pose, and on the way to it.
    pub(crate) at_rest: u64,
    pub(crate) short: u64,
    pub(crate) holds: u64,
}

impl Followed {
    pub(crate) fn add(&mut self, other: &Self) {
        self.curves += other.curves;
        self.goals += other.goals;
        self.moving += other.moving;
        self.refused += other.refused;
        self.cuts += other.cuts;
        self.at_rest += other.at_rest;
        self.short += other.short;
        self.holds += other.holds;
    }
}

/// A circle through the start, and how it is followed.
struct Curve {
    centre: [f64; 2],
    radius_m: f64,
    from: f64,
    speed_m_s: f64,
    alpha: f64,
    /// From one pose to the next.
    every_s: f64,
    poses: u32,
    /// The last pose is at rest.
    rests: bool,
    /// Every so many poses one is at rest; the machine may be held at that time.
    pauses: u64,
    holds: bool,
    /// Slices of background work between two ticks.
    steps: u64,
}

impl Curve {
    fn drawn(random: &mut Random, scene: &Scene, poses: u32) -> Self {
        let start = scene.job.start;
        let radius_m = 0.004 + 0.02 * random.fraction();
        let from = TAU * random.fraction();
        Self {
            centre: [
                start.position.x - radius_m * from.cos(),
                start.position.y - radius_m * from.sin(),
            ],
            radius_m,
            from,
            speed_m_s: 0.02 + 0.1 * random.fraction(),
            alpha: start.angle,
            every_s: [0.02, 0.05, 0.1, 0.2, 0.4][random.below(5) as usize],
            poses,
            rests: random.below(2) == 0,
            pauses: [5, 1000][random.below(2) as usize],
            holds: random.below(4) == 0,
            steps: [8, 40, 400][random.below(3) as usize],
        }
    }

    /// Pose and velocity of number `index`, SI.
    fn at(&self, index: u32) -> ([f64; 3], [f64; 3]) {
        let way = self.speed_m_s * self.every_s * f64::from(index);
        let (sin, cos) = (self.from + way / self.radius_m).sin_cos();
        let [x, y] = self.centre;
        let pose = [x + self.radius_m * cos, y + self.radius_m * sin, self.alpha];
        let is_last = index == self.poses && self.rests;
        match is_last || u64::from(index) % self.pauses == 4 {
            true => (pose, [0.0; 3]),
            false => (pose, [-self.speed_m_s * sin, self.speed_m_s * cos, 0.0]),
        }
    }
}

/// Follows the curve of `seed` on `scene`.
fn follow<N: HostNumber>(scene: &Scene, seed: u64, poses: u32) -> Followed {
    let mut random = Random::new(seed);
    let curve = Curve::drawn(&mut random, scene, poses);
    local::with_machine::<N, _>(scene, |machine| {
        play(machine, scene, &curve, &mut random, seed)
    })
    .expect("a machine")
}

fn play<N: ServiceNumber>(
    machine: &mut dyn LocalService<N>,
    scene: &Scene,
    curve: &Curve,
    random: &mut Random,
    seed: u64,
) -> Followed {
    let units = trirrr_scene::units::<N>(scene).expect("units");
    let mut client = GoalClient::new(local::hello::<N>(scene), Patience::default(), 1);
    let mut tally = Followed {
        curves: 1,
        ..Followed::default()
    };
    let tick_s = 1.0 / scene.tick_rate_hz;
    let (mut next, mut since, mut is_held, mut cut) = (1, 0.0, false, None);
    for tick in 0_u32.. {
        let seconds = f64::from(tick) * tick_s;
        let now = Duration::from_secs_f64(seconds);
        if next <= curve.poses && seconds >= curve.every_s * f64::from(next) {
            let (pose, velocity) = curve.at(next);
            let velocity: [f64; 3] = units.velocity(&velocity.into()).into();
            client.aim(Goal {
                to: offer::pose(&units.pose(&Pose::from_f64(pose[0], pose[1], pose[2]))),
                velocity: velocity.map(N::from_f64),
                cut: true,
                least_ticks: 0,
            });
            tally.goals += 1;
            tally.moving += u64::from(velocity != [0.0; 3]);
            if curve.holds && random.below(8) == 0 {
                is_held = !is_held;
                tally.holds += u64::from(is_held);
                client.command(if is_held {
                    UserCommand::Hold
                } else {
                    UserCommand::Resume
                });
            }
            if next == curve.poses {
                client.command(UserCommand::Resume);
                is_held = false;
                client.finish();
                since = seconds;
            }
            next += 1;
        }
        loop {
            match client.poll(now) {
                Turn::Send(request) => {
                    let reply = machine.answer(&request);
                    let sequence = request.sequence;
                    client.receive(&Message::Reply { sequence, reply }, now);
                }
                Turn::Wait(_) => break,
                Turn::Reconnect => panic!("seed {seed}: silent"),
                Turn::Done(end) => {
                    end.unwrap_or_else(|why| panic!("seed {seed}: {why:?}"));
                    assert_eq!(machine.state(), State::Idle, "seed {seed}");
                    tally.short += u64::from(client.falls_short());
                    tally.at_rest += u64::from(!client.falls_short());
                    return tally;
                }
            }
        }
        machine.tick();
        for _ in 0..curve.steps {
            if !machine.step() {
                break;
            }
        }
        while let Some(message) = machine.outgoing() {
            client.receive(&message, now);
        }
        tally.refused += u64::from(client.take_refused().is_some());
        let Some(status) = client.status() else {
            continue;
        };
        tally.cuts += u64::from(status.cut != cut);
        cut = status.cut;
        let moves_on = !status.planning || is_held || status.state == State::Running;
        let waits = status.acting == Acting::Hold || next <= curve.poses && moves_on;
        if waits {
            since = seconds;
        }
        assert!(
            seconds - since < PATIENCE_S,
            "seed {seed}: frozen: {status:?}"
        );
    }
    unreachable!("ticks have no end")
}

/// `curves` of `poses` each on every scene, and one more for each scene that a machine of the other number type follows.
pub(crate) fn follow_all(curves: u64, poses: u32) -> Followed {
    let mut total = Followed::default();
    for (index, name) in SCENES.into_iter().enumerate() {
        let scene = Scene::read(format!("{}/../{name}", env!("CARGO_MANIFEST_DIR"))).expect(name);
        let mut here = Followed::default();
        for seed in 0..curves {
            let seed = 1000 * index as u64 + seed;
            here.add(&match scene.number {
                NumberType::F64 => follow::<f64>(&scene, seed, poses),
                _ => follow::<f32>(&scene, seed, poses),
            });
        }
        println!("{name}: {here:?}");
        total.add(&here);
    }
    total
}
