//! Times from a push to the fault.

use crate::bench::{Bench, COARSE, FINE, Setup};
use trirrr_protocol::message::FaultCode;

/// Least, middle and greatest time from a push of `force` to the fault, ms, over directions and phases.
fn times(setup: Setup, force: f64, moves: bool, pushes: u32) -> Option<[f64; 3]> {
    let mut all = Vec::new();
    for push in 0..pushes {
        let direction = 2.4 * f64::from(push);
        let mut bench = Bench::settled(setup, 1 + 37 * u64::from(push), moves);
        let push = [force * direction.cos(), force * direction.sin(), 0.0];
        let (ticks, fault) = bench.feel(push, moves)?;
        assert_eq!(fault.code, FaultCode::Contact);
        assert!(fault.value > fault.limit, "{fault:?}");
        all.push(f64::from(ticks) * 1e3 / setup.tick_rate_hz);
    }
    all.sort_by(f64::total_cmp);
    Some([all[0], all[all.len() / 2], all[all.len() - 1]])
}

/// Massive links, encoders of 4,096 counts at the rotors, torques with 10 mN m of noise at the joints.
#[test]
fn a_newton_is_felt_within_five_milliseconds() {
    for moves in [false, true] {
        let times = times(FINE, 1.0, moves, 12).expect("felt");
        println!("1 N, moves {moves}: {times:?} ms");
        assert!(times[2] <= 5.0, "moves {moves}: {times:?} ms");
    }
}

#[test]
fn a_coarse_encoder_feels_it_later() {
    for moves in [false, true] {
        let times = times(COARSE, 1.0, moves, 6).expect("felt");
        println!("1 N, moves {moves}: {times:?} ms");
        assert!(times[2] <= 25.0, "moves {moves}: {times:?} ms");
    }
}

/// Prints the table of `docs/service.md`.
#[test]
#[ignore = "a table: cargo test --release"]
fn times_against_forces_and_thresholds() {
    for (name, setup) in [("fine", FINE), ("coarse", COARSE)] {
        for threshold in [setup.contact.force_n, 1.0, 2.0] {
            let mut before = [f64::INFINITY; 2];
            for force in [0.5, 1.0, 2.0, 5.0] {
                if force <= 1.3 * threshold {
                    continue;
                }
                let contact = trirrr_service::features::ContactParameters {
                    force_n: threshold,
                    ..setup.contact
                };
                let setup = Setup { contact, ..setup };
                let found = [false, true].map(|moves| times(setup, force, moves, 40));
                println!(
                    "{name}: threshold {threshold} N, {force} N: standing {:.1?} ms, moving {:.1?} ms",
                    found[0], found[1]
                );
                // What pushes harder is felt sooner, in the median of as many pushes.
                let medians = found.map(|times| times.expect("felt")[1]);
                for (median, before) in medians.into_iter().zip(&mut before) {
                    assert!(median <= *before, "{name}: {threshold} N, {force} N");
                    *before = median;
                }
            }
        }
    }
}
