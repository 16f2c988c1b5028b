//! Nothing pushes: no contact.

use crate::bench::{Bench, COARSE, FINE, Setup, detection};

/// Ticks of a bench that half stands and half moves; ends at an alarm.
fn watch(setup: Setup, ticks: u32) {
    for moves in [false, true] {
        let mut bench = Bench::settled(setup, 7, moves);
        for tick in 0..ticks / 2 {
            bench.go_on(moves);
            assert_eq!(bench.fault(), None, "tick {tick}, moves {moves}");
        }
    }
}

#[test]
fn noise_is_no_contact() {
    watch(FINE, 40_000);
    watch(COARSE, 20_000);
}

/// Asked: none in ten million ticks.
#[test]
#[ignore = "ten million ticks: cargo test --release"]
fn noise_is_no_contact_for_ten_million_ticks() {
    watch(FINE, 10_000_000);
}

/// Friction of the motors, known to a tenth, is allowed for: without it the same machine alarms.
#[test]
fn friction_is_no_contact() {
    let rubbing = |known: f64| Setup {
        coulomb: 0.1,
        contact: trirrr_service::features::ContactParameters {
            coulomb_nm: [known; 3],
            ..detection(1.0, 20.0, 2)
        },
        ..COARSE
    };
    watch(rubbing(0.11), 10_000);
    let mut ignorant = Bench::settled(rubbing(0.0), 7, false);
    let felt = ignorant.feel([0.0; 3], true);
    assert!(felt.is_some(), "no alarm without allowance");
}
