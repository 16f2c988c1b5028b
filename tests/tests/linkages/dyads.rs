//! Dyads of random dimensions between random motions: the branch is the one that was asked
//! for, and differences confirm rates and accelerations.

use super::ends::{CASES, branch, check, end, moves, offset, unit, vector};
use core::f64::consts::PI;
use proptest::prelude::*;
use std::cell::RefCell;
use trirrr_core::number::{cross, dot};
use trirrr_linkage::ppr::Ppr;
use trirrr_linkage::prp::Prp;
use trirrr_linkage::rpr::Rpr;
use trirrr_linkage::rrp::Rrp;
use trirrr_linkage::rrr::{Rrr, SolveRrr};
use trirrr_tests::random::for_all;

#[test]
fn rrr() {
    let motion = RefCell::default();
    let strategy = (0.1..2.0, 0.1..2.0, branch(), end(), end()).prop_filter(
        "reach",
        |(l1, l2, branch, a, c): &(f64, f64, _, _, _)| {
            let dyad = Rrr::<f64>::new(*l1, *l2, *branch);
            dyad.solve(&a.point, &c.point).is_ok()
        },
    );
    for_all(CASES, strategy, |case| {
        let (l1, l2, branch, a, c) = case;
        let dyad = Rrr::<f64>::new(l1, l2, branch);
        let d = c.point.position - a.point.position;
        let at = dyad.position(d).unwrap();
        assert!(cross(d, at.r1) * branch > 0.0, "{case:?}");
        // Ends that nearly coincide turn the dyad as a whole.
        moves(
            &motion,
            |t| dyad.solve(&a.point(t), &c.point(t)),
            d.x.hypot(d.y),
            &case,
        );
    });
    check("RRR", motion);
}

#[test]
fn rpr() {
    let motion = RefCell::default();
    let strategy = (offset(), offset(), branch(), end(), end()).prop_filter(
        "reach",
        |(along, across, branch, a, b)| {
            let dyad = Rpr::<f64>::from_offsets(*along, *across, *branch);
            dyad.solve(&a.point, &b.point).is_ok()
        },
    );
    for_all(CASES, strategy, |case| {
        let (along, across, branch, a, b) = case;
        let dyad = Rpr::<f64>::from_offsets(along, across, branch);
        let d = a.point.position - b.point.position;
        let at = dyad.position(d).unwrap();
        let u = at.direction;
        assert!(dot(u, d) * branch > 0.0 || dyad.singularity_distance(&at) < 1e-7);
        // Ends that nearly coincide turn the dyad as a whole.
        moves(
            &motion,
            |t| dyad.solve(&a.point(t), &b.point(t)),
            d.x.hypot(d.y),
            &case,
        );
    });
    check("RPR", motion);
}

#[test]
fn rrp() {
    let motion = RefCell::default();
    let strategy = (0.1..2.0, offset(), offset(), branch(), end(), end()).prop_filter(
        "reach",
        |(z4, along, across, branch, a, b)| {
            let dyad = Rrp::<f64>::from_offsets(*z4, *along, *across, *branch);
            dyad.solve(&a.point, &b.guide(0.0)).is_ok()
        },
    );
    for_all(CASES, strategy, |case| {
        let (z4, along, across, branch, a, b) = case;
        let dyad = Rrp::<f64>::from_offsets(z4, along, across, branch);
        let (p, u) = (a.point.position - b.point.position, unit(b.angle));
        let at = dyad.position(p, u).unwrap();
        assert!(dot(u, at.r) * branch < 0.0, "{case:?}");
        moves(&motion, |t| dyad.solve(&a.point(t), &b.guide(t)), z4, &case);
    });
    check("RRP", motion);
}

#[test]
fn prp() {
    let motion = RefCell::default();
    let strategy = (vector(0.5), vector(0.5), end(), end());
    for_all(CASES, strategy, |case| {
        let (first, second, a, b) = case;
        let dyad = Prp::<f64>::from_offsets(first, second);
        moves(
            &motion,
            |t| dyad.solve(&a.guide(t), &b.guide(t)),
            1.0,
            &case,
        );
    });
    check("PRP", motion);
}

#[test]
fn ppr() {
    let motion = RefCell::default();
    let strategy = (-PI..PI, vector(0.5), end(), end());
    for_all(CASES, strategy, |case| {
        let (second, offset, a, b) = case;
        let dyad = Ppr::<f64>::from_offsets(unit(second), offset);
        moves(
            &motion,
            |t| dyad.solve(&a.guide(t), &b.point(t)),
            1.0,
            &case,
        );
    });
    check("PPR", motion);
}
