//! Steppers on a scope: every edge, its time, and the sum of them.

mod common;

use common::{Edge, Pin, Random, Scope, output, wrapped};
use core::f64::consts::TAU;
use trirrr_core::number::Fixed;
use trirrr_drives::count::Countable;
use trirrr_drives::stepper::StepsPerTurn;
use trirrr_drives::stepper::{Axis, Line, Slots, Steppers, most_per_tick, slots_per_tick};
use trirrr_drives::{Active, Enable};
use trirrr_protocol::message::{DriveFault, FaultCode};

const STEP: [&str; 3] = ["step 1", "step 2", "step 3"];
const DIRECTION: [&str; 3] = ["direction 1", "direction 2", "direction 3"];
const ENABLE: &str = "enable";

const PER_TURN: u32 = 3200;
const GEAR: f64 = 4.81;
const START: [f64; 3] = [2.9, -0.4, -3.0];
const MOST: u32 = 24;

/// Motor 1 is reversed.
const REVERSED: [bool; 3] = [false, true, false];

type Drivers<'l> = Slots<'l, Pin, Pin, Pin>;

fn drivers<'l>(line: &'l Line, scope: &Scope, active: Active) -> Drivers<'l> {
    let enable = Enable::new(scope.pin(ENABLE), active).unwrap();
    let axis = |index: usize| {
        let (step, direction) = (scope.pin(STEP[index]), scope.pin(DIRECTION[index]));
        Axis::new(step, direction, REVERSED[index]).unwrap()
    };
    let axes = [axis(0), axis(1), axis(2)];
    Slots::new(line, axes, enable, slots_per_tick(MOST))
}

fn steppers<N: Countable>(line: &Line) -> Steppers<'_, N> {
    Steppers::new(
        [StepsPerTurn::new(PER_TURN, GEAR); 3],
        [MOST; 3],
        START.map(N::angle_from_f64),
        line,
    )
}

/// Motors behind the pins. Checks the timing that a driver needs.
struct Motors {
    /// Microsteps, counter-clockwise.
    position: [i64; 3],
    forward: [bool; 3],
    on: bool,
    rose: [i64; 3],
    fell: [i64; 3],
    turned: [i64; 3],
    switched: i64,
    rises: [Vec<i64>; 3],
}

impl Motors {
    fn new() -> Self {
        Self {
            position: [0; 3],
            forward: [true; 3],
            on: false,
            rose: [-1000; 3],
            fell: [-1000; 3],
            turned: [-1000; 3],
            switched: -1000,
            rises: [const { Vec::new() }; 3],
        }
    }

    fn watch(&mut self, edges: Vec<Edge>, active: Active) {
        for rises in &mut self.rises {
            rises.clear();
        }
        // At 0 the pins are taken.
        for Edge { at, pin, high } in edges.into_iter().filter(|edge| edge.at > 0) {
            if pin == ENABLE {
                self.on = high == (active == Active::High);
                self.switched = at;
                continue;
            }
            if let Some(motor) = DIRECTION.iter().position(|name| *name == pin) {
                // Hold time after the step before.
                assert!(at > self.rose[motor], "{pin} at {at}");
                self.forward[motor] = high != REVERSED[motor];
                self.turned[motor] = at;
                continue;
            }
            let motor = STEP.iter().position(|name| *name == pin).unwrap();
            if !high {
                assert_eq!(at, self.rose[motor] + 1, "{pin} is high for one slot");
                self.fell[motor] = at;
                continue;
            }
            assert!(self.on, "{pin} at {at}: no pulse while off");
            assert!(
                at > self.switched && at > self.turned[motor],
                "{pin} at {at}"
            );
            assert!(at > self.fell[motor], "{pin} at {at}: low for a slot");
            assert!(at >= self.rose[motor] + 2);
            self.rose[motor] = at;
            self.rises[motor].push(at);
            self.position[motor] += if self.forward[motor] { 1 } else { -1 };
        }
    }
}

/// Microsteps to `turned`, and whether that is not just between two.
fn rounded(turned: f64, tolerance: f64) -> (i64, bool) {
    let exact = turned * f64::from(PER_TURN) * GEAR / TAU;
    let clear = (exact - exact.floor() - 0.5).abs() > 0.0625 + tolerance;
    (exact.round() as i64, clear)
}

/// Random motions over many turns: in each tick all edges are right, and at its end the sum of the
/// pulses is the rounded angle.
fn motions<N: Countable>(tolerance: f64, active: Active) {
    let (line, scope) = (Line::new(), Scope::default());
    let mut tick = steppers::<N>(&line);
    let mut slots = drivers(&line, &scope, active);
    let mut motors = Motors::new();
    let mut random = Random(7);
    let microstep = TAU / (f64::from(PER_TURN) * GEAR);
    let mut rate = [0.0; 3];
    let mut turned = [0.0; 3];
    let mut clear_ones = 0;
    let mut worst: f64 = 0.0;
    for _ in 0..4000 {
        let turned_before = turned;
        for (rate, turned) in rate.iter_mut().zip(&mut turned) {
            // Up to 23.4 microsteps per tick, with rests and reversals.
            *rate = match random.below(5) {
                0 => 0.0,
                1 => -*rate,
                2 => *rate,
                _ => random.signed() * 23.4,
            };
            *turned += *rate * microstep;
        }
        let at = |leg: usize| [wrapped(START[leg] + turned[leg]), 0.0, 0.0];
        let before = motors.position;
        tick.apply(&output::<N>([at(0), at(1), at(2)], true))
            .unwrap();
        let begins = scope.now.get() + 1;
        // The last pulse may need the slot to spare.
        for _ in 0..=u64::from(slots_per_tick(MOST)) {
            scope.now.set(scope.now.get() + 1);
            slots.slot().unwrap();
        }
        motors.watch(scope.take(), active);
        for (leg, turned) in turned.into_iter().enumerate() {
            let (expected, clear) = rounded(turned, tolerance);
            if clear {
                assert_eq!(motors.position[leg], expected);
                clear_ones += 1;
            }
            let steps = (motors.position[leg] - before[leg]).unsigned_abs() as usize;
            let rises = &motors.rises[leg];
            assert_eq!(rises.len(), steps, "not one step too many");
            assert_eq!(i64::from(slots.positions()[leg]), motors.position[leg]);
            // Along the straight line from the angle before to this one, at every slot.
            let exact = |turned: f64| turned * f64::from(PER_TURN) * GEAR / TAU;
            let (from, to) = (exact(turned_before[leg]), exact(turned));
            let mut given = before[leg];
            let forward = motors.position[leg] > before[leg];
            for slot in 0..slots_per_tick(MOST) as usize {
                if rises.contains(&(begins + slot as i64)) {
                    given += if forward { 1 } else { -1 };
                }
                let middle = (slot as f64 + 0.5) / f64::from(slots_per_tick(MOST));
                let line = from + (to - from) * middle;
                worst = worst.max((given as f64 - line).abs());
            }
        }
    }
    assert!(clear_ones > 9_500, "{clear_ones}");
    println!("off the line by at most {worst:.3} microsteps");
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn every_edge_of_random_motions_is_in_its_slot_and_the_sum_is_the_rounded_angle() {
    // A turn is 15,392 microsteps; the angles are off as the core's own test of them says.
    motions::<f64>(1e-4, Active::Low);
    motions::<Fixed>(1e-4, Active::High);
    motions::<f32>(4e-3, Active::Low);
}

/// Ticks that come early, and drives that go off and on in the middle of one.
#[test]
fn no_step_is_lost_when_ticks_are_early_or_drives_go_off() {
    let active = Active::Low;
    let (line, scope) = (Line::new(), Scope::default());
    let mut tick = steppers::<f64>(&line);
    let mut slots = drivers(&line, &scope, active);
    let mut motors = Motors::new();
    let mut random = Random(3);
    let microstep = TAU / (f64::from(PER_TURN) * GEAR);
    let mut run = |count: u64, scope: &Scope| {
        for _ in 0..count {
            scope.now.set(scope.now.get() + 1);
            slots.slot().unwrap();
        }
    };
    // With the one to spare.
    let per_tick = u64::from(slots_per_tick(MOST)) + 1;
    let mut turned = 0.0;
    for round in 0..2000 {
        turned += random.signed() * 20.0 * microstep;
        let at = [wrapped(START[0] + turned), 0.0, 0.0];
        let rest = |leg: usize| [START[leg], 0.0, 0.0];
        let wanted = |on| output::<f64>([at, rest(1), rest(2)], on);
        tick.apply(&wanted(true)).unwrap();
        match round % 4 {
            0 => run(per_tick, &scope),
            1 => run(per_tick - random.below(per_tick / 2), &scope),
            2 => {
                // Off anywhere, for a while: a fault stands where it was commanded last.
                run(random.below(per_tick), &scope);
                tick.apply(&wanted(false)).unwrap();
                run(per_tick * 2, &scope);
                motors.watch(scope.take(), active);
                assert!(!motors.on);
                tick.apply(&wanted(true)).unwrap();
                run(per_tick, &scope);
            }
            _ => {
                run(per_tick / 3, &scope);
                tick.off();
                run(1, &scope);
                tick.apply(&wanted(true)).unwrap();
                run(per_tick * 3, &scope);
            }
        }
        motors.watch(scope.take(), active);
        if round % 4 != 1 {
            let (expected, clear) = rounded(turned, 1e-4);
            assert!(!clear || motors.position[0] == expected, "round {round}");
        }
    }
    assert_eq!(motors.position[1..], [0, 0]);
}

/// A tick without slots, and the next one in the same direction: all pulses come, as even as those of a longer way.
#[test]
fn missing_pulses_are_spread_over_the_next_tick() {
    let slots_of_tick = slots_per_tick(MOST);
    for sign in [1.0, -1.0] {
        let (line, scope) = (Line::new(), Scope::default());
        let mut tick = steppers::<f64>(&line);
        let mut slots = drivers(&line, &scope, Active::Low);
        let mut motors = Motors::new();
        let microstep = TAU / (f64::from(PER_TURN) * GEAR);
        let mut go = |steps: f64, count: u32| {
            let at = |leg: usize| [wrapped(START[leg] + sign * steps * microstep), 0.0, 0.0];
            tick.apply(&output::<f64>([at(0), at(1), at(2)], true))
                .unwrap();
            for _ in 0..count {
                scope.now.set(scope.now.get() + 1);
                slots.slot().unwrap();
            }
            motors.watch(scope.take(), Active::Low);
            (motors.position, motors.rises.clone())
        };
        go(0.0, slots_of_tick);
        let (position, _) = go(12.0, 1);
        assert_eq!(position, [0; 3]);
        let (position, rises) = go(16.0, slots_of_tick + 1);
        let all = if sign < 0.0 { -16 } else { 16 };
        assert_eq!(position, [all; 3]);
        for times in rises {
            let intervals = times.windows(2).map(|pair| (pair[1] - pair[0]) as u32);
            let even = slots_of_tick / 16;
            assert!(
                intervals
                    .clone()
                    .all(|each| (even..=even + 1).contains(&each)),
                "{:?}",
                intervals.collect::<Vec<_>>()
            );
        }
    }
}

#[test]
fn a_step_too_many_is_a_fault_and_none_of_the_three_moves() {
    let (line, scope) = (Line::new(), Scope::default());
    let mut tick = steppers::<f32>(&line);
    let mut slots = drivers(&line, &scope, Active::Low);
    let mut motors = Motors::new();
    let microstep = TAU / (f64::from(PER_TURN) * GEAR);
    let at = |leg: usize, steps: f64| [START[leg] + steps * microstep, 0.0, 0.0];
    let wanted = output::<f32>([at(0, 5.0), at(1, 48.2), at(2, 5.0)], true);
    let failure = tick.apply(&wanted).unwrap_err();
    assert_eq!(failure.code(), FaultCode::Drive(DriveFault::StepRate));
    assert_eq!(failure.drive, Some(1));
    // Twice as many as there may be.
    assert_eq!((failure.value, failure.limit), (2.0, 1.0));
    for _ in 0..100 {
        slots.slot().unwrap();
    }
    motors.watch(scope.take(), Active::Low);
    assert_eq!(motors.position, [0; 3]);
    // Where they stand is said in the bits, so that the service can be told.
    assert_eq!(tick.angles(), START.map(|angle| angle as f32));
    tick.apply(&output([at(0, 0.0), at(1, 0.0), at(2, 0.0)], true))
        .unwrap();
}

#[test]
fn homing_moves_the_angle_and_not_the_motor() {
    let (line, scope) = (Line::new(), Scope::default());
    let mut tick = steppers::<f64>(&line);
    let mut slots = drivers(&line, &scope, Active::High);
    let mut motors = Motors::new();
    // Motor 2 is found half a turn from where it was thought to be.
    let by = [0.5, 3.1, -0.25];
    tick.shift(by);
    let found = [0, 1, 2].map(|leg| START[leg] + by[leg]);
    let microstep = TAU / (f64::from(PER_TURN) * GEAR);
    let at = |leg: usize, steps: f64| [wrapped(found[leg] + steps * microstep), 0.0, 0.0];
    for (steps, expected) in [(0.0, 0), (10.0, 10), (-3.0, -3)] {
        tick.apply(&output([at(0, steps), at(1, steps), at(2, steps)], true))
            .unwrap();
        for _ in 0..slots_per_tick(MOST) {
            scope.now.set(scope.now.get() + 1);
            slots.slot().unwrap();
        }
        motors.watch(scope.take(), Active::High);
        assert_eq!(motors.position, [expected; 3]);
    }
}

#[test]
fn at_the_start_pins_are_low_and_drives_off() {
    let (line, scope) = (Line::new(), Scope::default());
    let mut slots = drivers(&line, &scope, Active::Low);
    let edge = |pin, high| Edge { at: 0, pin, high };
    assert_eq!(
        scope.take(),
        [
            edge(ENABLE, true),
            edge(STEP[0], false),
            edge(DIRECTION[0], true),
            edge(STEP[1], false),
            edge(DIRECTION[1], false),
            edge(STEP[2], false),
            edge(DIRECTION[2], true),
        ]
    );
    // And stay so until the first tick.
    for _ in 0..10 {
        slots.slot().unwrap();
    }
    assert_eq!(scope.take(), []);
}

#[test]
fn slots_leave_room_for_the_fastest_steps() {
    let most = most_per_tick(20_000.0, 1000.0);
    assert_eq!((most, slots_per_tick(most)), (20, 41));
    assert_eq!(trirrr_drives::stepper::slot_rate_hz(most, 1000.0), 42_000.0);
    // Cut, not rounded: 9 ticks of 1111 microsteps are less than 10,000.
    assert_eq!(most_per_tick(10_000.0, 9.0), 1111);
}

/// Greatest deviation of the step rate between two pulses from its mean, relative, where a joint turns by `rate` microsteps per tick
/// of `per_tick` slots.
fn ripple(rate: f64, per_tick: u32) -> f64 {
    let (line, scope) = (Line::new(), Scope::default());
    let mut tick = steppers::<f64>(&line);
    let mut slots = drivers(&line, &scope, Active::Low);
    let microstep = TAU / (f64::from(PER_TURN) * GEAR);
    let mut rises = Vec::new();
    for count in 1..=2000 {
        let turned = f64::from(count) * rate * microstep;
        let at = [0, 1, 2].map(|leg: usize| [wrapped(START[leg] + turned), 0.0, 0.0]);
        tick.apply(&output::<f64>(at, true)).unwrap();
        for _ in 0..per_tick {
            scope.now.set(scope.now.get() + 1);
            slots.slot().unwrap();
        }
        let edges = scope.take().into_iter();
        rises.extend(edges.filter(|edge| edge.pin == STEP[0] && edge.high));
    }
    // The motor begins at rest.
    let times: Vec<i64> = rises.iter().skip(2).map(|edge| edge.at).collect();
    assert!(times.len() as f64 >= 2000.0 * rate - 3.0);
    let intervals = times.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
    let mean = f64::from(per_tick) / rate;
    intervals
        .map(|interval| (mean / interval - 1.0).abs())
        .fold(0.0, f64::max)
}

#[test]
fn the_step_rate_of_an_even_motion_is_even() {
    // A timer gives a tick the slots that belong to it, and the spare one.
    let per_tick = slots_per_tick(MOST) + 1;
    for (rate, most) in [(0.4, 0.015), (1.5, 0.045), (2.3, 0.07)] {
        let found = ripple(rate, per_tick);
        println!(
            "{rate} microsteps per tick: step rate within {:.1} %",
            100.0 * found
        );
        // A pulse is in a slot: up to one of them early or late, and the spare one belongs to no line.
        assert!(found <= most, "{rate}: {found}");
    }
}
