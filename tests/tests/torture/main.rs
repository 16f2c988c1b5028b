//! Jobs over a line that damages every fifth frame: client and service, as they are, with only the
//! line and the clock in between made up.
//!
//! What has to hold however the line behaves: every job ends complete; each of its moves is executed
//! once, in order, tick by tick with the setpoints it was offered with; whatever either end takes
//! for a message was sent as that message. Goals may cut the motion at any time: what is played is the old motion up to
//! the cut and the new one from there, in the bits, at any pace, within the limits.

mod conversation;
mod errands;

use conversation::{Conversation, Tally};
use errands::{ErrandSession, Errands};

/// Jobs until `frames` frames have been on the line.
fn torture(frames: u64, first_seed: u64) -> Tally {
    let mut total = Tally::default();
    let mut seed = first_seed;
    while total.frames < frames {
        total.add(&Conversation::run(seed));
        seed += 1;
    }
    println!("{total:?}");
    total
}

#[test]
fn jobs_survive_a_bad_line() {
    let total = torture(1_000_000, 1);
    assert!(total.frames >= 1_000_000);
    // 51 of 256 frames, to six standard deviations of the binomial distribution.
    let frames = total.frames as f64;
    let rate = 51.0 / 256.0;
    let deviation = (frames * rate * (1.0 - rate)).sqrt();
    assert!((total.damaged as f64 - frames * rate).abs() < 6.0 * deviation);
    // Everything that is there to be tested did happen.
    assert!(total.moves > total.jobs);
    assert!(total.repeated > 0, "the client never had to ask again");
    assert!(total.heard_again > 0, "no request came twice");
    assert!(total.dropped_frames > 0, "no damage was found");
    assert!(total.reconnects > 0, "no line was ever given up");
    assert!(total.holds > 0, "no job was ever held");
    assert!(total.overrides > 0, "no pace was ever changed");
}

/// So many sessions of moves, goals and orders at random.
fn run_errands(sessions: u64) {
    let mut total = Errands::default();
    for seed in 1..=sessions {
        total.add(&ErrandSession::run(seed));
    }
    println!("{total:?}");
    // Everything that is there to be tested did happen.
    assert!(total.cuts > 5 * sessions, "few cuts");
    assert!(total.slow_cuts > sessions / 4, "few cuts at other paces");
    assert!(total.chains_cut > sessions, "few retargets cut another");
    assert!(total.behind > 0 && total.holds > 0 && total.stops > 0);
    assert!(total.damaged > 0);
}

#[test]
fn goals_cut_the_motion_at_any_time() {
    run_errands(12);
}

#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn goals_cut_the_motion_ten_thousand_times() {
    run_errands(2000);
}
