//! Every way that a run ends early has a name.

use crate::problems::{Decay, Oscillator};
use trirrr_integrate::{Failure, Integrator, Method, Reason, System, Unfit};

fn unfit(method: Method) -> Unfit {
    Integrator::new(&Oscillator, method)
        .map(|_| ())
        .unwrap_err()
}

#[test]
fn parameters_that_mean_nothing() {
    for step_s in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        assert!(matches!(unfit(Method::Rk4 { step_s }), Unfit::Step { .. }));
    }
    for tolerance in [0.0, 1e-15, 0.5, f64::NAN, -1e-6] {
        assert!(matches!(
            unfit(Method::RadauIia { tolerance }),
            Unfit::Tolerance { .. }
        ));
    }
    let bare = Decay([-1.0]);
    let euler = Method::SemiImplicitEuler { step_s: 1e-3 };
    let refused = Integrator::new(&bare, euler).map(|_| ()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "semi-implicit-euler needs positions and velocities, and the system has none"
    );
}

#[test]
fn a_step_longer_than_the_run() {
    let mut integrator = Integrator::new(&Oscillator, Method::Rk4 { step_s: 2.0 }).unwrap();
    let mut y = Oscillator::START;
    let failure = integrator
        .run(&mut Oscillator, 0.0, &mut y, 1.0, |_, _| {})
        .unwrap_err();
    assert_eq!(
        failure.to_string(),
        "step = 2 s is longer than the run of 1 s"
    );
    assert_eq!(y, Oscillator::START);
    for (start, end) in [
        (1.0, 0.0),
        (0.0, f64::NAN),
        (f64::INFINITY, 1.0),
        (0.5, 0.5),
    ] {
        let failure = integrator
            .run(&mut Oscillator, start, &mut y, end, |_, _| {})
            .unwrap_err();
        assert!(
            matches!(failure, Failure::Unfit(Unfit::Run { .. })),
            "{failure}"
        );
    }
}

#[test]
fn a_step_that_is_too_long_for_the_method() {
    // RK4 is stable to 2.785 / 1000 s here; at 3e-3 s each step amplifies by |R(-3)| = 1.375.
    let mut system = Decay([-1000.0, -1.0]);
    let mut integrator = Integrator::new(&system, Method::Rk4 { step_s: 3e-3 }).unwrap();
    let mut y = [1.0, 1.0];
    let failure = integrator
        .run(&mut system, 0.0, &mut y, 3.0, |_, _| {})
        .unwrap_err();
    let Failure::StepTooLong {
        step_s,
        limit_s,
        method,
        t,
    } = failure
    else {
        panic!("{failure}");
    };
    assert_eq!((step_s, method), (3e-3, "rk4"));
    assert!((limit_s - 2.785_293_563e-3).abs() < 1e-8, "{limit_s:e}");
    // 1e12 = 1.375^n at n = 86.8.
    assert!((t - 86.0 * 3e-3).abs() < 4e-3, "{t}");
    assert!(y.iter().all(|y| y.is_finite()));
}

/// y' = y^2, y(0) = 1: infinite at t = 1.
struct BlowUp;

impl System<1> for BlowUp {
    type Refusal = String;
    fn derivative(&self, _: f64, y: &[f64; 1], dy: &mut [f64; 1]) -> Result<(), String> {
        *dy = [y[0] * y[0]];
        Ok(())
    }
    fn scales(&self) -> [f64; 1] {
        [1.0]
    }
}

/// y' = -1/y, y(0) = 1: y = sqrt(1 - 2 t), no value from t = 0.5 on.
struct Wall;

impl System<1> for Wall {
    type Refusal = &'static str;
    fn derivative(&self, _: f64, y: &[f64; 1], dy: &mut [f64; 1]) -> Result<(), &'static str> {
        if y[0] <= 0.0 {
            return Err("out of reach");
        }
        *dy = [-1.0 / y[0]];
        Ok(())
    }
    fn scales(&self) -> [f64; 1] {
        [1.0]
    }
}

/// A derivative that is not a number from t = 0.25 on.
struct Hole;

impl System<1> for Hole {
    type Refusal = String;
    fn derivative(&self, t: f64, _: &[f64; 1], dy: &mut [f64; 1]) -> Result<(), String> {
        *dy = [if t < 0.25 { 1.0 } else { f64::NAN }];
        Ok(())
    }
    fn scales(&self) -> [f64; 1] {
        [1.0]
    }
}

const METHODS: [Method; 3] = [
    Method::Rk4 { step_s: 1e-4 },
    Method::DormandPrince { tolerance: 1e-8 },
    Method::RadauIia { tolerance: 1e-8 },
];

#[test]
fn a_solution_that_grows_out_of_every_bound() {
    for method in METHODS {
        let mut integrator = Integrator::new(&BlowUp, method).unwrap();
        let mut y = [1.0];
        let failure = integrator
            .run(&mut BlowUp, 0.0, &mut y, 2.0, |_, _| {})
            .unwrap_err();
        let t = match failure {
            Failure::Diverged {
                t, component: 0, ..
            }
            | Failure::Underflow { t, .. } => t,
            other => panic!("{method:?}: {other}"),
        };
        assert!((t - 1.0).abs() < 2e-3, "{method:?}: {failure}");
        assert!(y[0].is_finite());
    }
}

#[test]
fn equations_without_a_value_say_so_themselves() {
    for method in METHODS {
        let mut integrator = Integrator::new(&Wall, method).unwrap();
        let mut y = [1.0];
        let failure = integrator
            .run(&mut Wall, 0.0, &mut y, 2.0, |_, _| {})
            .unwrap_err();
        let t = match failure {
            Failure::Refused {
                t,
                cause: "out of reach",
            } => t,
            // The slope is infinite at the wall: the error is what stops some.
            Failure::Underflow {
                t,
                reason: Reason::Error | Reason::Iteration,
                ..
            } => t,
            ref other => panic!("{method:?}: {other}"),
        };
        // RK4 sees the wall only from a step away.
        assert!((t - 0.5).abs() < 2e-4, "{method:?}: {failure}");
    }
}

#[test]
fn nothing_goes_on_with_what_is_not_a_number() {
    for method in METHODS {
        let mut integrator = Integrator::new(&Hole, method).unwrap();
        let mut y = [0.0];
        let failure = integrator
            .run(&mut Hole, 0.0, &mut y, 2.0, |_, _| {})
            .unwrap_err();
        let t = match failure {
            Failure::Diverged { t, .. } => t,
            Failure::Underflow {
                t,
                reason: Reason::NotFinite,
                ..
            } => t,
            ref other => panic!("{method:?}: {other}"),
        };
        assert!((t - 0.25).abs() < 2e-4, "{method:?}: {failure}");
        assert!((y[0] - 0.25).abs() < 2e-4, "{method:?}: {}", y[0]);
    }
}

/// A relay without hysteresis: y' = -sign(y), by events.
struct Relay {
    sign: f64,
}

impl System<1> for Relay {
    type Refusal = String;
    fn derivative(&self, _: f64, _: &[f64; 1], dy: &mut [f64; 1]) -> Result<(), String> {
        *dy = [-self.sign];
        Ok(())
    }
    fn scales(&self) -> [f64; 1] {
        [1.0]
    }
    fn events(&self) -> usize {
        1
    }
    fn event_name(&self, _: usize) -> String {
        "relay".into()
    }
    fn direction(&self, _: usize) -> Option<trirrr_integrate::Direction> {
        Some(trirrr_integrate::Direction::Either)
    }
    fn event_values(&self, _: f64, y: &[f64; 1], values: &mut [f64]) {
        values[0] = y[0];
    }
    fn at_event(
        &mut self,
        _: usize,
        _: f64,
        _: &mut [f64; 1],
    ) -> Result<trirrr_integrate::Action, String> {
        self.sign = -self.sign;
        Ok(trirrr_integrate::Action::Switch)
    }
}

#[test]
fn chatter_is_refused_by_name() {
    for method in METHODS {
        let mut relay = Relay { sign: 1.0 };
        let mut integrator = Integrator::new(&relay, method).unwrap();
        let mut y = [0.5];
        let failure = integrator
            .run(&mut relay, 0.0, &mut y, 2.0, |_, _| {})
            .unwrap_err();
        let Failure::Chatter { t, name, .. } = &failure else {
            panic!("{method:?}: {failure}");
        };
        assert_eq!(name, "relay");
        assert!((t - 0.5).abs() < 1e-6, "{method:?}: {failure}");
    }
}
