//! Rust source of a board's pins, as the firmware includes it.

mod rp2040;
mod stm32;

use super::chip::Family;
use super::file::{BoardFile, WiredPin};
use super::needs::Needs;
use super::role::Role;

/// The pins that the image of a scene with these needs has, as types of its board's package, and the settings of the PLL.
pub(super) fn source(board: &BoardFile, needs: &Needs) -> String {
    let pins = match board.chip.family {
        Family::Stm32f405 | Family::Stm32g474 => stm32::source(board, needs),
        Family::Rp2040 => rp2040::source(board, needs),
    };
    modules(needs) + &pins
}

/// Names the modules of the scene's drives and tool.
fn modules(needs: &Needs) -> String {
    let drive = match needs.drive.as_str() {
        "odrive" | "mit" | "moteus" => "can",
        kind => kind,
    };
    let (tool, part) = match needs.tool.as_str() {
        "duty" => ("crate::duty", "DutyPart"),
        "level" => ("trirrr_boards::tool::level", "LevelPart<Tool>"),
        _ => ("trirrr_boards::tool::none", "NoTool"),
    };
    format!(
        "pub(crate) use crate::drives::{drive} as drive;\n\
         pub(crate) use {tool} as tool;\n\
         pub(crate) type ToolPart = {tool}::{part};\n"
    )
}

/// Entry of the vector table for the task of the line: that of its port, or of USB; none without a host.
fn line_entry(board: &BoardFile, needs: &Needs, interrupt: &str) -> String {
    if needs.autonomous {
        return String::new();
    }
    match board.line {
        Some(_) => format!("trirrr_boards::entry!({interrupt}, LINE);\n"),
        None => format!(
            "trirrr_boards::entry!({}, USB);\n",
            board.chip.usb.interrupt
        ),
    }
}

/// Fields of the struct `Pins` for a role, one for each of its pins.
const FIELDS: [(Role, &[&str]); 25] = [
    (Role::LineTransmit, &["line_transmit"]),
    (Role::LineReceive, &["line_receive"]),
    (Role::LogTransmit, &["log_transmit"]),
    (Role::Step, &["step_1", "step_2", "step_3"]),
    (
        Role::Direction,
        &["direction_1", "direction_2", "direction_3"],
    ),
    (Role::StepperEnable, &["enable"]),
    (
        Role::SetValue,
        &["set_value_1", "set_value_2", "set_value_3"],
    ),
    (Role::Failure, &["failure_1", "failure_2", "failure_3"]),
    (
        Role::EncoderA,
        &["encoder_a_1", "encoder_a_2", "encoder_a_3"],
    ),
    (
        Role::EncoderB,
        &["encoder_b_1", "encoder_b_2", "encoder_b_3"],
    ),
    (Role::AmplifierEnable, &["enable"]),
    (Role::CanReceive, &["can_receive"]),
    (Role::CanTransmit, &["can_transmit"]),
    (Role::Tool, &["tool"]),
    (Role::ToolEnable, &["tool_enable"]),
    (Role::Stop, &["stop"]),
    (Role::Door, &["door"]),
    (Role::Probe, &["probe"]),
    (Role::Limits, &["limit_1", "limit_2", "limit_3"]),
    (Role::Button, &["button"]),
    (Role::Homing, &["homing_1", "homing_2", "homing_3"]),
    (Role::Brake, &["brake"]),
    (Role::Lamp, &["lamp"]),
    (
        Role::Outputs,
        &[
            "output_1", "output_2", "output_3", "output_4", "output_5", "output_6", "output_7",
            "output_8",
        ],
    ),
    (
        Role::Inputs,
        &[
            "input_1", "input_2", "input_3", "input_4", "input_5", "input_6", "input_7", "input_8",
        ],
    ),
];

/// Field of a struct: no pin where the scene has no use for it, and a type of the firmware asks for one.
struct PinField<'b> {
    name: &'static str,
    pin: Option<&'b WiredPin>,
    group: PinGroup,
}

/// Struct that a field is in, by who takes its pins.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PinGroup {
    /// `Pins` itself.
    Own,
    Line,
    Drives,
    Tool,
    Homing,
    Contacts,
    SpareInputs,
    Brake,
    Lamp,
    SpareOutputs,
}

/// Groups with a struct of their own, its name, and that of its field in `Pins`.
const STRUCTS: [(PinGroup, &str, &str); 2] = [
    (PinGroup::Line, "LinePins", "line"),
    (PinGroup::Drives, "DrivePins", "drives"),
];

/// Struct of `trirrr-boards` whose fields are tuples of pins.
struct OfTuples {
    name: &'static str,
    /// Its field in `Pins`.
    field: &'static str,
    /// Its own fields.
    groups: [(&'static str, PinGroup); 3],
}

const OF_TUPLES: [OfTuples; 2] = [
    OfTuples {
        name: "InputPins",
        field: "inputs",
        groups: [
            ("homing", PinGroup::Homing),
            ("contacts", PinGroup::Contacts),
            ("spare", PinGroup::SpareInputs),
        ],
    },
    OfTuples {
        name: "OutputPins",
        field: "outputs",
        groups: [
            ("brake", PinGroup::Brake),
            ("lamp", PinGroup::Lamp),
            ("spare", PinGroup::SpareOutputs),
        ],
    },
];

impl PinGroup {
    fn of(role: Role) -> Self {
        match role {
            Role::LineTransmit | Role::LineReceive => Self::Line,
            Role::Tool | Role::ToolEnable => Self::Tool,
            Role::Homing => Self::Homing,
            Role::Stop | Role::Door | Role::Probe | Role::Limits | Role::Button => Self::Contacts,
            Role::Inputs => Self::SpareInputs,
            Role::Brake => Self::Brake,
            Role::Lamp => Self::Lamp,
            Role::Outputs => Self::SpareOutputs,
            _ if matches!(role.entry().table, "stepper" | "amplifier" | "can") => Self::Drives,
            _ => Self::Own,
        }
    }
}

/// The fields of an image, and of no function that its scene lacks.
fn fields<'b>(board: &'b BoardFile, needs: &Needs) -> Vec<PinField<'b>> {
    let needed = needs.roles();
    let is_always = |role| match role {
        Role::LineTransmit | Role::LineReceive => board.line.is_some(),
        _ => role == Role::LogTransmit,
    };
    // The inputs, and tool and its enable line, are one type of the firmware each.
    let is_beside = |role| match role {
        Role::Stop | Role::Door | Role::Probe | Role::Limits | Role::Button => needs.interlocks,
        Role::ToolEnable => needs.has_tool(),
        _ => false,
    };
    let of_usb = board.usb.iter().map(|(name, pin)| PinField {
        name,
        pin: Some(pin),
        group: PinGroup::Line,
    });
    let mut fields: Vec<_> = of_usb.collect();
    for (role, names) in FIELDS {
        let pins: Vec<Option<&WiredPin>> = if role.entry().is_list {
            // All are one type of the firmware: where the scene names fewer, the rest is none.
            let named = board.pins(role).into_iter().flatten().map(Some);
            let named = named.take(needs.listed(role));
            let rest = std::iter::repeat(None);
            let all = if needs.has_spare() { names.len() } else { 0 };
            named.chain(rest).take(all).collect()
        } else if is_always(role) || needed.contains_key(&role) {
            board.pins(role).into_iter().flatten().map(Some).collect()
        } else if is_beside(role) {
            vec![None; names.len()]
        } else {
            Vec::new()
        };
        let group = PinGroup::of(role);
        fields.extend(
            names
                .iter()
                .zip(pins)
                .map(|(name, pin)| PinField { name, pin, group }),
        );
    }
    fields
}

/// Name of a type from that of its field: `step_1` becomes `Step1`.
fn type_name(field: &str) -> String {
    let words = field.split('_').map(|word| {
        let (first, rest) = word.split_at(1);
        first.to_uppercase() + rest
    });
    words.collect()
}

/// The pins of an image as source: structs and the expressions that build them.
struct Declared {
    /// A type for each field, and the structs of the groups.
    types: String,
    /// Fields of the struct `Pins`,
    fields: String,
    /// and their values.
    values: String,
}

/// Declares `fields`, with the type of a pin and the expression that takes it.
fn declare(
    fields: &[PinField],
    pin_type: impl Fn(&WiredPin) -> String,
    taken: impl Fn(&WiredPin) -> String,
) -> Declared {
    let mut types = String::new();
    for field in fields {
        let of = match field.pin {
            Some(pin) if pin.inverted => format!("Inverted<{}>", pin_type(pin)),
            Some(pin) => pin_type(pin),
            None => "NoPin".into(),
        };
        types += &format!("pub(crate) type {} = {of};\n", type_name(field.name));
    }
    let value = |field: &PinField| match field.pin {
        Some(pin) if pin.inverted => format!("Inverted({})", taken(pin)),
        Some(pin) => taken(pin),
        None => "NoPin".into(),
    };
    let of_group = |group| {
        let (mut declared, mut values) = (String::new(), String::new());
        for field in fields.iter().filter(|field| field.group == group) {
            let value = value(field);
            let (name, alias) = (field.name, type_name(field.name));
            declared += &format!("    pub(crate) {name}: {alias},\n");
            values += &format!("            {name}: {value},\n");
        }
        (declared, values)
    };
    let (mut own, mut own_values) = of_group(PinGroup::Own);
    for (group, name, field) in STRUCTS {
        let (declared, values) = of_group(group);
        types += &format!("pub(crate) struct {name} {{\n{declared}}}\n");
        own += &format!("    pub(crate) {field}: {name},\n");
        own_values += &format!("            {field}: {name} {{\n{values}            }},\n");
    }
    // Without a pin these are `()`.
    let tuple = |group, of: &dyn Fn(&PinField) -> String| {
        let parts = fields.iter().filter(|field| field.group == group);
        format!(
            "({})",
            parts.map(|field| of(field) + ", ").collect::<String>()
        )
    };
    let alias = |field: &PinField| type_name(field.name);
    types += &format!(
        "pub(crate) type ToolPins = {};\n",
        tuple(PinGroup::Tool, &alias)
    );
    own += "    pub(crate) tool: ToolPins,\n";
    own_values += &format!("            tool: {},\n", tuple(PinGroup::Tool, &value));
    for OfTuples {
        name,
        field,
        groups,
    } in OF_TUPLES
    {
        let kinds = groups.map(|(_, group)| tuple(group, &alias)).join(", ");
        types += &format!("pub(crate) type {name} = trirrr_boards::{name}<{kinds}>;\n");
        own += &format!("    pub(crate) {field}: {name},\n");
        let values = groups.map(|(name, group)| format!("{name}: {}", tuple(group, &value)));
        own_values += &format!(
            "            {field}: trirrr_boards::{name} {{ {} }},\n",
            values.join(", ")
        );
    }
    Declared {
        types,
        fields: own,
        values: own_values,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::shipped;

    /// Source of the shipped board for a scene that needs these.
    fn of(board: &str, change: impl Fn(String) -> String, needs: &Needs) -> String {
        let text = change(shipped(board));
        let board = BoardFile::parse(&text, board, None).unwrap_or_else(|error| panic!("{error}"));
        source(&board, needs)
    }

    fn steppers() -> Needs {
        Needs {
            drive: "stepper".into(),
            ..Needs::default()
        }
    }

    fn nothing() -> Needs {
        Needs {
            drive: "none".into(),
            ..Needs::default()
        }
    }

    #[test]
    fn an_image_holds_the_pins_of_its_scene_and_no_others() {
        let text = of("generic-f405", |text| text, &nothing());
        for part in [
            "pub(crate) type LineTransmit = Pin<'A', 2>;",
            "pub(crate) const LINE_PORT: stm32_metapac::usart::Usart = stm32_metapac::USART2;",
            "pub(crate) type LogTransmit = Pin<'B', 10>;",
            "gpio::switch_on(b\"AB\");",
            "divider: 8, factor: 336",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(!text.contains("enable"), "{text}");
        let needs = Needs {
            tool: "duty".into(),
            door: true,
            interlocks: true,
            ..steppers()
        };
        let text = of("generic-f405", |text| text, &needs);
        for part in [
            "pub(crate) type StepOutput = PortOutput<'C'>;",
            "pub(crate) type Step3 = Pin<'C', 2>;",
            "pub(crate) type Direction1 = Pin<'C', 3>;",
            "pub(crate) type ToolEnable = NoPin;",
            "pub(crate) type Stop = NoPin;",
            "pub(crate) type Limit3 = NoPin;",
            "pub(crate) type Door = Pin<'A', 7>;",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(!text.contains("Brake"), "{text}");
    }

    #[test]
    fn an_inverted_pin_is_another_type() {
        let invert = |text: String| {
            let plain = "step = [\"PC0\", \"PC1\", \"PC2\"]";
            assert!(text.contains(plain));
            text.replace(plain, "step = [\"PC0\", \"!PC1\", \"PC2\"]")
        };
        let text = of("generic-f405", invert, &steppers());
        for part in [
            "pub(crate) type StepOutput = AnyOutput;",
            "pub(crate) type DirectionOutput = PortOutput<'C'>;",
            "pub(crate) type Step1 = Pin<'C', 0>;",
            "pub(crate) type Step2 = Inverted<Pin<'C', 1>>;",
            "step_2: Inverted(Pin::of_its_port()),",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn a_board_of_its_own_crystal_and_ports_has_them() {
        let text = of("feather-f405", |text| text, &steppers());
        for part in [
            "pub(crate) const LINE_PORT: stm32_metapac::usart::Usart = stm32_metapac::USART3;",
            "line_interrupt!(DMA1_STREAM1, OTG_FS);",
            "pub(crate) const LINE_TRANSMIT_STREAM: usize = 3;",
            "pub(crate) const LOG_PORT: stm32_metapac::usart::Usart = stm32_metapac::USART1;",
            "divider: 12, factor: 336",
            "pub(crate) type Step1 = Pin<'C', 2>;",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn a_nucleo_has_its_pins_and_no_ports_that_its_scene_leaves_alone() {
        let needs = Needs {
            drive: "moteus".into(),
            ..Needs::default()
        };
        let text = of("nucleo-g474re", |text| text, &needs);
        for part in [
            "divider: 6, factor: 85",
            "line_interrupt!(DMA1_CHANNEL1, USB_LP);",
            "pub(crate) const LINE_TRANSMIT_REQUEST: u8 = 27;",
            "pub(crate) type CanReceive = Pin<'A', 11>;",
            "can_transmit: Pin::of_its_port(),",
            "gpio::switch_on(b\"AB\");",
            "pub(crate) const LINE_PORT: stm32_metapac::usart::Usart = stm32_metapac::USART2;",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn a_line_over_usb_has_its_interrupt_and_no_port() {
        let needs = Needs {
            usb_line: true,
            ..nothing()
        };
        let parse = |name: &str, family| {
            let board = BoardFile::parse(&shipped(name), name, Some((family, &needs)));
            source(&board.unwrap_or_else(|error| panic!("{error}")), &needs)
        };
        let pico = parse("pico", Family::Rp2040);
        let f405 = parse("generic-f405", Family::Stm32f405);
        assert!(
            pico.contains("line_interrupt!(UART1_IRQ, USBCTRL_IRQ);"),
            "{pico}"
        );
        for part in [
            "line_interrupt!(USART3, OTG_FS);",
            "pub(crate) type UsbMinus = Pin<'A', 11>;",
            "pub(crate) type UsbPlus = Pin<'A', 12>;",
        ] {
            assert!(f405.contains(part), "{part}: {f405}");
        }
        assert!(
            pico.contains("type LinePort = crate::pins::UsbPort;"),
            "{pico}"
        );
        for text in [pico, f405] {
            assert!(
                !text.contains("LINE_PORT") && !text.contains("line_transmit"),
                "{text}"
            );
        }
    }

    #[test]
    fn a_pico_has_its_slice_of_pwm() {
        let needs = Needs {
            tool: "duty".into(),
            ..steppers()
        };
        let text = of("pico", |text| text, &needs);
        for part in [
            "pub(crate) type Tool = Direct<Gpio16>;",
            "pub(crate) type ToolPwm = rp2040_hal::pwm::Pwm0;",
            "line_interrupt!(UART0_IRQ, USBCTRL_IRQ);",
            "pub(crate) const CRYSTAL_MHZ: u8 = 12;",
            "step_1: Direct(pins.gpio6),",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let odd = |text: String| {
            let text = text.replace("\"GP26\"", "\"GP16\"");
            text.replace("output = \"GP16\"", "output = \"GP26\"")
        };
        assert!(of("pico", odd, &needs).contains("ToolPwm = rp2040_hal::pwm::Pwm5;"));
        assert!(!of("pico", |text| text, &nothing()).contains("ToolPwm"));
    }
}
