//! Motions, units, distances, path modes, dwell, pauses and ends.
use crate::common::{last, motion, near, place, refused, run, run_with, same};
use trirrr_toolpath::gcode::{
    GcodeSetup, Interpreter, LengthUnit, MotionMode, PathMode, ProgramEnd, ZWords,
};
use trirrr_toolpath::{Act, ToolCurve};

#[test]
fn a_rapid_is_a_line_without_a_feed() {
    let (interpreter, elements) = run("G0 X10 Y-5 A30");
    assert_eq!(elements.len(), 1);
    assert_eq!(elements[0].line, 1);
    let motion = motion(&elements[0]);
    assert_eq!(
        (motion.curve, motion.feed_m_s, motion.stops),
        (ToolCurve::Line, None, false)
    );
    same(motion.to, place(10.0, -5.0, 30.0));
    same(interpreter.place(), place(10.0, -5.0, 30.0));
}

#[test]
fn a_line_has_the_feed_in_metres_per_second() {
    let motion = last("G1 X10 F600");
    assert_eq!(motion.curve, ToolCurve::Line);
    near(motion.feed_m_s.unwrap(), 0.01);
}

#[test]
fn axes_without_a_word_stay() {
    same(last("G0 X1 Y2 A3\nY5").to, place(1.0, 5.0, 3.0));
}

#[test]
fn the_motion_mode_holds() {
    let (_, elements) = run("G1 X1 F60\nX2\nG0\nX3\nG1\nX4");
    let feeds: Vec<_> = elements
        .iter()
        .map(|e| motion(e).feed_m_s.is_some())
        .collect();
    assert_eq!(feeds, [true, true, false, true]);
    let lines: Vec<_> = elements.iter().map(|e| e.line).collect();
    assert_eq!(lines, [1, 2, 4, 6]);
}

#[test]
fn g80_takes_the_motion_mode_away() {
    let (interpreter, _) = run("G1 X1 F60\nG80");
    assert_eq!(interpreter.modal().motion, MotionMode::None);
    assert!(
        refused("G1 X1 F60\nG80\nX2")
            .reason
            .contains("no motion code")
    );
    same(last("G80\nG0 X3").to, place(3.0, 0.0, 0.0));
}

#[test]
fn inches_hold_for_coordinates_and_feeds() {
    let motion = last("G20 G1 X2 F60 A90");
    // A stays in degrees.
    same(motion.to, place(50.8, 0.0, 90.0));
    near(motion.feed_m_s.unwrap(), 0.0254);
    assert_eq!(run("G20").0.modal().unit, LengthUnit::Inch);
}

#[test]
fn a_feed_stays_the_same_speed_when_the_unit_changes() {
    near(last("G20 G1 X1 F6\nG21 X1").feed_m_s.unwrap(), 0.00254);
}

#[test]
fn incremental_words_add_to_the_place() {
    same(
        last("G0 X10 Y10 A10\nG91\nX-3 A5\nX-3 Y1").to,
        place(4.0, 11.0, 15.0),
    );
    same(last("G91 G0 X1\nG90 X1.5").to, place(1.5, 0.0, 0.0));
}

#[test]
fn modes_of_a_line_hold_for_its_own_words() {
    // The order of the words does not matter.
    same(last("X1 G20 G0\nX1 G91").to, place(50.8, 0.0, 0.0));
}

#[test]
fn exact_modes_stop_and_blending_does_not() {
    let stops = |text| last(text).stops;
    assert!(!stops("G1 F60 X1"));
    assert!(stops("G61 G1 F60 X1"));
    assert!(stops("G61.1 G1 F60 X1"));
    assert!(!stops("G61 G1 F60 X1\nG64 X2"));
    assert!(stops("G61\nG0 X1"));
    assert_eq!(run("G61.1").0.modal().path, PathMode::ExactStop);
}

#[test]
fn the_tolerance_of_g64_is_a_length() {
    let blend = |text| run(text).0.modal().blend_m;
    assert_eq!(blend("G64"), None);
    near(blend("G64 P0.05").unwrap(), 0.05e-3);
    near(blend("G20 G64 P0.001").unwrap(), 0.0254e-3);
    assert_eq!(blend("G64 P0"), Some(0.0));
    assert_eq!(blend("G64 P1\nG61"), None);
    assert_eq!(blend("G64 P1\nG64"), None);
    refused("G64 P-1");
}

#[test]
fn a_dwell_stands_for_seconds_before_the_motion_of_its_line() {
    let (_, elements) = run("G4 P0.25\nG4 P0\nG1 X1 F60 G4 P2");
    let acts: Vec<_> = elements.iter().map(|e| e.act).collect();
    assert_eq!(acts.len(), 3);
    assert_eq!(acts[0], Act::Dwell { seconds: 0.25 });
    assert_eq!(acts[1], Act::Dwell { seconds: 2.0 });
    assert!(matches!(acts[2], Act::Motion(_)));
    assert!(refused("G4").reason.contains('P'));
    refused("G4 P-1");
    refused("G4 X1");
}

#[test]
fn m0_and_m1_pause_behind_the_motion() {
    for code in ["M0", "M1", "M00"] {
        let (_, elements) = run(&format!("{code} G0 X1"));
        assert!(matches!(elements[0].act, Act::Motion(_)));
        assert_eq!((elements[1].act, elements.len()), (Act::Pause, 2));
    }
}

#[test]
fn m2_and_m30_end_the_program_and_reset_modes() {
    for (code, end) in [
        ("M2", ProgramEnd::M2),
        ("m30", ProgramEnd::M30),
        ("M02", ProgramEnd::M2),
    ] {
        let mut interpreter = run("G20 G91 G55 G61 M3 S10 G0 F1\nG92 X1").0;
        let work = interpreter.line(3, &format!("{code} X1")).unwrap();
        assert_eq!(work.end, Some(end));
        // Incremental inches held up to the end: 1 in.
        assert_eq!(work.elements.len(), 1);
        same(interpreter.place(), place(25.4, 0.0, 0.0));
        assert_eq!(
            interpreter.modal().to_string(),
            "G1 G54 G17 G20 G90 G94 M5 M9 T0 F1 S10"
        );
        assert_eq!(interpreter.modal().path, PathMode::ExactPath);
        near(interpreter.shift().position_m[0], -0.0254);
    }
}

#[test]
fn the_report_of_modes_is_that_of_grbl() {
    let report = |text| run(text).0.modal().to_string();
    assert_eq!(report(""), "G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0");
    assert_eq!(
        report("G1 G59 G91 M4 S12.5 F1500 T1"),
        "G1 G59 G17 G21 G91 G94 M4 M9 T1 F1500 S12.5"
    );
    assert_eq!(
        report("G20 G93 M3 G80 S1"),
        "G80 G54 G17 G20 G90 G93 M3 M9 T0 F0 S1"
    );
    assert_eq!(
        report("F100\nG20"),
        "G0 G54 G17 G20 G90 G94 M5 M9 T0 F3.937008 S0"
    );
}

#[test]
fn words_without_an_effect_are_accepted() {
    let (interpreter, elements) = run("G17 G40 G49\nM7\nM8\nM9\nT0\nT1\nG94 G91.1\nG21");
    assert!(elements.is_empty());
    assert_eq!(interpreter.modal().tool, 1);
}

#[test]
fn a_line_that_goes_nowhere_gives_no_element() {
    assert!(run("G0 X0 Y0 A0\nG1 X0 F60\nG91 X0").1.is_empty());
    assert_eq!(run("G0 X10\nX10\nY1").1.len(), 2);
}

#[test]
fn reset_keeps_place_and_zero_points() {
    let mut interpreter = run("G0 X10\nG10 L2 P2 X5\nG92 X1\nG91 G20 G55 M3 S5 F3").0;
    interpreter.reset();
    assert_eq!(
        interpreter.modal(),
        Interpreter::new(GcodeSetup::default()).modal()
    );
    same(interpreter.place(), place(10.0, 0.0, 0.0));
    same(interpreter.origin(1), place(5.0, 0.0, 0.0));
    same(interpreter.shift(), place(0.0, 0.0, 0.0));
}

#[test]
fn z_words_have_no_effect_if_the_setup_says_so() {
    let setup = || GcodeSetup {
        z: ZWords::Ignored,
        home: Some(place(1.0, 1.0, 0.0)),
        ..GcodeSetup::default()
    };
    let (interpreter, elements) = run_with(
        setup(),
        "G0 Z5\nG1 X1 Z-1 F60\nG92 Z0\nG10 L20 P1 Z0\nG91 G28 Z0\nG53 G90 G0 Z1",
    );
    assert_eq!(elements.len(), 1);
    same(interpreter.place(), place(1.0, 0.0, 0.0));
    same(
        interpreter.work_place(interpreter.place()),
        place(1.0, 0.0, 0.0),
    );
    let fault = refused("G0 X1 Z5");
    assert!(fault.reason.contains("--ignore-z") && fault.reason.contains("--tool-by-z"));
}
