//! Machines with an emergency stop and a door, which a person presses and opens at any time.

use super::super::interlocks::{GuardedScene, scene};
use super::*;
use crate::feature::Optional;
use crate::settings::StopCategory;

/// Most acts on the way to a state in the short search.
const DEPTH: usize = 3;

/// `ON_PATH`: the emergency stop is of category 1; else of 0.
struct GuardedMachine<const ON_PATH: bool> {
    bench: Bench<GuardedScene>,
    readings: InterlockReadings,
}

impl<const ON_PATH: bool> Explored for GuardedMachine<ON_PATH> {
    type Scene = GuardedScene;

    const ACTS: &'static [Act] = &[
        Act::Ask(Ask::Enable),
        Act::Ask(Ask::Disable),
        Act::Ask(Ask::Start),
        Act::Ask(Ask::Hold),
        Act::Ask(Ask::Resume),
        Act::Ask(Ask::Stop),
        Act::Ask(Ask::ClearFault),
        Act::Ask(Ask::Recover),
        Act::Ask(Ask::Offer),
        Act::Ask(Ask::OfferMoving),
        Act::Ask(Ask::Retarget),
        Act::World(World::Presses(true)),
        Act::World(World::Presses(false)),
        Act::World(World::Opens(true)),
        Act::World(World::Opens(false)),
        Act::Fails(FaultCode::Drive(DriveFault::Reported)),
        Act::Fails(FaultCode::Overrun),
        Act::Ticks(1),
        Act::Ticks(7),
        Act::Silence,
    ];

    const STARTS: &'static [&'static [Act]] = &[
        &[],
        &[Act::Ask(Ask::Enable), Act::Ticks(7)],
        // A job under way, and one that is held.
        &[
            Act::Ask(Ask::Enable),
            Act::Ticks(7),
            Act::Ask(Ask::Offer),
            Act::Ask(Ask::Start),
            Act::Ticks(7),
        ],
    ];

    fn switched_on() -> Self {
        let category = match ON_PATH {
            true => StopCategory::StopThenOff,
            false => StopCategory::Off,
        };
        Self {
            bench: Bench::with_room::<4>(scene(category), home(), timed_settings()),
            readings: InterlockReadings::default(),
        }
    }

    fn bench(&mut self) -> &mut Bench<GuardedScene> {
        &mut self.bench
    }

    /// The table of the inputs holds in every tick.
    fn tick(&mut self) -> Output<f64> {
        self.bench.service.sense(self.readings);
        let output = self.bench.tick();
        let foreground = &self.bench.service.foreground;
        let (features, state) = (&foreground.features, foreground.state());
        if features.is_pressed() {
            assert!(state.has_fault(), "{state:?} while the stop is pressed");
            assert_eq!(output.tool, 0.0);
            if state == State::Fault || !ON_PATH && features.interlocks.get().unwrap().is_latched()
            {
                assert!(!output.is_on(), "{state:?} while the stop is pressed");
            }
        }
        if features.is_open() {
            let moves = matches!(state, State::Running | State::Recovering | State::Homing);
            assert!(!moves, "{state:?} behind an open door");
            assert_eq!(output.tool, 0.0);
            assert!(!foreground.tool_runs());
        }
        output
    }

    fn change(&mut self, world: World) {
        match world {
            World::Presses(presses) => self.readings.emergency_stop = presses,
            World::Opens(opens) => self.readings.door = opens,
            _ => {}
        }
    }

    fn mend(&mut self) {
        self.readings = InterlockReadings::default();
    }

    /// Not the ticks that a change has lasted: the outputs do not show them.
    fn world(&self) -> String {
        let features = &self.bench.service.foreground.features;
        let states = features.input_states();
        let latched = features.interlocks.get().unwrap().is_latched();
        format!("{:?} {states:?} {latched}", self.readings)
    }

    fn refuses(&mut self, ask: Ask) -> bool {
        let inputs = self.bench.status().inputs;
        let moves = matches!(ask, Ask::Start | Ask::Resume | Ask::Recover | Ask::Home);
        let acknowledges = matches!(ask, Ask::ClearFault | Ask::Enable);
        let (is_pressed, is_open) = (inputs.emergency_stop.is_active(), inputs.door.is_active());
        is_pressed && (moves || acknowledges) || is_open && moves
    }

    /// Of a machine whose stop stays pressed, the drives are off in its fault.
    fn is_off(&mut self) -> bool {
        let status = self.bench.status();
        let is_off = !self.bench.service.output().is_on();
        let is_pressed = status.inputs.emergency_stop.is_active();
        status.state == State::Disabled || status.state == State::Fault && is_pressed && is_off
    }
}

#[test]
fn an_emergency_stop_and_a_door_are_survivable_and_have_a_way_out() {
    // All but those of homing.
    let kinds = explore::<GuardedMachine<false>>(Some(DEPTH)).kinds;
    assert_taken(taken::GUARDED_MACHINE);
    assert_eq!(kinds.len(), 12, "{kinds:?}");
}

#[test]
fn an_emergency_stop_on_the_path_is_survivable_and_has_a_way_out() {
    let kinds = explore::<GuardedMachine<true>>(Some(DEPTH)).kinds;
    assert_eq!(kinds.len(), 12, "{kinds:?}");
}

/// The searches end by themselves: there are no other states.
#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn all_states_of_an_emergency_stop_and_a_door_are_explored() {
    assert!(explore::<GuardedMachine<false>>(None).deepest > DEPTH);
}

#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn all_states_of_an_emergency_stop_on_the_path_are_explored() {
    assert!(explore::<GuardedMachine<true>>(None).deepest > DEPTH);
}
