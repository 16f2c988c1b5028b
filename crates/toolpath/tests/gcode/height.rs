//! Words of Z: refused, without effect, or the tool.
use crate::common::{near, refused_with, run_with};
use trirrr_toolpath::gcode::{GcodeSetup, ZWords, elements};
use trirrr_toolpath::{Act, Element, ToolCurve, ToolPlace};

fn setup(z: ZWords) -> GcodeSetup {
    GcodeSetup {
        z,
        home: Some(ToolPlace::default()),
        ..GcodeSetup::default()
    }
}

fn by_z(on_at_mm: f64) -> GcodeSetup {
    setup(ZWords::Tool {
        on_at_m: 1e-3 * on_at_mm,
    })
}

/// Ends of motions in x, mm, with the power there; the powers of stands with `None`.
fn course(setup: GcodeSetup, text: &str) -> Vec<(Option<f64>, f64)> {
    let at = |element: &Element| match element.act {
        Act::Motion(motion) => Some((motion.to.position_m[0] * 1e9).round() / 1e6),
        _ => None,
    };
    let power = |element: &Element| element.tool.map_or(0.0, |tool| tool.power);
    run_with(setup, text)
        .1
        .iter()
        .map(|each| (at(each), power(each)))
        .collect()
}

fn powers(setup: GcodeSetup, text: &str) -> Vec<f64> {
    course(setup, text)
        .into_iter()
        .map(|(_, power)| power)
        .collect()
}

#[test]
fn z_switches_the_tool() {
    let tool = |text| powers(by_z(0.0), text);
    // Travel at a feed, as of CAM that has no rapids.
    assert_eq!(
        tool("M3 S1000\nG0 X0.1 Y0\nG1 Z-1 F200\nX10 F500\nZ3\nX20\nZ-1\nX30\nM5"),
        [0.0, 1.0, 0.0, 1.0]
    );
    // A pen has no M3 and no S.
    assert_eq!(
        tool("G0 X1\nG0 Z0\nG0 X2\nG1 X3 F60\nG0 Z0.001\nX4"),
        [0.0, 1.0, 1.0, 0.0]
    );
    // M5 and S0 have it off, once there is M3 or S.
    assert_eq!(
        tool("M5\nG1 Z-1 F60\nX1\nM3 S500\nX2\nM5\nX3\nM3 S0\nX4"),
        [1.0, 0.5, 0.0, 0.0]
    );
    // In a dwell as in a motion; M4 is off there.
    assert_eq!(
        tool("G0 Z-1\nG4 P1\nG0 Z1\nG4 P1\nM4 S10\nZ-1\nG4 P1"),
        [1.0, 0.0, 0.0]
    );
    assert_eq!(powers(by_z(2.0), "G1 Z2 F60\nX1\nZ2.1\nX2"), [1.0, 0.0]);
    assert_eq!(powers(by_z(-0.5), "G1 Z0 F60\nX1\nZ-.5\nX2"), [0.0, 1.0]);
    // Inches, distances, zero points, arcs.
    assert_eq!(
        powers(by_z(25.0), "G20 G1 Z1 F60\nX1\nG91 Z-.1\nX1"),
        [0.0, 1.0]
    );
    assert_eq!(tool("G91 G1 Z-1 F60\nX1\nZ2\nX1\nZ-1\nX1"), [1.0, 0.0, 1.0]);
    assert_eq!(
        tool("G0 Z-5\nG92 Z1\nG0 X1\nG10 L20 P1 Z0\nX2\nG54 Z.1\nX3"),
        [0.0, 1.0, 0.0]
    );
    assert_eq!(
        tool("G2 X2 I1 Z-1 F60\nG2 X0 I-1\nG0 Z1\nG3 X2 R1"),
        [0.0, 1.0, 0.0]
    );
    // Before the first height, at home and in the fixed frame it is off.
    assert_eq!(
        tool("G0 X1\nG92 Z0\nX2\nZ0\nX3\nG28 G91 Z0\nG90 X4"),
        [0.0, 0.0, 1.0, 0.0]
    );
    assert_eq!(tool("G0 Z-1\nX1\nG53 G0 Z-1\nX2"), [1.0, 0.0]);
    assert_eq!(tool("G0 Z-1\nX1 M0\nX2"), [1.0, 0.0, 1.0]);
}

#[test]
fn ramps_switch_the_tool_where_they_cross_the_height() {
    let steps = course(by_z(0.0), "G0 Z3\nG1 X4 Z-1 F60\nX0 Z1\nX8 Z1\nX12 Z0\nX13");
    let (at, on): (Vec<_>, Vec<_>) = steps.into_iter().unzip();
    assert_eq!(
        at.into_iter().flatten().collect::<Vec<_>>(),
        [3.0, 4.0, 2.0, 0.0, 8.0, 12.0, 13.0]
    );
    assert_eq!(on, [0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    // A helix, cut at a third of its turn: each part is an arc about the same centre.
    let (_, elements) = run_with(by_z(0.0), "G0 Z1\nG2 X0 Y0 I5 J0 Z-2 F60");
    let turns: Vec<f64> = elements
        .iter()
        .map(|element| match element.act {
            Act::Motion(motion) => match motion.curve {
                ToolCurve::Arc { turn_rad, centre_m } => {
                    near(centre_m[0], 0.005);
                    turn_rad.to_degrees()
                }
                curve => panic!("{curve:?}"),
            },
            act => panic!("{act:?}"),
        })
        .collect();
    near(turns[0], -120.0);
    near(turns[1], -240.0);
    assert!(elements[0].tool.is_none() && elements[1].tool.is_some());
}

/// Arcs of G18 and G19 are lines from above: lead-ins of CAM.
#[test]
fn arcs_across_the_plane_are_lines() {
    // A quarter down and a quarter along: from 0,2 about 2,2 to 2,0.
    let text = "G0 Z2\nG18 G2 X2 Z0 I2 K0 J9 F60\nG17 G1 X4";
    for z in [ZWords::Ignored, ZWords::Tool { on_at_m: 0.0 }] {
        let (_, elements) = run_with(setup(z), text);
        assert_eq!(elements.len(), 2, "{elements:?}");
    }
    // Half a turn from above to above dips below 0 between: off, on, off.
    let arc = "G0 Z1\nG18 G2 X4 Z1 R2 F60";
    let steps = course(by_z(0.0), arc);
    let half = 1e3 * (2.0 - 3f64.sqrt()) / 1e3;
    assert_eq!(steps.len(), 3, "{steps:?}");
    near(steps[0].0.unwrap(), (half * 1e6).round() / 1e6);
    assert_eq!(
        steps.iter().map(|step| step.1).collect::<Vec<_>>(),
        [0.0, 1.0, 0.0]
    );
    // More than half a turn goes beyond its ends and back.
    let ends: Vec<f64> = course(
        setup(ZWords::Ignored),
        "G0 Z0\nG19 G2 Y0 Z2 J0 K1 F60\nG18 G2 X1 Z1 K-1 F60",
    )
    .into_iter()
    .filter_map(|(x, _)| x)
    .collect();
    assert_eq!(ends, [0.0, 0.0, -1.0, 1.0]);
    assert!(
        refused_with(by_z(0.0), "G18 G2 X1 I1 F60")
            .reason
            .contains("not known")
    );
    assert!(
        refused_with(GcodeSetup::default(), "G18")
            .reason
            .contains("G17")
    );
}

#[test]
fn a_tool_that_is_on_where_z_lifts_it_is_refused() {
    for (text, line) in [
        // Lifts at a feed.
        ("M3 S1\nG1 Z-1 F60\nX1\nZ3\nX2\nZ-1", 5),
        ("M4 S1 F60\nG1 Z-1\nX1\nG0 Z5\nG1 X9", 5),
        ("M3 S1 F60 G91\nG1 Z-1\nX1\nZ.5\nX1", 5),
        ("M3 S1 F60\nG1 Z0\nX1\nZ5\nG2 X3 I1", 5),
        // On the way up, and on the way down from above the work.
        ("M3 S1 F60\nG1 Z-1\nX1 Z2", 3),
        ("M3 S1 F60\nG1 Z2\nX1 Z-1", 3),
        // The way to the first plunge; that at a height that is not known, too.
        ("M3 S1 F60\nG0 Z3\nG1 X5\nZ-1\nX6", 3),
        ("M3 S1 F60\nG1 X5\nZ-1\nX6", 2),
        ("G28\nM3 S1 F60\nG1 Z0\nX1\nZ-1\nX2", 4),
    ] {
        let setup = setup(ZWords::Ignored);
        let found = elements(text.as_bytes(), setup).find_map(Result::err);
        let fault = found.unwrap_or_else(|| panic!("{text}"));
        assert_eq!(fault.line, line, "{text}: {fault}");
        assert!(fault.reason.contains("--tool-by-z"), "{fault}");
    }
    for good in [
        // Rapids, M5 and S0 have it off.
        "M3 S1 F60\nG0 Z3\nG0 X5\nG1 Z-1\nX6\nG0 Z3\nX7\nG1 Z-1\nX8",
        "F60\nG1 Z-1\nM3 S1\nX1\nM5\nG1 Z3\nX2\nZ-1\nM3\nX3",
        "F60 M3\nG1 Z-1 S1\nX1\nS0 Z3\nX2\nS1 Z-1\nX3",
        // Passes, each lower, and the next contour.
        "M3 S1 F60\nG0 Z5\nX1\nG1 Z-1\nX2\nZ-2\nX1\nG0 Z5\nX9\nG1 Z-1\nX8\nZ-2\nX9",
        // Helices from pass to pass.
        "M3 S1 F60\nG0 Z1\nG1 Z0\nG2 I5 Z-1\nG2 I5 Z-2\nG2 I5",
        // One height, and the way up at the end; a focus.
        "M3 S1 F60\nG0 Z2\nG1 X5\nX6\nG0 Z10",
        "M3 S1 F60\nG1 X5\nX6\nM5\nG0 Z10\nX0",
        "G28 G91 Z0\nG90 M3 S1 F60\nG1 X5",
    ] {
        let setup = setup(ZWords::Ignored);
        let fault = elements(good.as_bytes(), setup).find_map(Result::err);
        assert_eq!(fault, None, "{good}");
    }
}
