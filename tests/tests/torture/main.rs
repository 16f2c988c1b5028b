//! Jobs over a line that damages every fifth frame: client and service, as they are, with only the
//! line and the clock in between made up.
//!
//! What has to hold however the line behaves: every job ends complete; each of its moves is executed
//! once, in order, tick by tick with the setpoints it was offered with; whatever either end takes
//! for a message was sent as that message. Goals may cut the motion at any time: what is played is the old motion up to
//! the cut and the new one from there, in the bits, at any pace, within the limits. A job goes on where it was when the cable is pulled or the host is
//! killed.

mod conversation;
mod endings;
mod errands;
mod follow;
mod long_job;
mod raster;
mod slow_line;

use conversation::{Conversation, Tally};
use errands::{ErrandSession, Errands};
use follow::follow_all;
use slow_line::{SERIAL, USB, circles, play};
use std::thread;
use trirrr_tests::random::share;

/// Jobs of `seeds` until `frames` frames have been on the line.
fn torture(frames: u64, seeds: impl Iterator<Item = u64>) -> Tally {
    let mut total = Tally::default();
    for seed in seeds {
        if total.frames >= frames {
            break;
        }
        total.add(&Conversation::run(seed));
    }
    println!("{total:?}");
    total
}

#[test]
fn jobs_survive_a_bad_line() {
    let half_frames = u64::from(share(1_000_000));
    // On two cores, seeds of their own on each.
    let mut total = Tally::default();
    thread::scope(|scope| {
        let halves =
            [0, 1].map(|half| scope.spawn(move || torture(half_frames, (1 + half..).step_by(2))));
        for half in halves {
            total.add(&half.join().expect("a half without a panic"));
        }
    });
    assert!(total.frames >= 2 * half_frames);
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
    assert!(total.replaced > 0, "no goal took the place of another");
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

/// Circles of goals in motion: none freezes the machine, and the client ends where the machine stands.
fn follow_circles(curves: u64, poses: u32) {
    let total = follow_all(curves, poses);
    println!("{total:?}");
    assert_eq!(total.at_rest + total.short, total.curves);
    // Everything that is there to be tested did happen.
    assert!(total.moving > total.goals / 2 && total.cuts > total.goals / 4);
    assert!(total.at_rest > 0 && total.short > 0 && total.holds > 0);
}

#[test]
fn goals_in_motion_are_followed() {
    follow_circles(4, 12);
}

#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn twenty_thousand_goals_in_motion_are_followed() {
    follow_circles(40, 125);
}

/// Moves of 10 ms, 16 ms each way: what an USB adapter makes of a serial line.
#[test]
fn a_delayed_line_keeps_up_with_moves_of_10_ms() {
    for bytes_per_tick in [SERIAL, USB] {
        let pace = play(circles(1000, 10), 16, bytes_per_tick);
        println!("1000 moves of 10 ms, 16 ms each way, {bytes_per_tick} bytes per ms: {pace:?}");
        assert_eq!((pace.dry, pace.repeated), (0, 0));
        assert!(pace.ticks <= 10_000 + 2, "{pace:?}");
    }
}

/// Moves of 1 ms, 0.1 mm each, 8 ms each way.
fn play_ticks(count: u32) {
    for bytes_per_tick in [SERIAL, USB] {
        let pace = play(circles(count, 1), 8, bytes_per_tick);
        println!("{count} moves of 1 ms, 8 ms each way, {bytes_per_tick} bytes per ms: {pace:?}");
        assert_eq!((pace.dry, pace.repeated), (0, 0));
        assert!(pace.ticks <= u64::from(count) + 2, "{pace:?}");
    }
}

#[test]
fn a_delayed_line_keeps_up_with_moves_of_a_tick() {
    play_ticks(5000);
}

#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn a_delayed_line_keeps_up_with_moves_of_a_tick_for_ten_minutes() {
    play_ticks(600_000);
}

/// Plays a job with interruptions at random. In each tick the machine puts out what the job asks for: each tick of the job's path
/// once, the tool where the job has it, and never while the machine stands.
fn play_long_job(ticks: u64, interruptions: usize, power_cuts: usize) {
    let count = long_job::play(ticks, interruptions, power_cuts, 1);
    println!("{count:?}");
    assert!(count.path_ticks > ticks);
    assert!(count.cables + count.hosts >= interruptions as u32);
    assert_eq!(count.powers, power_cuts as u32);
    // Everything that is there to be tested did happen.
    assert!(count.cables > 0 && count.hosts > 0);
    assert!(count.silences > 0, "the machine never waited for its host");
    assert!(count.dry > 0, "the queue was never empty");
    assert!(count.lost > 0, "no client found out by itself");
    assert!(count.between > 0, "no ramp passed a tick of the path");
    assert!(count.led_ticks > 0, "no way back");
    assert!(count.repeated > 0, "no request was repeated");
    assert!(count.tool_ticks > ticks / 3 && count.held_ticks > 0);
}

#[test]
fn a_job_survives_its_interruptions() {
    play_long_job(120_000, 20, 4);
}

#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn a_job_of_eight_hours_survives_two_hundred_interruptions() {
    play_long_job(28_800_000, 200, 20);
}

/// Ends streams in all ways and resumes them.
fn resume_all(streams: u64) {
    assert_eq!(endings::end_streams(streams), [0, 0]);
}

#[test]
fn nothing_of_a_job_is_lost_however_its_stream_ends() {
    resume_all(45);
}

#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn nothing_of_five_hundred_jobs_is_lost_however_their_streams_end() {
    resume_all(510);
}
