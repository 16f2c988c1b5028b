//! `[[tools]]`: tools of which the platform carries one, and `mounted`.

use crate::read::{Bound, Section};
use nalgebra::Vector2;
use trirrr_core::machine::{Parameters, PlatformParameters};

/// Most tools of a scene.
const MOST_TOOLS: usize = 32;

/// A tool that the platform may carry. Vectors are in the frame of the bare platform.
#[derive(Clone, Debug, PartialEq)]
pub struct MountableTool {
    /// Name: letters, digits, `-` and `_`.
    pub name: String,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moment of inertia about its centre of mass, kg m^2.
    pub inertia_kgm2: f64,
    /// Centre of mass, m.
    pub com_m: [f64; 2],
    /// Tool point, m.
    pub point_m: [f64; 2],
}

/// Tools of which the platform carries one.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolRack {
    bare: PlatformParameters,
    tools: Vec<MountableTool>,
    mounted: usize,
}

impl ToolRack {
    pub(crate) fn new(bare: PlatformParameters, tools: Vec<MountableTool>, mounted: usize) -> Self {
        Self {
            bare,
            tools,
            mounted,
        }
    }

    /// Returns the tools in the order of the file; at least one.
    pub fn tools(&self) -> &[MountableTool] {
        &self.tools
    }

    /// Returns the index of the tool that the scene has mounted: its job is for this one.
    pub fn mounted(&self) -> usize {
        self.mounted
    }

    /// Returns the index of the tool `name`.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.tools.iter().position(|tool| tool.name == name)
    }

    /// Returns the bare platform of `platform`, which carries the mounted tool; as it is where it weighs no more than the tool.
    pub fn without_mounted(&self, platform: &PlatformParameters) -> PlatformParameters {
        let in_own_frame = platform.at_tool_point(Vector2::zeros());
        without(&in_own_frame, &self.tools[self.mounted])
    }

    /// Returns `parameters` with the tool `index` on the platform and the reference point at its tool point.
    ///
    /// # Panics
    /// If there is no such tool.
    pub fn put_into(&self, parameters: &Parameters, index: usize) -> Parameters {
        let tool = &self.tools[index];
        let point = Vector2::from(tool.point_m);
        Parameters {
            platform: carrying(&self.bare, tool).at_tool_point(point),
            ..parameters.at_tool_point(point)
        }
    }
}

/// The body that is left of `whole` without `part`: masses, centres and moments of inertia in one frame.
fn without(whole: &PlatformParameters, part: &MountableTool) -> PlatformParameters {
    let mass_kg = whole.mass_kg - part.mass_kg;
    let of_part = Vector2::from(part.com_m);
    if mass_kg <= 0.0 {
        return *whole;
    }
    let com_m = (whole.com_m * whole.mass_kg - of_part * part.mass_kg) / mass_kg;
    let about = |mass: f64, com: Vector2<f64>| {
        let arm = com - whole.com_m;
        mass * arm.dot(&arm)
    };
    PlatformParameters {
        mass_kg,
        inertia_kgm2: whole.inertia_kgm2
            - about(mass_kg, com_m)
            - about(part.mass_kg, of_part)
            - part.inertia_kgm2,
        com_m,
        ..*whole
    }
}

/// Platform with `tool`, a single body in the frame of the bare platform.
fn carrying(bare: &PlatformParameters, tool: &MountableTool) -> PlatformParameters {
    let mass_kg = bare.mass_kg + tool.mass_kg;
    let of_tool = Vector2::from(tool.com_m);
    if mass_kg == 0.0 {
        return *bare;
    }
    let com_m = (bare.com_m * bare.mass_kg + of_tool * tool.mass_kg) / mass_kg;
    let about = |mass: f64, com: Vector2<f64>| {
        let arm = com - com_m;
        mass * arm.dot(&arm)
    };
    PlatformParameters {
        mass_kg,
        inertia_kgm2: bare.inertia_kgm2
            + about(bare.mass_kg, bare.com_m)
            + tool.inertia_kgm2
            + about(tool.mass_kg, of_tool),
        com_m,
        ..*bare
    }
}

/// Reads `[[tools]]`, and the index of the one that `mounted` names; `Some(None)` without them.
pub(crate) fn read_tools(root: &Section) -> Option<Option<(Vec<MountableTool>, usize)>> {
    if !root.has("tools") {
        if root.has("mounted") {
            root.refuse("mounted", "names a tool, and the scene has no [[tools]]");
            return None;
        }
        return Some(None);
    }
    let sections = root.sections("tools")?;
    if !(1..=MOST_TOOLS).contains(&sections.len()) {
        let found = sections.len();
        root.refuse_list(
            "tools",
            format!("expected 1 to {MOST_TOOLS} [[tools]], found {found}"),
        );
        return None;
    }
    let mut tools: Vec<MountableTool> = Vec::with_capacity(sections.len());
    let mut is_good = true;
    for section in &sections {
        match read_tool(section) {
            Some(tool) if tools.iter().any(|other| other.name == tool.name) => {
                section.refuse("name", "another of [[tools]] has this name");
                is_good = false;
            }
            Some(tool) => tools.push(tool),
            None => is_good = false,
        }
    }
    if !is_good {
        root.has("mounted");
        return None;
    }
    let mounted = match root.has("mounted") {
        true => {
            let names: Vec<(&str, usize)> = tools
                .iter()
                .map(|tool| tool.name.as_str())
                .zip(0..)
                .collect();
            root.choice("mounted", &names)?
        }
        false => 0,
    };
    Some(Some((tools, mounted)))
}

fn read_tool(section: &Section) -> Option<MountableTool> {
    let name = section.folder_name("name");
    let mass = section.number("mass_kg", Bound::NotNegative);
    let inertia = section.number_or("inertia_kgm2", Bound::NotNegative, 0.0);
    let point = section.vector("point_m", Some([0.0; 2]));
    let com = section.vector("com_m", point);
    Some(MountableTool {
        name: name?,
        mass_kg: mass?,
        inertia_kgm2: inertia?,
        com_m: com?,
        point_m: point?,
    })
}
