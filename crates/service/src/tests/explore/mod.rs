//! All states of the service that a model of its commands reaches: every command is survivable, and from each state a way leads out.
//!
//! The search is breadth first. Each state is reached anew by the shortest list of acts that leads to it, on a service of its own, and every act is
//! tried from there. States that a host and the outputs cannot tell apart are one. Seven machines are explored: one without anything more, one that is
//! sent to goals in motion, one that has to be homed, one that plays power lists, one whose drives tell where they are and feel contacts, one with an emergency stop and a door, and one
//! with a probe and limit switches.

mod guarded;
mod homed;
mod listed;
mod measured;
mod moving;
mod plain;
mod touching;

use super::transitions::{assert_taken, taken};
use super::*;
use crate::settings::{PowerTimes, Reactions};
use std::collections::{BTreeSet, VecDeque};
use std::format;
use std::string::String;
use trirrr_protocol::message::scene::{Section, SectionName};
use trirrr_protocol::message::{
    Acting, AnyMove, DriveFault, FaultCode, Goal, LEVEL_PARTS, LevelPiece, LevelRange, ListedMove,
    Recovery,
};

/// Ticks that an accepted command is watched for.
const WATCHED: u32 = 40;

/// Ticks of silence after which the machine acts.
const TIMEOUT: u32 = 60;

/// An act of the host, of the world, or of time.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Act {
    Ask(Ask),
    /// A drive or the board fails.
    Fails(FaultCode),
    /// Something around the machine changes.
    World(World),
    Ticks(u32),
    /// The host says nothing until its timeout is over.
    Silence,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Ask {
    Enable,
    Disable,
    Start,
    /// A run with the probe; away from what it touches.
    Probe {
        away: bool,
    },
    Hold,
    Resume,
    Stop,
    ClearFault,
    Home,
    Recover,
    RecoverFar,
    Offer,
    OfferMoving,
    /// A goal at rest, by a cut.
    Retarget,
    /// A goal in motion, by a cut; a little way ahead, less than it takes to stop.
    RetargetMoving {
        near: bool,
    },
    /// Levels, behind those given.
    Levels,
    /// A move with the last levels given.
    Listed,
    Feed(u8),
    /// Limits of the torque, N m; none.
    Torque(Option<f64>),
    Gravity(f64),
}

/// A change around the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
enum World {
    /// Switches of homing.
    Switches(Switches),
    /// The drive of the first motor is off its command, or follows it.
    Slips(bool),
    /// That of the second is silent, or tells.
    Silent(bool),
    /// That of the third has an error, or none.
    Errs(bool),
    /// Something pushes the platform, or nothing.
    Pushes(bool),
    /// A person presses the emergency stop, or lets it go.
    Presses(bool),
    /// The door is opened, or closed.
    Opens(bool),
    /// The probe touches, or nothing.
    Touches(bool),
    /// The second motor is on its limit switch, or off it.
    Limits(bool),
}

/// Working of the switches of homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Switches {
    /// Each is closed where its motor is beyond it.
    True,
    Open,
    Closed,
    /// The first is closed, the others are as they should be.
    FirstClosed,
}

/// A machine to explore.
trait Explored: Sized {
    type Scene: Scene<N = f64> + 'static;

    /// Acts that are tried in each state.
    const ACTS: &'static [Act];

    /// Acts that lead to where the search begins.
    const STARTS: &'static [&'static [Act]] = &[&[]];

    /// The machine as it is switched on.
    fn switched_on() -> Self;

    fn bench(&mut self) -> &mut Bench<Self::Scene>;

    /// One tick of the machine and of what is around it.
    fn tick(&mut self) -> Output<f64>;

    fn change(&mut self, _: World) {}

    /// Returns true if the machine has to refuse the command, whatever its state is.
    fn refuses(&mut self, _: Ask) -> bool {
        false
    }

    /// Returns true if its drives are off for good.
    fn is_off(&mut self) -> bool {
        self.bench().state() == State::Disabled
    }

    /// All around the machine is as it should be.
    fn mend(&mut self) {}

    /// All around the machine that tells one state from another.
    fn world(&self) -> String {
        String::new()
    }

    fn command(&mut self, ask: Ask) -> Command<f64> {
        let status = self.bench().status();
        let from = status.end.map_or(home(), |end| end.pose);
        let velocity = status.end.map_or([0.0; 3], |end| end.velocity.into());
        let there = if from.position.x < 0.24 {
            pose(0.25, 0.25, 0.18)
        } else {
            home()
        };
        let offer = |end_velocity: [f64; 3]| {
            Command::Move(Move {
                start_velocity: velocity,
                end_velocity,
                tool_power: 0.5,
                ..rest(status.next, from, there, 60)
            })
        };
        let goal = |to, velocity, least_ticks| {
            Command::Retarget(Goal {
                to,
                velocity,
                cut: true,
                least_ticks,
            })
        };
        match ask {
            Ask::Enable => Command::Enable,
            Ask::Disable => Command::Disable,
            Ask::Start => Command::Start,
            Ask::Probe { away } => Command::Probe { away },
            Ask::Hold => Command::Hold,
            Ask::Resume => Command::Resume,
            Ask::Stop => Command::Stop,
            Ask::ClearFault => Command::ClearFault,
            Ask::Home => Command::Home,
            Ask::Recover => Command::Recover(Recovery {
                to: home(),
                ticks: 20,
            }),
            Ask::RecoverFar => Command::Recover(Recovery {
                to: pose(0.27, 0.24, 0.1),
                ticks: 30,
            }),
            Ask::Offer => offer([0.0; 3]),
            Ask::OfferMoving => offer([0.02, 0.01, 0.0]),
            Ask::Retarget => goal(there, [0.0; 3], 0),
            Ask::RetargetMoving { near: false } => goal(there, [0.02, 0.01, 0.0], 0),
            Ask::RetargetMoving { near: true } => {
                let at = self.bench().service.foreground.pose.position;
                goal(pose(at.x + 2e-3, at.y + 1e-3, 0.16), [0.05, 0.025, 0.0], 4)
            }
            Ask::Levels => Command::Levels(LevelPiece::new(self.next_level(), &[90; 60])),
            Ask::Listed => {
                let range = LevelRange {
                    first: self.next_level().wrapping_sub(60),
                    count: 60,
                    offset: 0,
                    span: 60 * LEVEL_PARTS,
                };
                let Command::Move(each) = offer([0.0; 3]) else {
                    unreachable!("an offer is a move");
                };
                let start = AnyMove::Cubic(each).end();
                let start = status.end.unwrap_or(start);
                Command::Listed(ListedMove::new(
                    status.next,
                    &start,
                    &AnyMove::Cubic(each),
                    range,
                ))
            }
            Ask::Feed(percent) => Command::FeedOverride { percent },
            Ask::Torque(limit) => {
                let limits = LimitParameters {
                    torque_nm: limit.map(|limit| [limit; 3]),
                    ..LimitParameters::default()
                };
                replace(SectionName::Limits, &example(), &limits)
            }
            Ask::Gravity(y) => {
                let limits = LimitParameters::default();
                replace(SectionName::Platform, &under(y), &limits)
            }
        }
    }

    /// Number of the next level; 0 of a machine that takes none.
    fn next_level(&mut self) -> u32 {
        let far = LevelPiece::new(u32::MAX / 2, &[0]);
        match self.bench().ask(Command::Levels(far)) {
            Reply::Refused(Refusal::LevelNumber { expected }) => expected,
            _ => 0,
        }
    }

    /// Does the act. Returns true if it was a command that was accepted.
    fn act(&mut self, act: Act) -> bool {
        match act {
            Act::Ask(ask) => {
                let command = self.command(ask);
                let refuses = self.refuses(ask);
                let accepted = self.bench().ask(command) == Reply::Done;
                assert!(!(accepted && refuses), "{ask:?} was accepted");
                self.bench().judge();
                return accepted;
            }
            Act::Fails(code) => {
                self.bench()
                    .service
                    .foreground
                    .raise(code, Some(0), 1.0, 0.5);
                self.told();
            }
            Act::World(world) => self.change(world),
            Act::Ticks(ticks) => self.watched(ticks),
            Act::Silence => {
                for _ in 0..TIMEOUT + u32::from(RAMP) + 2 {
                    self.told();
                }
            }
        }
        false
    }

    /// One tick, compared with the table of the states: tool, drives and rest are so on any machine.
    fn told(&mut self) {
        let output = self.tick();
        let state = self.bench().service.foreground.state();
        if has_no_torque(state) {
            let torques = output.motors.map(|motor| motor.torque);
            assert_eq!(torques, [0.0; 3], "{state:?}");
        }
    }

    /// Ticks of a machine whose host is there.
    fn watched(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.told();
            self.bench().ask(Command::Status);
            self.bench().judge();
        }
    }

    /// The fault that comes in the next `ticks`, or is latched, where all around the machine is as it should be.
    fn fault_within(&mut self, ticks: u32) -> Option<FaultCode> {
        self.mend();
        self.watched(ticks);
        let fault = self.bench().status().fault;
        fault.map(|fault| fault.code)
    }

    /// Returns true if the status is ahead of the tick, by an order that the tick has not taken.
    fn is_ordered(&mut self) -> bool {
        self.bench().status().state != self.bench().service.foreground.state()
    }

    /// All that tells one state of it from another, for a host and at its outputs.
    fn key(&mut self) -> String {
        let status = self.bench().status();
        let output = *self.bench().service.foreground.output();
        let sample = self.bench().telemetry.last().copied();
        let place = sample.map(|sample| (sample.at > 0, sample.part > 0));
        let limits = *self.bench().service.foreground.guard.limits();
        format!(
            "{} {:?} {:?} {:?} {:?} queued {} judged {} room {} planning {} end {:?} refused {} feed {} {:?} {:?} {:?} {:?} {}",
            self.world(),
            self.bench().service.foreground.state(),
            status.state,
            status.acting,
            status.fault.map(|fault| fault.code),
            status.next.wrapping_sub(status.done).min(2),
            status.next == status.admitted,
            status.room == 7,
            status.planning,
            status
                .end
                .map(|end| end.velocity.iter().any(|part| *part != 0.0)),
            status.refused.is_some(),
            status.feed_percent,
            output.power,
            output.brake_released,
            place,
            limits,
            self.bench().service.foreground.pose.position.x < 0.24,
        )
    }

    /// The documented way to `Idle` out of any state, where all around the machine is as it should be. Returns false if it leads to none.
    fn leaves(&mut self) -> bool {
        self.mend();
        for _ in 0..60 {
            match self.bench().state() {
                State::Idle => return true,
                State::Fault => _ = self.bench().ask(Command::ClearFault),
                State::Disabled => _ = self.bench().ask(Command::Enable),
                State::Unhomed => _ = self.bench().ask(Command::Home),
                State::Cleared => {
                    let recovery = self.command(Ask::Recover);
                    self.bench().ask(recovery);
                }
                State::Running | State::Slowing | State::Holding => {
                    _ = self.bench().ask(Command::Stop)
                }
                _ => {}
            }
            self.watched(25);
        }
        false
    }

    /// The documented way of a motion to its goal, where all around the machine is as it should be: a hold is resumed, plans and cuts end by
    /// themselves, and where the machine waits for moves another goal leads on. No stop is needed. Returns false if it does not get there.
    fn goes_on(&mut self) -> bool {
        self.mend();
        for _ in 0..60 {
            let status = self.bench().status();
            let command = match status.state {
                State::Running => Command::Status,
                State::Slowing | State::Holding if status.acting != Acting::QueueDry => {
                    Command::Resume
                }
                State::Holding if !status.planning => self.command(Ask::Retarget),
                State::Slowing | State::Holding => Command::Status,
                _ => return true,
            };
            self.bench().ask(command);
            self.watched(25);
        }
        false
    }

    /// The documented way to drives that are off, whatever is wrong around the machine. Returns false if it leads to none.
    fn goes_off(&mut self) -> bool {
        for _ in 0..60 {
            if self.is_off() {
                return true;
            }
            match self.bench().state() {
                State::Fault => _ = self.bench().ask(Command::ClearFault),
                _ => _ = self.bench().ask(Command::Disable),
            }
            self.watched(10);
        }
        false
    }
}

/// The machine under so much gravity along y, m/s^2.
fn under(gravity: f64) -> Parameters {
    let mut parameters = example();
    parameters.gravity_m_s2.y = gravity;
    parameters
}

/// Command that replaces a part of the scene by that of `parameters` or `limits`.
fn replace(name: SectionName, parameters: &Parameters, limits: &LimitParameters) -> Command<f64> {
    Command::Replace(Section::of(name, parameters, limits).unwrap())
}

/// Settings of a machine whose drives and brake take their time.
fn timed_settings() -> Settings<f64> {
    Settings {
        power: PowerTimes {
            drives_ticks: 2,
            brake_release_ticks: 1,
            brake_engage_ticks: 2,
        },
        reactions: Reactions::default(),
        host_timeout_ticks: TIMEOUT,
        ..settings()
    }
}

/// The machine at the end of the acts.
fn reached<M: Explored>(acts: &[Act]) -> M {
    let mut machine = M::switched_on();
    for act in acts {
        machine.act(*act);
    }
    machine
}

/// Acts that are tried. Says so if something panics meanwhile.
struct Trial<'a>(&'a [Act], Option<Act>);

impl Drop for Trial<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            std::eprintln!("behind {:?}: {:?}", self.0, self.1);
        }
    }
}

/// Extent of a search.
struct Extent {
    /// Names of the states.
    kinds: BTreeSet<String>,
    /// Acts on the way from a start to the furthest state.
    deepest: usize,
}

/// Explores the states that at most `depth` acts lead to from a start, and tells apart which command is on its way to the tick; without a
/// depth all states, until nothing new is found, and any commands on their way that lead to the same status are one.
fn explore<M: Explored>(depth: Option<usize>) -> Extent {
    let mut known = BTreeSet::new();
    let mut open = VecDeque::new();
    for start in M::STARTS {
        known.insert(reached::<M>(start).key());
        open.push_back((start.to_vec(), 0));
    }
    let mut kinds = BTreeSet::new();
    let (mut tried, mut deepest) = (0_u32, 0);
    while let Some((acts, way)) = open.pop_front() {
        deepest = way;
        let _trial = Trial(&acts, None);
        let mut machine = reached::<M>(&acts);
        let here = machine.key();
        kinds.insert(format!("{:?}", machine.bench().service.foreground.state()));
        let lost = |way: &str, machine: &mut M| {
            panic!(
                "no way to {way} behind {acts:?}: {:?}",
                machine.bench().status()
            )
        };
        if !machine.leaves() {
            lost("Idle", &mut machine);
        }
        machine = reached(&acts);
        if !machine.goes_on() {
            lost("a goal", &mut machine);
        }
        machine = reached(&acts);
        if !machine.goes_off() {
            lost("Disabled", &mut machine);
        }
        for act in M::ACTS {
            let _trial = Trial(&acts, Some(*act));
            let mut machine = reached::<M>(&acts);
            let before = machine.bench().status().fault;
            tried += 1;
            let accepted = machine.act(*act);
            let mut key = machine.key();
            // An order is on its way to the tick: the status tells what it will lead to, or nothing does yet, but not which it is.
            if accepted && depth.is_some() && (machine.is_ordered() || key == here) {
                key += &format!(" {act:?}");
            }
            if depth.is_none_or(|depth| way < depth) && known.insert(key) {
                let mut next = acts.clone();
                next.push(*act);
                open.push_back((next, way + 1));
            }
            if accepted {
                let after = machine.fault_within(WATCHED);
                // What fails anyhow is not the fault of the command.
                let is_fatal = after.is_some()
                    && after != before.map(|fault| fault.code)
                    && reached::<M>(&acts).fault_within(WATCHED) != after;
                assert!(
                    !is_fatal,
                    "{act:?} was accepted and is fatal behind {acts:?}: {after:?}"
                );
            }
        }
    }
    std::println!(
        "{} states of {} kinds, {tried} acts tried, the furthest state {deepest} acts away: {kinds:?}",
        known.len(),
        kinds.len()
    );
    Extent { kinds, deepest }
}

/// States in which no torque is known.
fn has_no_torque(state: State) -> bool {
    matches!(
        state,
        State::Disabled
            | State::Fault
            | State::Cleared
            | State::Recovering
            | State::Unhomed
            | State::Homing
    )
}
