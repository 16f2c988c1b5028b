//! No step allocates, whatever the method, with events, samples and Jacobians on the way.

#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System as Heap};
use std::cell::Cell;
use trirrr_integrate::{Action, Direction, End, Integrator, Method, System};

/// The heap, counting what each thread asks it for: the test's own threads do so, too.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    ALLOCATIONS.with(|count| count.set(count.get() + 1));
}

// SAFETY: every call goes to the system's allocator as it came. The counter is a plain cell of the
// thread, initialised at compile time and without a destructor: reaching it allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promises are those of `alloc` itself.
        unsafe { Heap.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { Heap.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as above.
        unsafe { Heap.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static HEAP: Counting = Counting;

/// A mass of 1 kg on a spring, pushed by a force that follows its command within a millisecond, with
/// dry friction that changes its sign with the velocity: stiff, sampled and sudden.
#[derive(Default)]
struct Slider {
    command: f64,
    slides: f64,
    reversals: u64,
    samples: u64,
}

impl System<3> for Slider {
    type Refusal = String;
    fn derivative(&self, _: f64, y: &[f64; 3], dy: &mut [f64; 3]) -> Result<(), String> {
        let [x, v, force] = *y;
        *dy = [
            v,
            force - 100.0 * x - 0.1 * self.slides,
            1e3 * (self.command - force),
        ];
        Ok(())
    }
    fn scales(&self) -> [f64; 3] {
        [1.0; 3]
    }
    fn positions(&self) -> &[(usize, usize)] {
        &[(0, 1)]
    }
    fn events(&self) -> usize {
        1
    }
    fn direction(&self, _: usize) -> Option<Direction> {
        Some(Direction::Either)
    }
    fn event_values(&self, _: f64, y: &[f64; 3], values: &mut [f64]) {
        values[0] = y[1];
    }
    fn at_event(&mut self, _: usize, _: f64, _: &mut [f64; 3]) -> Result<Action, String> {
        self.slides = -self.slides;
        self.reversals += 1;
        Ok(Action::Switch)
    }
    fn sample_rate(&self) -> Option<f64> {
        Some(1e3)
    }
    fn sample(&mut self, tick: u64, _: f64, _: &mut [f64; 3]) -> Result<Action, String> {
        self.command = 2.0 * (0.01 * tick as f64).sin();
        self.samples += 1;
        Ok(Action::Switch)
    }
}

#[test]
fn no_step_of_any_method_allocates() {
    for method in [
        Method::SemiImplicitEuler { step_s: 1e-4 },
        Method::Rk4 { step_s: 1e-3 },
        Method::DormandPrince { tolerance: 1e-9 },
        Method::RadauIia { tolerance: 1e-9 },
    ] {
        let mut slider = Slider {
            slides: 1.0,
            ..Slider::default()
        };
        let before = ALLOCATIONS.get();
        let mut integrator = Integrator::new(&slider, method).unwrap();
        // The counter counts: what a method keeps is allocated here.
        assert!(ALLOCATIONS.get() > before, "{method:?}");
        let mut y = [0.0, 1.0, 0.0];
        let before = ALLOCATIONS.get();
        let end = integrator.run(&mut slider, 0.0, &mut y, 2.0, |_, step| {
            assert!(step.last()[0].is_finite());
        });
        let allocations = ALLOCATIONS.get() - before;
        assert_eq!(end, Ok(End::Reached), "{method:?}");
        let tally = integrator.tally();
        println!("{}: {tally:?}", method.name());
        // All of it was on the way: samples, events, steps cut at them, and matrices.
        assert_eq!(slider.samples, 2000);
        assert!(slider.reversals >= 4 && tally.events == slider.reversals);
        assert_eq!(
            tally.factorisations > 0,
            matches!(method, Method::RadauIia { .. })
        );
        assert_eq!(allocations, 0, "{method:?}: {} steps", tally.steps);
    }
}
