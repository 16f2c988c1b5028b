//! A mechanism solved twice: by its dyads (`compositions.rs`) in any number type, and by its loops in
//! f64.
//!
//! The condition of a result y of the data d (dimensions, inputs, their rates and accelerations)
//! is cond = |y| + sum |dy/dd d|: how far y moves when every datum moves by one part, in the worst
//! direction. The derivatives are central differences of the loops' solution, over 1e-5 of each
//! datum. Two solutions that are each as good as if the data had been rounded differ by a few
//! u cond.

use core::f64::consts::{PI, TAU};
use core::ops::RangeInclusive;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_linkage::closure::{Closure, ClosureInput, ClosurePosition, Length, Reference, Term};
use trirrr_linkage::{Drive, LinkMotion, SlideMotion};
use trirrr_tests::bound::Worst;

/// Steps to a turn.
const STEPS: u32 = 720;

/// Below 1 is the requirement; above the lower end the bound is not too wide to find a defect.
pub(crate) const BRACKET: RangeInclusive<f64> = 0.15..=1.0;

/// A result with its rate and its acceleration.
pub(crate) type Jet<N> = [N; 3];

/// A mechanism as a system of loops.
pub(crate) struct Loops<'a, const U: usize, const D: usize> {
    pub(crate) name: &'static str,
    /// Dimensions: lengths.
    pub(crate) lengths: &'a [f64],
    /// Dimensions: angles.
    pub(crate) fixed_angles: &'a [f64],
    /// The vectors for other values of the dimensions, lengths first.
    pub(crate) terms: &'a dyn Fn(&[f64]) -> Vec<Term<f64>>,
    /// Which unknowns are angles.
    pub(crate) angles: [bool; U],
    /// The inputs when the crank stands at an angle.
    pub(crate) inputs: &'a dyn Fn(f64) -> [ClosureInput<f64>; D],
    /// Which inputs are angles.
    pub(crate) driven_angles: [bool; D],
}

/// The motion of a link's direction.
pub(crate) fn turn<N: Number>(link: &LinkMotion<N>) -> Jet<N> {
    [N::radians(link.angle()), link.rate, link.acceleration]
}

/// The motion of a slide.
pub(crate) fn slide<N: Number>(slide: &SlideMotion<N>) -> Jet<N> {
    [slide.length, slide.rate, slide.acceleration]
}

/// An input that is an angle.
pub(crate) fn drive<N: Number>(input: &ClosureInput<N>) -> Drive<N> {
    Drive {
        angle: N::angle(input.value),
        rate: input.rate,
        acceleration: input.acceleration,
    }
}

/// A crank at `angle`, turning unsteadily.
pub(crate) fn crank(angle: f64) -> [ClosureInput<f64>; 1] {
    [ClosureInput {
        value: angle,
        rate: 1.3,
        acceleration: -0.7,
    }]
}

impl<'a, const U: usize> Loops<'a, U, 1> {
    /// A mechanism with one [`crank`].
    pub(crate) fn with_crank(
        name: &'static str,
        lengths: &'a [f64],
        fixed_angles: &'a [f64],
        angles: [bool; U],
        terms: &'a dyn Fn(&[f64]) -> Vec<Term<f64>>,
    ) -> Self {
        Self {
            name,
            lengths,
            fixed_angles,
            terms,
            angles,
            inputs: &crank,
            driven_angles: [true],
        }
    }
}

impl<const U: usize, const D: usize> Loops<'_, U, D> {
    fn constants(&self) -> Vec<f64> {
        [self.lengths, self.fixed_angles].concat()
    }

    fn solve(
        &self,
        constants: &[f64],
        inputs: &[ClosureInput<f64>; D],
        guess: [f64; U],
    ) -> ([Jet<f64>; U], ClosurePosition<f64, U>) {
        let terms = (self.terms)(constants);
        let closure = Closure::<f64, U, D>::new(&terms).expect("loops");
        let at = closure.position(inputs, guess);
        let at = at.unwrap_or_else(|status| panic!("{}: {status} at {inputs:?}", self.name));
        let rates = closure.rates(inputs, &at).expect("rates");
        let acc = closure.accelerations(inputs, &at, &rates);
        let acc = acc.expect("accelerations");
        let jets = core::array::from_fn(|i| [at.unknowns[i], rates[i], acc[i]]);
        (jets, at)
    }

    /// The condition of every result.
    fn condition(&self, inputs: &[ClosureInput<f64>; D], at: &[Jet<f64>; U]) -> [Jet<f64>; U] {
        let step = 1e-5;
        let constants = self.constants();
        let guess = at.map(|jet| jet[0]);
        let mut condition = core::array::from_fn(|i| {
            let value = if self.angles[i] {
                wrapped(at[i][0])
            } else {
                at[i][0]
            };
            [value.abs(), at[i][1].abs(), at[i][2].abs()]
        });
        for datum in 0..constants.len() + 3 * D {
            let moved = |by: f64| {
                let (mut constants, mut inputs) = (constants.clone(), *inputs);
                let input = datum.saturating_sub(constants.len());
                let is_fixed_angle = datum >= self.lengths.len();
                let (value, is_angle) = match constants.get_mut(datum) {
                    Some(constant) => (constant, is_fixed_angle),
                    None => match input % 3 {
                        0 => (&mut inputs[input / 3].value, self.driven_angles[input / 3]),
                        1 => (&mut inputs[input / 3].rate, false),
                        _ => (&mut inputs[input / 3].acceleration, false),
                    },
                };
                *value += by
                    * if is_angle {
                        value.abs().max(1.0)
                    } else {
                        *value
                    };
                self.solve(&constants, &inputs, guess).0
            };
            let (up, down) = (moved(step), moved(-step));
            for (i, jet) in condition.iter_mut().enumerate() {
                for (order, sum) in jet.iter_mut().enumerate() {
                    *sum += (up[i][order] - down[i][order]).abs() / (2.0 * step);
                }
            }
        }
        condition
    }

    /// Compares over a turn: error / (4 u cond).
    pub(crate) fn compare<N: Number>(
        &self,
        closed: impl Fn(&[ClosureInput<N>; D]) -> [Jet<N>; U],
    ) -> Worst {
        let mut worst = Worst::default();
        let mut guess = None;
        for step in 0..STEPS {
            let angle = f64::from(step) * (TAU / f64::from(STEPS));
            let narrow = (self.inputs)(angle).map(|input| ClosureInput {
                value: N::from_f64(input.value),
                rate: N::from_f64(input.rate),
                acceleration: N::from_f64(input.acceleration),
            });
            let inputs = narrow.map(|input| ClosureInput {
                value: input.value.to_f64(),
                rate: input.rate.to_f64(),
                acceleration: input.acceleration.to_f64(),
            });
            let results = closed(&narrow).map(|jet| jet.map(N::to_f64));
            // The first guess is off by what cannot pass for a solution.
            let from = guess.unwrap_or_else(|| results.map(|jet| jet[0] + 0.01));
            let (truth, at) = self.solve(&self.constants(), &inputs, from);
            guess = Some(at.unknowns);
            assert!(at.iterations <= 6, "{}: {}", self.name, at.iterations);
            assert!(at.residual <= 16.0 * f64::UNIT_ROUNDOFF, "{}", at.residual);
            let condition = self.condition(&inputs, &truth);
            for i in 0..U {
                for order in 0..3 {
                    let error = results[i][order] - truth[i][order];
                    let is_angle = order == 0 && self.angles[i];
                    let error = if is_angle { wrapped(error) } else { error };
                    let bound = 4.0 * N::UNIT_ROUNDOFF.to_f64() * condition[i][order];
                    let place = || format!("{} unknown {i} order {order} step {step}", self.name);
                    worst.compare(place, error, bound);
                }
            }
        }
        worst
    }
}

/// Compares in both number types.
pub(crate) fn compare_both<const U: usize, const D: usize>(
    loops: &Loops<U, D>,
    wide: impl Fn(&[ClosureInput<f64>; D]) -> [Jet<f64>; U],
    narrow: impl Fn(&[ClosureInput<f32>; D]) -> [Jet<f32>; U],
) {
    let worst = loops.compare(wide);
    worst.assert_within(&format!("{}, f64", loops.name), BRACKET);
    let worst = loops.compare(narrow);
    worst.assert_within(&format!("{}, f32", loops.name), BRACKET);
}

/// A vector: loop, length, reference, offset.
pub(crate) fn v(in_loop: usize, length: Length, reference: Reference, offset: f64) -> Term<f64> {
    Term::new(in_loop, length, reference, offset)
}

/// An angle less whole turns.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}
