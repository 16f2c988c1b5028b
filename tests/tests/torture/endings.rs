//! Streams of a job that end in all ways at random instants, and are resumed until the job is complete: host and machine as they are, the
//! clock and the line made up.
//!
//! Conditions that have to hold: the whole path of the job is passed with its tool, no tool is on at rest or while the job is not played, and no stream
//! hangs.

use std::time::Duration;
use trirrr_bench::faulty_link::Random;
use trirrr_client::local::{LocalService, hello, with_machine};
use trirrr_client::{
    Dialogue, JobClient, JobFailure, JobMark, JobPlace, JobRest, Patience, Turn, UserCommand,
};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{
    Acting, AnyMove, Command, InputState, Message, Move, Request, State, Telemetry,
};
use trirrr_scene::{JobLevels, Scene};
use trirrr_service::board::InterlockReadings;

const TICK_RATE_HZ: f64 = 1000.0;

/// Duration of the way back to the job after a fault, s.
const BACK_S: f64 = 0.5;

/// Ticks from one entry of the journal to the next.
const JOURNAL_EVERY: u64 = 100;

/// Ticks that no stream of the job takes, with a second end and all ways.
const LONGEST: u64 = 60_000;

/// Way in which a stream ends, or is disturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ending {
    /// Key `s`, or Ctrl-C.
    Stop,
    /// Key `d`.
    Disable,
    /// Keys `h`, then `s`.
    HoldStop,
    /// Keys `h`, then `r`: the stream goes on.
    HoldResume,
    /// The host is killed.
    Kill,
    /// The host is killed while the machine holds.
    HoldKill,
    /// The host is killed, and another program stops the machine.
    OtherStop,
    /// The emergency stop of category 1 is pressed.
    EmergencyStop,
    /// A motor reaches its limit switch.
    LimitSwitch,
    /// The door is opened, then `s`.
    DoorStop,
    /// The door is opened and closed, then `r`.
    DoorResume,
    /// The door is opened, and the host is killed.
    DoorKill,
    /// The cable is pulled until the host gives up.
    Cable,
    /// No sample arrives any more, then `s`.
    Unseen,
    /// The machine loses its power.
    Power,
}

const ENDINGS: [Ending; 15] = [
    Ending::Stop,
    Ending::Disable,
    Ending::HoldStop,
    Ending::HoldResume,
    Ending::Kill,
    Ending::HoldKill,
    Ending::OtherStop,
    Ending::EmergencyStop,
    Ending::LimitSwitch,
    Ending::DoorStop,
    Ending::DoorResume,
    Ending::DoorKill,
    Ending::Cable,
    Ending::Unseen,
    Ending::Power,
];

/// A laser behind a door, with an emergency stop of category 1 and limit switches.
fn scene() -> Scene {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/inputs/guarded.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let limits = "[inputs.limits]\ndebounce_s = 0.002\n\n[limits]";
    let text = text.replacen("[limits]", limits, 1);
    Scene::parse(&text, path).unwrap()
}

/// A job of straight chains with corners at rest between them, moves of few ticks and of many, with the tool and without, and dwells.
fn job(random: &mut Random) -> Vec<AnyMove<f32>> {
    let mut moves = Vec::new();
    let mut at = [0.21_f64, 0.22];
    let pose = |[x, y]: [f64; 2]| Pose::from_f64(x, y, 0.157_079_632);
    for chain in 0..6 {
        let angle = 1.1 * f64::from(chain) + 0.3;
        let direction = [angle.cos(), angle.sin()];
        let count = 1 + random.below(5);
        let speed = 0.02 + 0.03 * random.fraction();
        let is_on = chain == 0 || random.below(4) > 0;
        for part in 0..count {
            let ends = part == 0 || part + 1 == count;
            let ticks = if ends { 80 } else { 15 } + random.below(75) as u32;
            let way = speed * f64::from(ticks) / TICK_RATE_HZ;
            let to = [at[0] + way * direction[0], at[1] + way * direction[1]];
            let velocity = |rests: bool| match rests {
                true => [0.0; 3],
                false => [
                    (speed * direction[0]) as f32,
                    (speed * direction[1]) as f32,
                    0.0,
                ],
            };
            moves.push(AnyMove::Cubic(Move {
                start_velocity: velocity(part == 0),
                end_velocity: velocity(part + 1 == count),
                tool_power: if is_on { 0.6 } else { 0.0 },
                tool_speed: if is_on { 0.15 } else { 0.0 },
                ..Move::rest_to_rest(0, pose(at), pose(to), ticks)
            }));
            at = to;
        }
        if random.below(3) == 0 {
            let ticks = 20 + random.below(100) as u32;
            moves.push(AnyMove::Cubic(Move::rest_to_rest(
                0,
                pose(at),
                pose(at),
                ticks,
            )));
        }
    }
    moves
}

/// Parts of the path that were passed with the tool as the job has it.
struct Witness {
    /// Ticks of the job before each move, and all.
    before: Vec<u32>,
    /// Moves with a tool.
    uses_tool: Vec<bool>,
    /// Ticks of the path that were passed, one after the other.
    passed: Vec<bool>,
    /// Place of the last sample with the tool of the job.
    last: Option<f64>,
    tool_at_rest: u32,
}

impl Witness {
    fn new(moves: &[AnyMove<f32>]) -> Self {
        let mut before = vec![0];
        for each in moves {
            before.push(before[before.len() - 1] + each.common().ticks);
        }
        Self {
            passed: vec![false; before[moves.len()] as usize],
            uses_tool: moves
                .iter()
                .map(|each| each.common().tool_power > 0.0)
                .collect(),
            before,
            last: None,
            tool_at_rest: 0,
        }
    }

    /// Takes the sample of a tick of the machine, at `place` of the job where it is of the job. The command of a tick holds up to the next.
    fn see(&mut self, sample: &Telemetry<f32>, tool: f32, place: Option<JobPlace>) {
        let velocity = sample.setpoint.velocity;
        let stands = velocity.x == 0.0 && velocity.y == 0.0;
        self.tool_at_rest += u32::from(tool > 0.0 && (stands || !sample.state.is_running()));
        let here = place.map(|place| f64::from(self.before[place.index as usize] + place.at));
        if let (Some(from), Some(to)) = (self.last, here) {
            // A ramp lies between ticks: they count once the machine is beyond them.
            for tick in from as usize..(to.ceil() as usize).min(self.passed.len()) {
                self.passed[tick] = true;
            }
        }
        let works = |place: JobPlace| {
            let uses_tool = self.uses_tool.get(place.index as usize) == Some(&true);
            tool > 0.0
                || (sample.state.is_running()
                    && (stands || !uses_tool)
                    && sample.acting != Acting::Door)
        };
        self.last = here.filter(|_| place.is_some_and(works));
    }

    /// Ticks of the job's path with the tool that were not passed with it.
    fn undone(&self) -> usize {
        let with_tool = self
            .before
            .windows(2)
            .zip(&self.uses_tool)
            .filter(|(_, uses)| **uses);
        let ticks = with_tool.flat_map(|(span, _)| span[0]..span[1]);
        ticks.filter(|tick| !self.passed[*tick as usize]).count()
    }
}

/// End of a conversation of a host.
enum End {
    Complete,
    Failed(JobFailure<f32>),
    /// The user goes on behind a door: back to where it was opened.
    GoesBack,
    /// The host is no more, or has given up.
    Gone,
    /// The machine has lost its power.
    Power,
}

/// The ending of a conversation, for whoever looks for the cause.
fn why(client: &JobClient<f32>, failure: &JobFailure<f32>) -> String {
    format!("{} ({failure:?})", client.describe(failure))
}

/// A job, its machine, and all that happens to them.
struct World {
    random: Random,
    scene: Scene,
    moves: Vec<AnyMove<f32>>,
    witness: Witness,
    mark: Option<JobMark>,
    /// Endings ahead, with the tick of their stream.
    plan: Vec<(u64, Ending)>,
    readings: InterlockReadings,
    now: u64,
    conversation: u32,
    why: String,
    /// Moves that the machine has the name of, and the number of the first.
    played: Option<(JobRest<f32>, u32)>,
}

impl World {
    fn new(seed: u64, endings: &[Ending]) -> Self {
        let mut random = Random::new(seed);
        let moves = job(&mut random);
        let witness = Witness::new(&moves);
        let ticks = witness.passed.len() as u64;
        let plan = endings
            .iter()
            .map(|ending| (random.below(ticks + 400), *ending));
        let plan = plan.collect();
        Self {
            random,
            scene: scene(),
            moves,
            witness,
            mark: None,
            plan,
            readings: InterlockReadings::default(),
            now: 0,
            conversation: 0,
            why: String::new(),
            played: None,
        }
    }

    /// Streams the job, and resumes it until it is complete.
    fn play(mut self) -> Witness {
        let scene = self.scene.clone();
        for _ in 0..20 {
            let is_complete = with_machine::<f32, _>(&scene, |machine| {
                for _ in 0..20 {
                    match self.stream(machine) {
                        End::Complete => return true,
                        End::Power => return false,
                        _ => {}
                    }
                    // A person sees to the machine: the causes of the end go away.
                    self.readings = InterlockReadings::default();
                    let wait = self.random.below(2500);
                    for _ in 0..wait {
                        self.tick(machine, &mut Vec::new());
                    }
                }
                panic!("the job does not end: {}", self.why);
            });
            if is_complete.unwrap() {
                return self.witness;
            }
            (self.witness.last, self.played) = (None, None);
        }
        panic!("the job does not end");
    }

    /// One tick of the machine, with its messages.
    fn tick(&mut self, machine: &mut dyn LocalService<f32>, messages: &mut Vec<Message<f32>>) {
        self.now += 1;
        machine.sense(self.readings);
        machine.tick();
        let tool = machine.output().tool;
        while machine.step() {}
        while let Some(message) = machine.outgoing() {
            if let Message::Telemetry(sample) = &message {
                let place = self.played.as_ref().and_then(|(rest, first)| {
                    let index = sample.number.checked_sub(*first)?;
                    let is_of_it = (index as usize) < rest.moves().len();
                    let plays = matches!(
                        sample.state,
                        State::Running
                            | State::Slowing
                            | State::Holding
                            | State::Stopping
                            | State::Reacting
                    );
                    (is_of_it && plays).then(|| {
                        rest.place(JobPlace {
                            index,
                            at: sample.at,
                        })
                    })
                });
                self.witness.see(sample, tool, place);
            }
            messages.push(message);
        }
    }

    /// One stream, as the command runs it.
    fn stream(&mut self, machine: &mut dyn LocalService<f32>) -> End {
        let is_resumed = self.mark.is_some();
        let mut mark = self.mark.unwrap_or_default().resumed();
        loop {
            let period = (1.0 / TICK_RATE_HZ) as f32;
            let rest = JobRest::listed(&self.moves, &JobLevels::default(), mark.from, period);
            if rest.moves().is_empty() {
                return End::Complete;
            }
            let begun = mark.begun();
            self.conversation += 1 << 16;
            let patience = Patience {
                answer: Duration::from_millis(50),
                attempts: 4,
            };
            let hello = hello::<f32>(&self.scene);
            let client = JobClient::new(rest.work(), hello, 1, patience, self.conversation);
            let client = match begun {
                Some(begun) => client.attached(begun),
                None if is_resumed || mark.from != JobPlace::default() => {
                    client.with_recovery(BACK_S)
                }
                None => client,
            };
            let (end, has_joined) = self.converse(machine, client, &rest, &mut mark);
            self.mark = Some(mark);
            let is_missing = begun.is_some() && !has_joined;
            match end {
                End::Failed(failure) if is_missing && failure.loses_job() => {}
                End::GoesBack => {}
                end => return end,
            }
            mark = JobMark::at(mark.reached);
        }
    }

    fn converse(
        &mut self,
        machine: &mut dyn LocalService<f32>,
        mut client: JobClient<f32>,
        rest: &JobRest<f32>,
        mark: &mut JobMark,
    ) -> (End, bool) {
        let end = self.converse_with(machine, &mut client, rest, mark);
        (end, client.has_joined())
    }

    fn converse_with(
        &mut self,
        machine: &mut dyn LocalService<f32>,
        client: &mut JobClient<f32>,
        rest: &JobRest<f32>,
        mark: &mut JobMark,
    ) -> End {
        let begin = self.now;
        let ending = self.plan.pop();
        let (mut is_unseen, mut is_cut, mut goes_back) = (false, false, false);
        let mut acts: Vec<(u64, Act)> = Vec::new();
        if let Some((at, ending)) = ending {
            acts = self.acts(begin + at, ending);
        }
        let mut written = None;
        // A user who resumes a job that is held has it go on.
        let mut resumes = mark.begun().is_some();
        loop {
            assert!(
                self.now < begin + LONGEST,
                "hangs after {ending:?}: {:?}",
                client.status()
            );
            if resumes && let Some(status) = client.status() {
                resumes = false;
                let holds = matches!(status.state, State::Slowing | State::Holding);
                if holds && matches!(status.acting, Acting::Hold | Acting::Door) {
                    acts.push((self.now, Act::Resume));
                }
            }
            while let Some(index) = acts.iter().position(|(at, _)| *at <= self.now) {
                match acts.remove(index).1 {
                    Act::Key(command) => client.command(command),
                    Act::Resume => match client.status() {
                        Some(status) if status.acting == Acting::Door => {
                            // A status that is older than the door tells the user to wait.
                            match status.inputs.door == InputState::Active {
                                true => acts.push((self.now + 50, Act::Resume)),
                                false => {
                                    goes_back = true;
                                    client.command(UserCommand::Stop);
                                }
                            }
                        }
                        _ => client.command(UserCommand::Resume),
                    },
                    Act::Sense(readings) => self.readings = readings,
                    Act::Unseen => is_unseen = true,
                    Act::Cut => is_cut = true,
                    Act::Power => return End::Power,
                    Act::Kill => return End::Gone,
                    Act::OtherStop => {
                        self.other_stop(machine);
                        return End::Gone;
                    }
                }
            }
            let now = Duration::from_secs_f64(self.now as f64 / TICK_RATE_HZ);
            let mut asked = 0;
            loop {
                match client.poll(now) {
                    Turn::Send(_) if is_cut => {}
                    Turn::Send(Request { sequence, command }) => {
                        asked += 1;
                        assert!(
                            asked < 1000,
                            "asks on and on: {command:?} {:?}",
                            client.status()
                        );
                        let reply = machine.answer(&Request { sequence, command });
                        client.receive(&Message::Reply { sequence, reply }, now);
                    }
                    Turn::Wait(_) => break,
                    Turn::Reconnect => return End::Gone,
                    Turn::Done(result) => {
                        mark.note(client, |place| rest.place(place));
                        return match result {
                            Ok(()) => End::Complete,
                            Err(JobFailure::Stopped { .. }) if goes_back => End::GoesBack,
                            Err(failure) => {
                                self.why = why(client, &failure);
                                End::Failed(failure)
                            }
                        };
                    }
                }
                // The journal has the name of the job before a move of it is offered.
                if client.status().is_some() && mark.first_move != client.first_move() {
                    mark.note(client, |place| rest.place(place));
                }
            }
            if client.status().is_some() && written.is_none_or(|at| self.now >= at + JOURNAL_EVERY)
            {
                written = Some(self.now);
                mark.note(client, |place| rest.place(place));
            }
            if let Some(first) = client.first_move() {
                self.played = Some((rest.clone(), first));
            }
            let mut messages = Vec::new();
            self.tick(machine, &mut messages);
            for message in &messages {
                let is_sample = matches!(message, Message::Telemetry(_));
                if !(is_cut || is_unseen && is_sample) {
                    client.receive(message, now);
                }
            }
        }
    }

    /// Another program says hello and stops the machine.
    fn other_stop(&mut self, machine: &mut dyn LocalService<f32>) {
        let hello = Request {
            sequence: 0xffff_0000,
            command: Command::Hello(hello::<f32>(&self.scene)),
        };
        let trirrr_protocol::message::Reply::Hello(identity) = machine.answer(&hello) else {
            panic!("no hello");
        };
        machine.answer(&Request {
            sequence: identity.next_sequence,
            command: Command::Stop,
        });
        for _ in 0..300 {
            self.tick(machine, &mut Vec::new());
        }
    }

    /// Acts of an ending at the tick `at`.
    fn acts(&mut self, at: u64, ending: Ending) -> Vec<(u64, Act)> {
        use UserCommand::{Disable, Hold, Stop};
        let later = at + 1 + self.random.below(250);
        let clear = InterlockReadings::default();
        let open = InterlockReadings {
            door: true,
            ..clear
        };
        let pressed = InterlockReadings {
            emergency_stop: true,
            ..clear
        };
        let limit = InterlockReadings {
            limits: [false, true, false],
            ..clear
        };
        match ending {
            Ending::Stop => vec![(at, Act::Key(Stop))],
            Ending::Disable => vec![(at, Act::Key(Disable))],
            Ending::HoldStop => vec![(at, Act::Key(Hold)), (later, Act::Key(Stop))],
            Ending::HoldResume => vec![(at, Act::Key(Hold)), (later, Act::Resume)],
            Ending::Kill => vec![(at, Act::Kill)],
            Ending::HoldKill => vec![(at, Act::Key(Hold)), (later, Act::Kill)],
            Ending::OtherStop => vec![(at, Act::OtherStop)],
            Ending::EmergencyStop => vec![(at, Act::Sense(pressed)), (later, Act::Sense(clear))],
            Ending::LimitSwitch => vec![(at, Act::Sense(limit)), (later, Act::Sense(clear))],
            Ending::DoorStop => vec![
                (at, Act::Sense(open)),
                (at + 20, Act::Sense(clear)),
                (later + 20, Act::Key(Stop)),
            ],
            Ending::DoorResume => vec![
                (at, Act::Sense(open)),
                (later + 20, Act::Sense(clear)),
                (later + 400, Act::Resume),
            ],
            Ending::DoorKill => vec![
                (at, Act::Sense(open)),
                (at + 20, Act::Sense(clear)),
                (later + 20, Act::Kill),
            ],
            Ending::Cable => vec![(at, Act::Cut)],
            Ending::Unseen => vec![(at, Act::Unseen), (later, Act::Key(Stop))],
            Ending::Power => vec![(at, Act::Power)],
        }
    }
}

/// Something that happens.
#[derive(Clone, Copy, Debug)]
enum Act {
    Key(UserCommand),
    Resume,
    Sense(InterlockReadings),
    /// No sample arrives any more.
    Unseen,
    /// Nothing arrives any more.
    Cut,
    Power,
    Kill,
    OtherStop,
}

/// Ends `streams` streams, one or several of a job. Returns the ticks of paths left undone, and those with the tool on at rest.
pub(crate) fn end_streams(streams: u64) -> [usize; 2] {
    let (mut undone, mut tool_at_rest) = (0, 0);
    let mut index = 0;
    while index < streams {
        let mut random = Random::new(index);
        let count = (1 + random.below(3)).min(streams - index);
        let endings: Vec<_> = (index..index + count)
            .map(|each| ENDINGS[each as usize % ENDINGS.len()])
            .collect();
        let witness = World::new(index, &endings).play();
        if witness.undone() > 0 || witness.tool_at_rest > 0 {
            println!(
                "seed {index}, {endings:?}: {} ticks undone, {} with the tool at rest",
                witness.undone(),
                witness.tool_at_rest
            );
        }
        undone += witness.undone();
        tool_at_rest += witness.tool_at_rest as usize;
        index += count;
    }
    println!(
        "{streams} streams were ended: {undone} ticks of path undone, {tool_at_rest} with the tool on at rest"
    );
    [undone, tool_at_rest]
}
