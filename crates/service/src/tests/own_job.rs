//! A machine without a host, which plays a job of its own.

use super::homing::{parameters, timed};
use super::*;
use crate::admission::{Admission, Verdict};
use crate::foreground::Foreground;
use crate::settings::StopCategory;
use proptest::prelude::*;
use trirrr_core::limits::Limits;
use trirrr_core::machine::Geometry;
use trirrr_core::number::Fixed;
use trirrr_core::setpoint::Cubics;
use trirrr_core::tick::{Motor, Tick};
use trirrr_protocol::message::{AnyMove, FaultCode};

crate::scene! {
    /// The thesis machine with a door, an emergency stop and homing, and without a host.
    AloneScene [N: ServiceNumber] [N]: Compiled<'static, Dynamic<N>>,
    homing = On, interlocks = On<{ input_bits::STOP | input_bits::DOOR }>
}

type Alone<N> = Foreground<'static, AloneScene<N>, OwnJob<'static, AloneScene<N>, true>>;

const BUTTON_TICKS: u16 = 3;
const STOP_TICKS: u16 = 2;
const DOOR_TICKS: u16 = 4;

fn leak<T>(value: T) -> &'static T {
    Box::leak(Box::new(value))
}

/// There in two moves without a stop between, and back.
fn moves<N: ServiceNumber>() -> Vec<Move<N>> {
    let [a, b, c] = [home(), pose(0.23, 0.24, 0.17), pose(0.26, 0.25, 0.2)];
    let mut there = [rest(0, a, b, 110), rest(1, b, c, 120)];
    let speed = [0.02, 0.015, 0.02].map(N::from_f64);
    there[0].end_velocity = speed;
    there[1].start_velocity = speed;
    let mut back = rest(2, c, a, 150);
    back.tool_power = N::ONE;
    [there[0], there[1], back].into()
}

fn limits() -> LimitParameters {
    LimitParameters {
        rate_rad_s: Some([1.9; 3]),
        ..LimitParameters::default()
    }
}

/// A machine, and what its contacts and switches tell.
struct Machine<N: ServiceNumber> {
    tick: Alone<N>,
    homing: Option<&'static HomingCoefficients<N>>,
    readings: InterlockReadings,
}

#[derive(Clone, Copy)]
struct Given {
    begins: JobStart,
    passes: u32,
    is_homed: bool,
    category: StopCategory,
}

const PRESSED: Given = Given {
    begins: JobStart::Button,
    passes: 1,
    is_homed: false,
    category: StopCategory::StopThenOff,
};

impl<N: ServiceNumber> Machine<N> {
    fn new(given: Given) -> Self {
        let settings = Settings {
            ramp: Ramp::within(RAMP, None),
            ..settings()
        };
        let built = Limits::<N>::build(&limits()).unwrap();
        let mut admission =
            Admission::<Dynamic<N>, Cubics>::build(&example(), built, settings.ramp, PERIOD_S)
                .unwrap();
        let moves: Vec<_> = moves::<N>()
            .into_iter()
            .map(|each| {
                let each = AnyMove::Cubic(each);
                admission.offer_any(&each);
                while admission.step() == Verdict::Undecided {}
                assert_eq!(admission.step(), Verdict::Admitted);
                QueuedMove::of(&each, admission.paces(), settings.period).unwrap()
            })
            .collect();
        let geometry = Geometry::<N>::build(&example()).unwrap();
        let homing = given.is_homed.then(|| {
            let parameters = timed(parameters(Contact::Switch));
            leak(HomingCoefficients::build(&parameters, PERIOD_S))
        });
        let way = homing
            .map(|homing| leak(Recover::from_homing(homing, &geometry, settings.period).unwrap()));
        let parts = OwnJobParts {
            tick: leak(Tick::build(&example()).unwrap()),
            limits: leak(built),
            moves: moves.leak(),
            passes: given.passes,
            start: home(),
            angles: geometry.motor_angles(&geometry.position(&home()).unwrap()),
            begins: given.begins,
            button: Some(ButtonInput {
                debounce_ticks: BUTTON_TICKS,
            }),
            homing: homing.zip(way),
            interlocks: InterlockParameters {
                emergency_stop: Some(EmergencyStop {
                    debounce_ticks: STOP_TICKS,
                    category: given.category,
                }),
                door: Some(Door {
                    debounce_ticks: DOOR_TICKS,
                }),
                ..InterlockParameters::default()
            },
        };
        Self {
            tick: Foreground::alone(parts, &settings),
            homing,
            readings: InterlockReadings::default(),
        }
    }

    /// One tick. The motors are where they count, and switches close where they are.
    fn tick(&mut self) -> (State, Output<N>) {
        let motors = self.tick.output().motors;
        let closed = [0, 1, 2].map(|motor| {
            self.homing
                .is_some_and(|all| all.is_at_reference(motor, motors[motor].angle))
        });
        self.tick.sense(self.readings);
        let output = *self.tick.tick_with(closed);
        let state = self.tick.state();
        assert!(state.is_running() || output.tool == N::ZERO, "{state:?}");
        assert!(
            !matches!(state, State::Fault | State::Disabled) || !output.is_on(),
            "{state:?}"
        );
        (state, output)
    }

    fn ticks(&mut self, ticks: u16) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    #[track_caller]
    fn until(&mut self, state: State) {
        for _ in 0..5000 {
            if self.tick().0 == state {
                return;
            }
        }
        panic!("never {state:?}, but {:?}", self.tick.state());
    }

    /// Presses the button, and lets it go.
    fn press(&mut self) {
        for is_pressed in [false, true, false] {
            self.readings.button = is_pressed;
            self.ticks(BUTTON_TICKS + 2);
        }
    }

    #[track_caller]
    fn stays(&mut self, state: State) {
        for _ in 0..500 {
            assert_eq!(self.tick().0, state);
        }
    }
}

/// What a machine with a host does with the same moves, `passes` times one behind the other.
fn with_host<N: ServiceNumber>(passes: u32) -> Vec<Output<N>> {
    let mut bench = Bench::<Thesis<N>>::with(example(), limits());
    let mut outputs = Vec::new();
    let moves = moves::<N>();
    let mut offered = (0..passes).flat_map(|_| &moves).zip(0..).peekable();
    let mut begun = false;
    for _ in 0..5000 {
        // There is room for seven.
        while bench.status().room > 0
            && let Some((each, number)) = offered.next()
        {
            bench.offer(Move { number, ..*each });
        }
        if !begun {
            bench.done(Command::Start);
            begun = true;
        }
        let output = bench.tick();
        if bench.service.state() == State::Idle {
            return outputs;
        }
        bench.ask(Command::Status);
        outputs.push(output);
    }
    panic!("never over, but {:?}", bench.status());
}

fn has_the_bits_of_a_host<N: ServiceNumber>() {
    for passes in [1, 3] {
        let expected = with_host::<N>(passes);
        let mut machine = Machine::<N>::new(Given { passes, ..PRESSED });
        machine.press();
        machine.until(State::Idle);
        machine.readings.button = true;
        let mut played = Vec::new();
        for _ in 0..5000 {
            let (state, output) = machine.tick();
            match state {
                State::Running => played.push(output),
                _ if played.is_empty() => {}
                _ => break,
            }
        }
        assert_eq!(played.len(), expected.len(), "{passes}");
        let motors = |outputs: &[Output<N>]| -> Vec<([Motor<N>; 3], N)> {
            outputs
                .iter()
                .map(|each| (each.motors, each.tool))
                .collect()
        };
        assert!(motors(&played) == motors(&expected), "{passes}");
        assert_eq!(machine.tick.state(), State::Idle);
    }
}

#[test]
fn a_job_has_the_bits_that_it_has_with_a_host() {
    has_the_bits_of_a_host::<f64>();
    has_the_bits_of_a_host::<f32>();
    has_the_bits_of_a_host::<Fixed>();
}

#[test]
fn a_button_that_is_stuck_begins_nothing() {
    let mut machine = Machine::<f64>::new(PRESSED);
    machine.readings.button = true;
    machine.stays(State::Disabled);
    // Bounces are no release.
    machine.readings.button = false;
    machine.ticks(BUTTON_TICKS - 1);
    machine.readings.button = true;
    machine.stays(State::Disabled);
    machine.press();
    machine.until(State::Idle);
    // Held all along: once.
    machine.readings.button = true;
    machine.until(State::Running);
    machine.until(State::Idle);
    machine.stays(State::Idle);
}

#[test]
fn a_press_under_way_begins_nothing_later() {
    let mut machine = Machine::<f64>::new(PRESSED);
    machine.press();
    machine.until(State::Running);
    machine.press();
    machine.until(State::Idle);
    machine.stays(State::Idle);
}

#[test]
fn the_supply_begins_the_job_once_and_only_where_all_is_closed() {
    let given = Given {
        begins: JobStart::Power,
        passes: 2,
        ..PRESSED
    };
    let mut machine = Machine::<f64>::new(given);
    machine.until(State::Running);
    machine.until(State::Idle);
    machine.stays(State::Idle);

    for open_door in [true, false] {
        let mut machine = Machine::<f64>::new(given);
        machine.readings.door = open_door;
        machine.readings.emergency_stop = !open_door;
        machine.ticks(50);
        assert_ne!(machine.tick.state(), State::Running);
        assert!(!machine.tick.output().is_on());
        machine.readings = InterlockReadings::default();
        let state = machine.tick.state();
        machine.stays(state);
    }
    // The program has failed before: that it says from outside.
    let mut machine = Machine::<f64>::new(given);
    machine.tick.raise(FaultCode::Board, None, 1.0, 0.0);
    machine.stays(State::Fault);
}

#[test]
fn behind_a_door_the_job_waits_for_the_button() {
    let mut machine = Machine::<f64>::new(PRESSED);
    machine.press();
    machine.until(State::Idle);
    machine.press();
    machine.until(State::Running);
    machine.ticks(30);
    machine.readings.door = true;
    machine.until(State::Holding);
    // No press counts behind an open door.
    machine.press();
    machine.readings.door = false;
    machine.stays(State::Holding);
    machine.press();
    machine.until(State::Running);
    machine.until(State::Idle);
    assert_eq!(machine.tick.pose, home());
}

#[test]
fn motors_that_lost_their_places_stay_off_unless_they_are_homed() {
    for is_homed in [false, true] {
        for category in [StopCategory::Off, StopCategory::StopThenOff] {
            let mut machine = Machine::<f64>::new(Given {
                is_homed,
                category,
                ..PRESSED
            });
            machine.press();
            machine.until(State::Running);
            machine.ticks(20);
            machine.readings.emergency_stop = true;
            machine.until(State::Fault);
            machine.press();
            assert_eq!(machine.tick.state(), State::Fault, "it is pressed");
            machine.readings.emergency_stop = false;
            machine.stays(State::Fault);
            machine.press();
            if !is_homed {
                machine.stays(State::Fault);
                continue;
            }
            // Acknowledged, and nothing else.
            machine.stays(State::Disabled);
            machine.press();
            machine.until(State::Homing);
            machine.until(State::Recovering);
            machine.until(State::Running);
            machine.until(State::Idle);
            assert_eq!(machine.tick.pose, home());
        }
    }
}

#[test]
fn homing_that_a_door_ends_begins_anew_at_the_button() {
    let mut machine = Machine::<f64>::new(Given {
        is_homed: true,
        ..PRESSED
    });
    machine.press();
    machine.until(State::Homing);
    machine.readings.door = true;
    machine.until(State::Unhomed);
    machine.readings.door = false;
    machine.stays(State::Unhomed);
    machine.press();
    machine.until(State::Recovering);
    machine.readings.door = true;
    machine.until(State::Cleared);
    machine.readings.door = false;
    machine.stays(State::Cleared);
    machine.press();
    machine.until(State::Homing);
    machine.until(State::Running);
}

/// What somebody does for so many ticks: button, emergency stop, door.
fn acts() -> impl Strategy<Value = Vec<([bool; 3], u16)>> {
    let act = (
        [
            prop::bool::weighted(0.4),
            prop::bool::weighted(0.05),
            prop::bool::weighted(0.1),
        ],
        1u16..60,
    );
    prop::collection::vec(act, 1..120)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(share(400)))]

    /// Whatever somebody does: nothing begins to move without a press behind the last stop, while stop and door are closed.
    #[test]
    fn nothing_moves_that_nobody_asked_for(
        acts in acts(),
        is_homed in any::<bool>(),
        passes in prop_oneof![Just(1), Just(3), Just(FOREVER)],
    ) {
        let mut machine = Machine::<f32>::new(Given { is_homed, passes, ..PRESSED });
        let mut button = crate::interlock::DebouncedInput::active(BUTTON_TICKS);
        let mut is_asked = false;
        let mut before = State::Disabled;
        for ([is_pressed, stop, door], ticks) in acts {
            machine.readings = InterlockReadings {
                button: is_pressed,
                emergency_stop: stop,
                door,
                ..InterlockReadings::default()
            };
            for _ in 0..ticks {
                let is_press = button.read(is_pressed) && button.is_active();
                let (state, _) = machine.tick();
                let features = &machine.tick.features;
                is_asked |= is_press && !features.is_open() && !features.is_pressed();
                let rests = |state: State| state.is_at_rest();
                let moves = matches!(state, State::Running | State::Homing | State::Recovering);
                if rests(before) && moves {
                    prop_assert!(is_asked, "{before:?} to {state:?}");
                    prop_assert!(!features.is_open() && !features.is_pressed());
                }
                if matches!(state, State::Fault | State::Reacting | State::Stopping | State::Slowing)
                    || (before == State::Running && state == State::Idle)
                    // The press that acknowledges a fault begins nothing.
                    || before == State::Fault
                {
                    is_asked = false;
                }
                before = state;
            }
        }
    }
}
