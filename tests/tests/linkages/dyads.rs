//! Dyads of random dimensions between random motions: the loops close, the branch is the one that
//! was asked for, and differences confirm rates and accelerations.

use super::ends::{End, Results, Vector, branch, check, closes, end, moves, offset, unit, vector};
use core::f64::consts::PI;
use proptest::prelude::*;
use std::cell::RefCell;
use trirrr_core::linkage::ppr::Ppr;
use trirrr_core::linkage::prp::Prp;
use trirrr_core::linkage::rpr::Rpr;
use trirrr_core::linkage::rrp::Rrp;
use trirrr_core::linkage::rrr::Rrr;
use trirrr_core::number::{cross, dot, perpendicular};
use trirrr_tests::random::for_all;

const CASES: u32 = 10_000;

/// Both vectors lead from A to C, and have the links' lengths.
#[test]
fn rrr() {
    let (closure, motion) = (RefCell::default(), RefCell::default());
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
        let longest = f64::max(l1, l2).max(d.x.hypot(d.y));
        closes(&closure, at.r1 + at.r2 - d, longest, &case);
        for (r, l) in [(at.r1, l1), (at.r2, l2)] {
            let error = Vector::new(r.x.hypot(r.y) - l, 0.0);
            closes(&closure, error, longest, &case);
        }
        assert!(cross(d, at.r1) * branch > 0.0, "{case:?}");
        let solve = |t| {
            let at = dyad.solve(&a.point(t), &c.point(t))?;
            Ok(Results {
                links: vec![at.first, at.second],
                slides: vec![],
                points: vec![at.joint],
                // Ends that nearly coincide turn the dyad as a whole.
                distance: at.singularity_distance.min(d.x.hypot(d.y)),
            })
        };
        moves(&motion, solve, &case);
    });
    check("RRR", closure, motion, [0.05..=1.0, 1e-3..=1.0]);
}

#[test]
fn rpr() {
    let (closure, motion) = (RefCell::default(), RefCell::default());
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
        let longest = d.x.hypot(d.y).max(along.abs()).max(at.length.abs());
        let gap = u * (at.length + along) + perpendicular(u) * across - d;
        closes(&closure, gap, longest, &case);
        assert!(dot(u, d) * branch > 0.0 || dyad.singularity_distance(&at) < 1e-7);
        let solve = |t| {
            let at = dyad.solve(&a.point(t), &b.point(t))?;
            Ok(Results {
                links: vec![at.first, at.second],
                slides: vec![at.slide],
                points: vec![at.second.point(Vector::new(0.3, -0.2))],
                distance: at.singularity_distance.min(d.x.hypot(d.y)),
            })
        };
        moves(&motion, solve, &case);
    });
    check("RPR", closure, motion, [0.05..=1.0, 1e-3..=1.0]);
}

#[test]
fn rrp() {
    let (closure, motion) = (RefCell::default(), RefCell::default());
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
        let on_guide = u * (at.length + along) + perpendicular(u) * across;
        let longest = z4.max(at.length.abs()).max(p.x.hypot(p.y)).max(0.5);
        closes(&closure, on_guide + at.r - p, longest, &case);
        let error = Vector::new(at.r.x.hypot(at.r.y) - z4, 0.0);
        closes(&closure, error, longest, &case);
        assert!(dot(u, at.r) * branch < 0.0, "{case:?}");
        let solve = |t| {
            let at = dyad.solve(&a.point(t), &b.guide(t))?;
            Ok(Results {
                links: vec![at.link, at.slider],
                slides: vec![at.slide],
                points: vec![at.joint],
                distance: at.singularity_distance.min(z4),
            })
        };
        moves(&motion, solve, &case);
    });
    check("RRP", closure, motion, [0.05..=1.0, 1e-3..=1.0]);
}

#[test]
fn prp() {
    let (closure, motion) = (RefCell::default(), RefCell::default());
    let strategy = (vector(0.5), vector(0.5), end(), end());
    for_all(CASES, strategy, |case| {
        let (first, second, a, b) = case;
        let dyad = Prp::<f64>::from_offsets(first, second);
        let d = b.point.position - a.point.position;
        let at = dyad.position(d, [unit(a.angle), unit(b.angle)]).unwrap();
        let frame = |end: &End, local: Vector| {
            let u = unit(end.angle);
            u * local.x + perpendicular(u) * local.y
        };
        let [z1, z4] = at.lengths;
        let from_a = frame(&a, Vector::new(z1, 0.0) + first);
        let from_b = frame(&b, Vector::new(z4, 0.0) + second);
        let longest = z1.abs().max(z4.abs()).max(d.x.hypot(d.y)).max(0.5);
        closes(&closure, from_a - (d + from_b), longest, &case);
        let solve = |t| {
            let at = dyad.solve(&a.guide(t), &b.guide(t))?;
            Ok(Results {
                links: vec![at.first, at.second],
                slides: vec![at.first_slide, at.second_slide],
                points: vec![at.joint],
                distance: at.singularity_distance,
            })
        };
        moves(&motion, solve, &case);
    });
    check("PRP", closure, motion, [0.05..=1.0, 1e-3..=1.0]);
}

#[test]
fn ppr() {
    let (closure, motion) = (RefCell::default(), RefCell::default());
    let strategy = (-PI..PI, vector(0.5), end(), end());
    for_all(CASES, strategy, |case| {
        let (second, offset, a, b) = case;
        let dyad = Ppr::<f64>::from_offsets(unit(second), offset);
        let p = b.point.position - a.point.position;
        let u = unit(a.angle);
        let at = dyad.position(p, u).unwrap();
        // B, in the frame of the guide.
        let local = Vector::new(at.first, 0.0) + offset - unit(second) * at.second;
        let gap = u * local.x + perpendicular(u) * local.y - p;
        let longest = at
            .first
            .abs()
            .max(at.second.abs())
            .max(p.x.hypot(p.y))
            .max(0.5);
        closes(&closure, gap, longest, &case);
        let solve = |t| {
            let at = dyad.solve(&a.guide(t), &b.point(t))?;
            Ok(Results {
                links: vec![at.slider, at.link],
                slides: vec![at.first_slide, at.second_slide],
                points: vec![at.slider.origin],
                distance: at.singularity_distance,
            })
        };
        moves(&motion, solve, &case);
    });
    check("PPR", closure, motion, [0.05..=1.0, 1e-3..=1.0]);
}
