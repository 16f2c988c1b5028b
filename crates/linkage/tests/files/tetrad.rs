//! The shipped tetrad, against a closure that is solved in another way.

use crate::{link, shipped};
use trirrr_linkage::assur::{GroupKind, track};

type Point = [f64; 2];

fn turned([x, y]: Point, angle: f64, from: Point) -> Point {
    let (sin, cos) = angle.sin_cos();
    [from[0] + cos * x - sin * y, from[1] + sin * x + cos * y]
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn direction(from: Point, to: Point) -> f64 {
    (to[1] - from[1]).atan2(to[0] - from[0])
}

/// Angles of coupler, rocker, left and right bar, and the misfit of the right bar, for a crank and a coupler angle. The rocker
/// follows from the triangle A, Q, C, with C to the right of the way from A to Q.
fn assembled(crank: f64, coupler: f64) -> Option<([f64; 4], f64)> {
    let (o, q) = ([0.0, 0.0], [0.5, 0.0]);
    let (c_local, d_local) = ([-0.35, 0.35], [-0.18, 0.33]);
    let p = turned([0.05, 0.0], crank, o);
    let (a, b) = (
        turned([0.1, 0.1], coupler, p),
        turned([0.35, 0.05], coupler, p),
    );
    let (left, arm, base) = (0.25, distance(o, c_local), distance(a, q));
    let cosine = (left * left + base * base - arm * arm) / (2.0 * left * base);
    if cosine.abs() > 1.0 {
        return None;
    }
    // C lies above, to the left of A -> Q.
    let c = turned([left, 0.0], direction(a, q) + cosine.acos(), a);
    let rocker = direction(q, c) - direction(o, c_local);
    let d = turned(d_local, rocker, q);
    Some((
        [coupler, rocker, direction(a, c), direction(b, d)],
        distance(b, d) - 0.29,
    ))
}

/// Roots of the misfit near `around`, by a scan and halving.
fn root(crank: f64, around: f64) -> [f64; 4] {
    let misfit = |coupler: f64| assembled(crank, coupler).map(|(_, misfit)| misfit);
    let (mut low, mut high) = (around - 0.02, around + 0.02);
    let first = misfit(low).unwrap();
    assert!(
        first * misfit(high).unwrap() < 0.0,
        "no change of sign at {crank}"
    );
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        match misfit(middle).unwrap() * first > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    assembled(crank, low).unwrap().0
}

#[test]
fn the_tetrad_is_where_a_triangle_and_a_halved_interval_put_it() {
    let linkage = shipped("tetrad");
    assert_eq!(linkage.groups[1].kind, GroupKind::Tetrad);
    assert_eq!(linkage.groups[1].links.len(), 4);
    let names = ["coupler", "rocker", "left-bar", "right-bar"].map(|name| link(&linkage, name));
    let track = track(&linkage);
    assert!(track.stop.is_none());
    let mut before = 0.0;
    for position in &track.positions {
        let expected = root(6.0 * position.t, before);
        before = expected[0];
        for (name, expected) in names.iter().zip(expected) {
            let off = position.states[*name].angle - expected;
            assert!(off.abs() < 1e-12, "{name}: {off:e} at {}", position.t);
        }
        assert!(position.groups[1].iterations <= 8);
    }
}
