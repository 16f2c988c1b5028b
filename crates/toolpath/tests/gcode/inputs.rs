//! Waits for inputs: M66.
use crate::common::{refused, refused_with, run_with};
use trirrr_toolpath::gcode::GcodeSetup;
use trirrr_toolpath::{Act, InputAct, InputChange, ToolMotion};

fn setup() -> GcodeSetup {
    GcodeSetup {
        inputs: 3,
        outputs: 1,
        ..GcodeSetup::default()
    }
}

#[test]
fn a_wait_stands_before_the_motion_of_its_line_with_the_tool_off() {
    let text =
        "M3 S1000\nG1 X1 F60\nM66 P2 L1 Q0.5 X2\nM66 P0 L2 Q1\nM66 P1 L3 Q2\nM66 P1 L4 Q1000000";
    let (_, elements) = run_with(setup(), text);
    let waits: Vec<(usize, InputAct)> = (0..)
        .zip(&elements)
        .filter_map(|(place, element)| match element.act {
            Act::Input(wait) => {
                assert_eq!(element.tool, None);
                Some((place, wait))
            }
            _ => None,
        })
        .collect();
    let wait = |index, until, timeout_s| InputAct {
        index,
        until,
        timeout_s,
    };
    let expected = [
        (1, wait(2, InputChange::Rise, 0.5)),
        (3, wait(0, InputChange::Fall, 1.0)),
        (4, wait(1, InputChange::High, 2.0)),
        (5, wait(1, InputChange::Low, 1e6)),
    ];
    assert_eq!(waits, expected);
    let Act::Motion(ToolMotion { to, .. }) = elements[2].act else {
        panic!("{:?}", elements[2]);
    };
    assert_eq!(to.position_m, [2e-3, 0.0]);
}

#[test]
fn what_is_no_wait_is_refused() {
    for (line, word, reason) in [
        ("M66", "M66", "P with the number"),
        ("M66 P0", "M66", "L1"),
        ("M66 P0 L3", "M66", "Q with the seconds"),
        ("M66 P0 L0", "L0", "no parameter"),
        ("M66 P0 L5 Q1", "L5", "L4"),
        ("M66 P0 L1.5 Q1", "L1.5", "L4"),
        ("M66 P0 L3 Q0", "Q0", "positive"),
        ("M66 P0 L3 Q-1", "Q-1", "positive"),
        ("M66 P3 L3 Q1", "P3", "0 to 2"),
        ("M66 P0.5 L3 Q1", "P0.5", "0 to 2"),
        ("M66 E0 L0", "E0", "two levels"),
        ("M66 P0 L3 Q1 M62", "P0", "two codes"),
        ("M66 P0 L3 Q1 G4", "P0", "two codes"),
        ("M66 P0 L3 Q1 M66", "M66", "modal group"),
        ("M62 P0 Q1", "Q1", "M66"),
        ("G4 P1 L1", "L1", "M66"),
    ] {
        let fault = refused_with(setup(), line);
        assert_eq!(fault.word, word, "{line}");
        assert!(fault.reason.contains(reason), "{line}: {fault}");
    }
    let fault = refused("M66 P0 L3 Q1");
    assert!(fault.reason.contains("[[io.inputs]]"), "{fault}");
}
