mod accounts;
mod batches;
mod contact;
mod digital;
mod explore;
mod faults;
mod feedback;
mod homing;
mod interlocks;
mod levels;
mod limit_switches;
mod moves;
mod own_job;
mod path;
mod probe;
mod random;
mod reactions;
mod retarget;
mod scene;
mod sequence;
mod shared;
mod splice;
mod states;
mod threads;
mod transitions;
mod updates;
mod values;

pub(crate) use transitions::take_note;

use super::*;
use crate::admission::Enclose;
use crate::number::ServiceNumber;
use std::boxed::Box;
use std::vec::Vec;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{Parameters, example};
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;
use trirrr_protocol::message::{
    AngleReference, Board, Command, DriveSample, Event, Firmware, Hello, Identity, Message, Move,
    PROTOCOL, Refusal, Reply, Request, State, Status, Telemetry,
};
use trirrr_protocol::wire::{Decoder, encode};

/// Part of `cases` that a build without optimisation takes, at least one: all of them are for `cargo xtask nightly`, which
/// optimises.
pub(crate) const fn share(cases: u32) -> u32 {
    match cfg!(debug_assertions) {
        true => cases.div_ceil(10),
        false => cases,
    }
}

pub(super) const RAMP: u16 = 10;
pub(super) const SILENCE: u32 = 1000;
pub(super) const PERIOD_S: f64 = 0.01;
pub(super) const SCHEMA: u64 = 0x1234;
pub(super) const SCENE: u32 = 77;

/// Levels for which there is room in scenes with power lists.
pub(super) const LEVELS: usize = 256;

/// The thesis machine, whose parts can be changed.
pub(super) type Thesis<N> = Adjustable<Dynamic<N>>;

crate::scene! {
    /// The thesis machine with homing, whose drives tell where they are.
    pub(super) Homed [N: ServiceNumber] [N]: Thesis<N>, batches = On, update = NoImage, homing = On, feedback = On
}

/// A service, with what it said so far.
pub(super) struct Bench<S: Scene + 'static> {
    pub(super) service: Service<'static, S>,
    sequence: u32,
    /// What the tick is told of switches.
    pub(super) inputs: [bool; 3],
    pub(super) telemetry: Vec<Telemetry<S::N>>,
    pub(super) drives: Vec<DriveSample<S::N>>,
    pub(super) events: Vec<Event<S::N>>,
}

/// What `background` answers to a request, both over a line.
pub(super) fn hear<N: ServiceNumber, S: Scene<N = N>>(
    background: &mut Background<'_, S>,
    sequence: u32,
    command: Command<N>,
) -> Reply<N> {
    let mut room = [0; 1024];
    let mut line = encode(&Request { sequence, command }, &mut room).unwrap();
    let mut decoder = Decoder::<1024>::new();
    let request = decoder.take(&mut line).unwrap().unwrap();
    let reply = background.answer(&request, decoder.checksum());
    let mut room = [0; 1024];
    let mut line = encode(&reply, &mut room).unwrap();
    decoder.take(&mut line).unwrap().unwrap()
}

/// Where the thesis's move starts.
pub(super) fn home<N: Enclose>() -> Pose<N> {
    pose(0.21, 0.22, 0.157)
}

pub(super) fn pose<N: Enclose>(x: f64, y: f64, alpha: f64) -> Pose<N> {
    Pose::from_f64(x, y, alpha)
}

pub(super) fn rest<N: Enclose>(number: u32, from: Pose<N>, to: Pose<N>, ticks: u32) -> Move<N> {
    Move::rest_to_rest(number, from, to, ticks)
}

pub(super) fn settings<N: Enclose>() -> Settings<N> {
    settings_in(Units::SI)
}

fn settings_in<N: Enclose>(units: Units) -> Settings<N> {
    Settings {
        period: N::factor_from_f64(units.time(PERIOD_S)),
        ramp: Ramp::within(RAMP, None),
        host_timeout_ticks: SILENCE,
        telemetry_every: 1,
        power: PowerTimes::default(),
        reactions: Reactions::OFF,
        planning: None,
        scene: SceneIdentity {
            schema: SCHEMA,
            key: SCENE,
            name: name("thesis"),
            tick_rate_hz: 1.0 / PERIOD_S,
            length_m: units.length_m(),
            time_s: units.time_s(),
            mass_kg: units.of(0, 0, 1),
            reference: AngleReference::Declared,
        },
        board: Board::HOST,
        firmware: &Firmware::SIMULATOR,
    }
}

impl<N: ServiceNumber> Bench<Thesis<N>> {
    pub(super) fn new() -> Self {
        Self::with(example(), LimitParameters::default())
    }

    pub(super) fn with(parameters: Parameters, limits: LimitParameters) -> Self {
        Self::of(Adjustable::new(parameters, limits), home())
    }
}

impl<N: ServiceNumber, S: Scene<N = N> + 'static> Bench<S> {
    pub(super) fn of(scene: impl Into<SceneParts<'static, S>>, stands: Pose<N>) -> Self {
        Self::in_units(scene, stands, Units::SI)
    }

    pub(super) fn in_units(
        scene: impl Into<SceneParts<'static, S>>,
        stands: Pose<N>,
        units: Units,
    ) -> Self {
        Self::set(scene, stands, settings_in(units))
    }

    /// Service with these settings, enabled.
    pub(super) fn set(
        scene: impl Into<SceneParts<'static, S>>,
        stands: Pose<N>,
        settings: Settings<N>,
    ) -> Self {
        let enable_ticks = 1 + u32::from(settings.power.enable_ticks());
        let mut bench = Self::off(scene, stands, settings);
        let reply = bench.service.submit(&Command::Enable);
        assert!(matches!(reply, Reply::Done));
        bench.ticks(enable_ticks);
        bench.events.clear();
        bench.telemetry.clear();
        bench
    }

    /// Service with these settings, as it is switched on.
    pub(super) fn off(
        scene: impl Into<SceneParts<'static, S>>,
        stands: Pose<N>,
        settings: Settings<N>,
    ) -> Self {
        Self::with_room::<64>(scene, stands, settings)
    }

    /// The same with room for so many samples. The memory is never freed: a test with many services keeps it small.
    pub(super) fn with_room<const SAMPLES: usize>(
        scene: impl Into<SceneParts<'static, S>>,
        stands: Pose<N>,
        settings: Settings<N>,
    ) -> Self {
        let channels: Channels<S, 8, SAMPLES, LEVELS> = Channels::new();
        let service = Box::leak(Box::new(channels))
            .service(scene, stands, settings)
            .unwrap();
        let mut bench = Self {
            service,
            sequence: 0,
            inputs: [false; 3],
            telemetry: Vec::new(),
            drives: Vec::new(),
            events: Vec::new(),
        };
        bench.greet();
        // Tests count from 0.
        bench.service.background.next_sequence_is(0);
        bench
    }

    pub(super) fn greet(&mut self) -> Identity {
        let hello = Hello {
            protocol: PROTOCOL,
            schema: SCHEMA,
            scene: SCENE,
        };
        match self.ask_as(12345, Command::Hello(hello)) {
            Reply::Hello(identity) => identity,
            other => panic!("{other:?}"),
        }
    }

    pub(super) fn ask_as(&mut self, sequence: u32, command: Command<N>) -> Reply<N> {
        hear(&mut self.service.background, sequence, command)
    }

    pub(super) fn ask(&mut self, command: Command<N>) -> Reply<N> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        self.ask_as(sequence, command)
    }

    #[track_caller]
    pub(super) fn done(&mut self, command: Command<N>) {
        assert_eq!(self.ask(command), Reply::Done, "{command:?}");
    }

    #[track_caller]
    pub(super) fn refused(&mut self, command: Command<N>) -> Refusal<N> {
        match self.ask(command) {
            Reply::Refused(refusal) => refusal,
            other => panic!("{command:?}: {other:?}"),
        }
    }

    pub(super) fn status(&mut self) -> Status<N> {
        self.service.status()
    }

    pub(super) fn state(&mut self) -> State {
        self.status().state
    }

    /// Judges all that is offered.
    pub(super) fn judge(&mut self) {
        let mut steps = 0;
        while self.service.step() {
            steps += 1;
            assert!(steps < 10_000_000, "never judged");
        }
    }

    /// One tick, with everything that it says taken in; the invariants that hold after any.
    pub(super) fn tick(&mut self) -> Output<N> {
        self.service.set_inputs(self.inputs);
        let output = *self.service.tick();
        let state = self.service.state();
        if !state.is_running() {
            assert_eq!(output.tool, N::ZERO, "the tool is on in {state:?}");
        }
        assert!(output.tool >= N::ZERO && output.tool <= N::ONE);
        // Drives are on in every state but these, and in part of the last two: while they are checked they are off.
        let is_checked = state == State::Disabling && output.power == Power::Check;
        if state != State::Enabling && !is_checked {
            let off = matches!(state, State::Disabled | State::Fault);
            assert!(output.is_on() != off, "{state:?} {:?}", output.power);
        }
        assert!(output.is_on() || !output.brake_released);
        for motor in &output.motors {
            assert!(motor.rate.is_finite() && motor.torque.is_finite());
            if state.is_at_rest() {
                assert_eq!(motor.rate, N::ZERO, "{state:?}");
            }
        }
        while let Some(message) = self.service.outgoing() {
            match message {
                Message::Telemetry(sample) => self.telemetry.push(sample),
                Message::Drives(sample) => self.drives.push(sample),
                Message::Event(event) => self.events.push(event),
                Message::Reply { .. } => unreachable!("replies are returned"),
            }
        }
        output
    }

    /// Acknowledges a fault and switches the drives on again.
    #[track_caller]
    pub(super) fn acknowledge(&mut self) {
        self.done(Command::ClearFault);
        self.ticks(1);
        self.done(Command::Enable);
        self.ticks(1);
        while self.state() == State::Enabling {
            self.ticks(1);
        }
    }

    pub(super) fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Offers, judges and ticks once.
    #[track_caller]
    pub(super) fn offer(&mut self, offered: Move<N>) {
        self.done(Command::Move(offered));
        self.judge();
    }

    /// Ticks, with a host that is not silent, until the machine is in `state`.
    #[track_caller]
    pub(super) fn until(&mut self, state: State) -> u32 {
        for ticks in 1..100_000 {
            self.tick();
            if self.service.state() == state {
                return ticks;
            }
            if ticks % 100 == 0 {
                self.ask(Command::Status);
            }
        }
        panic!("never {state:?}, but {:?}", self.status());
    }
}
