//! The estimated force and moment are the true ones.

use crate::bench::{Bench, COARSE, FINE, Setup, detection};

/// Mean of the estimate over a while, some time after the push began.
fn estimated(setup: Setup, push: [f64; 3], moves: bool) -> [f64; 3] {
    let setup = Setup {
        contact: trirrr_service::features::ContactParameters {
            torque_nm: 1e3,
            ..detection(1e3, setup.contact.bandwidth_hz, 1)
        },
        ..setup
    };
    let mut bench = Bench::settled(setup, 5, moves);
    assert_eq!(bench.feel(push, moves).map(|(ticks, _)| ticks), None);
    let mut sum = [0.0; 3];
    // One shuttle there and back.
    let ticks = (2.0 * 0.7 * setup.tick_rate_hz) as u32;
    for _ in 0..ticks {
        bench.go_on(moves);
        for (sum, part) in sum.iter_mut().zip(bench.wrench) {
            *sum += f64::from(part) / f64::from(ticks);
        }
    }
    sum
}

#[test]
fn force_and_moment_are_those_of_the_push() {
    for setup in [FINE, COARSE] {
        for push in [
            [3.0, 0.0, 0.0],
            [0.0, -2.0, 0.0],
            [1.0, 1.0, 0.05],
            [0.0, 0.0, -0.1],
        ] {
            for moves in [false, true] {
                let found = estimated(setup, push, moves);
                println!("{push:?} moves {moves}: {found:.4?}");
                // A force is off by what the deviation adds, of second order; a count of the encoder holds some, too.
                for (found, (push, least)) in found.iter().zip(push.iter().zip([0.05, 0.05, 0.002]))
                {
                    let error = (found - push).abs();
                    assert!(error <= least + 0.03 * push.abs(), "{found} for {push}");
                }
            }
        }
    }
}
