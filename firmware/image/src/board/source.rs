//! Rust source of a board's pins, as the firmware includes it.

mod rp2040;
mod stm32;

use super::chip::Family;
use super::file::{BoardFile, WiredPin};
use super::needs::Needs;
use super::role::Role;

/// The pins that the image of a scene with these needs has, as types of its board's package, and the settings of the PLL.
pub(super) fn source(board: &BoardFile, needs: &Needs) -> String {
    match board.chip.family {
        Family::Stm32f405 | Family::Stm32g474 => stm32::source(board, needs),
        Family::Rp2040 => rp2040::source(board, needs),
    }
}

/// Fields of the struct `Pins` for a role, one for each of its pins.
const FIELDS: [(Role, &[&str]); 24] = [
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
    Drives,
    Inputs,
    Outputs,
}

/// Groups with a struct of their own, its name, and that of its field in `Pins`.
const STRUCTS: [(PinGroup, &str, &str); 3] = [
    (PinGroup::Drives, "DrivePins", "drives"),
    (PinGroup::Inputs, "InputPins", "inputs"),
    (PinGroup::Outputs, "OutputPins", "outputs"),
];

impl PinGroup {
    fn of(role: Role) -> Self {
        match role {
            Role::Homing | Role::Stop | Role::Door | Role::Probe => Self::Inputs,
            Role::Limits | Role::Inputs => Self::Inputs,
            Role::Brake | Role::Lamp | Role::Outputs => Self::Outputs,
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
        Role::Stop | Role::Door | Role::Probe | Role::Limits => needs.interlocks,
        Role::ToolEnable => needs.has_tool(),
        _ => false,
    };
    let of_usb = board.usb.iter().map(|(name, pin)| PinField {
        name,
        pin: Some(pin),
        group: PinGroup::Own,
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
    let of_group = |group| {
        let (mut declared, mut values) = (String::new(), String::new());
        for field in fields.iter().filter(|field| field.group == group) {
            let value = match field.pin {
                Some(pin) if pin.inverted => format!("Inverted({})", taken(pin)),
                Some(pin) => taken(pin),
                None => "NoPin".into(),
            };
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
            "pub(crate) type LinePort = stm32f4xx_hal::pac::USART2;",
            "log_transmit: b.pb10,",
            "divider: 8, factor: 336",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        // Port C is not even switched on.
        assert!(
            !text.contains("ports.c") && !text.contains("enable"),
            "{text}"
        );
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
            "direction_1: c.pc3,",
            "pub(crate) type ToolEnable = NoPin;",
            "pub(crate) type Stop = NoPin;",
            "pub(crate) type Limit3 = NoPin;",
            "door: a.pa7,",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(!text.contains("brake"), "{text}");
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
            "step_2: Inverted(c.pc1),",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn a_board_of_its_own_crystal_and_ports_has_them() {
        let text = of("feather-f405", |text| text, &steppers());
        for part in [
            "pub(crate) type LinePort = stm32f4xx_hal::pac::USART3;",
            "line_interrupt!(DMA1_STREAM1, OTG_FS);",
            "pub(crate) const LINE_TRANSMIT_STREAM: usize = 3;",
            "pub(crate) type LogPort = stm32f4xx_hal::pac::USART1;",
            "divider: 12, factor: 336",
            "step_1: c.pc2,",
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
            "ports.switch_on('A', rcc);",
            "line: stm32_metapac::USART2,",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(!text.contains("switch_on('C'"), "{text}");
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
            "usb_plus: a.pa12,",
        ] {
            assert!(f405.contains(part), "{part}: {f405}");
        }
        for text in [pico, f405] {
            assert!(
                !text.contains("LinePort") && !text.contains("line:"),
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
            "pub(crate) type Tool = Pin<Gpio16, FunctionNull, PullDown>;",
            "pub(crate) type ToolPwm = rp2040_hal::pwm::Pwm0;",
            "line_interrupt!(UART0_IRQ, USBCTRL_IRQ);",
            "pub(crate) const CRYSTAL_MHZ: u8 = 12;",
            "step_1: pins.gpio6,",
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
