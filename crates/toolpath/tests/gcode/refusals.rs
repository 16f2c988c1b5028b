//! Lines that are refused: the word is named, and the state stays.
use crate::common::{refused, run};

#[test]
fn what_is_not_supported_is_refused_by_name() {
    for word in [
        "G18", "G19", "G17.1", "G5", "G5.1", "G28.1", "G30", "G30.1", "G33", "G38.2", "G41", "G42",
        "G43", "G43.1", "G59.1", "G73", "G76", "G81", "G89", "G92.2", "G92.3", "G95", "G96", "G97",
        "G98", "G99", "G7", "G8", "G29", "G100", "M48", "M60", "M98", "M99", "M100", "M106",
        "M3.1", "G1.1", "G999999", "M999999", "T1.5", "B1", "C1", "D1", "E1", "H1", "Q1", "U1",
        "V1", "W1", "K1", "Z1", "L1", "P1", "I1", "J1", "R1",
    ] {
        let fault = refused(&format!("G0 G91 F60\n{word}"));
        assert_eq!(fault.word, word);
        assert_eq!(
            refused(&format!("G91 F60\nG20 F5 M3 S7 G55 {word}")).word,
            word
        );
        assert_eq!(refused(&format!("G20 F5 {word} G55 X5")).word, word);
    }
}

#[test]
fn reasons_say_what_would_do() {
    for (text, hint) in [
        ("G18", "G17"),
        ("G41", "G40"),
        ("G43", "G49"),
        ("G81 X1", "G0 and G1"),
        ("G5 X1", "G2"),
        ("M98 P1", "subprograms"),
        ("G30", "G28"),
        ("#1=5", "parameters"),
        ("G0 X#1", "parameters"),
        ("G0 X[1+2]", "expressions"),
        ("O100 sub", "O words"),
        ("o1 X5", "O words"),
        ("G1 X1e3 F1", "no exponent; write X1000"),
        ("G1 X-1.5E-2 F1", "no exponent; write X-0.015"),
        ("G1 (a) X1e400 (b)", "beyond 1,000,000"),
        ("G1 X1e+4000000000 F1", "beyond 1,000,000"),
        ("G1X1Y2e1", "write Y20"),
        ("G1 X1 E5 F1", "extruder"),
        ("G0 B5", "X, Y and A"),
    ] {
        let fault = refused(text);
        assert!(fault.reason.contains(hint), "{text}: {fault}");
    }
    assert_eq!(refused("G1 X1e3").word, "X1e3");
    assert_eq!(refused("G1 X1 E3").word, "E3");
    assert_eq!(
        refused("G0 X1\nG18").to_string(),
        format!("2: G18: {}", refused("G18").reason)
    );
}

#[test]
fn codes_of_one_modal_group_exclude_each_other() {
    for text in [
        "G0 G1 X1 F1",
        "G1 G1 X1 F1",
        "G2 G3 I1 F1",
        "G80 G80",
        "G90 G91",
        "G90.1 G91.1",
        "G93 G94",
        "G20 G21",
        "G54 G55",
        "G61 G64",
        "G61 G61.1",
        "G17 G17",
        "G40 G40",
        "G4 G53 P1 X1",
        "G92 G28 X1",
        "G10 G92.1 L2 P1 X1",
        "M3 M4",
        "M4 M5",
        "M7 M8",
        "M0 M2",
        "M2 M30",
    ] {
        let fault = refused(text);
        assert!(fault.reason.contains("modal group"), "{text}: {fault}");
        assert_eq!(fault.word, text.split(' ').nth(1).unwrap());
    }
    // One of each group in one line.
    run("G0 G17 G21 G90 G91.1 G94 G40 G49 G54 G64 M3 M8 S1 F1 T1 X1");
}

#[test]
fn a_letter_stands_once() {
    for text in ["G0 X1 X2", "G0 X1 x1", "G1 X1 F1 F1", "S1 S2", "G4 P1 P1"] {
        assert!(refused(text).reason.contains("already"), "{text}");
    }
}

#[test]
fn absurd_values_are_refused() {
    for text in [
        "G0 X1000001",
        "G0 X-1000000.5",
        "G4 P9999999",
        &format!("G0 X{}", "9".repeat(400)),
    ] {
        assert!(refused(text).reason.contains("1,000,000"), "{text}");
    }
    run("G0 X1000000 Y-1000000");
    refused(&format!("G{}", "9".repeat(400)));
}

#[test]
fn sums_that_go_too_far_are_refused() {
    let mut interpreter = run("G91").0;
    // Each line goes a kilometre.
    let refused = (1..2000).find(|number| interpreter.line(*number, "G0 X1000000").is_err());
    assert_eq!(refused, Some(1001));
}

#[test]
fn junk_is_refused_and_not_skipped() {
    for text in [
        "G0 X",
        "G0 X-",
        "G0 X+",
        "G0 X--1",
        "G0 X+-1",
        "G0 X.",
        "G0 X1.2.3",
        "G0 X1..2",
        "G0 X1-2",
        "G0 X1 5 - 3",
        "G",
        "M",
        "T",
        "G X1",
        "G-1",
        "G+0",
        "G1.",
        "G91.01",
        "G91.10",
        "G91.11",
        "G.1",
        "0 X1",
        "X",
        "5",
        "-5",
        "+",
        ".",
        "G0 X1 $",
        "$H",
        "?",
        "!",
        "~",
        "G0,X1",
        "G0=X1",
        "G0 X1:",
        "G0 X1 é",
        "é",
        "G0 X\u{ff11}",
        "G0\u{a0}X1",
        "G0 X1\0",
        "\0",
        "G0 X1\nG0 X2",
        "G0 X1\u{2212}5",
        "G0 X1 @",
        "\"G0\"",
        "G0 X1\\",
        "[G0]",
        "<a>",
        "G0 X1 ^ 2",
        "G0\rX1",
        "G429496730",
        "G4294967296",
        "M429496730",
        "T429496730",
        "T99999999999999999999",
        "X1 G0 Y",
        "G0 X1 'a'",
    ] {
        let mut interpreter = run("G91").0;
        let before = crate::common::observable(&interpreter);
        let fault = interpreter.line(7, text).expect_err(text);
        assert_eq!(fault.fault.line, 7);
        assert_eq!(crate::common::observable(&interpreter), before, "{text}");
    }
}

#[test]
fn a_long_word_is_cut_in_the_refusal() {
    let fault = refused(&format!("G0 X{}", "1".repeat(900)));
    assert!(fault.word.len() < 50, "{fault}");
}

/// The kinds tell programs what is wrong; a number with a comma is told as it was meant.
#[test]
fn refusals_have_kinds() {
    use trirrr_toolpath::gcode::RefusalKind as Kind;
    for (text, kind) in [
        ("1", Kind::Letter),
        ("G0 X", Kind::Number),
        ("S-1", Kind::Negative),
        ("G41", Kind::Unsupported),
        ("G20 G21", Kind::ModalGroup),
        ("G1 X1", Kind::NoFeed),
        ("M3.5", Kind::NotWhole),
        ("G1 G92 X1", Kind::AxisConflict),
        ("S1 S2", Kind::Repeated),
        ("G92", Kind::NoAxes),
        ("N10000001", Kind::LineNumber),
        ("G4", Kind::MissingWord),
        ("G10 L2 P7 X1", Kind::NoSystem),
        ("G53 G2 X1 I1 F1", Kind::FixedFrame),
        ("G80\nX1", Kind::NoMotionMode),
        ("G2 X10 I1 F1", Kind::ArcTarget),
        ("G2 X10 R1 F1", Kind::ArcRadius),
        ("G2 X1 F1", Kind::NoCentre),
        ("G0 I1", Kind::Unused),
        ("G0 X1000001", Kind::TooLarge),
        ("G0 X20,5", Kind::Letter),
        ("G0 X,5", Kind::Number),
    ] {
        let (before, line) = text.rsplit_once('\n').unwrap_or(("", text));
        let found = run(before).0.line(2, line).expect_err(text);
        assert_eq!(found.kind, kind, "{text}: {found}");
    }
    for (text, word, meant) in [
        (
            "G1 X20,5 Y10",
            "X20,5",
            "the decimal sign is a point, not a comma: X20.5",
        ),
        ("g1 x 1 , 5 f600", "x1,5", "x1.5"),
        ("G0 Y-,25", "Y-,25", "Y-.25"),
        ("G4 P0,1", "P0,1", "P0.1"),
        ("G0 X1,234.5", "X1,234.5", "one decimal sign"),
    ] {
        let found = refused(text);
        assert_eq!(found.word, word);
        assert!(found.reason.contains(meant), "{text}: {found}");
        assert!(!found.reason.contains("remove"), "{found}");
    }
}
