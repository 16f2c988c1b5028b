//! Drives on a simulated bus under a whole machine.

use crate::reference::run;
use crate::scenes::{attempt, edited, parse, text};
use trirrr_plant::{PlantEnd, Refusal};

/// Largest distance of the platform from its setpoint, m.
fn farthest(text: &str) -> f64 {
    let (outcome, rows) = run(&parse(text));
    assert_eq!(outcome.end, PlantEnd::Complete);
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    assert!(
        outcome.balance.error().abs() < 1e-6,
        "{:?}",
        outcome.balance
    );
    rows.iter().fold(0.0, |most: f64, row| {
        let [x, y, _] = [0, 1, 2].map(|axis| row.pose[axis] - row.setpoint[axis]);
        most.max(x.hypot(y))
    })
}

/// The shipped scene with each of its three drives edited.
fn with_drives(edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text("plant-odrive"), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 3, "{from}");
        text.replace(from, to)
    })
}

/// Coulomb friction of 20 mN m over a gain of 300 N m/rad are 67 urad of a joint; an ODrive holds its position for the
/// 2 ms of a tick, in which a joint turns 1.5 mrad at 0.74 rad/s.
#[test]
fn odrives_play_the_thesis_move_with_friction_and_encoders() {
    let off = farthest(&text("plant-odrive"));
    println!("{off:.2e} m");
    assert!(off < 3e-4, "{off:e}");
    // What the drives know makes no difference to where they go.
    let joint = with_drives(&[(
        "protocol = \"odrive\"",
        "protocol = \"odrive\"\nabsolute = \"joint\"",
    )]);
    assert!((farthest(&joint) - off).abs() < 1e-5);
    // Twice the ticks halve what the hold costs.
    let quick = edited(
        &text("plant-odrive"),
        &[("tick_rate_hz = 500", "tick_rate_hz = 1000")],
    );
    let quicker = farthest(&quick);
    println!("{quicker:.2e} m at 1000 Hz");
    assert!(quicker < off);
}

#[test]
fn other_drives_play_it_too() {
    let moteus = with_drives(&[
        ("protocol = \"odrive\"", "protocol = \"moteus\""),
        ("bit_rate_hz = 1000000\n", ""),
        (
            "messages_hz = 1050 # 50 heartbeats, 500 estimates of the encoder and as many of the torque\n",
            "",
        ),
    ]);
    let off = farthest(&moteus);
    println!("moteus: {off:.2e} m");
    assert!(off < 3e-4, "{off:e}");
    let mit = with_drives(&[
        (
            "protocol = \"odrive\"",
            "protocol = \"mit\"\nmodel = \"dm4310\"\nkp_nm_rad = 300.0\nkd_nm_s_rad = 2.0",
        ),
        (
            "messages_hz = 1050 # 50 heartbeats, 500 estimates of the encoder and as many of the torque\n",
            "",
        ),
        ("gear_ratio = 10.0", "gear_ratio = 1.0"),
        ("rotor_inertia_kgm2 = 1e-5", "rotor_inertia_kgm2 = 1e-3"),
    ]);
    let off = farthest(&mit);
    println!("MIT mode: {off:.2e} m");
    assert!(off < 6e-4, "{off:e}");
}

#[test]
fn a_bus_that_is_too_slow_ends_the_run() {
    // 3 * 135 bits in 2 ms are 203 kbit/s.
    let slow = with_drives(&[
        ("bit_rate_hz = 1000000", "bit_rate_hz = 125000"),
        ("messages_hz = 1050", "messages_hz = 110"),
    ]);
    match attempt(&parse(&slow)) {
        Err(Refusal::Drive { reason, .. }) => assert!(reason.contains("BusBusy"), "{reason}"),
        other => panic!("{other:?}"),
    }
}
