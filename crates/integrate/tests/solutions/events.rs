//! Events are located where they are, never stepped over, and handled once.

use crate::problems::{Ball, Oscillator};
use trirrr_integrate::{Action, Direction, End, Failure, Integrator, Method, System};

const METHODS: [Method; 4] = [
    Method::SemiImplicitEuler { step_s: 1e-3 },
    Method::Rk4 { step_s: 0.05 },
    Method::DormandPrince { tolerance: 1e-10 },
    Method::RadauIia { tolerance: 1e-10 },
];

#[test]
fn bounces_are_located_to_the_resolution_of_time() {
    for method in METHODS {
        let mut ball = Ball {
            most: 12,
            ..Ball::default()
        };
        let mut integrator = Integrator::new(&ball, method).unwrap();
        let mut y = [1.0, 0.0];
        let end = integrator
            .run(&mut ball, 0.0, &mut y, 100.0, |_, _| {})
            .unwrap();
        assert_eq!(ball.bounces.len(), 12, "{method:?}");
        for (number, &t) in ball.bounces.iter().enumerate() {
            // A parabola is what every method but Euler follows exactly: rounding is all that is
            // left. Euler's flights are a step too short each, and their speeds a step's too low.
            let bound = if matches!(method, Method::SemiImplicitEuler { .. }) {
                7e-2
            } else {
                1e-12
            };
            let error = (t - Ball::bounce(number)).abs();
            assert!(
                error < bound,
                "{method:?}: bounce {number} off by {error:e} s"
            );
        }
        assert_eq!(
            end,
            End::Stopped {
                t: ball.bounces[11]
            },
            "{method:?}"
        );
    }
}

#[test]
fn a_ball_that_bounces_without_end_is_refused_as_chatter() {
    // In Euler's eyes a ball that would rise for less than a step does not rise at all.
    for method in &METHODS[1..] {
        let method = *method;
        let mut ball = Ball {
            most: usize::MAX,
            ..Ball::default()
        };
        let mut integrator = Integrator::new(&ball, method).unwrap();
        let mut y = [1.0, 0.0];
        let failure = integrator
            .run(&mut ball, 0.0, &mut y, 100.0, |_, _| {})
            .unwrap_err();
        let Failure::Chatter { t, name, .. } = failure else {
            panic!("{method:?}: {failure}");
        };
        assert_eq!(name, "floor");
        // All bounces are over at the limit of the geometric series.
        let over = Ball::bounce(200);
        assert!(
            (t - over).abs() < 0.05 * over,
            "{method:?}: at {t} s, not {over} s"
        );
    }
}

/// The oscillator with a threshold for x.
struct Threshold {
    level: f64,
    direction: Direction,
    crossings: Vec<f64>,
}

impl System<3> for Threshold {
    type Refusal = String;
    fn derivative(&self, t: f64, y: &[f64; 3], dy: &mut [f64; 3]) -> Result<(), String> {
        Oscillator.derivative(t, y, dy)
    }
    fn scales(&self) -> [f64; 3] {
        [1.0; 3]
    }
    fn events(&self) -> usize {
        1
    }
    fn direction(&self, _: usize) -> Option<Direction> {
        Some(self.direction)
    }
    fn event_values(&self, _: f64, y: &[f64; 3], values: &mut [f64]) {
        values[0] = y[0] - self.level;
    }
    fn at_event(&mut self, _: usize, t: f64, _: &mut [f64; 3]) -> Result<Action, String> {
        self.crossings.push(t);
        Ok(Action::Continue)
    }
}

fn crossings(level: f64, direction: Direction, method: Method) -> Vec<f64> {
    let mut system = Threshold {
        level,
        direction,
        crossings: vec![],
    };
    let mut integrator = Integrator::new(&system, method).unwrap();
    let mut y = Oscillator::START;
    integrator
        .run(&mut system, 0.0, &mut y, 20.0, |_, _| {})
        .unwrap();
    system.crossings
}

#[test]
fn crossings_of_a_smooth_function_in_each_direction() {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};
    for method in [
        Method::DormandPrince { tolerance: 1e-11 },
        Method::RadauIia { tolerance: 1e-11 },
    ] {
        let falling: Vec<f64> = (0..4)
            .map(|k| FRAC_PI_2 + TAU * f64::from(k))
            .filter(|t| *t < 20.0)
            .collect();
        let rising: Vec<f64> = falling
            .iter()
            .map(|t| t + PI)
            .filter(|t| *t < 20.0)
            .collect();
        let mut either = [falling.clone(), rising.clone()].concat();
        either.sort_by(f64::total_cmp);
        for (direction, wanted) in [
            (Direction::Falling, falling),
            (Direction::Rising, rising),
            (Direction::Either, either),
        ] {
            let found = crossings(0.0, direction, method);
            assert_eq!(
                found.len(),
                wanted.len(),
                "{method:?} {direction:?}: {found:?}"
            );
            for (found, wanted) in found.iter().zip(&wanted) {
                // The motion itself is off by some hundred steps' tolerances by then.
                assert!(
                    (found - wanted).abs() < 3e-9,
                    "{method:?}: {found} for {wanted}"
                );
            }
        }
    }
}

#[test]
fn two_crossings_within_a_step_are_both_found() {
    // x is above 0.9999 for 2 acos(0.9999) = 0.0283 s in each period: far less than a step of
    // 0.05 s, and in most steps none of the looks falls into it.
    let touch = 0.9999f64.acos();
    let found = crossings(0.9999, Direction::Either, Method::Rk4 { step_s: 0.05 });
    let mut wanted = vec![touch];
    for period in 1..4 {
        let top = std::f64::consts::TAU * f64::from(period);
        wanted.extend([top - touch, top + touch]);
    }
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    for (found, wanted) in found.iter().zip(&wanted) {
        // RK4 at 0.05 s is off by h^4/120 t = 1e-6, and the slope at the crossing is 0.014.
        assert!((found - wanted).abs() < 1e-4, "{found} for {wanted}");
    }
}

#[test]
fn a_threshold_that_is_missed_by_little_is_no_event() {
    let method = Method::DormandPrince { tolerance: 1e-10 };
    assert!(crossings(1.000_001, Direction::Either, method).is_empty());
}

/// Two thresholds at the same instant: both are handled, in order.
struct Twins(Vec<(usize, f64)>);

impl System<1> for Twins {
    type Refusal = String;
    fn derivative(&self, _: f64, _: &[f64; 1], dy: &mut [f64; 1]) -> Result<(), String> {
        *dy = [1.0];
        Ok(())
    }
    fn scales(&self) -> [f64; 1] {
        [1.0]
    }
    fn events(&self) -> usize {
        3
    }
    fn direction(&self, event: usize) -> Option<Direction> {
        Some([Direction::Rising, Direction::Falling, Direction::Falling][event])
    }
    fn event_values(&self, _: f64, y: &[f64; 1], values: &mut [f64]) {
        values.copy_from_slice(&[y[0] - 0.3, 0.3 - y[0], y[0] - 0.3]);
    }
    fn at_event(&mut self, event: usize, t: f64, _: &mut [f64; 1]) -> Result<Action, String> {
        self.0.push((event, t));
        Ok(Action::Switch)
    }
}

#[test]
fn events_at_one_instant_are_all_handled() {
    for method in [
        Method::Rk4 { step_s: 0.07 },
        Method::DormandPrince { tolerance: 1e-9 },
    ] {
        let mut system = Twins(vec![]);
        let mut integrator = Integrator::new(&system, method).unwrap();
        let mut y = [0.0];
        integrator
            .run(&mut system, 0.0, &mut y, 1.0, |_, _| {})
            .unwrap();
        // The third looks the other way.
        let [(0, first), (1, second)] = system.0[..] else {
            panic!("{method:?}: {:?}", system.0);
        };
        assert_eq!(first, second);
        assert!((first - 0.3).abs() < 1e-15, "{first}");
    }
}

/// Counts up by one each sample, holding the rate: y is the integral of k over each period.
struct Sampled {
    held: f64,
    instants: Vec<(u64, f64)>,
}

impl System<1> for Sampled {
    type Refusal = String;
    fn derivative(&self, _: f64, _: &[f64; 1], dy: &mut [f64; 1]) -> Result<(), String> {
        *dy = [self.held];
        Ok(())
    }
    fn scales(&self) -> [f64; 1] {
        [1.0]
    }
    fn sample_rate(&self) -> Option<f64> {
        Some(10_000.0)
    }
    fn sample(&mut self, tick: u64, t: f64, _: &mut [f64; 1]) -> Result<Action, String> {
        self.instants.push((tick, t));
        self.held = tick as f64;
        Ok(Action::Switch)
    }
}

#[test]
fn samples_are_taken_at_their_instants_exactly() {
    for method in [
        Method::Rk4 { step_s: 3e-5 },
        Method::DormandPrince { tolerance: 1e-10 },
        Method::RadauIia { tolerance: 1e-10 },
    ] {
        let mut system = Sampled {
            held: 0.0,
            instants: vec![],
        };
        let mut integrator = Integrator::new(&system, method).unwrap();
        let mut y = [0.0];
        let mut last = 0.0;
        let observe = |_: &Sampled, step: &trirrr_integrate::Dense<1>| {
            assert_eq!(step.start(), last, "no gap");
            last = step.end();
        };
        integrator
            .run(&mut system, 0.0, &mut y, 0.05, observe)
            .unwrap();
        assert_eq!(system.instants.len(), 500);
        for (k, &(tick, t)) in system.instants.iter().enumerate() {
            assert_eq!((tick, t), (k as u64, k as f64 / 1e4));
        }
        // The sum of k/1e4 for k below 500, from derivatives that are constant over each step: a
        // kink stepped over would cost some 1e-4 of it.
        let truth = 499.0 * 500.0 / 2.0 / 1e4;
        assert!((y[0] - truth).abs() < 1e-12, "{method:?}: {}", y[0]);
        assert_eq!(last, 0.05);
    }
}
