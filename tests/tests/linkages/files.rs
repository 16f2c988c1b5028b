//! The files and the compositions of dyads describe the same machines: their links move alike.

use super::compositions;
use nalgebra::Vector2;
use std::path::Path;
use trirrr_linkage::assur::{Linkage, PointRef, track};
use trirrr_linkage::{Drive, LinkMotion};

/// A link of the file, its motion in the composition, and points of it: name and place in the
/// composition's frame.
type Same<'a> = (&'a str, LinkMotion<f64>, &'a [(&'a str, [f64; 2])]);

fn agree<'a, const LINKS: usize>(
    file: &str,
    composed: impl Fn(&[Drive<f64>]) -> [Same<'a>; LINKS],
) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../linkages");
    let linkage = Linkage::read(folder.join(file).with_extension("toml")).unwrap();
    let track = track(&linkage);
    assert_eq!(track.stop, None);
    for position in &track.positions {
        let drives: Vec<_> = linkage
            .drives
            .iter()
            .map(|drive| {
                let [angle, rate, acceleration] = drive.at(position.t);
                Drive {
                    angle,
                    rate,
                    acceleration,
                }
            })
            .collect();
        for (name, motion, points) in composed(&drives) {
            let link = linkage.links.iter().position(|link| link.name == name);
            let link = link.unwrap_or_else(|| panic!("no link {name}"));
            let state = &position.states[link].motion;
            let near = |a: f64, b: f64, what: &str| {
                let off = (a - b).abs();
                let bound = 2e-13 * (1.0 + b.abs());
                assert!(off <= bound, "{name} {what}: {a} for {b} at {}", position.t);
            };
            near(state.rate, motion.rate, "rate");
            near(state.acceleration, motion.acceleration, "acceleration");
            for &(point_name, [x, y]) in points {
                let of_link = &linkage.links[link].points;
                let point = of_link.iter().position(|(name, _)| name == point_name);
                let point = point.unwrap_or_else(|| panic!("no point {point_name}"));
                let read = position.point(&linkage, PointRef { link, point });
                let hand = motion.point(Vector2::new(x, y));
                for axis in 0..2 {
                    near(read.position[axis], hand.position[axis], point_name);
                    near(read.velocity[axis], hand.velocity[axis], point_name);
                    near(read.acceleration[axis], hand.acceleration[axis], point_name);
                }
            }
        }
    }
}

#[test]
fn four_bar_with_a_coupler_point() {
    agree("four-bar", |drives| {
        let ([crank, coupler, rocker], []) = compositions::four_bar(&drives[0]).unwrap();
        [
            ("crank", crank, &[("A", [0.1, 0.0])]),
            (
                "coupler",
                coupler,
                &[("A", [0.0; 2]), ("B", [0.35, 0.0]), ("P", [0.2, 0.12])],
            ),
            ("rocker", rocker, &[("C", [0.0; 2]), ("B", [0.25, 0.0])]),
        ]
    });
}

#[test]
fn slider_cranks() {
    agree("slider-crank", |drives| {
        let at = compositions::slider_crank([0.1, 0.35, 0.0], 0.0, 1.0, &drives[0]);
        let ([crank, rod, slider], _) = at.unwrap();
        [
            ("crank", crank, &[("A", [0.1, 0.0])]),
            (
                "rod",
                rod,
                &[("B", [0.0; 2]), ("A", [0.35, 0.0]), ("G", [0.2, 0.0])],
            ),
            ("slider", slider, &[("B", [0.0; 2])]),
        ]
    });
    agree("slider-crank-eccentric", |drives| {
        let at = compositions::slider_crank([0.025, 0.2, 0.02], 0.0, 1.0, &drives[0]);
        let ([disc, rod, slider], _) = at.unwrap();
        [
            ("disc", disc, &[("A", [0.025, 0.0]), ("K", [0.025, 0.06])]),
            ("rod", rod, &[("B", [0.0; 2]), ("A", [0.2, 0.0])]),
            ("slider", slider, &[("B", [0.0; 2])]),
        ]
    });
}

#[test]
fn five_bar_with_two_drives() {
    agree("five-bar", |drives| {
        let at = compositions::five_bar(&[drives[0], drives[1]]);
        let ([left_crank, left_link, right_link, right_crank], []) = at.unwrap();
        [
            ("left-crank", left_crank, &[("A", [0.05, 0.0])]),
            ("left-link", left_link, &[("B", [0.2, 0.0])]),
            (
                "right-link",
                right_link,
                &[("D", [0.0; 2]), ("B", [0.22, 0.0])],
            ),
            ("right-crank", right_crank, &[("D", [0.04, 0.0])]),
        ]
    });
}

#[test]
fn quick_returns() {
    agree("quick-return", |drives| {
        let ([_, lever, rod, ram], _) = compositions::quick_return(&drives[0]).unwrap();
        [
            ("lever", lever, &[("Q", [0.0; 2]), ("E", [0.5, 0.0])]),
            ("rod", rod, &[("R", [0.0; 2]), ("E", [0.3, 0.0])]),
            ("ram", ram, &[("R", [0.0; 2])]),
        ]
    });
    agree("quick-return-slotted", |drives| {
        let ([_, lever, ram], _) = compositions::slotted_quick_return(&drives[0]).unwrap();
        [
            ("lever", lever, &[("Q", [0.0; 2])]),
            ("ram", ram, &[("R", [0.0; 2]), ("S", [0.0, -0.03])]),
        ]
    });
}

#[test]
fn scotch_yoke_with_a_leaning_slot() {
    agree("scotch-yoke", |drives| {
        let ([crank, yoke], _) = compositions::scotch_yoke(&drives[0]).unwrap();
        [
            ("crank", crank, &[("A", [0.1, 0.0])]),
            ("yoke", yoke, &[("Y", [0.0; 2])]),
        ]
    });
}

#[test]
fn fairbairn_and_inserter() {
    agree("fairbairn", |drives| {
        let at = compositions::fairbairn(&drives[0]);
        let ([_, rod, bridle, tracing, rocker], []) = at.unwrap();
        [
            ("rod", rod, &[("A", [0.0; 2]), ("M", [0.3, 0.0])]),
            ("bridle", bridle, &[("M", [0.2, 0.0])]),
            ("tracing", tracing, &[("T", [-0.2, 0.0]), ("N", [0.2, 0.0])]),
            ("rocker", rocker, &[("G", [0.0; 2]), ("N", [0.8, 0.0])]),
        ]
    });
    agree("inserter", |drives| {
        let at = compositions::inserter(&drives[0]);
        let ([_, coupler, rocker, rod, pusher], _) = at.unwrap();
        [
            ("coupler", coupler, &[("P", [0.15, 0.12])]),
            ("rocker", rocker, &[("B", [0.14, 0.0])]),
            ("rod", rod, &[("S", [0.0; 2]), ("P", [0.3, 0.0])]),
            ("pusher", pusher, &[("S", [0.0; 2])]),
        ]
    });
}

#[test]
fn two_loops() {
    agree("two-loop", |drives| {
        let at = compositions::two_loop(&drives[0]);
        let ([_, coupler, rocker, upper, lower], _) = at.unwrap();
        [
            ("coupler", coupler, &[("P", [0.2, 0.0]), ("B", [0.35, 0.0])]),
            ("rocker", rocker, &[("B", [0.3, 0.0])]),
            ("upper", upper, &[("P", [0.0; 2])]),
            ("lower", lower, &[("Q", [0.0; 2])]),
        ]
    });
}

#[test]
fn serial_arm_by_relative_angles() {
    agree("serial-arm", |drives| {
        let mut absolute = [drives[0]; 3];
        for i in 1..3 {
            let before = absolute[i - 1];
            absolute[i] = Drive {
                angle: before.angle + drives[i].angle,
                rate: before.rate + drives[i].rate,
                acceleration: before.acceleration + drives[i].acceleration,
            };
        }
        let [upper, fore, tool] = compositions::serial_arm(&absolute);
        [
            ("upper", upper, &[("E", [0.4, 0.0])]),
            ("fore", fore, &[("W", [0.3, 0.0])]),
            ("tool", tool, &[("T", [0.1, 0.0])]),
        ]
    });
}
