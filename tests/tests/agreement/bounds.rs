//! What errors of the inputs and of the functions do to the results.

use core::f64::consts::TAU;
use trirrr_core::machine::Parameters;
use trirrr_core::number::Fixed;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::units::Units;
use trirrr_tests::bound::{Worst, angle_difference};
use trirrr_tests::inputs::Input;
use trirrr_tests::motors::{Motors, STAGES, of_list};
use trirrr_tests::results::uncertainties;
use trirrr_tests::vector_formulas::{self, Functions};

/// How far the results move when each input moves by `off`, to first order.
pub(crate) fn of_inputs(
    parameters: &Parameters,
    setpoint: &Setpoint<f64>,
    off: impl Fn(Input) -> f64,
) -> Motors {
    of_list(&uncertainties(parameters, setpoint, off))
}

/// micromath's square root is (1 + m/2) for the significand 1 + m where the exponent is even and
/// (3 + m)/2 / sqrt 2 where it is odd: too large by 1.5 / sqrt 2 at most.
const ROOT: f64 = 1.5 * core::f64::consts::FRAC_1_SQRT_2;
/// Its cosine is 0.775 p + 0.225 p^2 of a parabola p: off by 1.09e-3 at most. The angle is counted
/// in turns, from the nearest whole one: three roundings of its own size.
const SIN_COS: f64 = 1.09e-3;
/// Its arctangent is a quotient of quadratic forms: off by 2.83e-3 rad at most.
const ARCTANGENT: f64 = 2.83e-3;

/// How far the results move when micromath's functions err by as much as they can. The errors are
/// no small ones, so they are made in full rather than taken to first order: sine and cosine too
/// small, right, too large; each root right, half as wrong as it can be, and wholly; in all 243
/// combinations. `None` where one of them takes a leg out of reach, or the machine through its
/// parallel singularity, beside which a torque has no bound.
pub(crate) fn coarse_functions(
    parameters: &Parameters,
    setpoint: &Setpoint<f64>,
) -> Option<Motors> {
    let exact = Functions::exact(setpoint);
    let (reference, det) = vector_formulas::motors(parameters, setpoint, &exact, |_, value| value)?;
    let angle = SIN_COS + 3.0 * f64::from(f32::EPSILON) * setpoint.pose.angle.abs();
    let mut bounds = [[0.0f64; 4]; 3];
    for combination in 0..243 {
        let level = |place: u32| f64::from(combination / 3i32.pow(place) % 3);
        let functions = Functions {
            sin: exact.sin + (level(0) - 1.0) * angle,
            cos: exact.cos + (level(1) - 1.0) * angle,
            roots: [2, 3, 4].map(|place| 1.0 + 0.5 * level(place) * (ROOT - 1.0)),
        };
        let (moved, det_there) =
            vector_formulas::motors(parameters, setpoint, &functions, |_, value| value)?;
        if det_there * det <= 0.0 {
            return None;
        }
        for (leg, bounds) in bounds.iter_mut().enumerate() {
            for (stage, bound) in bounds.iter_mut().enumerate() {
                let change = difference(stage, moved[leg][stage], reference[leg][stage]);
                *bound = bound.max(change);
            }
        }
    }
    for bounds in &mut bounds {
        bounds[0] += ARCTANGENT;
    }
    Some(bounds)
}

/// Fixed point's sine, cosine and root are within 0.9 unit, its other values within half of one; what
/// is multiplied by a factor carries 2^-30 of itself besides.
const FIXED_VALUE: f64 = 0.9 * Fixed::UNIT;
const FIXED_FACTOR: f64 = 0.5 * Fixed::UNIT;
/// Its angles are whole numbers of 2^-32 of a turn, off by 1.1 of them.
const FIXED_ANGLE: f64 = 1.1 * TAU / 4_294_967_296.0;

/// How far the results move when every value on the way through the tick is off by what fixed point
/// rounds it by in `units`: the sum over all of them, each moved alone. That is the quantisation
/// times the condition of each value, the latter by a difference of the formulas themselves.
/// `None` where one of them takes a leg out of reach.
pub(crate) fn fixed_roundings(
    parameters: &Parameters,
    setpoint: &Setpoint<f64>,
    units: &Units,
) -> Option<Motors> {
    let exact = Functions::exact(setpoint);
    let mut values = 0;
    let (reference, _) = vector_formulas::motors(parameters, setpoint, &exact, |_, value| {
        values += 1;
        value
    })?;
    let mut bounds = [[FIXED_ANGLE, 0.0, 0.0, 0.0]; 3];
    for moved_one in 0..values {
        let mut number = 0;
        let (moved, _) =
            vector_formulas::motors(parameters, setpoint, &exact, |[l, t, m], value| {
                number += 1;
                if number - 1 == moved_one {
                    value + FIXED_VALUE * units.of(l, t, m) + FIXED_FACTOR * value.abs()
                } else {
                    value
                }
            })?;
        for (leg, bounds) in bounds.iter_mut().enumerate() {
            for (stage, bound) in bounds.iter_mut().enumerate() {
                *bound += difference(stage, moved[leg][stage], reference[leg][stage]);
            }
        }
    }
    Some(bounds)
}

/// The size of the difference of two results, of angles without whole turns.
fn difference(stage: usize, a: f64, b: f64) -> f64 {
    match stage {
        0 => angle_difference(a, b).abs(),
        _ => (a - b).abs(),
    }
}

/// The worst results of each stage.
#[derive(Default)]
pub(crate) struct Stages(pub(crate) [Worst; 4]);

impl Stages {
    pub(crate) fn compare(
        &mut self,
        place: impl Fn() -> String,
        found: &Motors,
        reference: &Motors,
        bounds: &Motors,
    ) {
        for leg in 0..3 {
            for (stage, worst) in self.0.iter_mut().enumerate() {
                let error = difference(stage, found[leg][stage], reference[leg][stage]);
                worst.compare(
                    || format!("motor {} {}", leg + 1, place()),
                    error,
                    bounds[leg][stage],
                );
            }
        }
    }

    /// Asserts the bracket of each stage: position, rate, acceleration, torque.
    pub(crate) fn assert_within(&self, what: &str, brackets: [(f64, f64); 4]) {
        for ((worst, name), (low, high)) in self.0.iter().zip(STAGES).zip(brackets) {
            worst.assert_within(&format!("{what}, {name}"), low..=high);
        }
    }
}

/// The formulas with their functions handed in give what the core gives: they may say what errors
/// of the functions do.
#[test]
fn the_formulas_are_the_cores() {
    use trirrr_tests::motors::motors;
    use trirrr_tests::random::{case, for_all};
    let worst = std::cell::RefCell::new(Stages::default());
    for_all(2000, case(), |case| {
        let (parameters, setpoint) = (&case.parameters, &case.setpoint);
        let exact = Functions::exact(setpoint);
        let (found, _) = vector_formulas::motors(parameters, setpoint, &exact, |_, value| value)
            .expect("in reach");
        let reference = motors::<f64>(parameters, setpoint).expect("a motion");
        // Two sums of the same formulas in different orders.
        let off = |input: Input| 4.0 * f64::EPSILON * input.length;
        let bounds = of_inputs(parameters, setpoint, off);
        let place = || format!("{case:?}");
        worst
            .borrow_mut()
            .compare(place, &found, &reference, &bounds);
    });
    let brackets = [(0.1, 0.3); 4];
    worst.into_inner().assert_within("formulas, f64", brackets);
}
