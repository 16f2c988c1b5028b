//! The models hold what the number type computes, or what is true where that is what is bounded.

use super::*;
use crate::admission::Enclose;
use crate::tests::share;
use core::cmp::Ordering;
use nalgebra::Vector2;
use proptest::prelude::*;
use trirrr_core::dyad::Rrr;
use trirrr_core::number::{Arithmetic, Coarse, Fixed, Number};

/// A model by its three numbers, and where in it the quantity is: t and the part of the error.
type Drawn = ([f64; 3], [f64; 2]);

/// Numbers of so few digits, at such t, that the quantity itself is exact in both types.
fn drawn() -> impl Strategy<Value = Drawn> {
    let halves = (-2..=2).prop_map(|halves: i32| f64::from(halves) / 2.0);
    let part = prop_oneof![Just(-1.0), Just(0.0), Just(1.0)];
    let linear = prop_oneof![1 => Just(0), 9 => -800..800];
    let error = prop_oneof![1 => Just(0), 1 => 1..200];
    (-2000..2000, linear, error, halves, part).prop_map(|(c, l, e, t, part): (i32, _, _, _, _)| {
        (
            [c, l, e].map(|digits| f64::from(digits) / 1024.0),
            [t, part],
        )
    })
}

fn model<N: Enclose>(numbers: [f64; 3]) -> TaylorModel<N> {
    let [constant, linear, error] = numbers.map(<Float<N>>::from_f64);
    TaylorModel {
        constant: Centre::exactly(constant),
        linear,
        error,
    }
}

/// The quantity there.
fn value<T: Number>([c, l, e]: [f64; 3], [t, part]: [f64; 2]) -> T {
    T::from_f64(c + l * t + e * part)
}

/// Whether `found`, the result of an operation, lies in the operation's `model`.
fn holds<N: Enclose>(model: TaylorModel<N>, t: f64, found: f64) -> bool {
    let error = <Middle<N>>::unmarked(model.error);
    let [l, e] = [model.linear, error].map(<Float<N>>::to_f64);
    let c = model.constant.to_f64();
    // Exact differences of near numbers, and products with halves.
    !model.is_finite() || ((found - c) - l * t).abs() <= e
}

/// Models of `N` hold the results in `T`, if `prepare` is done to the operands.
fn operations<N: Enclose, T: Number>(
    (x, at_x): Drawn,
    (y, at_y): Drawn,
    prepare: impl Fn(TaylorModel<N>) -> TaylorModel<N>,
) {
    // One t for both.
    let (t, at_y) = (at_x[0], [at_x[0], at_y[1]]);
    let (a, b) = (value::<T>(x, at_x), value::<T>(y, at_y));
    let (x, y) = (prepare(model::<N>(x)), prepare(model::<N>(y)));
    let angle = |model: TaylorModel<N>| TaylorModel::<N>::angle(model);
    let (sin, cos) = TaylorModel::<N>::sin_cos(angle(x));
    let (sin_a, cos_a) = T::sin_cos(T::angle(a));
    let cases = [
        ("sum", x + y, a + b),
        ("difference", x - y, a - b),
        ("product", x * y, a * b),
        ("square", x * x, a * a),
        (
            "ab+cd",
            TaylorModel::ab_plus_cd(x, y, y, y),
            T::ab_plus_cd(a, b, b, b),
        ),
        (
            "ab-cd",
            TaylorModel::ab_minus_cd(x, x, y, x),
            T::ab_minus_cd(a, a, b, a),
        ),
        ("quotient", x.div(y), a.div(b)),
        ("root", x.sqrt(), a.sqrt()),
        ("size", x.abs(), a.abs()),
        ("sine", sin, sin_a),
        ("cosine", cos, cos_a),
    ];
    for (name, model, found) in cases {
        // What leaves the range of the type is seen by the tick itself.
        if !found.is_finite() {
            continue;
        }
        let found = found.to_f64();
        assert!(
            holds(model, t, found),
            "{name} of {a:?} {b:?}: {found:?} not in {model:?}"
        );
    }
    match x.partial_cmp(&y) {
        Some(Ordering::Greater) => assert!(a > b),
        Some(Ordering::Less) => assert!(a < b),
        Some(Ordering::Equal) => assert!(a == b),
        None => {}
    }
}

/// The direction of a vector, likewise.
fn directions<N: Enclose, T: Number>((x, at_x): Drawn, (y, at_y): Drawn) {
    let (t, at_y) = (at_x[0], [at_x[0], at_y[1]]);
    let (a, b) = (value::<T>(x, at_x), value::<T>(y, at_y));
    let (x, y) = (model::<N>(x), model::<N>(y));
    let direction = TaylorModel::<N>::radians(TaylorModel::<N>::atan2(y, x));
    // Where the interval passes the negative x axis the two may differ by a whole turn.
    let turn = core::f64::consts::TAU;
    let found = T::angle_to_f64(T::atan2(b, a));
    let turns = ((direction.constant.to_f64() - found) / turn).round();
    assert!(
        holds(direction, t, found + turns * turn) || holds(direction, t, found),
        "direction of {a:?} {b:?}: {found:?} not in {direction:?}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(share(20_000)))]

    #[test]
    fn results_are_held(x in drawn(), y in drawn()) {
        operations::<f64, f64>(x, y, |model| model);
        operations::<Fixed, Fixed>(x, y, |model| model);
        operations::<f32, f64>(x, y, |model| model);
        operations::<Coarse, f64>(x, y, |model| model);
    }

    #[test]
    fn directions_are_held(x in drawn(), y in drawn()) {
        directions::<f64, f64>(x, y);
        directions::<Fixed, Fixed>(x, y);
        directions::<f32, f64>(x, y);
        directions::<Coarse, f64>(x, y);
    }

    /// Rough models hold what a tick rounds, too.
    #[test]
    fn results_are_held_roughly(x in drawn(), y in drawn()) {
        operations::<f32, f64>(x, y, TaylorModel::made_rough);
        operations::<f32, f32>(x, y, TaylorModel::made_rough);
    }
}

/// Halving the interval divides what is not linear by four: the models are not wider than need
/// be.
#[test]
fn the_excess_goes_with_the_square_of_the_interval() {
    let excess = |half_width: f64| {
        let x = TaylorModel::span(0.7, half_width);
        let y = x * x + TaylorModel::ONE.div(x);
        let (sin, _) = TaylorModel::<f64>::sin_cos(TaylorModel::<f64>::angle(y.sqrt()));
        sin.error
    };
    for half_width in [0.1, 0.01, 0.001] {
        let ratio = excess(half_width) / excess(half_width / 2.0);
        assert!((3.9..6.0).contains(&ratio), "{half_width}: {ratio}");
    }
    assert!(excess(0.01) < 3e-4, "{}", excess(0.01));
}

#[test]
fn only_what_is_certain_compares() {
    let straddling = TaylorModel::<f64>::span(0.1, 0.2);
    assert_eq!(straddling.partial_cmp(&TaylorModel::ZERO), None);
    assert!(!(straddling > TaylorModel::ZERO) && !(straddling <= TaylorModel::ZERO));
    assert!(straddling > TaylorModel::point(-0.11));
    assert!(straddling.div(straddling).constant == 0.0);
    assert!(!straddling.div(straddling).is_finite());
    assert!(!straddling.sqrt().is_finite());
    assert!(TaylorModel::<f64>::ZERO == TaylorModel::point(0.0));
}

/// A dyad whose end C starts at the polar coordinates `at`, in parts of its reach, and moves by the models of `motion`.
#[derive(Clone, Copy, Debug)]
struct Moving {
    lengths: [f64; 2],
    branch: f64,
    at: [f64; 2],
    motion: [[f64; 2]; 2],
}

fn moving() -> impl Strategy<Value = Moving> {
    let lengths = [0.05..2.0, 0.05..2.0f64];
    let branch = prop_oneof![Just(1.0), Just(-1.0)];
    let at = [0.02..0.98, 0.0..6.3f64];
    // Mostly less than a tenth of the machine, as over an interval.
    let motion = [[-0.3..0.3f64, 0.0..0.05f64], [-0.3..0.3f64, 0.0..0.05f64]]
        .map(|[linear, error]| (linear, error).prop_map(|(linear, error)| [linear, error]));
    (lengths, branch, at, motion, -6.0..0.0f64).prop_map(|(lengths, branch, at, motion, small)| {
        let scale = small.exp2();
        Moving {
            lengths,
            branch,
            at,
            motion: motion.map(|axis| axis.map(|part| part * scale)),
        }
    })
}

impl Moving {
    /// The span's models in the numbers of `f32`.
    fn span(&self) -> Vector2<TaylorModel<f32>> {
        let [l1, l2] = self.lengths;
        let (least, most) = ((l1 - l2).abs(), l1 + l2);
        let d = least + (most - least) * self.at[0];
        let middle = [d * self.at[1].cos(), d * self.at[1].sin()];
        let axis = |axis: usize| {
            let [linear, error] = self.motion[axis];
            model::<f32>([middle[axis], linear, error]).made_rough()
        };
        Vector2::new(axis(0), axis(1))
    }

    /// Bounds of the links by the tick's formulas, and narrowed ones.
    fn links(&self) -> Option<[[TaylorModel<f32>; 4]; 2]> {
        let [l1, l2] = self.lengths;
        let dyad = Rrr::<TaylorModel<f32>>::new(l1, l2, self.branch);
        let span = self.span();
        let wide = dyad.position(span).ok()?;
        let mut narrow = wide;
        let lengths = dyad.squared_lengths().map(TaylorModel::middle);
        TaylorModel::narrow(&mut narrow, &span, lengths);
        Some([wide, narrow].map(|links| [links.r1.x, links.r1.y, links.r2.x, links.r2.y]))
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(share(20_000)))]

    #[test]
    fn narrow_links_hold_the_true_ones(moving in moving()) {
        let Some([_, narrow]) = moving.links() else {
            return Ok(());
        };
        let [l1, l2] = moving.lengths;
        let dyad = Rrr::<f64>::new(l1, l2, moving.branch);
        let span = moving.span();
        for t in [-1.0, -0.6, 0.0, 0.3, 1.0] {
            for parts in [[-1.0, -1.0], [-1.0, 1.0], [0.2, -0.7], [1.0, -1.0], [1.0, 1.0]] {
                let [x, y] = [(span.x, parts[0]), (span.y, parts[1])].map(|(axis, part)| {
                    let line = axis.line();
                    let [c, l, e] = [line.constant, line.slope, line.error].map(f64::from);
                    c + l * t + e * part
                });
                let links = dyad.position(Vector2::new(x, y));
                let links = links.expect("within reach, as the models say");
                let true_ones = [links.r1.x, links.r1.y, links.r2.x, links.r2.y];
                for (model, found) in narrow.iter().zip(true_ones) {
                    prop_assert!(holds(*model, t, found), "{found} {model:?} at {t} {parts:?}");
                }
            }
        }
    }
}

/// A leg that turns by some degrees: the bounds are no more than half as wide as those of the tick's formulas.
#[test]
fn narrow_links_are_narrower() {
    let moving = Moving {
        lengths: [0.3, 0.36],
        branch: 1.0,
        at: [0.6, 0.7],
        motion: [[0.03, 0.003], [-0.02, 0.002]],
    };
    let [wide, narrow] = moving.links().expect("within reach");
    for (wide, narrow) in wide.into_iter().zip(narrow) {
        assert!(
            narrow.curvature() < 0.5 * wide.curvature(),
            "{wide:?} {narrow:?}"
        );
    }
}
