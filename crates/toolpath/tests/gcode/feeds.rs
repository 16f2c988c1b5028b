//! F in its two senses.
use crate::common::{last, motion, near, place, refused, run, same};
use std::f64::consts::PI;

fn feed(text: &str) -> f64 {
    last(text).feed_m_s.unwrap()
}

#[test]
fn a_feed_holds_until_the_next() {
    near(feed("F120\nG1 X1"), 0.002);
    near(feed("F120\nG1 X1\nX2"), 0.002);
    near(feed("F120\nG1 X1\nX2 F60"), 0.001);
}

#[test]
fn a_motion_at_the_feed_needs_one() {
    for text in [
        "G1 X1",
        "G2 X1 R5",
        "G1 X1 F0",
        "F60\nF0\nG1 X1",
        "F60\nG93\nG94 G1 X1",
        "G1 A5",
        "G1 X0",
    ] {
        assert!(refused(text).reason.contains('F'), "{text}");
    }
    assert_eq!(refused("G0 X1 F-1").word, "F-1");
}

#[test]
fn a_rapid_needs_no_feed() {
    assert_eq!(last("G0 X1 F0").feed_m_s, None);
    assert_eq!(last("G93 G0 X1").feed_m_s, None);
}

#[test]
fn inverse_time_is_the_length_by_the_duration() {
    // 5 mm in 1/2 min.
    near(feed("G93 G1 X3 Y4 F2"), 0.005 / 30.0);
    near(feed("G93 G20 G1 X1 F60"), 0.0254);
    // A quarter of a circle of 10 mm in a minute.
    near(feed("G0 X10\nG93 G3 X0 Y10 I-10 F1"), 0.005 * PI / 60.0);
    // Two and a quarter turns.
    near(
        feed("G0 X10\nG93 G3 X0 Y10 I-10 P3 F1"),
        4.5 * PI * 0.01 / 60.0,
    );
}

#[test]
fn inverse_time_is_needed_in_each_line() {
    assert!(refused("G93 G1 X1 F2\nX2").reason.contains("G93"));
    assert!(refused("F2\nG93\nG1 X1").reason.contains("G93"));
    refused("G93 G1 X1 F0");
}

#[test]
fn a_line_that_only_turns_has_no_feed() {
    for text in ["G1 A90 F600", "G93 G1 A90 F2"] {
        let motion = last(text);
        assert_eq!(motion.feed_m_s, None);
        same(motion.to, place(0.0, 0.0, 90.0));
    }
    // With the tool point on its way the feed is that of the tool point.
    near(feed("G1 X1 A90 F600"), 0.01);
}

#[test]
fn a_feed_that_is_as_good_as_none_is_refused() {
    assert!(refused("G1 X1 F0.00001").reason.contains("nanometre"));
    assert_eq!(refused("G93 G1 X1 F0.00001").word, "F0.00001");
}

#[test]
fn parts_of_an_arc_share_the_feed_of_the_whole() {
    // Nearly closed, with radii 10 and 10.001 mm: two arcs.
    let (_, elements) = run("G0 X10\nG93 F1 G3 X10.001 Y-0.01 I-10");
    let feeds: Vec<_> = elements[1..]
        .iter()
        .map(|e| motion(e).feed_m_s.unwrap())
        .collect();
    assert_eq!(feeds.len(), 2);
    assert_eq!(feeds[0], feeds[1]);
    assert!((feeds[0] / (2.0 * PI * 0.01 / 60.0) - 1.0).abs() < 1e-3);
}
