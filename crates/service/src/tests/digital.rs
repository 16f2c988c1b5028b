//! Spare inputs and outputs.

use super::*;
use crate::admission::Path;
use crate::settings::StopCategory;
use trirrr_core::model::Model;
use trirrr_core::setpoint::Quintics;
use trirrr_protocol::message::{
    Acting, Bounded, DigitalStates, FaultCode, OutputSwitch, PathCurve, PathPiece, QuinticMove,
    Violation,
};

const TICKS: u32 = 40;
const DEBOUNCE: u16 = 3;

/// Outputs of the machine: one that stays, one of jobs, and another that stays.
const STAYS: u8 = 0b001;
const OF_JOBS: u8 = 0b010;

crate::scene! {
    /// The thesis machine with spare inputs and outputs.
    DigitalScene: Thesis<f64>, batches = On, update = NoImage, digital = On
}

crate::scene! {
    /// The same, which plans paths.
    PlanningScene: Adjustable<Dynamic<f64>, Quintics, HastyPlanner>,
    batches = On, update = NoImage, digital = On
}

const PINS: DigitalParameters = DigitalParameters {
    outputs: 3,
    in_jobs: OF_JOBS,
    inputs: 2,
    debounce_ticks: [DEBOUNCE; 8],
};

fn scene() -> SceneParts<'static, DigitalScene> {
    SceneParts {
        digital: PINS,
        ..Adjustable::new(example(), LimitParameters::default()).into()
    }
}

fn machine() -> Bench<DigitalScene> {
    Bench::set(scene(), home(), settings())
}

fn at(number: u32, on: u8, off: u8) -> Command<f64> {
    Command::OutputsAt(OutputSwitch { number, on, off })
}

fn output(index: u8, on: bool) -> Command<f64> {
    Command::Output { index, on }
}

/// Poses from which the moves of a job lead on.
fn corner(number: u32) -> Pose<f64> {
    match number % 2 {
        0 => home(),
        _ => pose(0.28, 0.28, 0.2),
    }
}

/// Offers moves, each with its change of outputs.
fn offer(bench: &mut Bench<DigitalScene>, changes: &[Option<(u8, u8)>]) {
    let first = bench.status().next;
    for (number, change) in (first..).zip(changes) {
        if let Some((on, off)) = change {
            bench.done(at(number, *on, *off));
        }
        bench.offer(rest(number, corner(number), corner(number + 1), TICKS));
    }
}

/// The outputs tick by tick, up to the end of the job.
fn played<S: Scene<N = f64> + 'static>(bench: &mut Bench<S>) -> Vec<(u32, u32, u8)> {
    let mut played = Vec::new();
    loop {
        bench.tick();
        let sample = *bench.telemetry.last().expect("a sample");
        if sample.state == State::Idle {
            return played;
        }
        played.push((sample.number, sample.at, bench.service.digital_outputs()));
    }
}

#[test]
fn outputs_change_in_the_very_tick_in_which_their_move_begins() {
    let mut bench = machine();
    let changes = [None, Some((STAYS | OF_JOBS, 0)), None, Some((0, STAYS))];
    offer(&mut bench, &changes);
    bench.done(Command::Start);
    let played = played(&mut bench);
    assert_eq!(played.len() as u32, 4 * TICKS + 1);
    for (number, at, outputs) in &played {
        // The end of a move is the start of the next: in that tick the next has begun.
        let expected = match number {
            0 => 0,
            1 | 2 => STAYS | OF_JOBS,
            _ => OF_JOBS,
        };
        assert_eq!(*outputs, expected, "tick {at} of move {number}");
    }
    let begins = played.iter().filter(|(_, at, _)| *at == 0).count();
    assert_eq!(begins, 4, "each move is seen in its first tick");
    // The host hears of it with the tick: the first of the job is that of its start.
    let started = bench.telemetry.iter().find(|sample| sample.number == 1);
    let first = bench.events.iter().find_map(|event| match event {
        Event::Digital(states) => Some(*states),
        _ => None,
    });
    let expected = DigitalStates {
        inputs: 0,
        outputs: STAYS | OF_JOBS,
        tick: started.expect("the second move was played").tick,
    };
    assert_eq!(first, Some(expected));
    // With the job its own output went.
    assert_eq!(bench.service.digital_outputs(), 0);
}

#[test]
fn a_change_with_the_first_move_comes_with_the_start() {
    let mut bench = machine();
    offer(&mut bench, &[Some((OF_JOBS, 0))]);
    bench.ticks(20);
    assert_eq!(bench.service.digital_outputs(), 0);
    bench.done(Command::Start);
    bench.tick();
    assert_eq!(bench.service.digital_outputs(), OF_JOBS);
    assert_eq!(bench.telemetry.last().map(|sample| sample.at), Some(0));
}

#[test]
fn a_change_of_a_move_in_a_slower_job_comes_with_its_begin_too() {
    let mut bench = machine();
    bench.done(Command::FeedOverride { percent: 37 });
    bench.tick();
    offer(&mut bench, &[None, Some((STAYS, 0)), None]);
    bench.done(Command::Start);
    let played = played(&mut bench);
    assert!(played.len() as u32 > 2 * 3 * TICKS, "{}", played.len());
    for (number, at, outputs) in played {
        assert_eq!(outputs & STAYS != 0, number >= 1, "tick {at} of {number}");
    }
    assert_eq!(
        bench.service.digital_outputs(),
        STAYS,
        "it outlasts the job"
    );
}

#[test]
fn an_order_switches_an_output_at_once_and_in_any_state_that_has_power() {
    let mut bench = machine();
    bench.done(output(2, true));
    bench.done(output(1, true));
    bench.ticks(2);
    // That of jobs waits for one.
    assert_eq!(bench.service.digital_outputs(), 0b100);
    bench.done(output(2, false));
    bench.tick();
    assert_eq!(bench.service.digital_outputs(), 0);
    offer(&mut bench, &[None]);
    bench.done(Command::Start);
    bench.tick();
    assert_eq!(bench.service.digital_outputs(), OF_JOBS);
    bench.ticks(5);
    bench.done(output(0, true));
    bench.tick();
    assert_eq!(bench.service.digital_outputs(), STAYS | OF_JOBS);
    let states = bench.status().digital.expect("the scene names some");
    assert_eq!(states.outputs, STAYS | OF_JOBS);
    assert_eq!(states.tick, bench.telemetry.last().expect("a sample").tick);
}

#[test]
fn in_a_hold_outputs_of_jobs_are_off_and_the_others_stay() {
    let mut bench = machine();
    offer(&mut bench, &[Some((STAYS | OF_JOBS, 0)), None]);
    bench.done(Command::Start);
    bench.ticks(10);
    bench.done(Command::Hold);
    let mut slows = 0;
    while bench.state() != State::Holding {
        bench.tick();
        let expected = match bench.service.state() {
            // As the tool: on the way to rest the path is still worked on.
            State::Slowing => STAYS | OF_JOBS,
            _ => STAYS,
        };
        assert_eq!(bench.service.digital_outputs(), expected);
        slows += 1;
    }
    assert!(slows > 2);
    bench.done(Command::Resume);
    bench.ticks(2);
    assert_eq!(bench.service.state(), State::Running);
    assert_eq!(bench.service.digital_outputs(), STAYS | OF_JOBS);
    bench.done(Command::Stop);
    bench.tick();
    assert_eq!(bench.service.digital_outputs(), STAYS);
    bench.until(State::Idle);
    // The next job does not begin with what the last one left.
    offer(&mut bench, &[]);
    let end = bench.status().end.expect("it stands").pose;
    let number = bench.status().next;
    bench.offer(rest(number, end, home(), TICKS));
    bench.done(Command::Start);
    bench.ticks(2);
    assert_eq!(bench.service.digital_outputs(), STAYS);
}

/// A machine whose outputs are on in the middle of a job.
fn under_way(reactions: Reactions) -> Bench<DigitalScene> {
    let settings = Settings {
        reactions,
        ..settings()
    };
    let mut bench = Bench::set(scene(), home(), settings);
    offer(&mut bench, &[Some((STAYS | OF_JOBS, 0)), Some((0b100, 0))]);
    bench.done(Command::Start);
    bench.ticks(10);
    assert_eq!(bench.service.digital_outputs(), STAYS | OF_JOBS);
    bench
}

#[test]
fn a_fault_switches_every_output_off_before_the_next_tick() {
    let rests = Reactions {
        limit: StopCategory::StopThenOff,
        ..Reactions::OFF
    };
    for reactions in [Reactions::OFF, rests] {
        let mut bench = under_way(reactions);
        let code = FaultCode::Limit(trirrr_protocol::message::Bounded::Rate);
        bench.service.raise(code, None, 1.0, 0.5);
        assert_eq!(bench.service.digital_outputs(), 0);
        bench.until(State::Fault);
        assert_eq!(bench.status().digital.expect("some").outputs, 0);
        assert_eq!(bench.refused(output(0, true)), Refusal::State(State::Fault));
        // Off is never refused.
        bench.done(output(0, false));
        bench.ticks(2);
        // What waited with the second move went with the queue.
        bench.done(Command::ClearFault);
        bench.ticks(1);
        let refusal = Refusal::State(State::Disabled);
        assert_eq!(bench.refused(output(0, true)), refusal);
        bench.done(Command::Enable);
        bench.ticks(2);
        assert_eq!(bench.service.digital_outputs(), 0);
    }
}

#[test]
fn outputs_are_off_while_the_drives_are() {
    let mut bench = machine();
    bench.done(output(0, true));
    bench.tick();
    assert_eq!(bench.service.digital_outputs(), STAYS);
    bench.done(Command::Disable);
    bench.tick();
    assert_eq!(bench.service.digital_outputs(), 0);
    bench.until(State::Disabled);
    bench.done(Command::Enable);
    bench.ticks(2);
    assert_eq!(bench.service.state(), State::Idle);
    assert_eq!(bench.service.digital_outputs(), 0);
}

#[test]
fn an_emergency_stop_and_a_door_take_outputs_as_they_take_the_tool() {
    use super::interlocks::Guarded;
    let guarded = SceneParts {
        digital: PINS,
        ..super::interlocks::scene(StopCategory::StopThenOff)
    };
    let mut machine = Guarded {
        bench: Bench::set(guarded, home(), settings()),
        readings: InterlockReadings::default(),
    };
    machine.bench.done(at(0, STAYS | OF_JOBS, 0));
    machine.bench.offer(rest(0, home(), corner(1), 100));
    machine.bench.done(Command::Start);
    machine.ticks(10);
    machine.readings.door = true;
    machine.ticks(super::interlocks::DOOR_TICKS);
    assert_eq!(machine.bench.service.digital_outputs(), STAYS);
    assert_eq!(machine.bench.status().acting, Acting::Door);
    machine.readings.emergency_stop = true;
    machine.ticks(super::interlocks::STOP_TICKS);
    assert_eq!(machine.bench.service.digital_outputs(), 0);
}

#[test]
fn what_the_scene_does_not_name_is_refused_with_the_number_of_what_it_does() {
    let mut bench = machine();
    let none = Refusal::NoOutput { outputs: 3 };
    for index in [3, 7, 8, 255] {
        assert_eq!(bench.refused(output(index, false)), none);
    }
    assert_eq!(bench.refused(at(0, 0b1000, 0)), none);
    assert_eq!(bench.refused(at(0, 0, 0x80)), none);
    assert_eq!(
        bench.refused(at(1, 1, 0)),
        Refusal::MoveNumber { expected: 0 }
    );
    let mut plain = Bench::<Thesis<f64>>::new();
    let none = Refusal::NoOutput { outputs: 0 };
    assert_eq!(plain.refused(output(0, false)), none);
    assert_eq!(plain.refused(at(0, 1, 0)), none);
    assert_eq!(plain.status().digital, None);
}

#[test]
fn of_two_changes_for_one_move_the_later_one_counts() {
    let mut bench = machine();
    bench.done(at(0, STAYS, 0));
    bench.done(at(0, 0b100, STAYS));
    offer(&mut bench, &[None]);
    bench.done(Command::Start);
    bench.tick();
    assert_eq!(bench.service.digital_outputs(), 0b100);
}

#[test]
fn changes_go_with_a_move_that_is_refused_and_with_a_queue_that_is_dropped() {
    let mut bench = machine();
    bench.done(at(0, STAYS, 0));
    bench.done(Command::Move(rest(0, home(), pose(5.0, 5.0, 0.0), TICKS)));
    bench.judge();
    assert!(bench.status().refused.is_some());
    offer(&mut bench, &[None, Some((STAYS, 0))]);
    bench.done(Command::Start);
    bench.ticks(5);
    assert_eq!(bench.service.digital_outputs(), 0);
    bench.done(Command::Stop);
    bench.until(State::Idle);
    let (number, end) = (bench.status().next, bench.status().end.expect("it stands"));
    assert_eq!(number, 1, "the second move has given its number back");
    bench.offer(rest(number, end.pose, home(), TICKS));
    bench.done(Command::Start);
    bench.ticks(5);
    assert_eq!(bench.service.digital_outputs(), 0);
}

/// Planner of a line to the second corner, whose first move is too fast. It finds no way along a piece of feed 2.
struct HastyPlanner {
    from: Option<Pose<f64>>,
    ticks: u32,
    is_kept: bool,
    finds_none: bool,
}

impl PathPlanner<f64> for HastyPlanner {
    const EMPTY: Self = Self {
        from: None,
        ticks: 1,
        is_kept: false,
        finds_none: false,
    };

    fn set_up(&mut self, _: Option<Planning<f64>>) {}

    fn can_plan(&self) -> bool {
        true
    }

    fn is_active(&self) -> bool {
        self.from.is_some()
    }

    fn begin(&mut self, pose: Pose<f64>) {
        *self = Self {
            from: Some(pose),
            ..Self::EMPTY
        };
    }

    fn push(&mut self, piece: &PathPiece<f64>) -> bool {
        self.finds_none = piece.feed == 2.0;
        true
    }

    fn step<M: Model<N = f64>>(&mut self, _: &Path<M>) -> PathStep<f64> {
        match self.from.filter(|_| !self.is_kept) {
            Some(_) if self.finds_none => PathStep::Refused {
                number: 0,
                violation: Violation {
                    what: Bounded::Rate,
                    index: Some(0),
                    at: 0.5,
                    value: 9.0,
                    error: None,
                    limit: 5.0,
                    certain: true,
                    ramp: false,
                    shortest: None,
                },
            },
            Some(from) => PathStep::Move(QuinticMove {
                common: rest(0, from, corner(1), self.ticks),
                start_acceleration: [0.0; 3],
                end_acceleration: [0.0; 3],
            }),
            None => PathStep::Done,
        }
    }

    fn keep(&mut self) {
        self.is_kept = true;
    }

    fn cut<M: Model<N = f64>>(&mut self, _: &Path<M>, _: &Violation<f64>) {
        self.ticks = TICKS;
    }

    fn drop_path(&mut self) {
        *self = Self::EMPTY;
    }
}

/// A machine that plans by itself begins with its outputs as a job of moves does: in the tick of the first move.
#[test]
fn a_change_stays_with_the_move_that_the_planner_makes_anew() {
    let limits = LimitParameters {
        rate_rad_s: Some([5.0; 3]),
        ..LimitParameters::default()
    };
    let scene = SceneParts {
        digital: PINS,
        ..Adjustable::new(example(), limits).into()
    };
    let mut bench = Bench::<PlanningScene>::set(scene, home(), settings());
    let piece = |feed| {
        Command::Path(PathPiece {
            number: 0,
            curve: PathCurve::Line { to: corner(1) },
            feed,
            tool_power: 0.0,
            tool_speed: 0.0,
            last: true,
        })
    };
    // With a path that is refused its changes go.
    bench.done(at(0, STAYS, 0));
    bench.done(piece(2.0));
    bench.judge();
    assert!(bench.status().refused.is_some());
    bench.done(at(0, OF_JOBS, 0));
    bench.done(piece(0.1));
    bench.judge();
    assert_eq!(bench.status().admitted, 1, "{:?}", bench.status().refused);
    bench.done(Command::Start);
    let played = played(&mut bench);
    assert_eq!(played.len() as u32, TICKS + 1);
    assert!(played.iter().all(|(.., outputs)| *outputs == OF_JOBS));
}

#[test]
fn changes_beyond_the_room_are_refused_until_one_is_over() {
    let mut bench = machine();
    let mut given = 0;
    // As many as the queue has moves, judged and not.
    for round in 0..100 {
        offer(&mut bench, &[Some((STAYS, 0))]);
        given += 1;
        if bench.status().room == 0 {
            break;
        }
        assert!(round < 99);
    }
    assert!(given < 16);
    bench.done(Command::Start);
    // Moves come and go: the room comes back with them.
    for _ in 0..40 {
        bench.ticks(TICKS);
        offer(&mut bench, &[Some((0, STAYS))]);
    }
    assert_eq!(bench.service.digital_outputs(), 0);
}

#[test]
fn inputs_are_told_free_of_bounces() {
    let mut bench = machine();
    assert_eq!(bench.status().digital, Some(DigitalStates::default()));
    for bounce in [0b10, 0b00, 0b10, 0b10] {
        bench.service.sense_digital(bounce);
        bench.tick();
        assert_eq!(bench.status().digital.expect("some").inputs, 0);
    }
    bench.service.sense_digital(0b10);
    bench.tick();
    let states = bench.status().digital.expect("some");
    assert_eq!((states.inputs, states.outputs), (0b10, 0));
    assert_eq!(states.tick, bench.telemetry.last().expect("a sample").tick);
    assert!(bench.events.contains(&Event::Digital(states)));
    for _ in 0..DEBOUNCE {
        bench.service.sense_digital(0);
        bench.tick();
    }
    assert_eq!(bench.status().digital.expect("some").inputs, 0);
}
