//! Alarms, lost machines, and senders that follow one another.

use crate::machine::{Machine, answers};
use std::time::Duration;
use trirrr_grbl::MachinePhase;

/// Each line in flight gets one answer, however the program ends.
#[test]
fn lines_in_flight_are_answered_once_after_an_alarm() {
    let lines = "G1 X1 F100\n".repeat(40) + "G4 P100\nG1 X2\nM0\nG1 X3\n";
    let fault = |machine: &mut Machine| {
        machine.view.phase = MachinePhase::Fault;
        machine.view.reason = Some("torque".into());
    };
    let lose = |machine: &mut Machine| {
        machine.view.phase = MachinePhase::Lost;
        machine.view.reason = Some("the cable is pulled".into());
        machine.is_busy = true;
    };
    let refuse = |machine: &mut Machine| machine.refuse("a result is not proven");
    let ways: [&dyn Fn(&mut Machine); 3] = [&refuse, &fault, &lose];
    for (way, break_off) in ways.iter().enumerate() {
        for before in [0, 3, 30] {
            let mut machine = Machine::new();
            machine.send(b"$X\n");
            machine.motion_time = Duration::from_millis(500);
            let mut said = machine.now(lines.as_bytes());
            (0..before).for_each(|_| said += &machine.pass(Duration::from_millis(400)));
            break_off(&mut machine);
            (0..20).for_each(|_| said += &machine.now(b""));
            let place = format!("way {way} after {before}: {said}");
            assert_eq!(answers(&said), lines.lines().count(), "{place}");
            assert_eq!(said.matches("ALARM:").count(), 1, "{place}");
            assert!(said.ends_with("error:9\r\n"), "{place}");
            assert_eq!(machine.state(), "Alarm", "{place}");
            // The sender is in step.
            assert_eq!(answers(&machine.now(b"G1 X1\n")), 1, "{place}");
        }
    }
}

/// `?` and `$` commands are answered while the machine is lost, and `$X` brings it back once it is found.
#[test]
fn a_lost_machine_is_told_at_once() {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.view.phase = MachinePhase::Lost;
    machine.view.reason = Some("the line to the machine is lost".into());
    machine.is_busy = true;
    let said = machine.now(b"?");
    assert!(
        said.contains("[MSG:the line to the machine is lost]\r\nALARM:1\r\n"),
        "{said}"
    );
    assert!(said.contains("<Alarm|"), "{said}");
    for line in ["$X", "$H"] {
        assert!(
            machine
                .now(format!("{line}\n").as_bytes())
                .ends_with("error:9\r\n"),
            "{line}"
        );
    }
    assert!(machine.now(b"$G\n").ends_with("ok\r\n"));
    machine.view.phase = MachinePhase::Idle;
    machine.view.reason = None;
    machine.is_busy = false;
    assert_eq!(machine.state(), "Alarm");
    assert!(machine.send(b"$X\n").ends_with("ok\r\n"));
    assert_eq!(machine.state(), "Idle");
}

/// The next one is locked out of a machine that is on, with zero points and settings as they were; the rest is as after a reset.
#[test]
fn the_next_sender_finds_the_machine_locked_and_its_zero_points() {
    let mut machine = Machine::new();
    machine.send(b"$X\nG10 L20 P1 X5 Y-5\nG10 L2 P2 X7\nG92 X1\nG55 G91 G20 M3 S10\n$10=2\n$30=100\nG1 X1 F10\n");
    machine.now(b"!");
    let said = machine.connect();
    assert!(
        said.contains("Grbl 1.1h") && said.contains("'$H'|'$X' to unlock"),
        "{said}"
    );
    assert_eq!(machine.state(), "Alarm");
    assert!(machine.send(b"G1 X1 F100\n").ends_with("error:9\r\n"));
    let offsets = machine.send(b"$#\n");
    for expected in [
        "[G54:-5.000,5.000,0.000,0.000]",
        "[G55:7.000,0.000,0.000,0.000]",
        "[G92:0.000,0.000,0.000,0.000]",
    ] {
        assert!(offsets.contains(expected), "{offsets}");
    }
    assert!(machine.send(b"$$\n").contains("$30=100"));
    let modes = machine.send(b"$G\n");
    assert!(
        modes.contains("[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"),
        "{modes}"
    );
    machine.send(b"$X\n");
    assert_eq!(machine.state(), "Idle");
}

/// More than is kept: the program ends, and the line lives.
#[test]
fn a_flood_of_lines_ends_in_an_alarm() {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.now(&b"G4 P1000\n".repeat(600_000));
    let said = machine.now(b"?");
    assert!(said.contains("<Alarm"), "{said}");
    machine.send(b"\x18");
    machine.send(b"$X\n");
    assert_eq!(machine.state(), "Idle");
}
