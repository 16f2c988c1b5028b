//! Tools of which a machine carries one, and the tool that a job is for.

use crate::Scene;
use trirrr_protocol::message::scene::Platform;

/// Relative difference of values that a board has taken into its units and back.
const ROUNDING: f64 = 1e-9;

/// Mass, moment of inertia, centre of mass and tool point of a platform with a tool on it, SI units, as a board tells them.
pub type ToolBody = [f64; 6];

/// Tools of a scene, and the one that its job is for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarriedTools {
    names: Vec<String>,
    bodies: Vec<ToolBody>,
    wanted: usize,
}

impl CarriedTools {
    /// The tools of `scene`; none of a scene without any.
    pub fn of(scene: &Scene) -> Option<Self> {
        let rack = scene.tools.as_ref()?;
        let bodies = 0..rack.tools().len();
        let body = |index| body(&Platform::from(&rack.put_into(&scene.parameters, index)));
        Some(Self {
            names: rack.tools().iter().map(|tool| tool.name.clone()).collect(),
            bodies: bodies.map(body).collect(),
            wanted: rack.mounted(),
        })
    }

    /// Puts tools together that another program has taken apart: `wanted` is the index of the one that the job is for. None where there is no
    /// such tool, or another number of bodies than of names.
    pub fn new(names: Vec<String>, bodies: Vec<ToolBody>, wanted: usize) -> Option<Self> {
        let is_whole = names.len() == bodies.len() && wanted < names.len();
        is_whole.then_some(Self {
            names,
            bodies,
            wanted,
        })
    }

    /// Returns the names of the tools.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the bodies of the platform with each tool.
    pub fn bodies(&self) -> &[ToolBody] {
        &self.bodies
    }

    /// Returns the index of the tool that the job is for.
    pub fn wanted(&self) -> usize {
        self.wanted
    }

    /// Returns the index of the tool that `platform` carries; none of a platform with no tool of the scene.
    pub fn found(&self, platform: &Platform) -> Option<usize> {
        let told = body(platform);
        self.bodies.iter().position(|own| {
            let mut pairs = told.iter().zip(own);
            // Lengths are compared in m, whatever their direction.
            let largest = |a: f64, b: f64| a.abs().max(b.abs()).max(1e-3);
            pairs.all(|(a, b)| (a - b).abs() <= ROUNDING * largest(*a, *b))
        })
    }

    /// Says that the machine carries the tool `found`, or none of these, and not the one that the job is for.
    pub fn complaint(&self, found: Option<usize>) -> String {
        let name = |index: usize| self.names.get(index).map_or("", String::as_str);
        let wanted = name(self.wanted);
        let carried = match found {
            Some(index) => format!("the tool {:?}", name(index)),
            None => "no tool of the scene".into(),
        };
        format!(
            "the machine carries {carried}, and the job is for the tool {wanted:?}: `trirrr tool SCENE --port PORT --mount {wanted}` once \
             that is on it, or `--set mounted=NAME` for a job with another"
        )
    }
}

fn body(of: &Platform) -> ToolBody {
    let [[cx, cy], [tx, ty]] = [of.com_m, of.tool_point_m];
    [of.mass_kg, of.inertia_kgm2, cx, cy, tx, ty]
}
