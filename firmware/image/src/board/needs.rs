//! Functions that a scene takes from its board.

use super::role::Role;
use crate::generate::{DriveError, kind, slots_hz, tool_kind};
use std::collections::BTreeMap;
use trirrr_scene::{Scene, ToolKind};

/// Functions of a board that the image of a scene has, and how fast its steppers step.
///
/// The build script of `trirrr-app` writes them for those of the boards: [`Needs::metadata`], [`Needs::read`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Needs {
    /// File of the scene, for messages.
    pub scene: String,
    /// Board that the scene names, as the path of its file where it is one.
    pub board: Option<String>,
    /// Kind of the drives, as `cfg(drive = "...")` has it.
    pub drive: String,
    /// Kind of the output to the tool, as `cfg(tool = "...")` has it.
    pub tool: String,
    /// The tool has an enable line.
    pub tool_enable: bool,
    /// Homing.
    pub homing: bool,
    /// Brake.
    pub brake: bool,
    /// Status lamp.
    pub lamp: bool,
    /// Number of spare outputs, and of spare inputs.
    pub spare: [usize; 2],
    /// Emergency stop.
    pub stop: bool,
    /// Door.
    pub door: bool,
    /// Probe.
    pub probe: bool,
    /// Limit switches with pins of their own.
    pub limits: bool,
    /// Button of a board without a host.
    pub button: bool,
    /// Any contact, also limit switches that are those of homing.
    pub interlocks: bool,
    /// The board plays its job without a host.
    pub autonomous: bool,
    /// Slots of its steppers, Hz, and its ticks, Hz.
    pub slots: Option<(u32, f64)>,
    /// The line is USB, whatever the port of the board file: the build asks for it, and no scene.
    pub usb_line: bool,
}

impl Needs {
    /// The needs of `scene`, read from `file`.
    ///
    /// # Errors
    /// Steppers that no board drives.
    pub fn of(scene: &Scene, file: &str, board: Option<String>) -> Result<Self, DriveError> {
        let slots = slots_hz(scene)?;
        let has_enable = |kind: &ToolKind| {
            matches!(
                kind,
                ToolKind::Pwm {
                    enable: Some(_),
                    ..
                }
            )
        };
        Ok(Self {
            scene: file.into(),
            board,
            drive: kind(scene).into(),
            tool: tool_kind(scene).into(),
            tool_enable: scene.tool.is_some_and(|port| has_enable(&port.kind)),
            homing: scene.homing.is_some(),
            brake: scene.power.has_brake,
            lamp: scene.has_lamp,
            spare: [
                scene.spare_pins.outputs.len(),
                scene.spare_pins.inputs.len(),
            ],
            stop: scene.inputs.interlocks.emergency_stop.is_some(),
            door: scene.inputs.interlocks.door.is_some(),
            probe: scene.inputs.interlocks.probe.is_some(),
            limits: scene.inputs.has_limit_pins(),
            button: scene.inputs.button.is_some(),
            interlocks: scene.inputs.have_contacts(),
            autonomous: scene.service.autonomous.is_some(),
            slots: slots.map(|slots| (slots, scene.tick_rate_hz)),
            usb_line: false,
        })
    }

    /// Names and values, as one build script hands them to another.
    pub fn metadata(&self) -> Vec<(&'static str, String)> {
        let mut metadata = vec![
            ("scene", self.scene.clone()),
            ("drive", self.drive.clone()),
            ("tool", self.tool.clone()),
        ];
        metadata.extend(self.board.clone().map(|board| ("board", board)));
        for (name, is_so) in self.flags() {
            if is_so {
                metadata.push((name, "yes".into()));
            }
        }
        if self.has_spare() {
            let [outputs, inputs] = self.spare.map(|count| count.to_string());
            metadata.push(("digital", "yes".into()));
            metadata.push(("spare_outputs", outputs));
            metadata.push(("spare_inputs", inputs));
        }
        if let Some((slots_hz, tick_rate_hz)) = self.slots {
            metadata.push(("slots_hz", slots_hz.to_string()));
            metadata.push(("tick_rate_hz", format!("{tick_rate_hz:?}")));
        }
        metadata
    }

    /// Functions for which the packages of boards have code of their own, each with its `cfg`.
    pub fn cfgs(&self) -> [(&'static str, bool); 6] {
        [
            ("homing", self.homing),
            ("brake", self.brake),
            ("lamp", self.lamp),
            ("digital", self.has_spare()),
            ("interlocks", self.interlocks),
            ("autonomous", self.autonomous),
        ]
    }

    /// Returns true if there is something that a failure has to switch off: drives, a tool or spare outputs.
    pub fn has_outputs(&self) -> bool {
        self.drive != "none" || self.has_tool() || self.has_spare()
    }

    fn flags(&self) -> [(&'static str, bool); 11] {
        [
            ("tool_enable", self.tool_enable),
            ("homing", self.homing),
            ("brake", self.brake),
            ("lamp", self.lamp),
            ("estop", self.stop),
            ("door", self.door),
            ("probe", self.probe),
            ("limits", self.limits),
            ("button", self.button),
            ("interlocks", self.interlocks),
            ("autonomous", self.autonomous),
        ]
    }

    /// Reads what [`metadata`](Self::metadata) wrote, by name.
    ///
    /// # Errors
    /// A value that is missing or none.
    pub fn read(value: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        let demand = |name: &str| value(name).ok_or_else(|| format!("trirrr-app gave no {name}"));
        let has = |name: &str| value(name).is_some();
        let number = |name: &str| -> Result<f64, String> {
            let text = demand(name)?;
            text.parse().map_err(|_| format!("{name}={text}"))
        };
        let slots = match has("slots_hz") {
            true => Some((number("slots_hz")? as u32, number("tick_rate_hz")?)),
            false => None,
        };
        let spare = match has("digital") {
            true => [number("spare_outputs")?, number("spare_inputs")?].map(|count| count as usize),
            false => [0; 2],
        };
        Ok(Self {
            scene: demand("scene")?,
            board: value("board"),
            drive: demand("drive")?,
            tool: demand("tool")?,
            tool_enable: has("tool_enable"),
            homing: has("homing"),
            brake: has("brake"),
            lamp: has("lamp"),
            spare,
            stop: has("estop"),
            door: has("door"),
            probe: has("probe"),
            limits: has("limits"),
            button: has("button"),
            interlocks: has("interlocks"),
            autonomous: has("autonomous"),
            slots,
            usb_line: false,
        })
    }

    /// Returns true if the scene names a spare output or input.
    pub(super) fn has_spare(&self) -> bool {
        self.spare != [0; 2]
    }

    /// Pins that the scene needs of a role whose pins are a list; 0 of any other role.
    pub(super) fn listed(&self, role: Role) -> usize {
        let [outputs, inputs] = self.spare;
        match role {
            Role::Outputs => outputs,
            Role::Inputs => inputs,
            _ => 0,
        }
    }

    /// Returns true if the scene has an output to a tool.
    pub(super) fn has_tool(&self) -> bool {
        !matches!(self.tool.as_str(), "none" | "")
    }

    /// Roles that need a pin, with what in the scene needs them.
    pub(super) fn roles(&self) -> BTreeMap<Role, &'static str> {
        let steppers = [Role::Step, Role::Direction, Role::StepperEnable];
        let amplifiers = [
            Role::SetValue,
            Role::Failure,
            Role::EncoderA,
            Role::EncoderB,
            Role::AmplifierEnable,
        ];
        let (drives, what): (&[Role], _) = match self.drive.as_str() {
            "stepper" => (&steppers, "steppers"),
            "bldc" => (&amplifiers, "brushless motors with amplifiers"),
            "none" => (&[], ""),
            _ => (&[Role::CanReceive, Role::CanTransmit], "drives on CAN"),
        };
        let others = [
            (self.has_tool(), Role::Tool, "a tool"),
            (
                self.tool_enable,
                Role::ToolEnable,
                "a tool with an enable line",
            ),
            (self.stop, Role::Stop, "an emergency stop"),
            (self.door, Role::Door, "a door"),
            (self.probe, Role::Probe, "a probe"),
            (
                self.limits,
                Role::Limits,
                "limit switches with pins of their own",
            ),
            (self.button, Role::Button, "a button"),
            (self.homing, Role::Homing, "homing"),
            (self.brake, Role::Brake, "a brake"),
            (self.lamp, Role::Lamp, "a status lamp"),
            (
                self.listed(Role::Outputs) > 0,
                Role::Outputs,
                "spare outputs",
            ),
            (self.listed(Role::Inputs) > 0, Role::Inputs, "spare inputs"),
        ];
        let drives = drives.iter().map(|role| (*role, what));
        let others = others.into_iter().filter(|(is_needed, ..)| *is_needed);
        drives
            .chain(others.map(|(_, role, what)| (role, what)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn of(scene: &str) -> Needs {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let file = scenes.join(scene);
        let scene = Scene::read(&file).expect("a shipped scene");
        Needs::of(&scene, &file.display().to_string(), None).expect("a board drives it")
    }

    #[test]
    fn needs_are_handed_on_whole() {
        for scene in [
            "thesis.toml",
            "engraving.toml",
            "inputs/guarded.toml",
            "inputs/probing.toml",
            "inputs/valves.toml",
            "pick-home.toml",
        ] {
            let mut needs = of(scene);
            needs.board = Some("feather-f405".into());
            let metadata: BTreeMap<_, _> = needs.metadata().into_iter().collect();
            let read = Needs::read(|name| metadata.get(name).cloned());
            assert_eq!(read.as_ref(), Ok(&needs), "{scene}");
        }
        let error = Needs::read(|_| None).expect_err("nothing was handed on");
        assert!(error.contains("scene"), "{error}");
    }

    #[test]
    fn a_scene_needs_what_it_names_and_no_more() {
        assert!(of("thesis.toml").roles().is_empty());
        let engraving = of("engraving.toml");
        let roles: Vec<Role> = engraving.roles().into_keys().collect();
        let steppers = [Role::Step, Role::Direction, Role::StepperEnable];
        assert_eq!(roles[..3], steppers);
        assert!(roles.contains(&Role::Tool) && !roles.contains(&Role::Stop));
        let roles = of("inputs/guarded.toml").roles();
        assert!(roles.contains_key(&Role::Stop) && roles.contains_key(&Role::Door));
        assert!(!roles.contains_key(&Role::Probe) && !roles.contains_key(&Role::Limits));
        let roles = of("inputs/probing.toml").roles();
        assert!(roles.contains_key(&Role::Probe) && roles.contains_key(&Role::Limits));
        assert!(roles.contains_key(&Role::Lamp) && !engraving.roles().contains_key(&Role::Lamp));
        assert!(!roles.contains_key(&Role::Outputs) && !roles.contains_key(&Role::Inputs));
        let valves = of("inputs/valves.toml");
        assert_eq!(valves.spare, [2, 1]);
        let roles = valves.roles();
        assert!(roles.contains_key(&Role::Outputs) && roles.contains_key(&Role::Inputs));
    }
}
