//! The output to the tool as constants of an image.

use std::fmt::Write;
use trirrr_drives::tool::{DutySpan, FULL};
use trirrr_scene::{EnableLevel, Scene, ToolKind, ToolPort};

/// The kinds of output, as `cfg(tool = "...")` has them in an image.
pub(super) const TOOLS: &[&str] = &[NONE, "duty", "level"];

/// No output.
const NONE: &str = "none";

/// The kind of the scene's output to the tool: `"none"`, `"duty"` of a laser, a spindle or a servo, or `"level"`.
pub fn tool_kind(scene: &Scene) -> &'static str {
    match scene.tool.map(|port| port.kind) {
        None => NONE,
        Some(ToolKind::Pwm { .. } | ToolKind::Servo { .. }) => "duty",
        Some(ToolKind::Digital { .. }) => "level",
    }
}

/// A module `tool` with the constants of the scene's output to the tool; nothing if it has none.
pub(super) fn tool(scene: &Scene) -> String {
    let Some(port) = &scene.tool else {
        return String::new();
    };
    let mut text = String::from("#[allow(dead_code)]\npub mod tool {\n");
    let mut line = |name: &str, of: &str, value: String| {
        writeln!(text, "pub const {name}: {of} = {value};").expect("a String takes all text");
    };
    line("DELAY", "usize", port.delay_ticks.to_string());
    line("INVERTED", "bool", port.inverted.to_string());
    let holds = matches!(port.kind, ToolKind::Digital { holds: true });
    line("HOLDS", "bool", holds.to_string());
    if let Some((frequency_hz, span)) = duties(port) {
        let DutySpan { off, least, most } = span;
        line("FREQUENCY_HZ", "u32", frequency_hz.to_string());
        line(
            "SPAN",
            "trirrr_drives::tool::DutySpan",
            format!("trirrr_drives::tool::DutySpan {{ off: {off}, least: {least}, most: {most} }}"),
        );
        // A pulse of a servo is never cut.
        let cuts = matches!(port.kind, ToolKind::Pwm { .. });
        line("CUTS", "bool", cuts.to_string());
    }
    let enable = match port.kind {
        ToolKind::Pwm {
            enable: Some(EnableLevel::High),
            ..
        } => "Some(trirrr_drives::Active::High)",
        ToolKind::Pwm {
            enable: Some(EnableLevel::Low),
            ..
        } => "Some(trirrr_drives::Active::Low)",
        _ => "None",
    };
    line("ENABLE", "Option<trirrr_drives::Active>", enable.into());
    text.push_str("}\n");
    text
}

/// Frequency and duties of a PWM output; none of a digital one.
fn duties(port: &ToolPort) -> Option<(u32, DutySpan)> {
    // The cast saturates.
    let part = |part: f64| (part * f64::from(FULL)).round() as u16;
    match port.kind {
        ToolKind::Pwm {
            frequency_hz,
            duty: [least, most],
            ..
        } => {
            let (least, most) = (part(least), part(most));
            Some((
                frequency_hz,
                DutySpan {
                    off: 0,
                    least,
                    most,
                },
            ))
        }
        ToolKind::Servo {
            frequency_hz,
            pulse_up_s,
            pulse_down_s,
        } => {
            let pulse = |seconds: f64| part(seconds * f64::from(frequency_hz));
            let (up, down) = (pulse(pulse_up_s), pulse(pulse_down_s));
            let span = DutySpan {
                off: up,
                least: up,
                most: down,
            };
            Some((frequency_hz, span))
        }
        ToolKind::Digital { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The thesis scene with this tool, as constants.
    fn with(tool: &str) -> String {
        let text = include_str!("../../../../scenes/thesis.toml");
        let text = text.replacen("[platform]", &format!("{tool}\n[platform]"), 1);
        let scene = Scene::parse(&text, "test.toml").unwrap_or_else(|error| panic!("{error}"));
        tool_of(&scene)
    }

    fn tool_of(scene: &Scene) -> String {
        super::tool(scene)
    }

    #[test]
    fn a_laser_is_duties_and_a_level() {
        let text = with(
            "[tool]\nkind = \"pwm\"\nfrequency_hz = 5000\nduty_min = 0.1\nduty_max = 0.8\nenable = \"low\"\nlead_s = -0.03",
        );
        for part in [
            "DELAY: usize = 3;",
            "FREQUENCY_HZ: u32 = 5000;",
            "{ off: 0, least: 6554, most: 52428 }",
            "CUTS: bool = true;",
            "Some(trirrr_drives::Active::Low)",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn a_servo_has_pulses_and_is_not_cut() {
        let text = with(
            "[tool]\nkind = \"servo\"\npulse_up_s = 0.001\npulse_down_s = 0.002\ntravel_s = 0.1",
        );
        for part in [
            "FREQUENCY_HZ: u32 = 50;",
            "{ off: 3277, least: 3277, most: 6554 }",
            "CUTS: bool = false;",
            "ENABLE: Option<trirrr_drives::Active> = None;",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn a_gripper_has_no_duty_and_no_tool_no_constants() {
        let text = with("[tool]\nkind = \"digital\"\nholds = true\ninverted = true");
        assert!(text.contains("HOLDS: bool = true;") && text.contains("INVERTED: bool = true;"));
        assert!(!text.contains("SPAN"));
        assert_eq!(with(""), "");
    }
}
