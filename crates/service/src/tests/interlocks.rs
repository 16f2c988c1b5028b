//! Emergency stop, door, limit switches and probe.

use super::homing::home_angles;
use super::transitions::{assert_taken, taken};
use super::*;
use crate::settings::StopCategory;
use trirrr_protocol::message::{
    Acting, DriveFault, FaultCode, InputState, InputStates, Interruption, Recovery,
};

crate::scene! {
    /// The thesis machine with all inputs, homing, feedback and spare outputs, as hosts have them.
    pub(super) GuardedScene: Thesis<f64>,
    batches = On, update = NoImage, homing = On, feedback = On,
    interlocks = On<{ input_bits::ALL }>, probe = On, digital = On
}

pub(super) const STOP_TICKS: u16 = 2;
pub(super) const DOOR_TICKS: u16 = 3;
pub(super) const PROBE_TICKS: u16 = 2;
pub(super) const LIMIT_TICKS: u16 = 2;

/// The thesis machine with an emergency stop of this category, and a door.
pub(super) fn scene(category: StopCategory) -> SceneParts<'static, GuardedScene> {
    SceneParts {
        interlocks: InterlockParameters {
            emergency_stop: Some(EmergencyStop {
                debounce_ticks: STOP_TICKS,
                category,
            }),
            door: Some(Door {
                debounce_ticks: DOOR_TICKS,
            }),
            ..InterlockParameters::default()
        },
        ..Adjustable::new(example(), LimitParameters::default()).into()
    }
}

/// The thesis machine with a probe and limit switches.
pub(super) fn touching() -> SceneParts<'static, GuardedScene> {
    SceneParts {
        interlocks: InterlockParameters {
            probe: Some(ProbeInput {
                debounce_ticks: PROBE_TICKS,
            }),
            limits: Some(LimitInputs {
                debounce_ticks: LIMIT_TICKS,
            }),
            ..InterlockParameters::default()
        },
        ..scene(StopCategory::Off)
    }
}

/// A service, and what its contacts tell.
pub(super) struct Guarded {
    pub(super) bench: Bench<GuardedScene>,
    pub(super) readings: InterlockReadings,
}

impl Guarded {
    pub(super) fn tick(&mut self) -> Output<f64> {
        self.bench.service.sense(self.readings);
        self.bench.tick()
    }

    pub(super) fn ticks(&mut self, ticks: u16) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Presses the stop or lets it go. The tick that takes it for true is the next one.
    fn press(&mut self, is_pressed: bool) {
        self.readings.emergency_stop = is_pressed;
        self.ticks(STOP_TICKS - 1);
    }

    /// Opens or closes the door. The tick that takes it for true is the next one.
    fn open(&mut self, is_open: bool) {
        self.readings.door = is_open;
        self.ticks(DOOR_TICKS - 1);
    }

    pub(super) fn until(&mut self, state: State) {
        for _ in 0..1000 {
            self.tick();
            if self.bench.service.state() == state {
                return;
            }
        }
        panic!("never {state:?}, but {:?}", self.bench.status());
    }

    fn inputs(&mut self) -> [InputState; 2] {
        let InputStates {
            emergency_stop,
            door,
            ..
        } = self.bench.status().inputs;
        [emergency_stop, door]
    }

    /// Inputs, as events have told them since.
    fn told(&mut self) -> Vec<[InputState; 2]> {
        let told = self.bench.events.drain(..);
        told.filter_map(|event| match event {
            Event::Inputs(states) => Some([states.emergency_stop, states.door]),
            _ => None,
        })
        .collect()
    }
}

use InputState::{Absent, Active, Clear};

/// A machine in the middle of a move with its tool on.
fn running(category: StopCategory) -> Guarded {
    let mut guarded = Guarded {
        bench: Bench::set(scene(category), home(), settings()),
        readings: InterlockReadings::default(),
    };
    guarded.bench.offer(Move {
        tool_power: 0.5,
        ..rest(0, home(), pose(0.28, 0.28, 0.2), 100)
    });
    guarded.bench.done(Command::Start);
    guarded.ticks(40);
    assert!(guarded.bench.service.output().tool > 0.0);
    guarded
}

#[test]
fn an_emergency_stop_of_category_0_is_off_in_the_tick_that_sees_it() {
    let mut guarded = running(StopCategory::Off);
    guarded.press(true);
    // Within the debounce time nothing happens.
    let output = *guarded.bench.service.output();
    assert!(output.is_on() && output.tool > 0.0);
    let output = guarded.tick();
    assert!(!output.is_on() && !output.brake_released);
    assert_eq!(output.tool, 0.0);
    assert_eq!(guarded.bench.state(), State::Fault);
    let fault = guarded.bench.status().fault.unwrap();
    // The first tick has enabled the machine.
    let seen = 1 + 40 + u32::from(STOP_TICKS) - 1;
    assert_eq!((fault.code, fault.tick), (FaultCode::EmergencyStop, seen));
    assert_eq!(guarded.inputs(), [Active, Clear]);
}

/// On the very path, and to the place, of a stop that a host asks for.
#[test]
fn an_emergency_stop_of_category_1_comes_to_rest_on_the_path_then_is_off() {
    let mut plain = running(StopCategory::StopThenOff);
    plain.ticks(STOP_TICKS - 1);
    plain.bench.done(Command::Stop);
    let mut guarded = running(StopCategory::StopThenOff);
    guarded.press(true);
    let mut ticks = 0;
    while plain.bench.service.state() != State::Idle {
        let (stopped, output) = (plain.tick(), guarded.tick());
        for (a, b) in stopped.motors.iter().zip(&output.motors) {
            assert_eq!((a.angle.to_bits(), a.rate), (b.angle.to_bits(), b.rate));
        }
        assert_eq!(output.tool, 0.0);
        ticks += 1;
    }
    assert!(ticks >= u32::from(RAMP) && guarded.bench.state() == State::Reacting);
    guarded.until(State::Fault);
    assert!(!guarded.bench.service.output().is_on());
    let fault = guarded.bench.status().fault.unwrap();
    assert_eq!(fault.code, FaultCode::EmergencyStop);
}

/// Pressed again on the way to rest it changes nothing; a failure of a drive does.
#[test]
fn a_stop_of_category_1_that_bounces_does_not_let_go_of_the_platform() {
    let mut guarded = running(StopCategory::StopThenOff);
    guarded.press(true);
    guarded.tick();
    assert_eq!(guarded.bench.state(), State::Reacting);
    for pressed in [false, true] {
        guarded.press(pressed);
        guarded.tick();
        assert_eq!(guarded.bench.state(), State::Reacting);
        assert!(guarded.bench.service.output().is_on());
    }
    let fault = FaultCode::Drive(DriveFault::Reported);
    guarded.bench.service.raise(fault, Some(1), 5.0, 0.0);
    assert!(!guarded.bench.service.output().is_on());
}

#[test]
fn an_emergency_stop_is_latched_until_a_person_acknowledges_it_and_enables() {
    let mut guarded = running(StopCategory::Off);
    guarded.press(true);
    guarded.tick();
    let refusal = guarded.bench.refused(Command::ClearFault);
    assert_eq!(refusal, Refusal::EmergencyStop);
    for command in [Command::Enable, Command::Start, Command::Resume] {
        let refusal = guarded.bench.refused(command);
        assert_eq!(refusal, Refusal::State(State::Fault), "{command:?}");
    }
    guarded.press(false);
    assert_eq!(
        guarded.bench.refused(Command::ClearFault),
        Refusal::EmergencyStop
    );
    guarded.tick();
    assert_eq!(guarded.inputs(), [Clear, Clear]);
    // It is not over by itself.
    guarded.ticks(50);
    assert_eq!(guarded.bench.state(), State::Fault);
    guarded.bench.done(Command::ClearFault);
    guarded.tick();
    assert_eq!(guarded.bench.state(), State::Disabled);
    assert!(!guarded.bench.service.output().is_on());
    guarded.bench.done(Command::Enable);
    guarded.until(State::Cleared);
    // And again, with drives that are off.
    guarded.bench.done(Command::Disable);
    guarded.until(State::Disabled);
    guarded.press(true);
    guarded.tick();
    let fault = guarded.bench.status().fault.unwrap();
    assert_eq!(fault.code, FaultCode::EmergencyStop);
    assert_eq!(
        guarded.told(),
        [[Active, Clear], [Clear, Clear], [Active, Clear]]
    );
}

/// The order to acknowledge is on its way while the stop is pressed: the tick does not take it.
#[test]
fn an_acknowledgement_that_meets_a_pressed_stop_is_not_taken() {
    let mut guarded = running(StopCategory::Off);
    guarded.press(true);
    guarded.tick();
    guarded.press(false);
    guarded.tick();
    guarded.press(true);
    guarded.bench.done(Command::ClearFault);
    guarded.tick();
    assert_eq!(guarded.bench.state(), State::Fault);
    guarded.press(false);
    guarded.tick();
    guarded.bench.done(Command::ClearFault);
    guarded.tick();
    assert_eq!(guarded.bench.state(), State::Disabled);
}

/// Drives that hold after another fault go off at once.
#[test]
fn an_emergency_stop_switches_off_what_a_fault_of_category_2_holds() {
    let reactions = Reactions {
        overrun: StopCategory::StopAndHold,
        ..Reactions::OFF
    };
    let settings = Settings {
        reactions,
        ..settings()
    };
    let mut bench = Bench::set(scene(StopCategory::StopThenOff), home(), settings);
    assert!(!bench.service.report_timing(1200, 1000));
    for _ in 0..3 {
        assert!(bench.service.tick().is_on());
    }
    assert_eq!(bench.state(), State::Fault);
    let readings = InterlockReadings {
        emergency_stop: true,
        ..InterlockReadings::default()
    };
    for tick in 1..=STOP_TICKS {
        bench.service.sense(readings);
        assert_eq!(bench.service.tick().is_on(), tick < STOP_TICKS);
    }
    // The first fault stays.
    let fault = bench.status().fault.unwrap();
    assert_eq!(fault.code, FaultCode::Overrun);
}

/// A loose wire: however short the active parts, the contact of a stop, a door and a limit switch is heard.
#[test]
fn a_contact_that_chatters_stops_the_machine_within_its_bound() {
    type Contact = fn(&mut InterlockReadings) -> &mut bool;
    let contacts: [(Contact, u16, State); 3] = [
        (|told| &mut told.emergency_stop, STOP_TICKS, State::Fault),
        (|told| &mut told.door, DOOR_TICKS, State::Slowing),
        (|told| &mut told.limits[1], LIMIT_TICKS, State::Fault),
    ];
    for (contact, ticks, stopped) in contacts {
        for (open, closed) in [(1, 1), (2, 2), (1, 2), (2, 3), (1, 10 * ticks - 1)] {
            let mut scene = scene(StopCategory::Off);
            scene.interlocks.limits = touching().interlocks.limits;
            let mut guarded = Guarded {
                bench: Bench::set(scene, home(), settings()),
                readings: InterlockReadings::default(),
            };
            let way = rest(0, home(), pose(0.28, 0.28, 0.2), 200);
            guarded.bench.offer(way);
            guarded.bench.done(Command::Start);
            guarded.ticks(10);
            let mut within = 0;
            while guarded.bench.service.state() == State::Running {
                *contact(&mut guarded.readings) = within % (open + closed) < open;
                guarded.tick();
                within += 1;
                assert!(within <= 10 * ticks * ticks, "{open} {closed}");
            }
            assert_eq!(guarded.bench.service.state(), stopped);
            if open == closed {
                assert!(within <= 2 * ticks, "{within}");
            }
        }
    }
}

/// The tool is off at once, the path waits, and goes on in its own bits when the host says so.
#[test]
fn a_door_holds_the_job_with_the_tool_off_until_it_is_closed_and_resumed() {
    let mut guarded = running(StopCategory::Off);
    guarded.open(true);
    assert!(guarded.bench.service.output().tool > 0.0);
    let output = guarded.tick();
    assert_eq!(output.tool, 0.0);
    assert!(output.is_on() && !guarded.bench.service.foreground.tool_runs());
    assert_eq!(guarded.bench.state(), State::Slowing);
    guarded.until(State::Holding);
    assert_eq!(guarded.bench.status().acting, Acting::Door);
    assert_eq!(guarded.bench.refused(Command::Resume), Refusal::DoorOpen);
    // Another hold does not take its place.
    guarded.bench.done(Command::Hold);
    guarded.ticks(20);
    assert_eq!(guarded.bench.status().acting, Acting::Door);
    guarded.open(false);
    guarded.ticks(50);
    assert_eq!(guarded.inputs(), [Clear, Clear]);
    assert_eq!(
        guarded.bench.state(),
        State::Holding,
        "it goes on by itself"
    );
    guarded.bench.done(Command::Resume);
    guarded.until(State::Idle);
    assert_eq!(guarded.bench.status().done, 1);
    assert_eq!(guarded.bench.status().interrupted, None);
    let mut plain = running(StopCategory::Off);
    plain.until(State::Idle);
    let [held, whole] = [&guarded, &plain].map(|each| each.bench.service.output().motors);
    assert_eq!(held, whole);
    assert_eq!(guarded.told(), [[Clear, Active], [Clear, Clear]]);
}

/// Once it was open, the tool stays off until the job runs again, and a job that does not was left where it was opened.
#[test]
fn a_job_is_left_where_the_door_was_opened() {
    let opened = |guarded: &mut Guarded| {
        guarded.open(true);
        let last = *guarded.bench.telemetry.last().unwrap();
        guarded.tick();
        Interruption {
            number: last.number,
            at: last.at,
        }
    };
    for is_held in [false, true] {
        let mut guarded = running(StopCategory::Off);
        let place = opened(&mut guarded);
        // Closed on the way to rest.
        guarded.open(false);
        guarded.tick();
        assert_eq!(guarded.bench.state(), State::Slowing);
        assert_eq!(guarded.inputs(), [Clear, Clear]);
        assert_eq!(guarded.bench.service.output().tool, 0.0);
        assert!(!guarded.bench.service.foreground.tool_runs());
        guarded.until(State::Holding);
        if is_held {
            guarded.bench.done(Command::Hold);
            guarded.ticks(2);
        }
        assert_eq!(guarded.bench.status().acting, Acting::Door);
        guarded.bench.done(Command::Stop);
        guarded.until(State::Idle);
        assert_eq!(guarded.bench.status().interrupted, Some(place));
    }
    // So near the end that the way to rest leads over it.
    let mut guarded = running(StopCategory::Off);
    while guarded.bench.telemetry.last().unwrap().at < 94 {
        guarded.tick();
    }
    let place = opened(&mut guarded);
    guarded.until(State::Idle);
    let status = guarded.bench.status();
    assert_eq!((status.done, status.acting), (1, Acting::Door));
    assert_eq!(status.interrupted, Some(place));
}

/// A job that holds for want of moves holds for the door, too: moves that come while it is open do not lead on, nor do they once it is
/// closed.
#[test]
fn a_dry_hold_behind_an_open_door_waits_for_the_host() {
    let mut guarded = Guarded {
        bench: Bench::set(scene(StopCategory::Off), home(), settings()),
        readings: InterlockReadings::default(),
    };
    let (middle, end) = (pose(0.25, 0.25, 0.18), pose(0.28, 0.28, 0.2));
    let end_velocity = [0.02, 0.02, 0.0];
    guarded.bench.offer(Move {
        end_velocity,
        ..rest(0, home(), middle, 60)
    });
    guarded.bench.done(Command::Start);
    guarded.until(State::Holding);
    assert_eq!(guarded.bench.status().acting, Acting::QueueDry);
    guarded.open(true);
    guarded.tick();
    assert_eq!(guarded.bench.status().acting, Acting::Door);
    guarded.bench.offer(Move {
        start_velocity: end_velocity,
        ..rest(1, middle, end, 60)
    });
    guarded.ticks(20);
    assert_eq!(guarded.bench.state(), State::Holding);
    guarded.open(false);
    guarded.ticks(20);
    let status = guarded.bench.status();
    assert_eq!(
        (status.state, status.acting),
        (State::Holding, Acting::Door)
    );
    guarded.bench.done(Command::Resume);
    guarded.until(State::Idle);
    assert_eq!(guarded.bench.status().done, 2);
}

#[test]
fn nothing_starts_behind_an_open_door() {
    let mut guarded = running(StopCategory::Off);
    guarded.until(State::Idle);
    let end = guarded.bench.status().end.unwrap().pose;
    guarded.bench.offer(rest(1, end, home(), 100));
    let recovery = Recovery {
        to: home(),
        ticks: 50,
    };
    guarded.open(true);
    // Those that come before the tick has seen it are not taken by the tick.
    guarded.bench.done(Command::Start);
    guarded.tick();
    assert_eq!(guarded.bench.state(), State::Idle);
    assert_eq!(guarded.bench.refused(Command::Start), Refusal::DoorOpen);
    guarded.bench.done(Command::Stop);
    guarded.ticks(3);
    let refusal = guarded.bench.refused(Command::Recover(recovery));
    assert_eq!(refusal, Refusal::DoorOpen);
    // The drives may go off and on.
    guarded.bench.done(Command::Disable);
    guarded.until(State::Disabled);
    guarded.bench.done(Command::Enable);
    guarded.until(State::Idle);
    guarded.open(false);
    guarded.tick();
    guarded.bench.done(Command::Recover(recovery));
    guarded.until(State::Recovering);
    guarded.open(true);
    guarded.until(State::Cleared);
}

/// A door that closes before the machine stands lets it stand all the same.
#[test]
fn a_door_that_was_open_for_a_moment_holds_the_job() {
    let mut guarded = running(StopCategory::Off);
    guarded.open(true);
    guarded.tick();
    guarded.open(false);
    guarded.tick();
    assert_eq!(guarded.bench.state(), State::Slowing);
    guarded.until(State::Holding);
    guarded.ticks(50);
    assert_eq!(guarded.bench.state(), State::Holding);
}

#[test]
fn homing_is_given_up_where_the_door_opens() {
    let parameters = super::homing::parameters(Contact::Switch);
    let coefficients = HomingCoefficients::build(&parameters, PERIOD_S);
    let scene = SceneParts {
        homing: Some(&*Box::leak(Box::new(coefficients))),
        ..scene(StopCategory::Off)
    };
    let mut guarded = Guarded {
        bench: Bench::set(scene, home(), settings()),
        readings: InterlockReadings::default(),
    };
    assert!(home_angles().iter().all(|angle| angle.is_finite()));
    assert_eq!(guarded.bench.state(), State::Unhomed);
    guarded.bench.done(Command::Home);
    guarded.until(State::Homing);
    guarded.ticks(20);
    guarded.open(true);
    guarded.tick();
    assert_eq!(guarded.bench.state(), State::Stopping);
    assert_taken(taken::DOOR_IN_HOMING);
    assert_eq!(guarded.bench.status().acting, Acting::Door);
    guarded.until(State::Unhomed);
    assert_eq!(guarded.bench.refused(Command::Home), Refusal::DoorOpen);
    guarded.open(false);
    guarded.tick();
    guarded.bench.done(Command::Home);
    guarded.until(State::Homing);
}

#[test]
fn a_scene_tells_the_inputs_that_it_names() {
    let mut plain = Bench::<Thesis<f64>>::new();
    assert_eq!(plain.status().inputs, InputStates::ABSENT);
    let parameters = InterlockParameters {
        door: None,
        ..scene(StopCategory::Off).interlocks
    };
    let mut guarded = Guarded {
        bench: Bench::set(
            SceneParts {
                interlocks: parameters,
                ..scene(StopCategory::Off)
            },
            home(),
            settings(),
        ),
        readings: InterlockReadings {
            door: true,
            ..InterlockReadings::default()
        },
    };
    guarded.ticks(20);
    // A reading of an input that is not there counts for nothing.
    assert_eq!(guarded.inputs(), [Clear, Absent]);
    assert_eq!(guarded.bench.state(), State::Idle);
}
