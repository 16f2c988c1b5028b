//! Whatever finite numbers go in, what comes out is finite or a status.

use super::compositions::{self, Moving};
use nalgebra::Vector2;
use proptest::prelude::*;
use trirrr_core::number::Number;
use trirrr_linkage::closure::{Closure, ClosureInput, Length, Reference, Term};
use trirrr_linkage::ppr::Ppr;
use trirrr_linkage::prp::Prp;
use trirrr_linkage::rpr::Rpr;
use trirrr_linkage::rrp::Rrp;
use trirrr_linkage::rrr::{Rrr, SolveRrr};
use trirrr_linkage::{Drive, DyadMotion, LinkMotion, LinkageStatus, PointMotion, SlideMotion};
use trirrr_tests::random::{for_all, share};

const CASES: u32 = 10_000;

/// Any finite number; half of them of a size that mechanisms have.
fn any() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![
        POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO,
        -2.0..2.0,
        Just(0.0),
        Just(1.0),
    ]
}

fn numbers<const K: usize>() -> impl Strategy<Value = [f64; K]> {
    prop::collection::vec(any(), K).prop_map(|numbers| numbers.try_into().expect("K numbers"))
}

/// The finite number of the type that is nearest to `x`.
fn number<N: Number>(x: f64) -> N {
    let x = N::from_f64(x);
    if x.is_finite() { x } else { N::ONE }
}

fn point<N: Number>(x: &[f64]) -> PointMotion<N> {
    let vector = |i: usize| Vector2::new(number(x[i]), number(x[i + 1]));
    PointMotion {
        position: vector(0),
        velocity: vector(2),
        acceleration: vector(4),
    }
}

fn link<N: Number>(x: &[f64]) -> LinkMotion<N> {
    LinkMotion {
        origin: point(x),
        direction: Vector2::new(number(x[6]), number(x[7])),
        rate: number(x[8]),
        acceleration: number(x[9]),
    }
}

fn finite<N: Number>(links: &[LinkMotion<N>], slides: &[SlideMotion<N>]) -> bool {
    links.iter().all(LinkMotion::is_finite) && slides.iter().all(SlideMotion::is_finite)
}

/// `None` for a dyad that does not reach, otherwise `true` for results that are finite.
fn dyad<N: Number, const S: usize>(
    solved: Result<DyadMotion<N, S>, LinkageStatus>,
) -> Option<bool> {
    let at = solved.ok()?;
    let distance = at.singularity_distance.is_finite();
    Some(distance && finite(&[at.first, at.second], &at.slides))
}

fn dyads<N: Number>(constants: &[f64; 4], ends: &[f64; 20]) -> [Option<bool>; 5] {
    let [a, b, c, d] = *constants;
    let branch = if d < 0.0 { -1.0 } else { 1.0 };
    let (first, second) = (link::<N>(&ends[..10]), link::<N>(&ends[10..]));
    let (start, end) = (first.origin, second.origin);
    let pair = |x, y| Vector2::new(x, y);
    let (prp, ppr) = (
        Prp::<N>::from_offsets(pair(a, b), pair(c, d)),
        Ppr::<N>::from_offsets(pair(a, b), pair(c, d)),
    );
    [
        dyad(Rrr::<N>::new(a, b, branch).solve(&start, &end)),
        dyad(Rpr::<N>::new(a, b, c, d, branch).solve(&start, &end)),
        dyad(Rrp::<N>::new(a, b, c, branch).solve(&start, &second)),
        dyad(prp.solve(&first, &second)),
        dyad(ppr.solve(&first, &end)),
    ]
}

#[test]
fn dyads_return_finite_numbers_or_a_status() {
    let solved = std::cell::RefCell::new([0; 5]);
    for_all(
        CASES,
        (numbers::<4>(), numbers::<20>()),
        |(constants, ends)| {
            let both = [
                dyads::<f64>(&constants, &ends),
                dyads::<f32>(&constants, &ends),
            ];
            for results in both {
                for (dyad, result) in results.into_iter().enumerate() {
                    assert_ne!(result, Some(false), "dyad {dyad}: {constants:?} {ends:?}");
                    solved.borrow_mut()[dyad] += usize::from(result.is_some());
                }
            }
        },
    );
    // Enough of them can be solved for the test to mean something.
    for (dyad, solved) in solved.into_inner().into_iter().enumerate() {
        assert!(solved > 100, "dyad {dyad}: {solved}");
    }
}

/// The mechanisms with one crank.
fn mechanisms<N: Number>(drive: &[f64; 3]) -> [Option<bool>; 6] {
    fn of<N: Number, const L: usize, const S: usize>(moving: Moving<N, L, S>) -> Option<bool> {
        moving.ok().map(|(links, slides)| finite(&links, &slides))
    }
    let drive = Drive::<N> {
        angle: N::angle(number(drive[0])),
        rate: number(drive[1]),
        acceleration: number(drive[2]),
    };
    [
        of(compositions::four_bar(&drive)),
        of(compositions::quick_return(&drive)),
        of(compositions::slotted_quick_return(&drive)),
        of(compositions::fairbairn(&drive)),
        of(compositions::inserter(&drive)),
        of(compositions::two_loop(&drive)),
    ]
}

#[test]
fn mechanisms_return_finite_numbers_or_a_status() {
    for_all(CASES, numbers::<3>(), |drive| {
        for results in [mechanisms::<f64>(&drive), mechanisms::<f32>(&drive)] {
            for result in results {
                assert_ne!(result, Some(false), "{drive:?}");
            }
        }
    });
}

fn closure<N: Number>(z: &[f64; 4], inputs: &[f64; 6], guess: &[f64; 2]) -> Option<bool> {
    let terms = [
        Term::<N>::new(0, Length::Constant(z[0]), Reference::Driven(0), 0.0),
        Term::new(0, Length::Unknown(1), Reference::Unknown(0), z[1]),
        Term::new(0, Length::Constant(z[2]), Reference::Unknown(0), z[3]),
        Term::new(0, Length::Driven(1), Reference::Fixed, 0.0).reversed(),
    ];
    let closure = Closure::<N, 2, 2>::new(&terms).ok()?;
    let input = |i: usize| ClosureInput {
        value: number(inputs[3 * i]),
        rate: number(inputs[3 * i + 1]),
        acceleration: number(inputs[3 * i + 2]),
    };
    let inputs = [input(0), input(1)];
    let at = closure.position(&inputs, guess.map(number)).ok()?;
    let rates = closure.rates(&inputs, &at).ok()?;
    let acc = closure.accelerations(&inputs, &at, &rates).ok()?;
    let all = [at.unknowns, rates, acc, [at.residual, at.condition]];
    Some(all.iter().flatten().all(|number| number.is_finite()))
}

#[test]
fn loops_return_finite_numbers_or_a_status() {
    let solved = std::cell::Cell::new(0);
    let strategy = (numbers::<4>(), numbers::<6>(), numbers::<2>());
    for_all(CASES, strategy, |(z, inputs, guess)| {
        for result in [
            closure::<f64>(&z, &inputs, &guess),
            closure::<f32>(&z, &inputs, &guess),
        ] {
            assert_ne!(result, Some(false), "{z:?} {inputs:?} {guess:?}");
            solved.set(solved.get() + usize::from(result.is_some()));
        }
    });
    assert!(solved.get() > share(5000) as usize, "{}", solved.get());
}
