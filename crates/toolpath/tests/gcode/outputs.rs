//! Outputs: M62 to M65.
use crate::common::{refused, refused_with, run_with};
use trirrr_toolpath::gcode::{GcodeSetup, elements};
use trirrr_toolpath::{Act, Element, OutputAct};

fn setup() -> GcodeSetup {
    GcodeSetup {
        outputs: 3,
        ..GcodeSetup::default()
    }
}

fn acts(text: &str) -> Vec<Act> {
    let (_, elements) = run_with(setup(), text);
    elements.iter().map(|element| element.act).collect()
}

fn output(index: u8, on: bool, with_motion: bool) -> Act {
    Act::Output(OutputAct {
        index,
        on,
        with_motion,
    })
}

#[test]
fn outputs_stand_where_the_program_has_them() {
    let found = acts("M62 P0\nG1 X1 F60\nM64 P2\nM65 P1\nG4 P1\nM63 P0\nX2\nM2");
    let outputs: Vec<(usize, Act)> = (0..)
        .zip(found)
        .filter(|(_, act)| matches!(act, Act::Output(_)))
        .collect();
    assert_eq!(
        outputs,
        [
            (0, output(0, true, true)),
            (2, output(2, true, false)),
            (3, output(1, false, false)),
            (5, output(0, false, true)),
        ]
    );
}

#[test]
fn an_output_comes_before_the_dwell_and_the_motion_of_its_line() {
    let found = acts("G1 X1 F60 M62 P1");
    assert_eq!(found[0], output(1, true, true));
    assert!(matches!(found[1], Act::Motion(_)) && found.len() == 2);
    // Both would have P.
    assert_eq!(refused_with(setup(), "G4 P1 M62").word, "P1");
}

#[test]
fn what_names_no_output_is_refused() {
    for (line, word, reason) in [
        ("M62", "M62", "needs P"),
        ("M64 P3", "P3", "0 to 2"),
        ("M65 P-1", "P-1", "not negative"),
        ("M62 P0.5", "P0.5", "0 to 2"),
        ("M62 P0 M63", "M63", "modal group"),
        ("M67 E0 Q1", "M67", "two levels"),
    ] {
        let fault = refused_with(setup(), line);
        assert_eq!(fault.word, word, "{line}");
        assert!(fault.reason.contains(reason), "{line}: {fault}");
    }
    assert!(refused("M62 P0").reason.contains("[[io.outputs]]"));
}

#[test]
fn a_change_without_a_motion_behind_it_is_refused_at_the_end() {
    for text in [
        "G1 X1 F60\nM62 P0",
        "G1 X1 F60\nM62 P0\nG4 P1\nM2",
        "G1 X1 F60\nM63 P0\nM30",
        "%\nG1 X1 F60\nM62 P0\n%",
    ] {
        let all: Vec<_> = elements(text.as_bytes(), setup()).collect();
        let fault = all.last().expect("an item").clone().expect_err(text);
        let line = 1 + text
            .lines()
            .position(|line| line.starts_with("M6"))
            .unwrap() as u32;
        assert_eq!(fault.line, line, "{text}");
        assert!(fault.reason.contains("M64"), "{fault}");
    }
    let good = "M62 P0\nG1 X1 F60\nM65 P0\n";
    let all: Result<Vec<Element>, _> = elements(good.as_bytes(), setup()).collect();
    assert_eq!(all.expect("a good program").len(), 3);
}
