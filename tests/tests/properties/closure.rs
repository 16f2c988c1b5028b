//! The links have their lengths and close the loops; the elbows are on their sides.

use std::cell::RefCell;
use trirrr_core::number::Arithmetic;
use trirrr_tests::bound::Worst;
use trirrr_tests::evaluate::{distances, evaluate};
use trirrr_tests::random::{LEAST_DISTANCE, case, for_all, share};

/// A + r1 + r2 = D + c. The core forms r2 as d - r1 with d = (D - A) + c, so what is left is the
/// rounding of these three sums and of the ones in this test: four times half a unit in the last
/// place of the longest vector, twice for two components.
#[test]
fn every_loop_closes() {
    let worst = RefCell::new(Worst::default());
    for_all(4000, case(), |case| {
        let motion = evaluate(&case.parameters, &case.setpoint).expect("a motion");
        for (leg, motion) in motion.legs.iter().enumerate() {
            let (base, links) = (case.parameters.legs[leg].base_m, &motion.position.links);
            let (position, joint) = (case.setpoint.pose.position, motion.position.platform_joint);
            let gap = (base + links.r1 + links.r2) - (position + joint);
            let vectors = [base, links.r1, links.r2, position, joint];
            let longest = vectors.iter().map(|v| v.x.hypot(v.y)).fold(0.0, f64::max);
            let bound = 4.0 * f64::UNIT_ROUNDOFF * longest;
            worst
                .borrow_mut()
                .compare(|| format!("{case:?}"), gap.x.hypot(gap.y), bound);
        }
    });
    worst.into_inner().assert_within("closure", 0.2..=1.0);
}

/// |r1| = l1 and |r2| = l2. r1 and r2 are made of products with d / d^2: their errors are a few
/// roundings of the longest side, and where d is short those of the two links, multiplied by
/// (l1 + l2) / d. The area's share in that, l / S, is what the distance from stretching bounds.
#[test]
fn every_link_has_its_length() {
    let worst = RefCell::new(Worst::default());
    for_all(4000, case(), |case| {
        let motion = evaluate(&case.parameters, &case.setpoint).expect("a motion");
        for (leg, motion) in case.parameters.legs.iter().zip(&motion.legs) {
            let links = &motion.position.links;
            let d = links.r1 + links.r2;
            let d = d.x.hypot(d.y);
            let reach = leg.proximal_m + leg.distal_m;
            let sine = links.r1_cross_r2.abs() / (leg.proximal_m * leg.distal_m);
            // The position of D relative to A carries a rounding of its own coordinates.
            let place = leg.base_m.x.hypot(leg.base_m.y) + reach;
            let bound = 4.0 * f64::UNIT_ROUNDOFF * place * (reach / d) / sine;
            for (vector, length) in [(links.r1, leg.proximal_m), (links.r2, leg.distal_m)] {
                let error = vector.x.hypot(vector.y) - length;
                worst
                    .borrow_mut()
                    .compare(|| format!("{case:?}"), error, bound);
            }
        }
    });
    worst.into_inner().assert_within("link lengths", 0.05..=1.0);
}

/// r1 x r2 = -sigma S, and the cross product of the two vectors says the same.
#[test]
fn every_elbow_is_on_its_side() {
    let modes = RefCell::new([0u32; 8]);
    for_all(4000, case(), |case| {
        let motion = evaluate(&case.parameters, &case.setpoint).expect("a motion");
        let mut mode = 0;
        for (leg, motion) in case.parameters.legs.iter().zip(&motion.legs) {
            let links = &motion.position.links;
            let sign = leg.elbow.sign();
            assert!(links.r1_cross_r2 * sign < 0.0, "{case:?}");
            assert!(links.r1.perp(&links.r2) * sign < 0.0, "{case:?}");
            mode = 2 * mode + usize::from(sign > 0.0);
        }
        modes.borrow_mut()[mode] += 1;
    });
    let modes = modes.into_inner();
    assert!(
        modes.iter().all(|&cases| cases > share(300)),
        "not every mode was tried: {modes:?}"
    );
}

/// The two distances are what they say: the sine of an elbow, and a fraction of the greatest
/// det A, never above 1 but for its own rounding.
#[test]
fn distances_lie_between_0_and_1() {
    let greatest = RefCell::new((0.0f64, 0.0f64));
    for_all(20_000, case(), |case| {
        let (serial, parallel) = distances(&case.parameters, &case.setpoint.pose);
        let most = 1.0 + 64.0 * f64::UNIT_ROUNDOFF;
        for distance in serial.into_iter().chain([parallel]) {
            assert!(
                (LEAST_DISTANCE..=most).contains(&distance),
                "{case:?}: {distance}"
            );
        }
        let mut greatest = greatest.borrow_mut();
        greatest.0 = serial.into_iter().fold(greatest.0, f64::max);
        greatest.1 = greatest.1.max(parallel);
    });
    let (serial, parallel) = greatest.into_inner();
    // Both scales are used to the full.
    assert!(serial > 0.9999 && parallel > 0.8, "{serial} {parallel}");
}
