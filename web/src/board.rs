//! Scene as a conversation with its board needs it. The conversation is a module of its own, `web/board`.

use crate::Reading;
use trirrr_scene::{JobMove, Scene, in_number_type};
use wasm_bindgen::prelude::wasm_bindgen;

/// Scene of a board: plain numbers, so that they go from one module to the other.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoardScene {
    /// Name of the scene.
    pub name: String,
    /// Its number type.
    pub number: String,
    /// Its key.
    pub key: u32,
    /// Ticks per second; one unit of length, time and mass of the machine in SI; start of the job in these units, x, y, alpha; 1 in a scene
    /// with homing, or else 0.
    pub figures: Vec<f64>,
    /// Moves of the job in the machine's units, 22 numbers each: poses at both ends, velocities, accelerations; 1 for a quintic, or else 0;
    /// ticks; power of the tool and its speed.
    pub moves: Vec<f64>,
    /// Levels of the tool's power.
    pub levels: Vec<u8>,
    /// Levels of moves, 5 numbers each: index of the move, first level, count, offset, span.
    pub ranges: Vec<u32>,
    /// Spare outputs that change with moves, 3 numbers each: index of the move, outputs that go on and outputs that go off, a bit for each.
    pub outputs: Vec<u32>,
    /// Names of the tools of which the platform carries one.
    pub tools: Vec<String>,
    /// The index of the tool that the job is for, then the platform with each tool, 6 numbers each in SI units: mass, moment of inertia,
    /// centre of mass and tool point. Nothing of a scene without tools.
    pub bodies: Vec<f64>,
}

#[wasm_bindgen]
impl Reading {
    /// The scene for a conversation with its board, of a scene that was read [whole](Self::whole).
    ///
    /// # Errors
    /// The scene is refused, or was read as a draft.
    #[wasm_bindgen(js_name = boardScene)]
    pub fn board_scene(&self) -> Result<BoardScene, String> {
        BoardScene::of(self.good()?)
    }
}

impl BoardScene {
    fn of(scene: &Scene) -> Result<Self, String> {
        let units = in_number_type!(scene.number, N => trirrr_scene::units::<N>(scene));
        let units = units.map_err(|error| error.to_string())?;
        let job = scene.job.in_units(&units);
        let start = job.start;
        let ranges = job.levels.ranges.iter().flat_map(|(index, range)| {
            let (count, offset) = (range.count.into(), range.offset.into());
            [*index, range.first, count, offset, range.span]
        });
        let changes = job.outputs.changes().iter();
        let outputs = changes.flat_map(|(index, bits)| [*index, bits.on.into(), bits.off.into()]);
        let tools = trirrr_scene::CarriedTools::of(scene).unwrap_or_default();
        Ok(Self {
            name: scene.name.clone(),
            number: scene.number.to_string(),
            key: scene.key,
            figures: vec![
                scene.tick_rate_hz,
                units.length_m(),
                units.time_s(),
                units.of(0, 0, 1),
                start.position.x,
                start.position.y,
                start.angle,
                f64::from(u8::from(scene.homing.is_some())),
            ],
            moves: job.moves.iter().flat_map(numbers).collect(),
            ranges: ranges.collect(),
            outputs: outputs.collect(),
            levels: job.levels.levels,
            tools: tools.names().to_vec(),
            bodies: match tools.names() {
                [] => Vec::new(),
                _ => [&[tools.wanted() as f64], tools.bodies().as_flattened()].concat(),
            },
        })
    }
}

fn numbers(each: &JobMove) -> impl Iterator<Item = f64> {
    let pose =
        |pose: &trirrr_core::setpoint::Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
    let [begin, end] = each.accelerations.unwrap_or_default();
    let ends = [
        pose(&each.from),
        pose(&each.to),
        each.start_velocity.into(),
        each.end_velocity.into(),
        begin.into(),
        end.into(),
    ];
    let (power, speed) = each
        .tool
        .map_or((0.0, 0.0), |tool| (tool.power, tool.speed_m_s));
    let is_quintic = f64::from(u8::from(each.accelerations.is_some()));
    let ticks = f64::from(each.duration_ticks);
    ends.into_iter()
        .flatten()
        .chain([is_quintic, ticks, power, speed])
}
