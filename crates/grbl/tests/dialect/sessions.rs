//! Sessions of senders that have gone wrong with other controllers, at random delays.

use crate::machine::{Machine, Random, answers};
use std::time::Duration;
use trirrr_toolpath::gcode::ZWords;

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

fn unlocked() -> Machine {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.motion_time = ms(120);
    machine
}

/// A jog that is refused leaves no state behind: empty, without a feed, with a bad word.
#[test]
fn a_jog_that_is_refused_leaves_the_machine_idle() {
    let mut machine = unlocked();
    for jog in ["$J=\n", "$J=G91 X1\n", "$J=G91 X1 F100 Q7\n"] {
        let said = machine.now(jog.as_bytes());
        assert!(
            answers(&said) == 1 && said.contains("error:"),
            "{jog}: {said}"
        );
        assert_eq!(machine.state(), "Idle", "{jog}");
        assert!(machine.now(b"G1 X1 F500\n").ends_with("ok\r\n"), "{jog}");
        machine.send(b"");
    }
}

/// A cancel in the packet of the jog, before its answer, behind it, and behind its end; up to five jogs in a row.
#[test]
fn a_cancelled_jog_is_answered_once_and_moves_no_more() {
    let seed = 0x7472_6972_7272_0837;
    println!("seed {seed:#x}");
    let mut random = Random(seed);
    for number in 0..1000 {
        let mut machine = unlocked();
        let jogs = 1 + random.below(5);
        let mut said = String::new();
        for _ in 0..jogs {
            let cancel = random.below(31) as u64;
            let jog = b"$J=G21G91Y-8F4000\n";
            if cancel == 0 {
                said += &machine.now(&[jog.as_slice(), b"\x85"].concat());
            } else {
                said += &machine.now(jog);
                (0..cancel).for_each(|_| said += &machine.pass(ms(1)));
                said += &machine.now(b"\x85");
            }
            (0..random.below(30)).for_each(|_| said += &machine.pass(ms(1)));
        }
        (0..300).for_each(|_| said += &machine.pass(ms(1)));
        assert_eq!(answers(&said), jogs, "{number}: {said}");
        assert_eq!(machine.state(), "Idle", "{number}");
        let place = machine.view.place;
        machine.send(b"");
        assert_eq!(machine.view.place, place, "{number}");
        // A line behind the cancel of a jog that has ended.
        machine.now(b"\x85");
        assert!(machine.now(b"G1 X1 F500\n").ends_with("ok\r\n"), "{number}");
        machine.send(b"");
        assert_eq!(machine.view.place.position_m[0], 1e-3, "{number}");
    }
}

/// A reset while a hold slows down, and in the hold: one greeting, and no alarm.
#[test]
fn a_reset_in_a_hold_greets_once() {
    let mut random = Random(0x76);
    for _ in 0..200 {
        let mut machine = unlocked();
        let mut said = machine.now(b"M3 S500\nG1 X20 F1000\n");
        for byte in [b"!", b"\x18"] {
            (0..random.below(200)).for_each(|_| said += &machine.pass(ms(1)));
            said += &machine.now(byte);
        }
        said += &machine.send(b"");
        assert_eq!(said.matches("Grbl 1.1h").count(), 1, "{said}");
        assert!(!said.contains("ALARM"), "{said}");
        assert_eq!(machine.state(), "Idle");
        assert!(machine.send(b"$G\n").contains("M5"));
    }
}

#[test]
fn the_end_of_a_program_is_answered_once() {
    let mut machine = unlocked();
    for end in ["M30\n", "M2\n"] {
        assert_eq!(answers(&machine.send(end.as_bytes())), 1, "{end}");
    }
}

#[test]
fn every_end_of_a_line_is_one_answer() {
    for (bytes, lines) in [
        (b"G1 X1 F100\r\nX2\r\n".as_slice(), 2),
        (b"G1 X1 F100\nX2\n", 2),
        (b"G1 X1 F100\rX2\r", 2),
        // The first return ends the line, the second an empty one.
        (b"G1 X1 F100\r\r\nX2\r\r\n", 4),
        (b"G1 X1\x00 F100\n", 1),
    ] {
        let mut machine = unlocked();
        let said = machine.send(bytes);
        assert_eq!(answers(&said), lines, "{bytes:?}");
        assert_eq!(said.matches("ok").count(), lines, "{bytes:?}: {said}");
    }
    let mut machine = unlocked();
    let long = format!("G1 X1 F100 ({})\n", "c".repeat(300));
    assert_eq!(machine.send(long.as_bytes()), "ok\r\n");
    let long = format!("G1 X1 {}F100\n", "G1".repeat(500));
    let said = machine.send(long.as_bytes());
    assert!(
        answers(&said) == 1 && said.ends_with("error:11\r\n"),
        "{said}"
    );
}

/// Z is the tool of a pen; a lift with the tool on is refused where words of Z have no effect.
#[test]
fn the_tool_follows_z() {
    let mut pen = Machine::with_z(ZWords::Tool { on_at_m: 0.0 });
    pen.send(b"$X\n");
    for line in ["G0 X1", "G0 Z-1", "G1 X3 F600", "G0 X4", "G1 Z2", "X5"] {
        assert!(
            pen.send(format!("{line}\n").as_bytes()).ends_with("ok\r\n"),
            "{line}"
        );
    }
    assert_eq!(pen.powers, [0.0, 1.0, 1.0, 0.0]);
    let mut blind = Machine::with_z(ZWords::Ignored);
    blind.send(b"$X\n");
    blind.send(b"M3 S1 F600\nG1 Z-1\nX1\nZ3\n");
    let said = blind.send(b"X2\n");
    assert!(
        said.contains("--tool-by-z") && said.ends_with("error:20\r\n"),
        "{said}"
    );
}

/// M6 of another tool waits as M0, and says for which.
#[test]
fn another_tool_is_waited_for() {
    let mut machine = unlocked();
    assert_eq!(machine.now(b"T3 M6\n"), "ok\r\n");
    machine.send(b"G1 X1 F600\n");
    let said = machine.send(b"M6 T4 (a fine pen)\n");
    assert!(
        said.contains("[MSG:change to tool 4 (a fine pen)]"),
        "{said}"
    );
    assert_eq!(answers(&said), 0);
    assert_eq!(answers(&machine.send(b"~")), 1);
}
