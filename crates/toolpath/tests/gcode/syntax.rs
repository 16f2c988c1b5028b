//! Text of lines: white space, case, comments, numbers, checksums, block delete, `%`.
use crate::common::{last, near, place, refused, run, same};
use trirrr_toolpath::gcode::{GcodeSetup, Interpreter, LineWork, ProgramEnd};

fn line(text: &str) -> LineWork {
    Interpreter::new(GcodeSetup::default())
        .line(1, text)
        .unwrap()
}

#[test]
fn white_space_and_case_do_not_matter() {
    for text in [
        "g0x1y-2a3",
        "G0 X1 Y-2 A3",
        " G 0 X 1 . 0 Y - 2 A 3 ",
        "g00\tX+1\tY-2.\tA+3.00\r",
        "G0.0 X1Y-2A3",
    ] {
        same(last(text).to, place(1.0, -2.0, 3.0));
    }
}

#[test]
fn numbers_have_all_their_digits() {
    same(last("G0 X.5 Y-.25").to, place(0.5, -0.25, 0.0));
    // 32-bit floats of the parser would give 12.345679 and 0.1 with an error of 1e-9.
    assert_eq!(last("G0 X12.3456789").to.position_m[0], 12.3456789 / 1000.0);
    assert_eq!(last("G0 X0.1").to.position_m[0], 0.1 / 1000.0);
    near(
        last("G0 X0000000012.0000000000000000001").to.position_m[0],
        0.012,
    );
}

#[test]
fn line_numbers_have_no_effect() {
    same(last("N10 G0 X1").to, place(1.0, 0.0, 0.0));
    same(last("N1.5 G0 X1").to, place(1.0, 0.0, 0.0));
    assert!(run("N1\nn99999\nO1000\n:12 (name)").1.is_empty());
    for text in [
        "G0 N1 X1",
        "X1 N1",
        "N-1",
        "N",
        "N1 N2 G0 X1",
        "N99999999999",
    ] {
        refused(text);
    }
}

#[test]
fn comments_are_left_out() {
    same(
        last("G0 (a) X1 (b; c *) Y2 ; d (e").to,
        place(1.0, 2.0, 0.0),
    );
    same(last("G(in a word)0 X1(or)0").to, place(10.0, 0.0, 0.0));
    assert_eq!(line("(no message)"), LineWork::default());
    assert_eq!(line("; (MSG, not one)"), LineWork::default());
    for text in ["G0 X1 (open", "G0 X1 close)", "G0 X1 (a (b) c)"] {
        refused(text);
    }
}

#[test]
fn messages_are_handed_out() {
    assert_eq!(
        line("(MSG, turn the glass)").message.unwrap(),
        "turn the glass"
    );
    let work = line("G0 X1 ( msg ,a, b) (c)");
    assert_eq!(
        (work.message.as_deref(), work.elements.len()),
        (Some("a, b"), 1)
    );
    assert_eq!(line("(MESSAGE, no)").message, None);
}

#[test]
fn checksums_are_checked() {
    // Exclusive or of the bytes of "N3 T0" is 57, an example of RepRap's documentation.
    run("N3 T0*57");
    run("N3 T0*57 ; comment");
    run("N3 T0 * 25");
    // Comments count: 71 ^ 48 ^ 32 ^ 88 ^ 49 is 62, and 40 ^ 97 ^ 41 is 96.
    run("G0 X1*62");
    run("G0 X1(a)*94");
    assert!(refused("N3 T0*58").reason.contains("57"));
    for text in [
        "N3 T0*",
        "N3 T0*x",
        "N3 T0*57 X1",
        "N3 T0*-57",
        "N3 T0*313",
        "N3 T0*57*57",
        "*1",
    ] {
        refused(text);
    }
    assert!(run("*0").1.is_empty());
}

#[test]
fn a_deleted_block_is_left_out() {
    assert!(run("/G0 X1\n / what ever # it says").1.is_empty());
    assert_eq!(refused("G0 / X1").word, "/");
}

#[test]
fn percent_opens_and_ends_a_program() {
    let mut interpreter = Interpreter::new(GcodeSetup::default());
    let mut end = |text: &str| interpreter.line(1, text).unwrap().end;
    let percent = Some(ProgramEnd::Percent);
    assert_eq!(end("%"), None);
    assert_eq!(end("(comment)"), None);
    assert_eq!(end("G0 X1"), None);
    assert_eq!(end(" % "), percent);
    // The next program is closed by M2: the percent behind it neither ends nor opens.
    assert_eq!(end("%"), None);
    assert_eq!(end("G0 X2"), None);
    assert_eq!(end("M2"), Some(ProgramEnd::M2));
    assert_eq!(end("%"), None);
    assert_eq!(end("%"), None);
    assert_eq!(end("G0 X1"), None);
    assert_eq!(end("%"), percent);
    assert_eq!(end("%O0001 part 7"), None);
    assert_eq!(end("G0 X1"), None);
    assert_eq!(end("%_N_part_MPF (a)"), percent);
    refused("% G0 X1");
    refused("%G0X1");
    refused("G0 X1 %");
}

#[test]
fn empty_lines_hold_nothing() {
    for text in ["", "   ", "\r", "\t", "N5", ";", "()"] {
        assert_eq!(line(text), LineWork::default(), "{text:?}");
    }
}

#[test]
fn words_may_stand_in_any_order() {
    let a = run("F60 X1 G1 S10 M3").1;
    assert_eq!(a, run("M3 S10 G1 X1 F60").1);
    assert_eq!(a.len(), 1);
}

#[test]
fn the_words_of_a_line_have_a_thousand_bytes() {
    let longest = format!("G0 X{}1", "0".repeat(996));
    assert_eq!(run(&longest).1.len(), 1);
    assert!(
        refused(&longest.replace("X0", "X00"))
            .reason
            .contains("1,000")
    );
    assert_eq!(run(&format!("G0 X1;{}", "c".repeat(5000))).1.len(), 1);
}

/// Lines for a controller are named as such.
#[test]
fn lines_of_senders_are_named() {
    for text in [
        "$H",
        "$$",
        "?",
        "!",
        "~",
        "$J=G91 X1 F100",
        " $X",
        "$30=1000",
    ] {
        assert!(refused(text).reason.contains("`trirrr grbl`"), "{text}");
    }
}
