//! Laser: M3, M4, M5, S.
use crate::common::{refused, refused_with, run, run_with};
use trirrr_toolpath::ToolWork;
use trirrr_toolpath::gcode::GcodeSetup;

fn tools(text: &str) -> Vec<Option<ToolWork>> {
    run(text).1.iter().map(|element| element.tool).collect()
}

fn constant(power: f64) -> Option<ToolWork> {
    Some(ToolWork {
        power,
        follows_speed: false,
    })
}

fn following(power: f64) -> Option<ToolWork> {
    Some(ToolWork {
        power,
        follows_speed: true,
    })
}

#[test]
fn power_is_the_part_of_full_power() {
    assert_eq!(tools("M3 S250 G1 X1 F60"), [constant(0.25)]);
    assert_eq!(tools("M4 S1000 G2 X1 R5 F60"), [following(1.0)]);
    let setup = GcodeSetup {
        full_power: 255.0,
        ..GcodeSetup::default()
    };
    assert_eq!(run_with(setup, "M3 S51 G1 X1 F60").1[0].tool, constant(0.2));
}

#[test]
fn power_above_full_is_full_power() {
    assert_eq!(tools("M3 S1001 G1 X1 F60"), [constant(1.0)]);
    assert_eq!(run("S5000").0.modal().s, 1000.0);
    assert_eq!(refused("S-1").word, "S-1");
    for full_power in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            refused_with(
                GcodeSetup {
                    full_power,
                    ..GcodeSetup::default()
                },
                "S1"
            )
            .word,
            "S1"
        );
    }
}

#[test]
fn the_tool_is_off_in_rapids_and_without_power() {
    assert_eq!(
        tools("M3 S500 G0 X1\nG1 X2 F60\nG0 X3\nG1 X4 S0\nX5 S5\nM5\nX6"),
        [None, constant(0.5), None, None, constant(0.005), None]
    );
    assert_eq!(tools("S500 G1 X1 F60"), [None]);
}

#[test]
fn a_change_of_the_laser_holds_in_its_own_line() {
    assert_eq!(
        tools("M3 S100 G1 X1 F60\nX2 M5\nX3 M4\nX4 S200"),
        [constant(0.1), None, following(0.1), following(0.2)]
    );
}

#[test]
fn m3_stays_on_in_a_dwell_between_cuts_and_m4_does_not() {
    assert_eq!(tools("G1 F60 M3 S100\nG4 P1"), [constant(0.1)]);
    assert_eq!(tools("G1 F60 M4 S100\nG4 P1"), [None]);
    // In the mode of rapids GRBL has the laser off.
    assert_eq!(tools("G0 M3 S100\nG4 P1"), [None]);
    assert_eq!(tools("G1 M3 S100\nM5\nG4 P1"), [None]);
}

#[test]
fn a_turn_on_the_spot_is_like_a_dwell() {
    assert_eq!(tools("G1 F60 M3 S100 A5\nM4 A10"), [constant(0.1), None]);
}

#[test]
fn the_tool_is_off_in_a_pause() {
    assert_eq!(tools("G1 F60 M3 S100 X1 M0"), [constant(0.1), None]);
}

/// The first tool is mounted; for another one the program waits, and says for which.
#[test]
fn tools_are_changed_by_the_user() {
    use trirrr_toolpath::gcode::elements;
    use trirrr_toolpath::{Act, PathRemark};
    for (text, waits) in [
        ("T1 M6\nG1 X1 F60", &[][..]),
        ("M6 T201\nG1 X1 F60\nM6 T201", &[]),
        ("T2\nG1 X1 F60", &[]),
        ("M6\nT0 M6\nG1 X1 F60\nM6 T0", &[]),
        (
            "T4 M6\nG1 X1 F60\nT5 M6 (6 mm end mill)\nX2\nT5 M6",
            &[(3, "change to tool 5 (6 mm end mill)")],
        ),
        (
            "G1 T1 X1 F60\n; a fine pen\nN5 M6 T2\nX2\nM6 T1",
            &[
                (3, "change to tool 2 (a fine pen)"),
                (5, "change to tool 1"),
            ],
        ),
    ] {
        let mut file = elements(text.as_bytes(), GcodeSetup::default());
        let pauses = file
            .by_ref()
            .map(Result::unwrap)
            .filter(|each| each.act == Act::Pause);
        let lines: Vec<u32> = pauses.map(|each| each.line).collect();
        assert_eq!(
            lines,
            waits.iter().map(|(line, _)| *line).collect::<Vec<_>>(),
            "{text}"
        );
        let told = waits
            .iter()
            .map(|(line, text)| PathRemark::new(*line, *text));
        assert_eq!(file.remarks().remarks, told.collect::<Vec<_>>());
    }
    assert_eq!(refused("T1.5").word, "T1.5");
}
