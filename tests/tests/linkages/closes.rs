//! The loops of dyads of random dimensions close, in f64 and in f32, to 4 units in the last place of
//! the longest vector of the loop (the PRP to 5); so do the lengths of links. The gaps are formed in
//! 31 digits.

use super::ends::{CASES, End, Vector, branch, end, offset, unit, vector};
use core::f64::consts::PI;
use nalgebra::Vector2;
use proptest::prelude::*;
use std::cell::RefCell;
use trirrr_core::number::Number;
use trirrr_linkage::ppr::Ppr;
use trirrr_linkage::prp::Prp;
use trirrr_linkage::rpr::Rpr;
use trirrr_linkage::rrp::Rrp;
use trirrr_linkage::rrr::Rrr;
use trirrr_tests::bound::Worst;
use trirrr_tests::double_double::DoubleDouble;
use trirrr_tests::random::for_all;
use trirrr_tests::scalar::{Plane, Scalar, difference, dot, sum};

type Exact = Plane<DoubleDouble>;

/// The number of the type that is nearest to `x`, as an f64.
fn rounded<N: Number>(x: f64) -> f64 {
    N::from_f64(x).to_f64()
}

fn rounded_vector<N: Number>(v: Vector) -> Vector2<N> {
    v.map(N::from_f64)
}

fn exact<N: Number>(v: Vector2<N>) -> Exact {
    [v.x, v.y].map(|x| DoubleDouble::constant(x.to_f64()))
}

/// along u + across E u.
fn in_frame(u: Exact, along: DoubleDouble, across: DoubleDouble) -> Exact {
    [along * u[0] - across * u[1], along * u[1] + across * u[0]]
}

fn number<N: Number>(x: N) -> DoubleDouble {
    DoubleDouble::constant(x.to_f64())
}

fn size(v: Exact) -> f64 {
    dot(v, v).sqrt().value()
}

/// One gap, and the lengths of the vectors of its loop.
type Gap = (f64, Vec<f64>);

fn length_gap(r: Exact, length: f64) -> f64 {
    (dot(r, r).sqrt() - DoubleDouble::constant(length)).value()
}

/// Runs one kind of dyad in one number type. `gaps` is `None` for dyads that do not reach.
fn check<N: Number, S: Strategy>(
    name: &str,
    ulps: f64,
    strategy: S,
    gaps: impl Fn(&S::Value) -> Option<Vec<Gap>>,
) where
    S::Value: Clone,
{
    let worst = RefCell::new(Worst::default());
    let reaching = strategy.prop_filter("reach", |case| gaps(case).is_some());
    for_all(CASES, reaching, |case| {
        for (gap, lengths) in gaps(&case).unwrap() {
            let longest = lengths.into_iter().map(f64::abs).fold(0.0, f64::max);
            // The spacing of the numbers of the type at the longest length.
            let ulp = 2.0 * N::UNIT_ROUNDOFF.to_f64() * longest.log2().floor().exp2();
            let place = || format!("{case:?}");
            worst.borrow_mut().compare(place, gap, ulps * ulp);
        }
    });
    worst.into_inner().assert_within(name, 0.15..=1.0);
}

/// From the second end to the first.
fn between<N: Number>(from: &End, to: &End) -> Vector2<N> {
    rounded_vector(to.point.position - from.point.position)
}

fn rrr<N: Number>(name: &str) {
    let strategy = (0.1..2.0, 0.1..2.0, branch(), end(), end());
    check::<N, _>(name, 4.0, strategy, |&(l1, l2, branch, a, c)| {
        let (l1, l2) = (rounded::<N>(l1), rounded::<N>(l2));
        let d = between::<N>(&a, &c);
        let at = Rrr::<N>::new(l1, l2, branch).position(d).ok()?;
        let (r1, r2, d) = (exact(at.r1), exact(at.r2), exact(d));
        let lengths = vec![l1, l2, size(d)];
        let gap = size(difference(sum(r1, r2), d));
        Some(vec![
            (gap, lengths.clone()),
            (length_gap(r1, l1), lengths.clone()),
            (length_gap(r2, l2), lengths),
        ])
    });
}

fn rpr<N: Number>(name: &str) {
    let strategy = (offset(), offset(), branch(), end(), end());
    check::<N, _>(name, 4.0, strategy, |&(along, across, branch, a, b)| {
        let (along, across) = (rounded::<N>(along), rounded::<N>(across));
        let d = between::<N>(&b, &a);
        let dyad = Rpr::<N>::from_offsets(along, across, branch);
        let at = dyad.position(d).ok()?;
        let (u, d) = (exact(at.direction), exact(d));
        let offsets = [along, across].map(DoubleDouble::constant);
        let there = in_frame(u, number(at.length) + offsets[0], offsets[1]);
        let lengths = vec![at.length.to_f64(), along, across, size(d)];
        Some(vec![(size(difference(there, d)), lengths)])
    });
}

fn rrp<N: Number>(name: &str) {
    let strategy = (0.1..2.0, offset(), offset(), branch(), end(), end());
    check::<N, _>(name, 4.0, strategy, |&(z4, along, across, branch, a, b)| {
        let z4 = rounded::<N>(z4);
        let (along, across) = (rounded::<N>(along), rounded::<N>(across));
        let (p, u) = (between::<N>(&b, &a), rounded_vector(unit(b.angle)));
        let dyad = Rrp::<N>::from_offsets(z4, along, across, branch);
        let at = dyad.position(p, u).ok()?;
        let (u, p, r) = (exact(u), exact(p), exact(at.r));
        let offsets = [along, across].map(DoubleDouble::constant);
        let slider = in_frame(u, number(at.length) + offsets[0], offsets[1]);
        let lengths = vec![at.length.to_f64(), along, across, z4, size(p)];
        let gap = size(difference(sum(slider, r), p));
        Some(vec![(gap, lengths.clone()), (length_gap(r, z4), lengths)])
    });
}

/// One unit more than the others: both guides' directions are given, as unit vectors only to
/// rounding, and all of a long loop between nearly parallel guides lies along them.
fn prp<N: Number>(name: &str) {
    let strategy = (vector(0.5), vector(0.5), end(), end());
    check::<N, _>(name, 5.0, strategy, |&(first, second, a, b)| {
        let (first, second) = (first.map(rounded::<N>), second.map(rounded::<N>));
        let d = between::<N>(&a, &b);
        let directions = [a.angle, b.angle].map(|angle| rounded_vector::<N>(unit(angle)));
        let dyad = Prp::<N>::from_offsets(first, second);
        let at = dyad.position(d, directions).ok()?;
        let end = |u: Vector2<N>, length: N, offset: Vector| {
            let offset = exact(offset);
            in_frame(exact(u), number(length) + offset[0], offset[1])
        };
        let from_a = end(directions[0], at.lengths[0], first);
        let from_b = sum(exact(d), end(directions[1], at.lengths[1], second));
        let offsets = [first, second].map(|arm| arm.x.hypot(arm.y));
        let slides = at.lengths.map(N::to_f64);
        let lengths = [&offsets[..], &slides, &[size(exact(d))]].concat();
        Some(vec![(size(difference(from_a, from_b)), lengths)])
    });
}

fn ppr<N: Number>(name: &str) {
    let strategy = (-PI..PI, vector(0.5), end(), end());
    check::<N, _>(name, 4.0, strategy, |&(second, offset, a, b)| {
        let (second, offset) = (unit(second).map(rounded::<N>), offset.map(rounded::<N>));
        let (p, u) = (between::<N>(&a, &b), rounded_vector(unit(a.angle)));
        let dyad = Ppr::<N>::from_offsets(second, offset);
        let at = dyad.position(p, u).ok()?;
        // B, in the frame of the guide: z1 + offset - z4 (the second guide's direction).
        let (w, k) = (exact(second), exact(offset));
        let (z1, z4) = (number(at[0]), number(at[1]));
        let there = in_frame(exact(u), z1 + k[0] - z4 * w[0], k[1] - z4 * w[1]);
        let slides = at.map(N::to_f64);
        let lengths = vec![slides[0], slides[1], offset.x, offset.y, size(exact(p))];
        Some(vec![(size(difference(there, exact(p))), lengths)])
    });
}

#[test]
fn rrr_closes() {
    rrr::<f64>("RRR closes, f64");
    rrr::<f32>("RRR closes, f32");
}

#[test]
fn rpr_closes() {
    rpr::<f64>("RPR closes, f64");
    rpr::<f32>("RPR closes, f32");
}

#[test]
fn rrp_closes() {
    rrp::<f64>("RRP closes, f64");
    rrp::<f32>("RRP closes, f32");
}

#[test]
fn prp_closes() {
    prp::<f64>("PRP closes, f64");
    prp::<f32>("PRP closes, f32");
}

#[test]
fn ppr_closes() {
    ppr::<f64>("PPR closes, f64");
    ppr::<f32>("PPR closes, f32");
}
