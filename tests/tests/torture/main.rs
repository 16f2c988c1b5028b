//! Jobs over a line that damages every fifth frame: client and service, as they are, with only the
//! line and the clock in between made up.
//!
//! What has to hold however the line behaves: every job ends complete; each of its moves is executed
//! once, in order, tick by tick with the setpoints it was offered with; whatever either end takes
//! for a message was sent as that message.

mod conversation;

use conversation::{Conversation, Tally};

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
