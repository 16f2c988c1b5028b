//! Millions of ticks through the service in one run: the job of chained moves and the way back, over
//! and over, held and resumed in between. Every tick is where whole numbers say it is.

use trirrr_client::local::{self, LocalService};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::units::Units;
use trirrr_protocol::message::{
    Acting, AnyMove, Command, Message, Refusal, Reply, Request, State, Telemetry,
};
use trirrr_scene::offer;
use trirrr_scene::{self as scene, JobPlayer, Scene};

/// Ticks between a request and the next; the scene's host may be silent for 1000.
const ASK_EVERY: u64 = 100;

/// Ticks of the way back.
const BACK: u32 = 2000;

/// The scene of chained moves, with a move from where its job ends to where it starts.
fn there_and_back() -> Scene {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/chained.toml");
    let mut scene = Scene::read(file).unwrap();
    let last = *scene.job.moves.last().unwrap();
    scene.job.moves.push(scene::JobMove {
        from: last.to,
        to: scene.job.start,
        start_velocity: last.end_velocity,
        duration_ticks: BACK,
        ..last
    });
    scene
}

/// The client: offers moves, holds, resumes.
struct Client<'a> {
    machine: &'a mut dyn LocalService<f32>,
    cycle: Vec<AnyMove<f32>>,
    moves: u32,
    offered: u32,
    sequence: u32,
}

impl Client<'_> {
    fn ask(&mut self, command: Command<f32>) -> Reply<f32> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let reply = self.machine.answer(&Request { sequence, command });
        if let Reply::Hello(identity) = &reply {
            self.sequence = identity.next_sequence;
        }
        reply
    }

    fn done(&mut self, command: Command<f32>) {
        assert_eq!(self.ask(command), Reply::Done, "{command:?}");
    }

    fn feed(&mut self) {
        while self.offered < self.moves {
            let index = self.offered as usize % self.cycle.len();
            let number = self.offered;
            match self.ask(self.cycle[index].numbered(number).command()) {
                Reply::Done => self.offered += 1,
                Reply::Refused(Refusal::QueueFull) => break,
                reply => panic!("move {number}: {reply:?}"),
            }
        }
        while self.machine.step() {}
    }

    /// One tick, and its sample.
    fn tick(&mut self) -> Telemetry<f32> {
        self.machine.tick();
        let mut sample = None;
        while let Some(message) = self.machine.outgoing() {
            if let Message::Telemetry(telemetry) = message {
                assert!(sample.replace(telemetry).is_none(), "one sample per tick");
            }
        }
        sample.expect("a sample per tick")
    }
}

fn is_normal(sample: &Telemetry<f32>) -> bool {
    sample.state == State::Running && sample.acting == Acting::Nothing
}

/// The bits, for comparison: a sum that drifts differs in them first.
fn bits(setpoint: &Setpoint<f32>) -> [u32; 9] {
    let (pose, v, a) = (&setpoint.pose, &setpoint.velocity, &setpoint.acceleration);
    let values = [
        pose.position.x,
        pose.position.y,
        pose.angle,
        v.x,
        v.y,
        v.z,
        a.x,
        a.y,
        a.z,
    ];
    values.map(f32::to_bits)
}

#[test]
fn a_million_ticks_end_where_whole_numbers_say() {
    play(1_000_000);
}

#[test]
#[ignore = "a minute; cargo xtask nightly runs it"]
fn ten_million_ticks_end_where_whole_numbers_say() {
    play(10_000_000);
}

/// Plays rounds of the job for at least `ticks`.
fn play(ticks: u64) {
    let scene = there_and_back();
    let cycle: Vec<AnyMove<f32>> = offer::moves(&scene, &Units::SI);
    let player = JobPlayer::<f32>::new(&scene.job, scene.period_s());
    let ticks_of_cycle = u64::from(player.ticks());
    let starts: Vec<u64> = cycle
        .iter()
        .scan(0, |sum, each| {
            let start = *sum;
            *sum += u64::from(each.common().ticks);
            Some(start)
        })
        .collect();
    let cycles = ticks.div_ceil(ticks_of_cycle);
    let moves = cycles as u32 * cycle.len() as u32;
    let ramp = (scene.service.hold_ramp_s * scene.tick_rate_hz).round() as u64;
    assert_eq!(ramp, 100);
    // Path time of a sample in whole ticks, from the machine's count of moves and ticks in them.
    let place = |sample: &Telemetry<f32>| {
        let (round, index) = (
            u64::from(sample.number) / starts.len() as u64,
            sample.number as usize % starts.len(),
        );
        round * ticks_of_cycle + starts[index] + u64::from(sample.at)
    };

    local::with_machine::<f32, _>(&scene, |machine| {
        let mut client = Client {
            machine,
            cycle,
            moves,
            offered: 0,
            sequence: 0,
        };
        assert!(matches!(
            client.ask(Command::Hello(local::hello::<f32>(&scene))),
            Reply::Hello(_)
        ));
        client.done(Command::telemetry(1));
        client.tick();
        client.done(Command::Enable);
        client.tick();
        client.feed();
        client.done(Command::Start);

        let first = client.tick();
        assert_eq!((first.number, first.at, first.part), (0, 0, 0));
        let (mut elapsed, mut path) = (0_u64, 0_u64);
        let (mut holds, mut slow, mut delay, mut stands) = (0_u64, 0_u64, 0_u64, 0_u64);
        // Some 50,000 ticks apart, and never at the same place of the cycle.
        let mut next_hold = 41_234;
        let end = loop {
            let sample = client.tick();
            if sample.state == State::Idle {
                break sample;
            }
            elapsed += 1;
            if is_normal(&sample) {
                let now = place(&sample);
                if slow > 0 {
                    // Down to rest and up again is a triangle over twice the ramp: as much path as
                    // one ramp at normal speed. All other slow ticks are delay.
                    assert_eq!(now, path + ramp + 1, "after hold {holds}");
                    assert_eq!(slow, 2 * ramp + stands);
                    delay += slow - ramp;
                    (slow, stands) = (0, 0);
                } else {
                    assert_eq!(now, path + 1);
                }
                path = now;
                assert_eq!(sample.part, 0);
                // The end of a round is the start of the next, but for the last.
                let tick = match path == cycles * ticks_of_cycle {
                    true => ticks_of_cycle,
                    false => path % ticks_of_cycle,
                };
                assert_eq!(
                    bits(&sample.setpoint),
                    bits(&player.at(tick as u32)),
                    "tick {path} of the path"
                );
            } else {
                slow += 1;
                assert!(sample.tool <= 0.7, "{sample:?}");
                // The tick that comes to rest stands already, the last of the ramp.
                stands += u64::from(sample.state == State::Holding && slow > ramp);
            }
            if elapsed == next_hold {
                holds += 1;
                client.done(Command::Hold);
                next_hold += 49_000 + 13 * holds;
            } else if sample.state == State::Holding && slow == ramp + holds % 50 {
                client.done(Command::Resume);
            } else if elapsed.is_multiple_of(ASK_EVERY) {
                client.feed();
                assert!(matches!(client.ask(Command::Status), Reply::Status(_)));
            }
        };

        assert!(
            elapsed >= ticks && holds > ticks / 100_000,
            "{elapsed} {holds}"
        );
        assert_eq!(path, cycles * ticks_of_cycle, "path time");
        assert_eq!(elapsed, path + delay, "every tick is path or delay");
        // One more: the tick that found the end behind it.
        assert_eq!(u64::from(end.tick - first.tick), elapsed + 1);
        let start = player.at(0);
        assert_eq!(bits(&end.setpoint)[..3], bits(&start)[..3], "the end pose");
        assert_eq!(end.angles, first.angles);
        let Reply::Status(status) = client.ask(Command::Status) else {
            panic!("no status");
        };
        assert_eq!(
            (status.state, status.done, status.lost),
            (State::Idle, moves, 0)
        );
    })
    .unwrap();
}
