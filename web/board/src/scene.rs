//! Scene as the first module tells it.

use nalgebra::Vector3;
use trirrr_client::describe::Units;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::LevelRange;
use trirrr_scene::{CarriedTools, JobLevels, JobMove, JobOutputs, NumberType, OutputBits, Tool};

/// Numbers of a move.
const MOVE: usize = 22;

/// Scene of a board.
pub(crate) struct TalkScene {
    pub(crate) name: String,
    pub(crate) number: NumberType,
    pub(crate) key: u32,
    pub(crate) units: Units,
    /// Start of the job, in the machine's units,
    pub(crate) start: Pose<f64>,
    /// and its moves.
    pub(crate) moves: Vec<JobMove>,
    pub(crate) levels: JobLevels,
    pub(crate) has_homing: bool,
    /// Spare outputs that change with the moves.
    pub(crate) outputs: JobOutputs,
    /// Tools, and the one that the job is for.
    pub(crate) tools: Option<CarriedTools>,
}

impl TalkScene {
    /// Reads the parts of a scene.
    pub(crate) fn new(
        name: String,
        number: &str,
        key: u32,
        figures: &[f64],
        moves: &[f64],
        levels: Vec<u8>,
        ranges: &[u32],
    ) -> Result<Self, String> {
        let mut numbers = NumberType::ALL.into_iter();
        let number = numbers.find(|each| each.to_string() == number);
        let [rate, length_m, time_s, mass_kg, x, y, alpha, homing] = *figures else {
            return Err("a scene has eight figures".into());
        };
        Ok(Self {
            name,
            number: number.ok_or("no such number type")?,
            key,
            units: Units {
                length_m,
                time_s,
                mass_kg,
                tick_rate_hz: rate,
            },
            start: Pose::from_f64(x, y, alpha),
            moves: moves.chunks(MOVE).map(one).collect::<Result<_, _>>()?,
            levels: JobLevels {
                levels,
                ranges: ranges.chunks(5).map(range).collect::<Result<_, _>>()?,
            },
            has_homing: homing != 0.0,
            outputs: JobOutputs::default(),
            tools: None,
        })
    }

    /// Reads the outputs that change with the moves.
    pub(crate) fn switch(&mut self, outputs: &[u32]) -> Result<(), String> {
        let (changes, rest) = outputs.as_chunks();
        for [index, on, off] in changes {
            let bits = |value: u32| u8::try_from(value).map_err(|_| "there are eight outputs");
            let (on, off) = (bits(*on)?, bits(*off)?);
            self.outputs.add(*index, OutputBits { on, off });
        }
        match rest {
            [] => Ok(()),
            _ => Err("a change of outputs has three numbers".into()),
        }
    }

    /// Reads the tools of the scene, and which of them the job is for.
    pub(crate) fn carry(&mut self, names: Vec<String>, bodies: &[f64]) -> Result<(), String> {
        let [wanted, bodies @ ..] = bodies else {
            return Ok(());
        };
        let (bodies, rest) = bodies.as_chunks();
        // From float to integer the cast saturates.
        let tools = CarriedTools::new(names, bodies.to_vec(), *wanted as usize);
        self.tools = tools.filter(|_| rest.is_empty());
        match self.tools {
            Some(_) => Ok(()),
            None => Err("a tool has a name and six numbers".into()),
        }
    }
}

fn one(numbers: &[f64]) -> Result<JobMove, String> {
    let numbers = <[f64; MOVE]>::try_from(numbers).map_err(|_| "a move has 22 numbers")?;
    let triple = |index: usize| Vector3::from_column_slice(&numbers[3 * index..][..3]);
    let pose = |index: usize| {
        let [x, y, alpha] = triple(index).into();
        Pose::from_f64(x, y, alpha)
    };
    let [.., is_quintic, ticks, power, speed_m_s] = numbers;
    Ok(JobMove {
        from: pose(0),
        to: pose(1),
        start_velocity: triple(2),
        end_velocity: triple(3),
        accelerations: (is_quintic != 0.0).then(|| [triple(4), triple(5)]),
        // From float to integer the cast saturates.
        duration_ticks: ticks as u32,
        tool: Some(Tool { power, speed_m_s }),
    })
}

fn range(numbers: &[u32]) -> Result<(u32, LevelRange), String> {
    let [index, first, count, offset, span] = *numbers else {
        return Err("a range of levels has five numbers".into());
    };
    let narrow = |value: u32| u16::try_from(value).map_err(|_| "a range of levels is too long");
    let range = LevelRange {
        first,
        count: narrow(count)?,
        offset: narrow(offset)?,
        span,
    };
    Ok((index, range))
}
