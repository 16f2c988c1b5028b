//! Stability limits from the linearisation, against those in closed form and against runs.

use crate::problems::{Decay, Oscillator};
use trirrr_integrate::stability::{Warning, choose, warning};
use trirrr_integrate::{Failure, Integrator, Method, Spectrum, System};

/// x'' = -w^2 x - 2 d x'.
struct Damped {
    w: f64,
    d: f64,
}

impl System<2> for Damped {
    type Refusal = String;
    fn derivative(&self, _: f64, y: &[f64; 2], dy: &mut [f64; 2]) -> Result<(), String> {
        *dy = [y[1], -self.w * self.w * y[0] - 2.0 * self.d * y[1]];
        Ok(())
    }
    fn scales(&self) -> [f64; 2] {
        [1.0, self.w]
    }
    fn positions(&self) -> &[(usize, usize)] {
        &[(0, 1)]
    }
}

#[test]
fn eigenvalues_of_a_damped_oscillator() {
    let system = Damped {
        w: 1000.0,
        d: 100.0,
    };
    let spectrum = Spectrum::of(&system, 0.0, &[0.1, 0.0]).unwrap();
    assert!((spectrum.radius() - 1000.0).abs() < 1e-5);
    assert!((spectrum.growth() + 100.0).abs() < 1e-5);
    let imaginary = (1e6f64 - 1e4).sqrt();
    for value in spectrum.eigenvalues() {
        assert!((value.im.abs() - imaginary).abs() < 1e-5);
    }
}

#[test]
fn limits_in_closed_form() {
    let real = Spectrum::of(&Decay([-1000.0, -1.0]), 0.0, &[1.0, 1.0]).unwrap();
    let rk4 = Method::Rk4 { step_s: 1.0 };
    // RK4: the real root of 1 + z/2 + z^2/6 + z^3/24 = 0 is z = -2.785293563405282.
    let limit = real.longest_step(&rk4, &[]);
    assert!((limit - 2.785_293_563e-3).abs() < 1e-8, "{limit:e}");
    let swing = Damped { w: 1000.0, d: 0.0 };
    let imaginary = Spectrum::of(&swing, 0.0, &[0.1, 0.0]).unwrap();
    // On the imaginary axis: 2 sqrt(2).
    let limit = imaginary.longest_step(&rk4, &[]);
    assert!((limit - 8f64.sqrt() * 1e-3).abs() < 1e-8, "{limit:e}");
    // Semi-implicit Euler on the undamped oscillator: 2/w. With damping 2 d = 2 d': det = 1 - 2dh,
    // trace = 2 - 2dh - (wh)^2; stable while |trace| <= 1 + det: (wh)^2 + 4dh - 4 <= 0.
    let euler = Method::SemiImplicitEuler { step_s: 1.0 };
    let limit = imaginary.longest_step(&euler, swing.positions());
    assert!((limit - 2e-3).abs() < 1e-8, "{limit:e}");
    let damped = Damped {
        w: 1000.0,
        d: 300.0,
    };
    let spectrum = Spectrum::of(&damped, 0.0, &[0.1, 0.0]).unwrap();
    let limit = spectrum.longest_step(&euler, damped.positions());
    let truth = ((4.0 * 0.09f64 + 4.0).sqrt() - 0.6) * 1e-3;
    assert!((limit - truth).abs() < 1e-8, "{limit:e} for {truth:e}");
    // What adapts its step, or is stable with all, has none.
    let radau = Method::RadauIia { tolerance: 1e-6 };
    assert_eq!(real.longest_step(&radau, &[]), f64::INFINITY);
}

#[test]
fn limits_are_those_of_runs() {
    for (w, d) in [(1000.0, 100.0), (1000.0, 300.0), (500.0, 480.0)] {
        let start = [0.1, 0.0];
        let mut system = Damped { w, d };
        let spectrum = Spectrum::of(&system, 0.0, &start).unwrap();
        for method in [
            (|step_s| Method::Rk4 { step_s }) as fn(f64) -> Method,
            |step_s| Method::SemiImplicitEuler { step_s },
        ] {
            let limit = spectrum.longest_step(&method(1.0), system.positions());
            for (factor, stable) in [(0.98, true), (1.02, false)] {
                let method = method(factor * limit);
                let mut y = start;
                let mut integrator = Integrator::new(&system, method).unwrap();
                // 2 percent beyond the limit amplifies by about a percent each step, and 1e12 is
                // 1.01^2800.
                let span = 20_000.0 * limit;
                let end = integrator.run(&mut system, 0.0, &mut y, span, |_, _| {});
                if stable {
                    end.unwrap();
                    assert!(y[0].abs() < 1e-9, "{method:?}: {y:?}");
                } else {
                    let failure = end.unwrap_err();
                    assert!(matches!(failure, Failure::StepTooLong { .. }), "{failure}");
                }
            }
        }
    }
}

#[test]
fn zero_eigenvalues_limit_nothing() {
    // A free body and a recorded sum beside a decay.
    struct Free;
    impl System<4> for Free {
        type Refusal = String;
        fn derivative(&self, _: f64, y: &[f64; 4], dy: &mut [f64; 4]) -> Result<(), String> {
            *dy = [y[1], 0.0, -100.0 * y[2], y[2] * y[2]];
            Ok(())
        }
        fn scales(&self) -> [f64; 4] {
            [1.0, 1.0, 1.0, f64::INFINITY]
        }
        fn positions(&self) -> &[(usize, usize)] {
            &[(0, 1)]
        }
    }
    let spectrum = Spectrum::of(&Free, 0.0, &[0.3, 0.2, 1.0, 0.0]).unwrap();
    let limit = spectrum.longest_step(&Method::Rk4 { step_s: 1.0 }, &[(0, 1)]);
    assert!((limit - 2.785_293_563e-2).abs() < 1e-7, "{limit:e}");
    let limit = spectrum.longest_step(&Method::SemiImplicitEuler { step_s: 1.0 }, &[(0, 1)]);
    assert!((limit - 2e-2).abs() < 1e-7, "{limit:e}");
}

#[test]
fn the_method_is_chosen_by_stiffness() {
    let slow = Spectrum::of(&Oscillator, 0.0, &Oscillator::START).unwrap();
    let stiff = Spectrum::of(&Decay([-5e5, -1.0]), 0.0, &[1.0, 1.0]).unwrap();
    let tolerance = 1e-8;
    assert_eq!(
        choose(&slow, 1e-3, Some(tolerance)).method,
        Method::DormandPrince { tolerance }
    );
    let choice = choose(&stiff, 1e-3, None);
    let own = Method::RADAU_IIA_TOLERANCE;
    assert_eq!(choice.method, Method::RadauIia { tolerance: own });
    assert!(choice.to_string().starts_with("radau-iia: "), "{choice}");
    // From sample to sample of 10 MHz it is not stiff.
    assert_eq!(
        choose(&stiff, 1e-7, Some(tolerance)).method,
        Method::DormandPrince { tolerance }
    );
}

#[test]
fn what_cannot_be_stable_is_warned_of() {
    let spectrum = Spectrum::of(&Decay([-1000.0, -1.0]), 0.0, &[1.0, 1.0]).unwrap();
    let warn = |method| warning(&spectrum, &method, &[], 1.0);
    assert_eq!(warn(Method::Rk4 { step_s: 2.7e-3 }), None);
    let Some(Warning::Unstable { limit_s, .. }) = warn(Method::Rk4 { step_s: 2.8e-3 }) else {
        panic!("no warning");
    };
    assert!((limit_s - 2.785_293_563e-3).abs() < 1e-8);
    assert_eq!(warn(Method::DormandPrince { tolerance: 1e-8 }), None);
    assert_eq!(warn(Method::RadauIia { tolerance: 1e-8 }), None);
    let spectrum = Spectrum::of(&Decay([-1e7, -1.0]), 0.0, &[1.0, 1.0]).unwrap();
    let explicit = Method::DormandPrince { tolerance: 1e-8 };
    let Some(Warning::Stiff { steps, .. }) = warning(&spectrum, &explicit, &[], 1.0) else {
        panic!("no warning");
    };
    assert!((steps / 3.02e6 - 1.0).abs() < 0.01, "{steps:e}");
}
