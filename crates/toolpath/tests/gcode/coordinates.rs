//! Work coordinates: G53 to G59, G10, G92, G28.
use crate::common::{last, motion, place, refused, refused_with, run, run_with, same};
use trirrr_toolpath::gcode::{GcodeSetup, Interpreter};

fn setup() -> GcodeSetup {
    let mut setup = GcodeSetup {
        start: place(10.0, 20.0, 5.0),
        ..GcodeSetup::default()
    };
    setup.origins[0] = place(1.0, 2.0, 3.0);
    setup.origins[5] = place(-60.0, -70.0, -80.0);
    setup
}

#[test]
fn coordinates_count_from_the_zero_point() {
    let (interpreter, elements) = run_with(setup(), "G0 X1 Y1 A1\nG59 X1\nG54 Y0");
    let places: Vec<_> = elements.iter().map(|element| motion(element).to).collect();
    same(places[0], place(2.0, 3.0, 4.0));
    same(places[1], place(-59.0, 3.0, 4.0));
    same(places[2], place(-59.0, 2.0, 4.0));
    same(
        interpreter.work_place(interpreter.place()),
        place(-60.0, 0.0, 1.0),
    );
}

#[test]
fn each_of_g54_to_g59_has_its_zero_point() {
    for (index, code) in (0..6).zip(54..) {
        let number = index + 1;
        let text = format!("G10 L2 P{number} X{number} Y-{number}\nG{code} G0 X0 Y0");
        let (interpreter, _) = run(&text);
        same(
            interpreter.place(),
            place(number as f64, -(number as f64), 0.0),
        );
        assert_eq!(interpreter.modal().origin, index);
    }
}

#[test]
fn g10_l2_sets_the_named_axes_of_a_zero_point() {
    let (interpreter, elements) = run_with(setup(), "G20\nG10 L2 P1 X1\nG10 L2 P1 A90");
    assert!(elements.is_empty());
    same(interpreter.origin(0), place(25.4, 2.0, 90.0));
    same(interpreter.place(), place(10.0, 20.0, 5.0));
    // P0 is the active system; G91 does not matter.
    same(
        run_with(setup(), "G91 G59\nG10 L2 P0 Y1").0.origin(5),
        place(-60.0, 1.0, -80.0),
    );
}

#[test]
fn g10_l20_gives_the_place_coordinates() {
    let (interpreter, _) = run_with(setup(), "G10 L20 P1 X0 Y5\nG10 P3 L20 A0");
    same(interpreter.origin(0), place(10.0, 15.0, 3.0));
    same(
        interpreter.work_place(interpreter.place()),
        place(0.0, 5.0, 2.0),
    );
    same(interpreter.origin(2), place(0.0, 0.0, 5.0));
}

#[test]
fn g92_shifts_all_systems() {
    let (mut interpreter, _) = run_with(setup(), "G92 X100 A0");
    // The place stays, its coordinates are those of the words: 10 = 1 + shift + 100.
    same(interpreter.place(), place(10.0, 20.0, 5.0));
    same(interpreter.shift(), place(-91.0, 0.0, 2.0));
    same(
        interpreter.work_place(interpreter.place()),
        place(100.0, 18.0, 0.0),
    );
    interpreter.line(2, "G0 X101 Y18 A0").unwrap();
    same(interpreter.place(), place(11.0, 20.0, 5.0));
    interpreter.line(3, "G55 X0").unwrap();
    same(interpreter.place(), place(-91.0, 20.0, 5.0));
    interpreter.line(4, "G92.1").unwrap();
    same(interpreter.shift(), place(0.0, 0.0, 0.0));
    same(interpreter.place(), place(-91.0, 20.0, 5.0));
}

#[test]
fn a_second_g92_counts_from_the_same_zero_point() {
    let (interpreter, _) = run("G0 X10\nG92 X0\nG0 X5\nG92 Y3");
    same(interpreter.shift(), place(10.0, -3.0, 0.0));
    let (interpreter, _) = run("G0 X10\nG92 X0\nG0 X5\nG92 X0");
    same(interpreter.shift(), place(15.0, 0.0, 0.0));
}

#[test]
fn l20_counts_the_shift_of_g92() {
    // 10 = origin + 7 + 2, so the origin is 1.
    let (interpreter, _) = run("G0 X10\nG92 X3\nG10 L20 P1 X2");
    same(interpreter.shift(), place(7.0, 0.0, 0.0));
    same(interpreter.origin(0), place(1.0, 0.0, 0.0));
    same(
        interpreter.work_place(interpreter.place()),
        place(2.0, 0.0, 0.0),
    );
}

#[test]
fn g92_1_leaves_the_axis_words_to_the_motion() {
    same(last("G0 X10\nG92 X0\nG92.1 X1").to, place(1.0, 0.0, 0.0));
}

#[test]
fn g53_holds_for_its_line_alone() {
    let (interpreter, elements) = run_with(setup(), "G92 X0\nG53 G0 X10 Y1\nG1 G53 F60 A10\nX0");
    let places: Vec<_> = elements.iter().map(|element| motion(element).to).collect();
    // X10 in the fixed frame is the start: only y moves.
    same(places[0], place(10.0, 1.0, 5.0));
    same(places[1], place(10.0, 1.0, 10.0));
    assert_eq!(places.len(), 2, "x is zero of the shift already");
    same(interpreter.place(), place(10.0, 1.0, 10.0));
    for text in [
        "G2 G53 X1 I1 F1",
        "G91 G53 X1",
        "G80 G53 X1",
        "G1 X1 F60\nG3 X2 I0.5\nG53 X1",
    ] {
        assert_eq!(refused(text).word, "G53", "{text}");
    }
}

#[test]
fn g28_goes_home_by_the_intermediate_point() {
    let setup = || GcodeSetup {
        home: Some(place(1.0, 2.0, 3.0)),
        ..setup()
    };
    let places = |text: &str| -> Vec<_> {
        run_with(setup(), text)
            .1
            .iter()
            .map(|e| motion(e).to)
            .collect()
    };
    let all = places("G28");
    assert_eq!(all.len(), 1);
    same(all[0], place(1.0, 2.0, 3.0));
    // X5 is 6 mm in the fixed frame; y and alpha stay.
    let one = places("M3 S9 G1 F60\nG28 X5");
    same(one[0], place(6.0, 20.0, 5.0));
    same(one[1], place(1.0, 20.0, 5.0));
    assert_eq!(one.len(), 2);
    // The usual form: the intermediate point is the place itself.
    let usual = places("G91 G28 X0 Y0");
    assert_eq!(usual.len(), 1);
    same(usual[0], place(1.0, 2.0, 5.0));
    let (_, elements) = run_with(setup(), "M3 S9 G1 F60\nG28 X5");
    assert!(
        elements
            .iter()
            .all(|e| e.tool.is_none() && motion(e).feed_m_s.is_none())
    );
    assert_eq!(refused("G28").word, "G28");
    refused_with(setup(), "G28 G0 X1");
}

#[test]
fn axis_words_go_to_one_code() {
    for text in ["G10 L2 P1 G0 X1", "G92 G1 X1 F1", "G92 G2 X1 I1"] {
        assert!(refused(text).reason.contains("line of its own"), "{text}");
    }
    for text in [
        "G92",
        "G10 L2 P1",
        "G10 L3 P1 X1",
        "G10 P1 X1",
        "G10 L2 X1",
        "G10 L2 P7 X1",
        "G10 L2 P1.5 X1",
    ] {
        refused(text);
    }
    refused("G10 L2 P1 X1 R5");
}

#[test]
fn places_can_be_set_from_outside() {
    let mut interpreter = Interpreter::new(setup());
    interpreter.set_place(place(3.0, 4.0, 5.0));
    interpreter.set_origin(1, place(1.0, 1.0, 1.0));
    interpreter.set_origin(6, place(9.0, 9.0, 9.0));
    same(interpreter.place(), place(3.0, 4.0, 5.0));
    same(interpreter.origin(1), place(1.0, 1.0, 1.0));
    same(interpreter.origin(5), place(-60.0, -70.0, -80.0));
    interpreter.line(1, "G91 G0 X1").unwrap();
    same(interpreter.place(), place(4.0, 4.0, 5.0));
    interpreter.set_place(place(f64::NAN, 0.0, 0.0));
    assert!(interpreter.line(2, "G0 Y1").is_err());
    interpreter
        .line(3, "G90 G0 X1 Y1 A1")
        .expect_err("the place that it starts from is not known");
}
