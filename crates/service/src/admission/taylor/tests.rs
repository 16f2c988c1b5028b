//! The models hold what the number type computes, or what is true where that is what is bounded.

use super::*;
use crate::admission::Enclose;
use core::cmp::Ordering;
use proptest::prelude::*;
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
    #![proptest_config(ProptestConfig::with_cases(20_000))]

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
