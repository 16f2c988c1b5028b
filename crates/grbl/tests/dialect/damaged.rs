//! Damaged lines, on a machine that obeys at once, and what the machine does with good ones.

use crate::machine::{Machine, Random, answers};
use std::time::Duration;
use trirrr_grbl::InputsView;
use trirrr_toolpath::OutputAct;

const GOOD: [&str; 16] = [
    "G1 X10 Y20 F600",
    "G0 X-30.5",
    "G2 X10 Y10 I5 J0 F100",
    "M3 S500",
    "M5",
    "G4 P0.1",
    "G92 X0 Y0",
    "G10 L20 P1 X0",
    "$J=G91 X1 F100",
    "$10=1",
    "$G",
    "(comment) G91",
    "G90 G21",
    "G20",
    "M64 P1",
    "G1 X1 F100 M63 P0",
];

/// Each line is answered once, and nothing moves beyond the reach.
#[test]
fn a_hundred_thousand_damaged_lines_are_each_answered_once() {
    let seed = 0x7472_6972_7272_0020;
    println!("seed {seed:#x}");
    let (mut random, mut machine) = (Random(seed), Machine::new());
    machine.send(b"$X\n");
    for number in 0..100_000 {
        let mut line = GOOD[random.below(GOOD.len())].as_bytes().to_vec();
        for _ in 0..random.below(4) {
            let at = random.below(line.len());
            // Everything but the ends of lines, and the real-time bytes that drop lines, unlock or pause.
            let byte = match random.below(256) as u8 {
                b'\n' | b'\r' | 0x18 | b'?' | b'!' | b'~' | 0x84 | 0x85 => b'#',
                byte => byte,
            };
            match random.below(3) {
                0 => line[at] = byte,
                1 => line.insert(at, byte),
                _ if line.len() > 1 => drop(line.remove(at)),
                _ => {}
            }
        }
        let shown = String::from_utf8_lossy(&line).into_owned();
        line.push(b'\n');
        let mut said = machine.send(&line);
        // It may have become a long stand, a pause for a tool, which is named, and one of M0 behind it.
        for _ in 0..2 {
            if answers(&said) > 0 {
                break;
            }
            said += &machine.now(b"~");
            // An arc of a hundred turns is as many motions, of which the machine takes sixteen at a time.
            for _ in 0..8 {
                said += &machine.pass(Duration::from_secs(2_000_000));
            }
        }
        assert_eq!(answers(&said), 1, "{number}: {shown:?}: {said:?}");
        // A sleep, or check mode: both are ended by the user.
        match machine.state().as_str() {
            "Idle" => {}
            "Check" => drop(machine.send(b"$C\n")),
            "Sleep" => drop(machine.send(b"$X\n")),
            state => panic!("{number}: {shown:?}: {state}"),
        }
    }
    assert!(machine.motions > 1000, "{}", machine.motions);
}

#[test]
fn a_pause_waits_for_the_user_and_a_stand_for_its_time() {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    assert_eq!(answers(&machine.send(b"G1 X1 F100\nM0\nG1 X2\n")), 1);
    assert!(machine.send(b"?").starts_with("<Hold:0"));
    assert_eq!(machine.view.place.position_m[0], 1e-3);
    assert_eq!(answers(&machine.send(b"~")), 2);
    assert_eq!(machine.view.place.position_m[0], 2e-3);
}

/// The line is answered once the machine stands and the input is as it wants it, by its level or by a change that comes later.
#[test]
fn a_wait_for_an_input_ends_by_it() {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.is_busy = true;
    assert_eq!(answers(&machine.send(b"G1 X1 F100\nM66 P1 L3 Q1000\n")), 1);
    // Before the machine has told its inputs, none is on or off.
    machine.is_busy = false;
    assert_eq!(answers(&machine.send(b"")), 0);
    let inputs = |on, risen, fallen| Some(InputsView { on, risen, fallen });
    machine.view.inputs = inputs(0b01, 0, 0);
    assert_eq!(answers(&machine.send(b"")), 0);
    machine.view.inputs = inputs(0b10, 0, 0);
    assert_eq!(machine.send(b""), "ok\r\n");
    // A level is no change.
    for (line, changed) in [
        (b"M66 P1 L1 Q1000\n", inputs(0b10, 0b10, 0b10)),
        (b"M66 P1 L2 Q1000\n", inputs(0b10, 0, 0b10)),
    ] {
        machine.view.inputs = inputs(0b10, 0b01, 0b01);
        assert_eq!(machine.send(line), "");
        machine.view.inputs = changed;
        assert_eq!(machine.send(b""), "ok\r\n");
    }
    machine.view.inputs = inputs(0b10, 0, 0);
    assert_eq!(machine.send(b"M66 P0 L4 Q1000\n"), "ok\r\n");
}

#[test]
fn a_wait_that_is_over_in_vain_locks_the_machine() {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.view.inputs = Some(InputsView::default());
    let said = machine.send(b"G1 X1 F100\nM66 P1 L3 Q5.5\nX2\n");
    let expected = "ok\r\n[MSG:line 3: input 1 was not on within 5.5 s]\r\nALARM:5\r\nerror:9\r\n";
    // The line behind is answered, too.
    let (before, behind) = said.split_at(expected.len());
    assert_eq!((before, machine.motions), (expected, 1));
    assert!(behind.ends_with("locked: $X unlocks it, $H brings it to its start]\r\nerror:9\r\n"));
    assert!(machine.send(b"G1 X2\n").contains("the machine is locked"));
    machine.send(b"$X\nG1 X2 F100\n");
    assert_eq!(machine.motions, 2);
    // A reset ends a wait without an alarm.
    machine.send(b"M66 P1 L1 Q1000000\n");
    let said = machine.send(b"\x18G1 X1 F100\n");
    assert!(
        !said.contains("ALARM") && said.ends_with("ok\r\n"),
        "{said}"
    );
}

/// Each comes once the machine stands behind what is before it.
#[test]
fn outputs_change_where_the_program_has_them() {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.is_busy = true;
    let said = machine.send(b"G1 X1 F100\nM64 P1\nX2\nM63 P0\nX3\nM2\n");
    assert_eq!((answers(&said), machine.motions), (1, 1));
    assert_eq!(machine.outputs, []);
    machine.is_busy = false;
    assert_eq!(answers(&machine.send(b"")), 5);
    let act = |index, on, with_motion| OutputAct {
        index,
        on,
        with_motion,
    };
    let expected = [(1, act(1, true, false)), (2, act(0, false, true))];
    assert_eq!(machine.outputs, expected);
    assert_eq!((machine.motions, machine.ends), (3, 1));
    // A program that ends with one that waits for a motion, an output that there is not, and one that is only looked at.
    assert!(machine.send(b"M62 P0\nM2\n").contains("no motion follows"));
    assert!(
        machine
            .send(b"M64 P2\n")
            .contains("they have the numbers 0 to 1")
    );
    machine.outputs.clear();
    machine.send(b"$C\nM64 P1\nM2\n$C\n");
    assert_eq!((machine.outputs.len(), machine.ends), (0, 1));
}

#[test]
fn a_refused_motion_locks_the_machine_until_the_user_unlocks_it() {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.refuse("line 3: torque of motor 1");
    let said = machine.send(b"G1 X1 F100\n?");
    assert!(
        said.contains("ALARM:2") && said.contains("torque of motor 1"),
        "{said}"
    );
    assert!(
        said.contains("<Alarm") && said.contains("error:9"),
        "{said}"
    );
    assert!(machine.send(b"$X\n").contains("ok"));
    assert!(machine.send(b"G1 X1 F100\n").contains("ok"));
}

#[test]
fn settings_coordinates_and_units_are_reported() {
    let mut machine = Machine::new();
    machine.send(b"$X\n");
    machine.send(b"G10 L20 P2 X5 Y-5\nG55\nG1 X30.4 Y20.4 F100\n$10=0\n");
    let said = machine.send(b"?");
    assert!(said.contains("|WPos:30.400,20.400,0.000,0.000|"), "{said}");
    machine.send(b"$10=1\n$13=1\n");
    let said = machine.send(b"?");
    assert!(said.contains("|MPos:1.0000,1.0000,0.000,0.000|"), "{said}");
    assert!(
        machine
            .send(b"$G\n")
            .contains("[GC:G1 G55 G17 G21 G90 G94 M5 M9 T0 F100 S0]")
    );
    assert!(machine.send(b"$30=255\n$$\n").contains("$30=255"));
    assert!(
        machine.send(b"$G\n").contains("G54"),
        "a new scale begins anew"
    );
}
