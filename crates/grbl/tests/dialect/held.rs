//! Holds in every state.

use crate::machine::{Machine, Random, answers};
use std::time::Duration;
use trirrr_grbl::{InputsView, MachinePhase};

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

fn unlocked() -> Machine {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.motion_time = ms(300);
    machine
}

/// Byte, and the state at rest.
const HOLDS: [(u8, &str); 2] = [(b'!', "Hold:0"), (0x84, "Door:0")];

/// Programs that stand or move in all ways; each begins a motion within the next second if nothing holds.
const PROGRAMS: [&str; 7] = [
    "G1 X255 F600\n",
    "G1 X1 F600\nG4 P0.4\nG1 X2\n",
    "G4 P0.2\nG4 P0.2\nG0 X2\n",
    "M64 P1\nG1 X1 F600\nM65 P1\nM62 P0\nX2\n",
    "M66 P1 L3 Q0.7\nG1 X1 F600\n",
    "G38.3 X5 F100\nG1 X1 F600\n",
    "G2 X10 Y0 I5 J0 F900\nM3 S100\nG3 X0 Y0 I-5 J0\n",
];

#[test]
fn a_hold_is_kept_wherever_it_comes() {
    for (byte, state) in HOLDS {
        for program in PROGRAMS {
            for delay in [0, 1, 20, 59, 61, 150, 299, 301, 350, 500, 750, 900] {
                let mut machine = unlocked();
                machine.now(program.as_bytes());
                for _ in 0..delay {
                    machine.view.inputs = Some(InputsView {
                        on: u8::from(delay > 500) << 1,
                        ..InputsView::default()
                    });
                    machine.pass(ms(1));
                }
                machine.now(&[byte]);
                // The machine asserts that nothing is handed to it.
                let begun = machine.begun;
                for _ in 0..40 {
                    machine.pass(ms(100));
                    machine.view.inputs = Some(InputsView {
                        on: 2,
                        ..InputsView::default()
                    });
                }
                let place = format!("{program:?}, {byte} after {delay} ms");
                assert_eq!(machine.state(), state, "{place}");
                assert_eq!(machine.begun, begun, "{place}");
                machine.now(b"~");
                let said: String = (0..40).map(|_| machine.pass(ms(100))).collect();
                assert!(!said.contains("ALARM"), "{place}: {said}");
                assert_eq!(machine.state(), "Idle", "{place}");
                assert!(machine.begun > 0, "{place}");
            }
        }
    }
}

/// Between two lines, before any, and in the packet of a line.
#[test]
fn a_hold_in_idle_keeps_the_next_line_waiting() {
    for (byte, state) in HOLDS {
        let mut machine = unlocked();
        machine.now(&[b"G1 X1 F100\n".as_slice(), &[byte]].concat());
        assert_eq!(answers(&machine.send(b"G1 X2\nG1 X3\n")), 0);
        assert_eq!((machine.state().as_str(), machine.motions), (state, 0));
        // Commands are answered, and none moves.
        assert!(machine.now(b"").is_empty());
        machine.now(b"\x18");
        assert_eq!(machine.state(), "Idle", "a reset clears a hold");
        machine.now(&[byte]);
        for (line, expected) in [
            ("$X", "ok"),
            ("$G", "ok"),
            ("$J=X1F100", "error:8"),
            ("$H", "error:8"),
            ("$C", "error:8"),
            ("$SLP", "error:8"),
        ] {
            let said = machine.send(format!("{line}\n").as_bytes());
            assert_eq!(said.lines().last(), Some(expected), "{line}");
        }
        assert_eq!((machine.state().as_str(), machine.motions), (state, 0));
    }
}

#[test]
fn a_hold_in_an_alarm_lasts_until_the_user_goes_on() {
    let mut machine = Machine::new();
    machine.now(b"!");
    assert_eq!(machine.state(), "Alarm");
    machine.send(b"$X\n");
    assert_eq!(machine.state(), "Hold:0");
    assert_eq!(answers(&machine.send(b"G1 X1 F100\n")), 0);
    assert_eq!(answers(&machine.send(b"~")), 1);
    assert_eq!(machine.motions, 1);
}

#[test]
fn a_jog_is_cancelled_by_a_hold_and_leaves_none() {
    for byte in [b'!', 0x84, 0x85] {
        let mut machine = unlocked();
        machine.now(b"$J=G91X10F100\n$J=G91X10F100\n");
        machine.pass(ms(100));
        assert_eq!(machine.state(), "Jog");
        machine.now(&[byte]);
        machine.send(b"");
        assert_eq!(machine.state(), "Idle");
        let motions = machine.motions;
        machine.send(b"G1 X1 F100\n");
        assert_eq!(machine.motions, motions + 1);
    }
}

#[test]
fn the_door_itself_holds_and_only_a_closed_one_lets_go_on() {
    let mut machine = unlocked();
    machine.now(b"G1 X1 F100\nG4 P0.1\nX2\n");
    machine.pass(ms(100));
    machine.view.contacts.door = true;
    assert!(machine.now(b"").contains("[MSG:Check Door]"));
    assert_eq!(machine.state(), "Door:1");
    assert!(machine.now(b"?").contains("|Pn:D|") || machine.now(b"?").contains("|Pn:D>"));
    assert!(machine.now(b"~").contains("the door is open"));
    assert_eq!(machine.state(), "Door:1");
    machine.view.contacts.door = false;
    machine.send(b"");
    assert_eq!((machine.state().as_str(), machine.motions), ("Door:0", 1));
    machine.now(b"~");
    machine.send(b"");
    assert_eq!((machine.state().as_str(), machine.motions), ("Idle", 2));
    // One that opened and closed between two looks.
    machine.view.is_door_hold = true;
    machine.now(b"");
    machine.view.is_door_hold = false;
    assert_eq!(machine.state(), "Door:0");
    machine.now(b"~");
    // In a jog it ends the jog, and holds.
    machine.now(b"$J=G91X10F100\n");
    machine.pass(ms(100));
    machine.view.contacts.door = true;
    machine.send(b"");
    assert_eq!(machine.state(), "Door:1");
    // A reset does not close it, and a locked machine is not unlocked behind it.
    machine.send(b"\x18");
    assert_eq!(machine.state(), "Door:1");
    machine.refuse("no");
    for line in ["$X\n", "$H\n"] {
        assert!(machine.send(line.as_bytes()).ends_with("error:13\r\n"));
    }
}

#[test]
fn contacts_are_told() {
    let mut machine = unlocked();
    machine.view.contacts.probe = true;
    machine.view.contacts.limits = [true, false, true];
    assert!(machine.now(b"?").contains("|Pn:PXZ"));
}

/// In check mode no line reaches the machine.
#[test]
fn nothing_moves_in_check_mode() {
    let mut machine = unlocked();
    machine.send(b"$C\n");
    for (line, answer) in [
        ("G1 X30 F100", "ok"),
        ("$J=G91 X-1 F3000", "error:8"),
        ("$H", "error:8"),
        ("$SLP", "error:8"),
        ("$X", "ok"),
        ("G28", "ok"),
        ("G28 X1", "ok"),
        ("G38.2 X5 F100", "ok"),
        ("G2 X15 Y0 I5 F100", "ok"),
        ("G53 G0 X1", "ok"),
        ("M0", "ok"),
        ("G4 P100", "ok"),
        ("M64 P1", "ok"),
        ("M62 P1", "ok"),
        ("X3", "ok"),
        ("M66 P0 L3 Q1", "ok"),
        ("M2", "ok"),
    ] {
        let said = machine.send(format!("{line}\n").as_bytes());
        assert_eq!(said.lines().last(), Some(answer), "{line}: {said}");
        assert_eq!(machine.state(), "Check", "{line}");
    }
    assert_eq!(
        (machine.motions, machine.outputs.len(), machine.ends),
        (0, 0, 0)
    );
    let said = machine.send(b"$C\n");
    assert!(said.contains("ok\r\n\r\nGrbl 1.1h"), "a reset: {said}");
    // The place is that of the machine again.
    machine.send(b"G91 G1 X1 F100\n");
    assert_eq!(machine.view.place.position_m, [1e-3, 0.0]);
}

/// `!` and 0x84 at random instants of random jobs: the machine asserts that nothing is handed to it, and the report tells.
#[test]
fn holds_at_random_instants_are_none_lost() {
    let seed = 0x7472_6972_7272_0147;
    println!("seed {seed:#x}");
    let mut random = Random(seed);
    let lines = [
        "G91 G1 X1 F600",
        "X-1",
        "G2 X2 I1 J0 F900",
        "G2 X-2 I-1 J0",
        "G4 P0.05",
        "G4 P0.3",
        "M64 P1",
        "M62 P0",
        "G1 Y1",
        "Y-1",
        "M66 P0 L4 Q1",
        "M5",
        "",
        "M3 S9",
    ];
    let (mut holds, mut lost) = (0, 0);
    while holds < 1000 {
        let mut machine = unlocked();
        machine.motion_time = ms(20 + random.below(200) as u64);
        machine.view.inputs = Some(InputsView::default());
        for _ in 0..20 {
            let program: Vec<&str> = (0..random.below(6))
                .map(|_| lines[random.below(lines.len())])
                .collect();
            machine.now(format!("G91\n{}\n", program.join("\n")).as_bytes());
            for _ in 0..random.below(700) {
                machine.pass(ms(1));
            }
            let (byte, state) = HOLDS[random.below(2)];
            machine.now(&[byte]);
            let begun = machine.begun;
            for _ in 0..random.below(50) {
                machine.pass(ms(20));
            }
            holds += 1;
            lost += u32::from(machine.state() != state || machine.begun != begun);
            machine.now(b"~");
        }
        machine.pass(ms(100_000));
        assert_ne!(machine.view.phase, MachinePhase::Holding);
    }
    println!("{holds} holds: {lost} lost");
    assert_eq!(lost, 0);
}
