//! A machine with a probe and limit switches, which close and open at any time.

use super::super::interlocks::{GuardedScene, touching};
use super::*;
use crate::feature::Optional;
use crate::interlock::LatchedRun;
use crate::settings::StopCategory;
use trirrr_protocol::message::ProbeRun;

/// Most acts on the way to a state in the short search.
const DEPTH: usize = 3;

struct TouchingMachine {
    bench: Bench<GuardedScene>,
    readings: InterlockReadings,
}

impl TouchingMachine {
    fn run(&mut self) -> Option<LatchedRun<f64>> {
        let probe = self.bench.service.foreground.features.probe.get();
        probe.and_then(|probe| probe.run().copied())
    }
}

impl Explored for TouchingMachine {
    type Scene = GuardedScene;

    const ACTS: &'static [Act] = &[
        Act::Ask(Ask::Enable),
        Act::Ask(Ask::Disable),
        Act::Ask(Ask::Start),
        Act::Ask(Ask::Probe { away: false }),
        Act::Ask(Ask::Probe { away: true }),
        Act::Ask(Ask::Hold),
        Act::Ask(Ask::Resume),
        Act::Ask(Ask::Stop),
        Act::Ask(Ask::ClearFault),
        Act::Ask(Ask::Recover),
        Act::Ask(Ask::Offer),
        Act::Ask(Ask::OfferMoving),
        Act::Ask(Ask::Retarget),
        Act::World(World::Touches(true)),
        Act::World(World::Touches(false)),
        Act::World(World::Limits(true)),
        Act::World(World::Limits(false)),
        Act::Fails(FaultCode::Drive(DriveFault::Reported)),
        Act::Ticks(1),
        Act::Ticks(7),
        Act::Silence,
    ];

    const STARTS: &'static [&'static [Act]] = &[
        &[],
        &[Act::Ask(Ask::Enable), Act::Ticks(7)],
        // A run under way,
        &[
            Act::Ask(Ask::Enable),
            Act::Ticks(7),
            Act::Ask(Ask::Offer),
            Act::Ask(Ask::Probe { away: false }),
            Act::Ticks(7),
        ],
        // a motor that stands on its switch while the drives go on,
        &[
            Act::World(World::Limits(true)),
            Act::Ticks(7),
            Act::Ask(Ask::Enable),
            Act::Ticks(7),
        ],
        // and one that has come there, its fault acknowledged.
        &[
            Act::Ask(Ask::Enable),
            Act::Ticks(7),
            Act::World(World::Limits(true)),
            Act::Ticks(7),
            Act::Ask(Ask::ClearFault),
            Act::Ticks(1),
            Act::Ask(Ask::Enable),
            Act::Ticks(7),
        ],
    ];

    /// A limit switch is a fault on the path.
    fn switched_on() -> Self {
        let settings = Settings {
            reactions: Reactions {
                limit_switch: StopCategory::StopThenOff,
                ..Reactions::default()
            },
            ..timed_settings()
        };
        Self {
            bench: Bench::with_room::<4>(touching(), home(), settings),
            readings: InterlockReadings::default(),
        }
    }

    fn bench(&mut self) -> &mut Bench<GuardedScene> {
        &mut self.bench
    }

    /// The table of the inputs holds in every tick.
    fn tick(&mut self) -> Output<f64> {
        let before = self.run();
        self.bench.service.sense(self.readings);
        let output = self.bench.tick();
        let run = self.run();
        let foreground = &self.bench.service.foreground;
        let state = foreground.state();
        let plays = matches!(state, State::Running | State::Slowing | State::Holding);
        if foreground.features.is_at_limit() {
            assert!(!plays, "{state:?} on a limit switch");
        }
        match run {
            Some(LatchedRun::Armed) => assert!(plays, "{state:?} is armed"),
            Some(LatchedRun::Touched(_)) if before == Some(LatchedRun::Armed) => {
                assert!(!plays, "{state:?} behind a contact");
                assert_eq!(output.tool, 0.0);
            }
            _ => {}
        }
        output
    }

    fn change(&mut self, world: World) {
        match world {
            World::Touches(touches) => self.readings.probe = touches,
            World::Limits(is_on) => self.readings.limits[1] = is_on,
            _ => {}
        }
    }

    fn mend(&mut self) {
        self.readings = InterlockReadings::default();
    }

    /// Not the ticks that a change has lasted, nor the place of a contact.
    fn world(&self) -> String {
        let features = &self.bench.service.foreground.features;
        let states = features.input_states();
        let run = features.probe.get().and_then(|probe| probe.run().copied());
        let run = run.map(|run| match run {
            LatchedRun::Armed => "armed",
            LatchedRun::Touched(_) => "touched",
            LatchedRun::NotTouched => "not touched",
        });
        format!("{:?} {states:?} {run:?}", self.readings)
    }

    fn refuses(&mut self, ask: Ask) -> bool {
        let inputs = self.bench.status().inputs;
        let starts = matches!(ask, Ask::Start | Ask::Probe { .. });
        let is_at_limit = inputs.limits.iter().any(|limit| limit.is_active());
        let touches = inputs.probe.is_active();
        starts && is_at_limit || matches!(ask, Ask::Probe { away } if away != touches)
    }
}

#[test]
fn a_probe_and_limit_switches_are_survivable_and_have_a_way_out() {
    // All but those of homing.
    let kinds = explore::<TouchingMachine>(Some(DEPTH)).kinds;
    assert_taken(taken::TOUCHING_MACHINE);
    assert_eq!(kinds.len(), 12, "{kinds:?}");
}

/// The search ends by itself: there are no other states.
#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn all_states_of_a_probe_and_limit_switches_are_explored() {
    assert!(explore::<TouchingMachine>(None).deepest > DEPTH);
}

/// What a host reads is what the tick has, once no order is on its way.
#[test]
fn the_status_tells_the_run_of_the_tick() {
    let mut machine = TouchingMachine::switched_on();
    let acts = TouchingMachine::STARTS[2];
    for act in acts {
        machine.act(*act);
    }
    assert_eq!(machine.bench.status().probe, Some(ProbeRun::Armed));
    machine.act(Act::World(World::Touches(true)));
    machine.act(Act::Ticks(1));
    assert!(matches!(machine.run(), Some(LatchedRun::Touched(_))));
    let told = machine.bench.status().probe;
    assert!(matches!(told, Some(ProbeRun::Touched(_))), "{told:?}");
}
