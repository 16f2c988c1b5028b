//! Stiff test problems with published reference values.

use crate::problems::{Decay, Robertson, VanDerPol};
use trirrr_integrate::{Action, Failure, Integrator, Method, System};

fn solve<const N: usize, S: System<N>>(
    mut system: S,
    start: [f64; N],
    end: f64,
    tolerance: f64,
) -> ([f64; N], Integrator<N>) {
    let mut integrator = Integrator::new(&system, Method::RadauIia { tolerance }).unwrap();
    let mut y = start;
    integrator
        .run(&mut system, 0.0, &mut y, end, |_, _| {})
        .unwrap_or_else(|failure| panic!("{failure}: {:?}", y));
    (y, integrator)
}

fn digits<const N: usize>(y: [f64; N], truth: [f64; N]) -> f64 {
    (0..N).fold(f64::INFINITY, |least, i| {
        least.min(-(((y[i] - truth[i]) / truth[i]).abs().max(1e-17)).log10())
    })
}

#[test]
fn van_der_pol_to_the_digits_asked_for() {
    // The tolerance is per step, relative to 1; the solution sweeps through 0 and its flanks
    // multiply errors, so that some two digits are lost.
    for (tolerance, wanted) in [(1e-6, 4.0), (1e-8, 6.0), (1e-10, 8.0)] {
        let (y, integrator) = solve(VanDerPol, VanDerPol::START, 2.0, tolerance);
        let found = digits(y, VanDerPol::END);
        assert!(found > wanted, "{found} digits at {tolerance:e}");
        // The fast transients have a time constant of 1e-6 s: an explicit method would need
        // more than 1e6 steps.
        assert!(integrator.tally().steps < 5000, "{:?}", integrator.tally());
    }
}

#[test]
fn robertson_over_eleven_decades() {
    for (tolerance, wanted) in [(1e-6, 4.0), (1e-9, 6.5)] {
        let (y, integrator) = solve(Robertson, Robertson::START, 1e11, tolerance);
        let found = digits(y, Robertson::END);
        assert!(found > wanted, "{found} digits at {tolerance:e}");
        assert!(integrator.tally().steps < 2000, "{:?}", integrator.tally());
    }
}

#[test]
fn a_fast_decay_does_not_hold_up_the_implicit_method() {
    // L-stable: 1e9 time constants, the first transient is all that needs short steps.
    let (y, integrator) = solve(Decay([-1e9, -1.0]), [1.0, 1.0], 1.0, 1e-8);
    assert!(y[0].abs() < 1e-8, "{y:?}");
    assert!((y[1] - (-1.0f64).exp()).abs() < 1e-7, "{y:?}");
    assert!(integrator.tally().steps < 300, "{:?}", integrator.tally());
}

#[test]
fn the_explicit_pair_runs_out_of_steps_on_it_and_says_when() {
    let mut system = Decay([-1e9, -1.0]);
    let method = Method::DormandPrince { tolerance: 1e-8 };
    let mut integrator = Integrator::new(&system, method)
        .unwrap()
        .with_budget(10_000);
    let mut y = [1.0, 1.0];
    let failure = integrator
        .run(&mut system, 0.0, &mut y, 1.0, |_, _| {})
        .unwrap_err();
    let Failure::Budget { t, steps, step_s } = failure else {
        panic!("{failure}");
    };
    assert_eq!(steps, 10_000);
    // Stability holds the steps near 3.3e-9 s.
    assert!((1e-9..5e-9).contains(&step_s), "{step_s:e}");
    assert!((1e-5..5e-5).contains(&t), "{t:e}");
}

#[test]
fn finite_differences_serve_as_well_as_the_jacobian() {
    struct Differences;
    impl System<2> for Differences {
        type Refusal = String;
        fn derivative(&self, t: f64, y: &[f64; 2], dy: &mut [f64; 2]) -> Result<(), String> {
            VanDerPol.derivative(t, y, dy)
        }
        fn scales(&self) -> [f64; 2] {
            VanDerPol.scales()
        }
    }
    let (mut exact, mut found) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
    let at = [1.7, -0.3];
    VanDerPol.jacobian(0.0, &at, &mut exact).unwrap();
    Differences.jacobian(0.0, &at, &mut found).unwrap();
    for i in 0..2 {
        for j in 0..2 {
            // Central differences of a cubic: h^2/6 times the third derivative (0 here) and the
            // rounding of values of 1e6 over a step of 1e-5.
            let error = (found[i][j] - exact[i][j]).abs();
            assert!(error < 1e-9 * 2e6, "{i} {j}: {error:e}");
        }
    }
    let (y, _) = solve(Differences, VanDerPol::START, 2.0, 1e-8);
    assert!(digits(y, VanDerPol::END) > 6.0);
}

/// A motor whose winding settles in 1e-6 s, under a controller sampled at 10 kHz: current and rate.
struct SampledMotor {
    voltage: f64,
}

impl System<2> for SampledMotor {
    type Refusal = String;
    fn derivative(&self, _: f64, y: &[f64; 2], dy: &mut [f64; 2]) -> Result<(), String> {
        let [current, rate] = *y;
        *dy = [1e6 * (self.voltage - current - 0.1 * rate), 100.0 * current];
        Ok(())
    }
    fn scales(&self) -> [f64; 2] {
        [1.0; 2]
    }
    fn sample_rate(&self) -> Option<f64> {
        Some(1e4)
    }
    fn sample(&mut self, tick: u64, _: f64, y: &mut [f64; 2]) -> Result<Action, String> {
        self.voltage = (0.003 * tick as f64).sin() - y[1];
        Ok(Action::Switch)
    }
}

#[test]
fn the_step_after_a_sample_is_known_from_the_sample_before() {
    let solved = |tolerance| {
        let motor = SampledMotor { voltage: 0.0 };
        solve(motor, [0.0, 0.0], 0.2, tolerance)
    };
    let (y, integrator) = solved(1e-9);
    let tally = integrator.tally();
    println!("{tally:?}");
    // Each of 2000 samples excites the winding again.
    assert!(tally.steps > 4000, "{tally:?}");
    assert!(tally.rejected < 200, "{tally:?}");
    let (exact, _) = solved(1e-13);
    assert!((y[1] - exact[1]).abs() < 1e-8, "{y:?} {exact:?}");
}
