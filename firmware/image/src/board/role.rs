//! Functions of pins: their places in a board file and their rows in a table.

use trirrr_protocol::message::DIGITAL;

/// Function that a board file gives pins to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Line to the host, transmitter.
    LineTransmit,
    /// Line to the host, receiver.
    LineReceive,
    /// Transmitter of the log.
    LogTransmit,
    /// Steps of the three drivers.
    Step,
    /// Directions of the three drivers.
    Direction,
    /// Enable line of the drivers.
    StepperEnable,
    /// Set values of the three amplifiers.
    SetValue,
    /// Failure outputs of the three amplifiers.
    Failure,
    /// Channel A of the three encoders.
    EncoderA,
    /// Channel B of the three encoders.
    EncoderB,
    /// Enable line of the amplifiers.
    AmplifierEnable,
    /// CAN receiver.
    CanReceive,
    /// CAN transmitter.
    CanTransmit,
    /// Level or PWM of the tool.
    Tool,
    /// Enable line of the tool.
    ToolEnable,
    /// Contact of the emergency stop.
    Stop,
    /// Contact of the door.
    Door,
    /// Contact of the probe.
    Probe,
    /// Limit switches of the three motors.
    Limits,
    /// Button of a board without a host.
    Button,
    /// Switches of homing.
    Homing,
    /// Brake, released.
    Brake,
    /// Status lamp.
    Lamp,
    /// Spare outputs.
    Outputs,
    /// Spare inputs.
    Inputs,
}

/// Place and description of a role.
pub(super) struct RoleEntry {
    pub(super) role: Role,
    /// Table and key in a board file.
    pub(super) table: &'static str,
    pub(super) key: &'static str,
    /// Number of pins: one, or one for each motor; the most of a [list](Self::is_list).
    pub(super) count: usize,
    /// The board has any number of such pins.
    pub(super) is_list: bool,
    /// Text of a documentation table: function, and the other end of the wire.
    pub(super) function: &'static str,
    pub(super) other_end: &'static str,
    pub(super) is_output: bool,
    /// The level can be inverted: not that of a protocol, or of a counter.
    pub(super) inverts: bool,
}

impl RoleEntry {
    const fn new(role: Role, place: (&'static str, &'static str), count: usize) -> Self {
        let (table, key) = place;
        Self {
            role,
            table,
            key,
            count,
            is_list: false,
            function: "",
            other_end: "",
            is_output: false,
            inverts: true,
        }
    }

    const fn text(self, function: &'static str, other_end: &'static str) -> Self {
        Self {
            function,
            other_end,
            ..self
        }
    }

    const fn output(self) -> Self {
        Self {
            is_output: true,
            ..self
        }
    }

    const fn list(self) -> Self {
        Self {
            is_list: true,
            ..self
        }
    }

    const fn fixed_level(self) -> Self {
        Self {
            inverts: false,
            ..self
        }
    }
}

/// All roles, in the order of a board file.
pub(super) const ROLES: [RoleEntry; 25] = [
    RoleEntry::new(Role::LineTransmit, ("line", "transmit"), 1)
        .text("the line, transmitter", "RX of the host's adapter")
        .output()
        .fixed_level(),
    RoleEntry::new(Role::LineReceive, ("line", "receive"), 1)
        .text("the line, receiver, pulled up", "TX of the host's adapter")
        .fixed_level(),
    RoleEntry::new(Role::LogTransmit, ("log", "transmit"), 1)
        .text("the log, transmitter", "RX of an adapter for the log")
        .output()
        .fixed_level(),
    RoleEntry::new(Role::Step, ("stepper", "step"), 3)
        .text("stepper: step of motor 1, 2, 3", "driver")
        .output(),
    RoleEntry::new(Role::Direction, ("stepper", "direction"), 3)
        .text("stepper: direction of motor 1, 2, 3", "driver")
        .output(),
    RoleEntry::new(Role::StepperEnable, ("stepper", "enable"), 1)
        .text("stepper: enable of all three", "driver")
        .output(),
    RoleEntry::new(Role::SetValue, ("amplifier", "set_value"), 3)
        .text(
            "amplifier: set value of motor 1, 2, 3, PWM of `command_hz`",
            "amplifier",
        )
        .output(),
    RoleEntry::new(Role::Failure, ("amplifier", "failure"), 3).text(
        "amplifier: failure of motor 1, 2, 3, pulled to the level of a failure by 40 kOhm",
        "amplifier",
    ),
    RoleEntry::new(Role::EncoderA, ("amplifier", "encoder_a"), 3)
        .text(
            "encoder: A of motor 1, 2, 3",
            "line receiver of the encoder",
        )
        .fixed_level(),
    RoleEntry::new(Role::EncoderB, ("amplifier", "encoder_b"), 3)
        .text(
            "encoder: B of motor 1, 2, 3",
            "line receiver of the encoder",
        )
        .fixed_level(),
    RoleEntry::new(Role::AmplifierEnable, ("amplifier", "enable"), 1)
        .text("amplifier: enable of all three", "amplifier")
        .output(),
    RoleEntry::new(Role::CanReceive, ("can", "receive"), 1)
        .text("CAN receive", "CAN transceiver")
        .fixed_level(),
    RoleEntry::new(Role::CanTransmit, ("can", "transmit"), 1)
        .text("CAN transmit", "CAN transceiver")
        .output()
        .fixed_level(),
    RoleEntry::new(Role::Tool, ("tool", "output"), 1)
        .text(
            "[tool](#tool): level, or PWM",
            "laser driver, spindle, servo, gripper",
        )
        .output(),
    RoleEntry::new(Role::ToolEnable, ("tool", "enable"), 1)
        .text("tool: enable", "enable of the laser driver or the spindle")
        .output(),
    RoleEntry::new(Role::Stop, ("inputs", "estop"), 1).text(
        "[emergency stop](#inputs), pulled up",
        "normally closed contact to ground",
    ),
    RoleEntry::new(Role::Door, ("inputs", "door"), 1)
        .text("[door](#inputs), pulled up", "contact to ground"),
    RoleEntry::new(Role::Probe, ("inputs", "probe"), 1)
        .text("[probe](#inputs), pulled up", "contact to ground"),
    RoleEntry::new(Role::Limits, ("inputs", "limits"), 3).text(
        "[limit switch](#inputs) of motor 1, 2, 3, pulled up",
        "contact to ground",
    ),
    RoleEntry::new(Role::Button, ("inputs", "button"), 1).text(
        "[button](#autonomous) of a board without a host, pulled up",
        "normally open contact to ground",
    ),
    RoleEntry::new(Role::Homing, ("inputs", "homing"), 3).text(
        "homing: input of motor 1, 2, 3, pulled up",
        "switch to ground, or a drive's stall output",
    ),
    RoleEntry::new(Role::Brake, ("brake", "release"), 1)
        .text(
            "[brake](scene.md#power-optional), high while released",
            "driver of the brake's coil",
        )
        .output(),
    RoleEntry::new(Role::Lamp, ("io", "lamp"), 1)
        .text(
            "[status lamp](#status-lamp), high while on",
            "LED, or driver of a lamp",
        )
        .output(),
    RoleEntry::new(Role::Outputs, ("io", "outputs"), DIGITAL)
        .text(
            "[spare outputs](#spare-outputs-and-inputs), high while on",
            "driver of a valve, a relay, a lamp",
        )
        .output()
        .list(),
    RoleEntry::new(Role::Inputs, ("io", "inputs"), DIGITAL)
        .text(
            "[spare inputs](#spare-outputs-and-inputs), pulled up",
            "contact to ground",
        )
        .list(),
];

impl Role {
    /// Returns true if no image has both functions: a pin may have either.
    pub(super) fn is_apart(self, other: Self) -> bool {
        let needs_host = |role: Self| {
            let is_one = matches!(role, Self::Probe | Self::Outputs | Self::Inputs);
            is_one || matches!(role.entry().table, "line" | "can" | "amplifier")
        };
        (self == Self::Button && needs_host(other)) || (other == Self::Button && needs_host(self))
    }

    /// Path of the key in a board file: `stepper.step`.
    pub(super) fn path(self) -> String {
        let entry = self.entry();
        format!("{}.{}", entry.table, entry.key)
    }

    pub(super) fn entry(self) -> &'static RoleEntry {
        let found = ROLES.iter().find(|entry| entry.role == self);
        found.expect("each role has its entry")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_stand_in_their_order_and_each_has_a_place_of_its_own() {
        for pair in ROLES.windows(2) {
            assert!(pair[0].role < pair[1].role, "{:?}", pair[1].role);
        }
        let mut paths: Vec<String> = ROLES.iter().map(|entry| entry.role.path()).collect();
        paths.sort();
        paths.dedup();
        assert_eq!(paths.len(), ROLES.len());
    }
}
